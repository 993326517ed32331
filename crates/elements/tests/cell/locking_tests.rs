//! Locking with ν = 0.4999, and its cures: Cook's membrane and a slender beam, in plane strain and in 3D.

use super::testing::{elastic, solve, Grid};
use super::*;

/// The mean of u_y over the right end, under a shear force of total 1 there; the left end is held.
fn deflection(grid: &Grid, [left, right]: [f64; 2], material: &Material) -> f64 {
    let dim = grid.dim;
    let k = grid.assemble(Element::Q1, material);
    let mut load = vec![0.0; k.nrows()];
    let end = Side {
        axis: 0,
        upper: true,
    };
    for cell in 0..grid.cells.len() {
        let points: Vec<_> = end
            .corners(dim)
            .map(|a| grid.points[grid.cells[cell][a]])
            .collect();
        if points.iter().any(|p| p[0] < right - 1e-9) {
            continue;
        }
        let mut local = vec![0.0; dim * points.len()];
        let up = |_, _| [0.0, 1.0, 0.0];
        let outward = end.outward(dim);
        side_load(dim, &points, outward, Element::Q1, dim, up, &mut local);
        for (a, force) in end.corners(dim).zip(local.chunks(dim)) {
            load[dim * grid.cells[cell][a] + 1] += force[1];
        }
    }
    let area: f64 = load.iter().sum();
    let load: Vec<f64> = load.iter().map(|v| v / area).collect();
    let given: Vec<Option<f64>> = (0..load.len())
        .map(|dof| (grid.points[dof / dim][0] < left + 1e-9).then_some(0.0))
        .collect();
    let u = solve(&k, &load, &given);
    u.iter().zip(&load).map(|(u, f)| u * f).sum()
}

fn with(cure: Cure) -> Material {
    elastic(1.0, 0.4999, Plane::Strain, cure)
}

#[test]
fn cooks_membrane_locks_without_a_cure_only() {
    let grid = |n: usize| {
        Grid::new(2, [n; 3], |[s, t, _]| {
            [48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), 0.0]
        })
    };
    let ends = [0.0, 48.0];
    let fine = deflection(&grid(32), ends, &with(Cure::BBar));
    let part = |cure| deflection(&grid(16), ends, &with(cure)) / fine;
    let plain = part(Cure::None);
    assert!(plain < 0.4, "{plain}");
    for cure in [Cure::Selective, Cure::BBar] {
        let cured = part(cure);
        assert!((cured - 1.0).abs() < 0.03, "{cure:?} {cured}");
    }
}

/// Against Timoshenko's F L³/(3E'I) + 6/5 F L/(GA), with E' = E/(1 − ν²) in plane strain.
#[test]
fn a_slender_beam_bends_as_beam_theory_says_with_a_cure_only() {
    let (length, poisson) = (10.0, 0.4999);
    for (dim, cells) in [(2, [40, 4, 0]), (3, [40, 4, 2])] {
        let grid = Grid::new(dim, cells, |[s, t, r]| [length * s, t, r]);
        let modulus = if dim == 2 {
            1.0 / (1.0 - poisson * poisson)
        } else {
            1.0
        };
        let shear = 1.0 / (2.0 * (1.0 + poisson));
        let theory: f64 = 4.0 * length.powi(3) / modulus + 1.2 * length / shear;
        let part = |cure| deflection(&grid, [0.0, length], &with(cure)) / theory;
        let plain = part(Cure::None);
        assert!(plain < 0.5, "{dim}D: {plain}");
        for cure in [Cure::Selective, Cure::BBar] {
            let cured = part(cure);
            assert!((cured - 1.0).abs() < 0.06, "{dim}D {cure:?}: {cured}");
        }
    }
}
