//! Unit tests of `crates/base/src/linalg/semidefinite.rs`.

use super::*;
use crate::matrices::random;

/// V Vᵀ with n × r random V, rows scaled over twelve decades.
fn gram(n: usize, r: usize) -> (Dense, Vec<Vec<f64>>) {
    let v: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let size = 10f64.powi((i % 7) as i32 - 3);
            random(r, i as u64 + 1).iter().map(|x| size * x).collect()
        })
        .collect();
    let mut a = Dense::zeros(n, n);
    for i in 0..n {
        for j in 0..n {
            a.set(i, j, v[i].iter().zip(&v[j]).map(|(a, b)| a * b).sum());
        }
    }
    (a, v)
}

#[test]
fn rank_is_found_and_the_solution_reproduces_the_right_hand_side() {
    for (n, r) in [(12, 12), (12, 5), (30, 8)] {
        let (a, _) = gram(n, r);
        let factor = Semidefinite::new(&a);
        assert_eq!(factor.rank(), r);
        let x = random(n, 77);
        let mut b = vec![0.0; n];
        a.add_mul(&x, &mut b);
        let mut y = b.clone();
        factor.solve(&mut y);
        let mut back = vec![0.0; n];
        a.add_mul(&y, &mut back);
        for i in 0..n {
            let size = a.get(i, i).sqrt() * 10.0;
            assert!((back[i] - b[i]).abs() < 1e-6 * size, "{} {}", back[i], b[i]);
        }
    }
}

#[test]
fn zero_columns_are_dropped() {
    let mut a = Dense::zeros(3, 3);
    a.set(0, 0, 4.0);
    a.set(2, 2, 1.0);
    let factor = Semidefinite::new(&a);
    assert_eq!(factor.dropped(), [1]);
    let mut x = [8.0, 5.0, 3.0];
    factor.solve(&mut x);
    assert_eq!(x, [2.0, 0.0, 3.0]);
}

#[test]
fn a_dependent_column_that_no_pivot_shows_is_found() {
    // V with V z = 0 for a z that hardly has the last column: the last pivot is rounding over its square, 1e-7.
    let z = [0.5, -0.3, 0.7, 0.4, 1e-5];
    let n = z.len();
    let square: f64 = z.iter().map(|z| z * z).sum();
    let rows: Vec<Vec<f64>> = (0..7)
        .map(|i| {
            let mut row = random(n, i + 1);
            let part: f64 = row.iter().zip(z).map(|(v, z)| v * z).sum();
            row.iter_mut()
                .zip(z)
                .for_each(|(v, z)| *v -= part / square * z);
            row
        })
        .collect();
    let a = Dense::from_fn(n, n, |i, j| rows.iter().map(|row| row[i] * row[j]).sum());
    let factor = Semidefinite::new(&a);
    assert_eq!(factor.rank(), n - 1, "{:?}", factor.dropped());
}
