//! Unit tests of `crates/cholesky/src/multifrontal.rs`.

use super::*;
use crate::matrices::{dense_of, distance, grid_laplacian, random};

fn rim(nx: usize, ny: usize) -> Vec<u32> {
    let on_rim = |i: &u32| {
        let (x, y) = (*i as usize % nx, *i as usize / nx);
        x == 0 || y == 0 || x == nx - 1 || y == ny - 1
    };
    (0..(nx * ny) as u32).filter(on_rim).collect()
}

/// K_ΓΓ − K_ΓI K_II⁻¹ K_IΓ by faer's dense LU.
fn reference(k: &Csr, interface: &[u32]) -> faer::Mat<f64> {
    use faer::linalg::solvers::Solve;
    let a = dense_of(k);
    let inside: Vec<usize> = (0..k.n())
        .filter(|i| !interface.contains(&(*i as u32)))
        .collect();
    let pick =
        |r: &[usize], c: &[usize]| faer::Mat::from_fn(r.len(), c.len(), |i, j| a[(r[i], c[j])]);
    let outside: Vec<usize> = interface.iter().map(|&i| i as usize).collect();
    let inner = pick(&inside, &inside).partial_piv_lu();
    pick(&outside, &outside) - pick(&outside, &inside) * inner.solve(pick(&inside, &outside))
}

#[test]
fn schur_complement_equals_the_dense_one_even_when_k_is_singular() {
    for shift in [0.0, 0.3] {
        let (k, x) = grid_laplacian(19, 14, shift);
        let interface = rim(19, 14);
        for coordinates in [Some(&x[..]), None] {
            let sym = Arc::new(Symbolic::new(&k, &interface, coordinates));
            let (_, s) = PartialCholesky::new(&k, sym).expect("interior is definite");
            let expected = reference(&k, &interface);
            let error = (s.view() - &expected).norm_max() / expected.norm_max();
            assert!(error < 1e-13, "relative error {error:.1e}");
        }
    }
}

#[test]
fn forward_and_backward_solve_with_the_interior() {
    let (k, x) = grid_laplacian(15, 15, 0.0);
    let interface = rim(15, 15);
    let sym = Arc::new(Symbolic::new(&k, &interface, Some(&x)));
    let (factor, s) = PartialCholesky::new(&k, sym).expect("interior is definite");
    let u = random(k.n(), 3);
    let mut b = vec![0.0; k.n()];
    k.mul(&u, &mut b);
    factor.forward(&mut b);
    // The condensed load of b = K u is S u_Γ.
    let u_gamma: Vec<f64> = interface.iter().map(|&i| u[i as usize]).collect();
    let mut g = vec![0.0; u_gamma.len()];
    s.add_mul(&u_gamma, &mut g);
    for (&i, &gi) in interface.iter().zip(&g) {
        assert!((b[i as usize] - gi).abs() < 1e-12);
        b[i as usize] = u[i as usize];
    }
    factor.backward(&mut b);
    let error = distance(&b, &u);
    assert!(error < 1e-12, "error {error:.1e}");
}

#[test]
fn an_interior_that_nothing_holds_is_reported() {
    let (k, x) = grid_laplacian(8, 8, 0.0);
    let sym = Arc::new(Symbolic::new(&k, &[], Some(&x)));
    assert!(PartialCholesky::new(&k, sym).is_err());
}

#[test]
fn dofs_that_follow_from_others_are_left_out() {
    // Two copies of a few rows and columns of a regular matrix.
    let (k, _) = grid_laplacian(9, 8, 0.5);
    let twins = [3u32, 4, 40, 71];
    let n = k.n();
    let of = |i: usize| if i < n { i } else { twins[i - n] as usize };
    let m = n + twins.len();
    let mut triplets = Vec::new();
    for i in 0..m {
        for j in 0..m {
            let value = k.get(of(i), of(j));
            if value != 0.0 {
                triplets.push((i as u32, j as u32, value));
            }
        }
    }
    let double = Csr::from_triplets(m, &triplets);
    let symbolic = Arc::new(Symbolic::new(&double, &[], None));
    let (factor, left) = PartialCholesky::semidefinite(&double, symbolic, 1e-12);
    let mut left: Vec<usize> = left.iter().map(|&i| of(i as usize)).collect();
    left.sort_unstable();
    assert_eq!(left, [3, 4, 40, 71]);
    // What is in the range is solved for.
    let u = random(m, 8);
    let mut b = vec![0.0; m];
    double.mul(&u, &mut b);
    let mut x = b.clone();
    factor.solve(&mut x);
    let mut back = vec![0.0; m];
    double.mul(&x, &mut back);
    let away = back
        .iter()
        .zip(&b)
        .fold(0.0f64, |a, (p, q)| a.max((p - q).abs()));
    assert!(away < 1e-12, "{away:.1e}");
    let zeros =
        (0..n).filter(|&i| x[i] == 0.0).count() + (n..m).filter(|&i| x[i].abs() < 1e-100).count();
    assert!(zeros >= 1 && x.iter().filter(|x| x.abs() < 1e-100).count() == twins.len());
}
