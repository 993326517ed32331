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
