//! Unit tests of `src/feti/operators/springs.rs`.

use super::*;

/// Differences around a point where four bodies meet: four rows, rank three.
fn around_a_cross_point() -> faer::Mat<f64> {
    let rows = [[0, 1], [2, 3], [0, 2], [1, 3]];
    faer::Mat::from_fn(4, 4, |r, c| {
        f64::from(u8::from(rows[r][0] == c)) - f64::from(u8::from(rows[r][1] == c))
    })
}

fn orthonormal(b: &faer::Mat<f64>) -> Dense {
    let range = scaling::range(b);
    Dense::from_fn(b.nrows(), range.ncols(), |i, j| range[(i, j)])
}

#[test]
fn the_complement_exerts_no_force() {
    let b = around_a_cross_point();
    let n = complement(&orthonormal(&b));
    assert_eq!((n.rows, n.cols), (4, 1));
    for c in 0..4 {
        let force: f64 = (0..4).map(|r| b[(r, c)] * n.get(r, 0)).sum();
        assert!(force.abs() < 1e-14, "{force}");
    }
    let square: f64 = n.col(0).iter().map(|v| v * v).sum();
    assert!((square - 1.0).abs() < 1e-14);
}

#[test]
fn the_parts_are_orthogonal_whatever_the_compliance() {
    let n = complement(&orthonormal(&around_a_cross_point()));
    for c in [[1.0; 4], [1e-6, 1.0, 1e6, 3.0], [0.0, 0.0, 1e-9, 1.0]] {
        let x = inverse(&n, &c);
        let largest = x.data.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        // X C X = X and X symmetric: Π = I − X C projects along the multipliers without forces.
        for i in 0..4 {
            for j in 0..4 {
                let xcx: f64 = (0..4).map(|k| x.get(i, k) * c[k] * x.get(k, j)).sum();
                assert!((xcx - x.get(i, j)).abs() < 1e-12 * largest, "{c:?}");
                assert!((x.get(i, j) - x.get(j, i)).abs() < 1e-14 * largest);
            }
        }
    }
}

#[test]
fn rigid_rows_have_no_springs() {
    let n = complement(&orthonormal(&around_a_cross_point()));
    assert!(inverse(&n, &[0.0; 4]).data.iter().all(|v| *v == 0.0));
}

#[test]
fn rounding_is_no_compliance() {
    // Three tied rows around a point depend on each other; the fourth row is a spring and does not.
    let n = Dense::from_fn(4, 1, |i, _| [1.0, 1.0, -1.0, 1e-17][i]);
    assert!(inverse(&n, &[0.0, 0.0, 0.0, 1.0])
        .data
        .iter()
        .all(|v| *v == 0.0));
}
