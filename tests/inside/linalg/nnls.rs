//! Unit tests of `src/linalg/nnls.rs`.

use super::*;

fn dense(rows: &[&[f64]]) -> Dense {
    let mut a = Dense::zeros(rows.len(), rows[0].len());
    for (i, row) in rows.iter().enumerate() {
        row.iter().enumerate().for_each(|(j, &v)| a.set(i, j, v));
    }
    a
}

#[test]
fn a_vector_in_the_cone_is_reached() {
    let a = dense(&[&[1.0, 1.0, 0.0], &[0.0, 1.0, -1.0]]);
    let (x, r) = nnls(&a, &[3.0, -2.0], &[false; 3]);
    assert!(r.iter().all(|r| r.abs() < 1e-14), "{r:?}");
    assert!(x.iter().all(|x| *x >= 0.0), "{x:?}");
}

#[test]
fn outside_the_cone_the_residual_separates() {
    let a = dense(&[&[1.0, 1.0], &[0.0, 1.0]]);
    let (_, r) = nnls(&a, &[-1.0, 2.0], &[false; 2]);
    // The nearest point of the cone is 0.5 (1, 1).
    assert!(
        (r[0] + 1.5).abs() < 1e-14 && (r[1] - 1.5).abs() < 1e-14,
        "{r:?}"
    );
    let (x, r) = nnls(&a, &[-1.0, 2.0], &[true, false]);
    assert!(r.iter().all(|r| r.abs() < 1e-14) && x[0] < 0.0, "{x:?}");
}

#[test]
fn dependent_columns_do_no_harm() {
    let a = dense(&[&[1.0, 2.0, -1.0, 0.0], &[1.0, 2.0, -1.0, 0.0]]);
    let (x, r) = nnls(&a, &[2.0, 0.0], &[false; 4]);
    assert!(
        (r[0] - 1.0).abs() < 1e-13 && (r[1] + 1.0).abs() < 1e-13,
        "{x:?} {r:?}"
    );
}

#[test]
fn the_shortest_minimiser_is_that_of_singular_values() {
    // Full rank, more rows than columns, fewer, and dependent columns.
    for (m, n, rank) in [
        (5, 3, 3),
        (3, 5, 3),
        (6, 6, 2),
        (4, 7, 2),
        (1, 1, 1),
        (3, 2, 0),
    ] {
        let value = |i: usize, j: usize| ((7 * i + 13 * j + i * j) as f64 * 0.618).sin();
        let entry = |i: usize, j: usize| {
            let terms = (0..rank).map(|k| value(i + 11 * k, k) * value(k + 3, j + 5 * k));
            terms.sum::<f64>()
        };
        let a = Dense::from_fn(m, n, entry);
        let b: Vec<f64> = (0..m).map(|i| value(i, 40)).collect();
        let columns: Vec<usize> = (0..n).collect();
        let ours = least_squares(&a, &b, &columns);
        let svd = faer::Mat::from_fn(m, n, entry).thin_svd();
        let svd = svd.expect("the iteration ends");
        let sigma = svd.S().column_vector();
        for (k, x) in ours.iter().enumerate() {
            let kept = (0..sigma.nrows()).filter(|&l| sigma[l] > 1e-12 * sigma[0]);
            let terms = kept.map(|l| {
                let c: f64 = (0..m).map(|i| svd.U()[(i, l)] * b[i]).sum();
                c / sigma[l] * svd.V()[(k, l)]
            });
            let y: f64 = terms.sum();
            assert!((x - y).abs() < 1e-10, "{m} x {n}: {x} {y}");
        }
    }
}
