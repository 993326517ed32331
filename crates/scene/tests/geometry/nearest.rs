use super::*;

/// Every answer is that of a search through all points, also where distances are equal.
#[test]
fn the_nearest_point_is_found() {
    let mut state = 7_u64;
    let mut number = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((state >> 33) % 20) as f64
    };
    for n in [1, 2, 3, 50, 400] {
        let points: Vec<[f64; 3]> = (0..n).map(|_| [number(), number(), number()]).collect();
        let tree = Nearest::new(&points);
        for _ in 0..200 {
            let x = [number() - 5.0, number() + 0.5, 2.0 * number()];
            let square = |p: &[f64; 3]| (0..3).map(|d| (p[d] - x[d]).powi(2)).sum::<f64>();
            let expected =
                (0..n).min_by(|&a, &b| square(&points[a]).total_cmp(&square(&points[b])));
            assert_eq!(tree.find(x), expected);
        }
    }
    assert_eq!(Nearest::new(&[]).find([0.0; 3]), None);
}
