//! Unit tests of `crates/elements/src/element/thermal.rs`.

use super::super::testing::{affine, combinations, distorted, matrix, solid_kinds};
use super::*;
use crate::cell::{Cure, Plane};
use crate::element::stress_at_nodes;
use crate::law::Law;

/// A strain of one degree: along no axis, and nothing across the plane.
fn expansion(dim: usize) -> [f64; 6] {
    let mut out = [1.0, -0.4, 0.7, 0.6, -0.3, 0.9];
    if dim == 2 {
        [out[2], out[4], out[5]] = [0.0; 3];
    }
    out
}

/// u_i at a point where the strain is `e` t.
fn displacement(e: &[f64; 6], t: f64, p: [f64; 3], dim: usize) -> Vec<f64> {
    let strain = [
        [e[0], 0.5 * e[3], 0.5 * e[5]],
        [0.5 * e[3], e[1], 0.5 * e[4]],
        [0.5 * e[5], 0.5 * e[4], e[2]],
    ];
    let row = |i: usize| (0..dim).map(|j| t * strain[i][j] * p[j]).sum();
    (0..dim).map(row).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, v| a.max(v.abs()))
}

/// K u − f of a cell, beside the size of f.
fn imbalance(
    (kind, points): (CellKind, &[[f64; 3]]),
    (material, integration): (&Material, Integration),
    (e, temperatures): (&[f64; 6], &[f64]),
    nodal: &[f64],
) -> f64 {
    let k = matrix(kind, points, material, integration);
    let mut force = vec![0.0; nodal.len()];
    let dim = kind.dim();
    thermal_load(
        kind,
        dim,
        points,
        material,
        integration,
        e,
        temperatures,
        &mut force,
    );
    let rest: Vec<f64> = (0..nodal.len())
        .map(|i| (0..nodal.len()).map(|j| k[(i, j)] * nodal[j]).sum::<f64>() - force[i])
        .collect();
    largest(&rest) / largest(&force)
}

#[test]
fn a_cell_that_expands_freely_is_in_equilibrium_and_without_stress() {
    for kind in solid_kinds() {
        let dim = kind.dim();
        let e = expansion(dim);
        for (material, integration) in combinations(kind) {
            if material.components(dim) == 1 {
                continue;
            }
            let points = distorted(kind, 3);
            let nodal: Vec<f64> = points
                .iter()
                .flat_map(|p| displacement(&e, 2.0, *p, dim))
                .collect();
            let temperatures = vec![2.0; points.len()];
            let of = (&material, integration);
            let rest = imbalance((kind, &points), of, (&e, &temperatures), &nodal);
            assert!(
                rest < 1e-11,
                "{kind:?} {material:?} {integration:?} {rest:e}"
            );
            let mut at = vec![NodeStress::default(); points.len()];
            stress_at_nodes(kind, dim, &points, &material, integration, &nodal, &mut at);
            let one = thermal_stress(dim, &material, &e);
            for node in at {
                let left: Vec<f64> = (0..6)
                    .map(|c| node.stress[c] - 2.0 * one.stress[c])
                    .collect();
                let size = largest(&node.stress);
                assert!(
                    largest(&left) < 1e-10 * size,
                    "{kind:?} {material:?} {left:?}"
                );
            }
        }
    }
}

#[test]
fn cells_of_second_order_expand_freely_by_a_linear_temperature() {
    let (start, slope) = (0.3, [0.5, -0.2, 0.4]);
    for kind in solid_kinds().filter(|kind| kind.order() == 2) {
        let dim = kind.dim();
        let mut e = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        if dim == 2 {
            e[2] = 0.0;
        }
        for (material, integration) in combinations(kind) {
            if material.components(dim) == 1 {
                continue;
            }
            let points = affine(kind);
            let dot = |p: &[f64; 3]| (0..dim).map(|d| slope[d] * p[d]).sum::<f64>();
            let square = |p: &[f64; 3]| (0..dim).map(|d| p[d] * p[d]).sum::<f64>();
            // The strain of this displacement is the temperature times the identity.
            let nodal: Vec<f64> = points
                .iter()
                .flat_map(|p| {
                    let value = |i: usize| (start + dot(p)) * p[i] - 0.5 * slope[i] * square(p);
                    (0..dim).map(value).collect::<Vec<_>>()
                })
                .collect();
            let mut temperatures: Vec<f64> = points.iter().map(|p| start + dot(p)).collect();
            let before = temperatures.clone();
            cell_temperatures(kind, &mut temperatures);
            assert_eq!(temperatures, before);
            let of = (&material, integration);
            let rest = imbalance((kind, &points), of, (&e, &temperatures), &nodal);
            assert!(
                rest < 1e-11,
                "{kind:?} {material:?} {integration:?} {rest:e}"
            );
        }
    }
}

#[test]
fn rings_expand_freely() {
    let material = Material::Elastic {
        law: Law::Isotropic {
            young: 3.0,
            poisson: 0.3,
        },
        plane: Plane::Axial,
        cure: Cure::None,
    };
    let e = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
    for kind in solid_kinds().filter(|kind| kind.dim() == 2) {
        let points: Vec<[f64; 3]> = distorted(kind, 3)
            .iter()
            .map(|p| [p[0] + 5.0, p[1], 0.0])
            .collect();
        let nodal: Vec<f64> = points
            .iter()
            .flat_map(|p| [2.0 * p[0], 2.0 * p[1]])
            .collect();
        let temperatures = vec![2.0; points.len()];
        let of = (&material, Integration::Full);
        let rest = imbalance((kind, &points), of, (&e, &temperatures), &nodal);
        assert!(rest < 1e-11, "{kind:?} {rest:e}");
    }
}

#[test]
fn a_sheet_that_is_held_in_its_plane_expands_across() {
    let (young, poisson, alpha) = (3.0, 0.3, 1.5);
    for law in [
        Law::Isotropic { young, poisson },
        Law::General(crate::law::Tangent::isotropic(young, poisson)),
    ] {
        let sheet = Material::Elastic {
            law,
            plane: Plane::Stress,
            cure: Cure::None,
        };
        let one = thermal_stress(2, &sheet, &[alpha, alpha, alpha, 0.0, 0.0, 0.0]);
        assert!((one.stress[0] - young * alpha / (1.0 - poisson)).abs() < 1e-13);
        assert_eq!(one.stress[2], 0.0);
        // ε_zz = α + 2ν/(1 − ν) α.
        let across = alpha * (1.0 + 2.0 * poisson / (1.0 - poisson));
        assert!((one.strain[2] + across).abs() < 1e-13);
    }
}
