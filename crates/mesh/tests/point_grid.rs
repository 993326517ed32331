//! Points in boxes, small and large ones.

use super::PointGrid;

#[test]
fn boxes_of_any_size_have_the_points_inside() {
    let points = [
        [0.5, 0.5, 0.0],
        [3.5, 0.5, 0.0],
        [1e6, 2.0, 0.0],
        [-7.0, 1e9, 1e9],
    ];
    let grid = PointGrid::new(points.into_iter().enumerate(), 1.0);
    let within = |low: f64, high: f64| -> Vec<usize> { grid.within([low; 3], [high; 3]).collect() };
    assert_eq!(within(0.1, 0.9), [0]);
    assert_eq!(within(-0.1, 5.0), [0, 1]);
    // Boxes of more cells than anyone could look at.
    assert_eq!(within(-1e3, 1e7), [0, 1, 2]);
    assert_eq!(within(f64::NEG_INFINITY, f64::INFINITY), [0, 1, 2, 3]);
    assert!(within(5.0, 100.0).is_empty());
    assert_eq!(grid.around([0.0; 3], 2e6).collect::<Vec<_>>(), [0, 1, 2]);
}
