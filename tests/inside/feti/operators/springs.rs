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

/// A soft point between two stiff ones, by two rows: equal and opposite forces load the stiff points alone.
#[test]
fn springs_that_are_softer_than_their_nodes_are_found() {
    let b = Dense::from_fn(2, 3, |r, k| [[1.0, -1.0, 0.0], [0.0, -1.0, 1.0]][r][k]);
    let weights = [1e4, 1.0, 1e4];
    let f = compliance_of_nodes(&b, &[0, 1], &weights, 2.0);
    // The trace is what is given, and the shape that of B D⁻¹ Bᵀ.
    assert!((f.get(0, 0) + f.get(1, 1) - 2.0).abs() < 1e-14);
    assert!((f.get(0, 1) / f.get(0, 0) - 1.0 / 1.0001).abs() < 1e-12);
    let n = soft(&f, &[1.0 / 30.0; 2]);
    assert_eq!(n.cols, 1);
    assert!((n.get(0, 0) + n.get(1, 0)).abs() < 1e-12 * n.get(0, 0).abs());
    // N is orthogonal to the rest in F and in C.
    let c = [1e-3, 4e-3];
    let n = soft(&f, &c);
    assert_eq!(n.cols, 1);
    let x = inverse(&n, &c);
    for (i, c) in c.iter().enumerate() {
        // Rest = e_i − X C e_i; Nᵀ F rest = 0.
        let rest = [0, 1].map(|k| f64::from(u8::from(k == i)) - x.get(k, i) * c);
        let work: f64 = (0..4)
            .map(|k| n.get(k / 2, 0) * f.get(k / 2, k % 2) * rest[k % 2])
            .sum();
        assert!(work.abs() < 1e-9 * n.get(0, 0).abs(), "{work}");
    }
    // Stiff springs leave all to M⁻¹, soft ones nothing.
    assert_eq!(soft(&f, &[1e-9; 2]).cols, 0);
    assert_eq!(soft(&f, &[0.0; 2]).cols, 0);
    assert_eq!(soft(&f, &[100.0; 2]).cols, 2);
}
