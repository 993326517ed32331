//! Unit tests of `src/feti/primal/kernel.rs`.

use super::*;
use crate::matrices::grid_laplacian;

#[test]
fn a_weak_spring_holds_and_rounding_does_not() {
    for (spring, defect) in [(0.0, 1), (1e-8, 0), (1.0, 0)] {
        let (mut k, _) = grid_laplacian(60, 60, 0.0);
        let at = k.row_ptr[1777]
            + k.row(1777)
                .0
                .iter()
                .position(|&j| j == 1777)
                .expect("diagonal");
        k.val[at] += spring;
        // Stiffness that jumps between subdomains does not matter: the other one floats at 1e12.
        let (mut stiff, _) = grid_laplacian(60, 60, 0.0);
        stiff.val.iter_mut().for_each(|v| *v *= 1e12);
        let ones = vec![vec![1.0; k.n()]];
        let factors = [motion_factors(&k, &ones), motion_factors(&stiff, &ones)];
        assert_eq!(
            null_combinations(&factors).cols,
            defect,
            "spring {spring:e}"
        );
    }
}

#[test]
fn several_columns_find_the_one_combination() {
    // N = {1, x}: the Laplacian's kernel is the constant only.
    let (k, x) = grid_laplacian(9, 4, 0.0);
    let columns = vec![
        x.iter().map(|p| p[0] / 8.0 + 0.5).collect(),
        x.iter().map(|p| p[0] / 8.0 - 0.5).collect(),
    ];
    let c = null_combinations(&[motion_factors(&k, &columns)]);
    assert_eq!(c.cols, 1);
    assert!((c.get(0, 0) + c.get(1, 0)).abs() < 1e-12);
}

#[test]
fn a_motion_that_moves_no_free_dof_is_none() {
    // N = {x, y, rotation} at the free dofs of one component; where y is given everywhere, its column is zero.
    let (k, at) = grid_laplacian(9, 4, 0.0);
    let columns = |x: f64, y: f64| {
        let turn = at.iter().map(|p| -x * p[1]).collect::<Vec<f64>>();
        vec![vec![x; k.n()], vec![y; k.n()], turn]
    };
    let c = null_combinations(&[motion_factors(&k, &columns(1.0, 0.0))]);
    assert_eq!(c.cols, 1);
    // Only the translation along x, with nothing of the one along y.
    assert!((c.get(0, 0).abs() - 1.0).abs() < 1e-12 && c.get(1, 0).abs() < 1e-12);
    // A body whose other subdomain moves along y, by rounding, a little, or as much; and the same held by springs.
    let (held, _) = grid_laplacian(9, 4, 0.1);
    for (y, free) in [(0.0, 1), (1e-15, 1), (1e-3, 2), (1.0, 2)] {
        let counted = |k: &Csr| {
            let parts = [columns(1.0, 0.0), columns(0.0, y)].map(|n| motion_factors(k, &n));
            null_combinations(&parts).cols
        };
        assert_eq!([counted(&k), counted(&held)], [free, 0], "{y:e}");
    }
    // All values are given: there is no free dof.
    assert_eq!(null_combinations(&[Dense::zeros(6, 3)]).cols, 0);
}

#[test]
fn the_primal_matrix_shows_the_kernel_when_nothing_is_known() {
    let (k, _) = grid_laplacian(5, 5, 0.0);
    let dense = |k: &Csr| {
        let mut a = Dense::zeros(k.n(), k.n());
        (0..k.n()).for_each(|i| (0..k.n()).for_each(|j| a.set(i, j, k.get(i, j))));
        a
    };
    let z = null_space(&dense(&k), 8.0 / 3.0);
    assert_eq!(z.cols, 1);
    assert!(z.data.iter().all(|v| (v.abs() - 1.0).abs() < 1e-10));
    assert_eq!(fixing_rows(&z).len(), 1);
    let (held, _) = grid_laplacian(5, 5, 1e-6);
    assert_eq!(null_space(&dense(&held), 8.0 / 3.0).cols, 0);
    // One dof of a floating body: rounding of either sign, or a spring.
    for (left, defect) in [(3e-15, 1), (-3e-15, 1), (0.0, 1), (1e-6, 0)] {
        let mut one = Dense::zeros(1, 1);
        one.set(0, 0, left);
        assert_eq!(null_space(&one, 4.0).cols, defect, "{left:e}");
    }
}
