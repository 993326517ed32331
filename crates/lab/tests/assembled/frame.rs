//! Unit tests of `crates/lab/src/assembled/frame.rs`.

use super::*;

#[test]
fn directions_are_found_again_and_the_rest_is_orthogonal() {
    let n = [0.6, 0.8, 0.0];
    let frame = NodeFrame::new(&[n], [true, true, false]).expect("one direction");
    assert_eq!(frame.place(n.map(|v| -v)), Some((1, -1.0)));
    assert!(dot(frame.to[0], frame.to[1]).abs() < 1e-15);
    assert_eq!(frame.to[2], [0.0, 0.0, 1.0]);
    // Two walls that are not at right angles.
    let frame = NodeFrame::new(&[n, [1.0, 0.0, 0.0]], [true; 3]).expect("independent");
    for r in 0..3 {
        for c in 0..3 {
            let sum: f64 = (0..3).map(|k| frame.to[r][k] * frame.from[k][c]).sum();
            assert!((sum - f64::from(r == c)).abs() < 1e-14);
        }
    }
    assert!(frame.place(n).is_some() && frame.place([1.0, 0.0, 0.0]).is_some());
    assert_eq!(frame.place([0.0, 1.0, 0.0]), None);
}

#[test]
fn axes_change_nothing_and_dependent_directions_have_no_frame() {
    let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    assert!(NodeFrame::new(&[y], [true; 3]).is_some_and(|f| f.is_identity()));
    assert!(NodeFrame::new(&[y, x], [true; 3]).is_some_and(|f| f.is_identity()));
    assert_eq!(
        NodeFrame::new(&[x, y, [0.6, 0.8, 0.0]], [true, true, false]),
        None
    );
    assert_eq!(NodeFrame::new(&[x, y], [true, false, false]), None);
    let close = [1.0, 0.01, 0.0];
    assert_eq!(NodeFrame::new(&[x, close], [true; 3]), None);
}
