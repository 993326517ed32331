//! Unit tests of `crates/base/src/linalg/nnls.rs`.

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

/// Two directions that differ by rounding are one: their difference carries nothing, and makes no x of 1e11 whose terms
/// leave 1e-5 of the residual to rounding.
#[test]
fn directions_that_differ_by_noise_are_one() {
    let noise = 1e-10;
    for delta in [0.0, 1e-13, 1e-12, 3e-12, 1e-11, 5e-11] {
        let a = dense(&[&[1.0, 1.0, 0.0], &[0.3, 0.3 + delta, 0.0], &[0.0, 0.0, 1.0]]);
        let (x, r) = nnls_within(&a, &[1.0, 0.4, 2.0], &[true, true, false], noise);
        assert!(x.iter().all(|x| x.abs() < 3.0), "{delta}: {x:?}");
        // The distance of (1, 0.4) from the line along (1, 0.3).
        let far = 0.1 / 1.09f64.sqrt();
        assert!(
            (r[0].hypot(r[1]) - far).abs() < 10.0 * noise,
            "{delta}: {r:?}"
        );
        let (_, r) = nnls_within(&a, &[1.0, 0.3, 2.0], &[true, true, false], noise);
        assert!(r.iter().all(|r| r.abs() < 10.0 * noise), "{delta}: {r:?}");
    }
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
        let ours = least_squares(&a, &b, &columns, ROUNDING);
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

/// Costs of sizes r: 1, r, r log r, and the same times the part beyond a cache, with the noise of a clock. The way to
/// the next minimiser ends at a column that rounding may keep above zero (round 840); the search ends all the same.
#[test]
fn columns_that_hardly_differ_end_the_search() {
    let sizes: [f64; 9] = [3.0, 4.0, 9.0, 16.0, 36.0, 64.0, 196.0, 900.0, 3844.0];
    let often = [0, 1, 2, 3, 4, 4, 5, 6, 6, 7, 7, 8].map(|k| sizes[k]);
    for round in 0..3000u64 {
        let draws = crate::matrices::random(13, round + 1);
        let cache = 10.0 * 2f64.powf((round % 7) as f64);
        let term = |r: f64, j: usize| {
            let part = if r > cache { 1.0 - cache / r } else { 0.0 };
            let cost = [1.0, r, r * (r + 1.0).log2()][j % 3];
            cost * if j < 3 { 1.0 } else { part } / (1.0 + 0.1 * r)
        };
        let length = |j: usize| {
            often
                .iter()
                .map(|&r| term(r, j).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        let scale: Vec<f64> = (0..6).map(|j| length(j).max(1e-300)).collect();
        let a = Dense::from_fn(12, 6, |i, j| term(often[i], j) / scale[j]);
        let b: Vec<f64> = (0..12).map(|i| 1.0 + 0.5 * draws[i]).collect();
        let (x, r) = nnls(&a, &b, &[false; 6]);
        assert!(x.iter().all(|x| *x >= 0.0), "round {round}: {x:?}");
        let size = b.iter().map(|b| b * b).sum::<f64>().sqrt();
        for j in 0..6 {
            let gain: f64 = a.col(j).iter().zip(&r).map(|(a, r)| a * r).sum();
            assert!(gain < 1e-9 * size, "round {round}, column {j}: {gain:.1e}");
        }
    }
}
