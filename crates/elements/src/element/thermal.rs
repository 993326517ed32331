//! Nodal forces of an initial strain that follows a temperature: ∫ Bᵀ C α ΔT.
//!
//! Cells of first order have one temperature, the mean of their nodes: their strain is as constant as that. On cells of
//! second order it is interpolated. A free body that is heated by what is linear in space expands without stress with
//! every cell of second order, and by what is constant with every cell.

use super::axial::{is_axial, per_radius, rule};
use super::hourglass::mean_gradient;
use super::integration::{moduli, Integration};
use super::map::{by_kind, for_each_sample, relative};
use super::quadrature::Purpose;
use super::table::{table, ShapeTable};
use crate::cell::{is_plane_stress, IsotropicModuli, Material, Moduli, NodeStress};
use crate::kind::CellKind;
use crate::law::COMPONENT;
use std::f64::consts::TAU;

/// ΔT at the nodes of a cell as its strain takes it: the mean on cells of first order.
pub fn cell_temperatures(kind: CellKind, at_nodes: &mut [f64]) {
    if kind.order() == 1 {
        let mean = at_nodes.iter().sum::<f64>() / at_nodes.len() as f64;
        at_nodes.fill(mean);
    }
}

/// The nodal forces of the strain α ΔT, into `out`, of length nodes · `dim`. `expansion` has α along the axes of space,
/// the components xx, yy, zz, 2xy, 2yz, 2xz per degree, and `temperatures` ΔT at the nodes
/// ([`cell_temperatures`]). With [`Plane::Axial`](crate::cell::Plane) they are those of the whole ring.
///
/// # Panics
/// When a length is wrong, the material is scalar, or [`check`](super::check) refuses.
#[allow(clippy::too_many_arguments)] // a cell, its law, and what it is heated by
pub fn thermal_load(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    material: &Material,
    integration: Integration,
    expansion: &[f64; 6],
    temperatures: &[f64],
    out: &mut [f64],
) {
    assert_eq!(temperatures.len(), points.len(), "an entry per node");
    assert_eq!(
        out.len(),
        points.len() * dim,
        "an entry per degree of freedom"
    );
    let moduli = moduli(kind, dim, material, integration);
    out.fill(0.0);
    by_kind!(
        kind,
        load(
            kind,
            points,
            material,
            moduli,
            integration,
            expansion,
            temperatures,
            out
        )
    );
}

#[allow(clippy::too_many_arguments)] // what `thermal_load` gets, and its moduli
fn load<const D: usize, const N: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    material: &Material,
    moduli: Moduli,
    integration: Integration,
    expansion: &[f64; 6],
    temperatures: &[f64],
    out: &mut [f64],
) {
    let axial = is_axial(D, material);
    let (stress, by_mean) = of_a_degree(D, material, moduli, expansion);
    let add = |out: &mut [f64], weight: f64, gradient: &[[f64; N]; D], around: &[f64; N]| {
        for (a, node) in out.chunks_exact_mut(D).enumerate() {
            for (i, force) in node.iter_mut().enumerate() {
                let work: f64 = (0..D).map(|j| stress[i][j] * gradient[j][a]).sum();
                *force += weight * work;
            }
            node[0] += weight * stress[2][2] * around[a];
        }
    };
    if integration == Integration::Reduced && matches!(kind, CellKind::Quad4 | CellKind::Hex8) {
        let (mean, volume) = mean_gradient::<D, N>(kind, points);
        return add(out, volume * temperatures[0], &mean, &[0.0; N]);
    }
    let purpose = match integration {
        Integration::Reduced => Purpose::Reduced,
        _ => Purpose::Full,
    };
    let table = table(kind, if axial { rule(kind, purpose) } else { purpose });
    let (mut volume, mut heat, mut mean) = (0.0, 0.0, [[0.0; N]; D]);
    for_each_sample::<D, N>(&relative(points), table, |s| {
        let mut weight = s.weight;
        let mut around = [0.0; N];
        if axial {
            let inverse = per_radius(points, table, s.index);
            weight *= TAU / inverse;
            let values = table.values(s.index);
            around = std::array::from_fn(|a| values[a] * inverse);
        }
        let here = at(table, s.index, temperatures);
        add(out, weight * here, &s.gradient, &around);
        volume += weight;
        heat += weight * here;
        for a in 0..N {
            mean[0][a] += weight * around[a];
            for i in 0..D {
                mean[i][a] += weight * s.gradient[i][a];
            }
        }
    });
    if by_mean != 0.0 {
        let by_mean = by_mean * heat / volume;
        for (a, node) in out.chunks_exact_mut(D).enumerate() {
            (0..D).for_each(|i| node[i] += by_mean * mean[i][a]);
        }
    }
}

/// σ of the strain of one degree, and the factor of the mean dilatation.
fn of_a_degree(
    dim: usize,
    material: &Material,
    moduli: Moduli,
    expansion: &[f64; 6],
) -> ([[f64; 3]; 3], f64) {
    let tensor = |c: &[f64; 6]| COMPONENT.map(|row| row.map(|k| c[k]));
    match moduli {
        Moduli::General(tangent) => (tensor(&tangent.stress(expansion)), 0.0),
        Moduli::Isotropic(IsotropicModuli { shear, point, mean }) => {
            let [xx, yy, zz, ..] = *expansion;
            // A sheet is free to expand across.
            let across = if is_plane_stress(dim, material) {
                0.0
            } else {
                zz
            };
            let dilatation = xx + yy + across;
            let mut stress = tensor(&[0, 1, 2, 3, 4, 5].map(|c| {
                // Shear strains count twice in `expansion`.
                shear * expansion[c] * if c < 3 { 2.0 } else { 1.0 }
            }));
            (0..3).for_each(|i| stress[i][i] += point * dilatation);
            (stress, mean * dilatation)
        }
    }
}

/// ΔT at a point of the rule.
fn at(table: &ShapeTable, index: usize, temperatures: &[f64]) -> f64 {
    let values = table.values(index);
    values.iter().zip(temperatures).map(|(n, t)| n * t).sum()
}

/// The part of a heated cell that C ε and ε leave out, where ΔT = 1: the stress of the expansion, which is to be taken
/// from C ε, and in a sheet a strain across it, which is to be taken from ε.
pub fn thermal_stress(dim: usize, material: &Material, expansion: &[f64; 6]) -> NodeStress {
    let mut out = NodeStress::default();
    let Material::Elastic { law, .. } = material else {
        return out;
    };
    let tangent = law.tangent();
    if is_plane_stress(dim, material) {
        let mut gamma = *expansion;
        tangent.across(&mut gamma);
        out.strain[2] = gamma[2] - expansion[2];
        out.stress = tangent.stress(&gamma);
        out.stress[2] = 0.0;
    } else {
        out.stress = tangent.stress(expansion);
    }
    out
}

#[cfg(test)]
#[path = "../../tests/element/thermal.rs"]
mod tests;
