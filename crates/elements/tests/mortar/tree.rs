//! Unit tests of `crates/elements/src/mortar/tree.rs`.

use super::*;

#[test]
fn what_meets_is_found_and_nothing_else() {
    // Boxes of different sizes in a spiral.
    let boxes: Vec<Bounds> = (0..97)
        .map(|k| {
            let (t, size) = (0.37 * f64::from(k), 0.05 * f64::from(k % 7));
            let x = [t * t.cos(), t * t.sin(), 0.1 * t];
            [x, x.map(|v| v + size)]
        })
        .collect();
    let tree = Tree::new(boxes.clone());
    let mut most = 0;
    for k in 0..50 {
        let x = [-12.0 + 0.5 * f64::from(k), 3.0 - 0.3 * f64::from(k), 0.0];
        let place = [x, x.map(|v| v + 4.0)];
        let expected: Vec<u32> = (0..97)
            .filter(|&b| meet(&boxes[b as usize], &place))
            .collect();
        assert_eq!(tree.meet(&place), expected);
        most = most.max(expected.len());
    }
    assert!(most > 3);
    assert!(Tree::new(Vec::new()).meet(&[[0.0; 3]; 2]).is_empty());
}
