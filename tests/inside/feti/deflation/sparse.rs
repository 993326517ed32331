//! Unit tests of `src/feti/deflation/sparse.rs`.

use super::*;
use crate::feti::projector::sweep::MultiplierColumn;
use crate::matrices::random;
use crate::testing::with_session;
use base::linalg::semidefinite::Semidefinite;

/// Bodies in a line, three columns each on the rows of the body and of its neighbours; every tenth body repeats a
/// column of the body before it.
fn columns(bodies: usize, rows_of_body: usize) -> Vec<MultiplierColumn> {
    let draw = random(bodies * 9 * rows_of_body, 5);
    let mut out: Vec<MultiplierColumn> = Vec::new();
    for body in 0..bodies {
        let (low, high) = (body.saturating_sub(1), (body + 2).min(bodies));
        let rows = low * rows_of_body..high * rows_of_body;
        for c in 0..3 {
            let values = &draw[(3 * body + c) * 3 * rows_of_body..];
            let entries = rows.clone().zip(values).map(|(r, v)| (r as u32, *v));
            out.push(MultiplierColumn {
                entries: if body % 10 == 9 && c == 0 {
                    out[3 * body - 1].entries.clone()
                } else {
                    entries.collect()
                },
                reach: vec![body as u32],
            });
        }
    }
    out
}

#[test]
fn a_sparse_factor_solves_as_the_dense_one_does() {
    with_session(|session| {
        let w = columns(80, 4);
        // F is diagonal, with weights over six orders.
        let weight = |row: u32| 10f64.powi((row % 7) as i32 - 3);
        let image = |column: &MultiplierColumn| MultiplierColumn {
            entries: column
                .entries
                .iter()
                .map(|e| (e.0, weight(e.0) * e.1))
                .collect(),
            reach: column.reach.clone(),
        };
        let fw: Vec<MultiplierColumn> = w.iter().map(image).collect();
        let (pw, pf) = (Panels::new(&w), Panels::new(&fw));
        let (shape, e) = product(session.comm(), [&pw, &pf], None, None);
        let n = w.len();
        let mut whole = Dense::zeros(n, n);
        pw.add_product(&pf, &mut whole, (0, 0));
        let largest = whole.data.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        for i in 0..n {
            for j in 0..n {
                assert!((e.get(i, j) - whole.get(i, j)).abs() < 1e-14 * largest);
            }
        }
        assert!(e.nnz() < n * n / 8, "{} entries are not sparse", e.nnz());
        let dense = Semidefinite::new(&whole);
        // The pattern is kept where it suffices.
        let (again, _) = product(session.comm(), [&pw, &pf], None, Some(shape.clone()));
        assert!(Rc::ptr_eq(&shape, &again));
        let sparse = Sparse::new(shape, e);
        assert_eq!(sparse.rank(), dense.rank());
        assert_eq!(sparse.rank(), n - 8);
        let x = random(n, 11);
        let mut b = vec![0.0; n];
        whole.add_mul(&x, &mut b);
        let (mut c, mut d) = (b.clone(), b.clone());
        sparse.solve(&mut c);
        dense.solve(&mut d);
        // Solutions differ in what E maps to zero.
        for solution in [&c, &d] {
            let mut image = vec![0.0; n];
            whole.add_mul(solution, &mut image);
            for (i, (p, q)) in image.iter().zip(&b).enumerate() {
                let size = whole.get(i, i).sqrt() * b.iter().fold(0.0f64, |a, v| a.max(v.abs()));
                assert!((p - q).abs() < 1e-10 * size, "entry {i}: {p} and {q}");
            }
        }
    });
}
