//! The distance between the stress of displacements and a recovered one that is given at the nodes of a cell.

use super::axial::{is_axial, per_radius};
use super::integration::{moduli, Integration};
use super::map::{by_kind, for_each_sample, relative};
use super::quadrature::Purpose;
use super::stress::{add_gradient, stress_at_nodes, NodeStress};
use super::table::table;
use crate::cell::{stress_of_gradient, Material, Moduli};
use crate::kind::CellKind;
use std::f64::consts::TAU;

/// Most points of a rule for loads: those of a hexahedron of second order.
const MOST_POINTS: usize = 27;

/// ∫ (σ* − σ_h) : (ε* − ε_h) and ∫ σ_h : ε_h over a cell: σ_h and ε_h of the displacements `nodal`, σ* and ε* by the
/// shape functions from `recovered`, an entry per node. With [`Plane::Axial`](crate::cell::Plane) they are those
/// of the whole ring.
///
/// Where the stiffness does not see the gradient of the displacements in full ([`Integration`]), σ_h is what
/// [`stress_at_nodes`] says.
///
/// # Panics
/// When a length is wrong.
pub fn recovered_squares(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    material: &Material,
    integration: Integration,
    nodal: &[f64],
    recovered: &[NodeStress],
) -> [f64; 2] {
    assert_eq!(recovered.len(), points.len(), "an entry per node");
    let n = points.len() * material.components(dim);
    assert_eq!(nodal.len(), n, "a cell has {n} degrees of freedom");
    let mut at = [NodeStress::default(); CellKind::MOST_NODES];
    let own = if integration == Integration::Incompatible
        || integration == Integration::Reduced && kind.order() == 1
    {
        let at = &mut at[..points.len()];
        stress_at_nodes(kind, dim, points, material, integration, nodal, at);
        Own::At(at)
    } else {
        Own::Of(nodal)
    };
    let moduli = moduli(kind, dim, material, integration);
    by_kind!(
        kind,
        squares(kind, points, material, moduli, &own, recovered)
    )
}

/// The two integrals of [`recovered_squares`] for a constant stress: `own` stands for all points.
pub fn recovered_squares_of(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    material: &Material,
    own: &NodeStress,
    recovered: &[NodeStress],
) -> [f64; 2] {
    let at = vec![*own; points.len()];
    let moduli = moduli(kind, dim, material, Integration::Full);
    let own = Own::At(&at);
    by_kind!(
        kind,
        squares(kind, points, material, moduli, &own, recovered)
    )
}

/// Where σ_h comes from.
enum Own<'a> {
    /// From displacements.
    Of(&'a [f64]),
    /// From values at the nodes.
    At(&'a [NodeStress]),
}

fn squares<const D: usize, const N: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    material: &Material,
    moduli: Moduli,
    own: &Own,
    recovered: &[NodeStress],
) -> [f64; 2] {
    let table = table(kind, Purpose::Load);
    let axial = is_axial(D, material);
    // Gradients and weights at the points, and the mean of ∇·u.
    let mut samples = [(0.0, [[0.0; 3]; 3]); MOST_POINTS];
    let (mut dilatation, mut volume) = (0.0, 0.0);
    for_each_sample::<D, N>(&relative(points), table, |s| {
        let mut gradient = [[0.0; 3]; 3];
        let mut weight = s.weight;
        if let Own::Of(nodal) = own {
            add_gradient(&s.gradient, nodal, &mut gradient);
        }
        if axial {
            let inverse = per_radius(points, table, s.index);
            if let Own::Of(nodal) = own {
                let radial = nodal.iter().step_by(2).zip(table.values(s.index));
                gradient[2][2] = inverse * radial.map(|(u, n)| u * n).sum::<f64>();
            }
            weight *= TAU / inverse;
        }
        volume += weight;
        dilatation += weight * (0..3).map(|i| gradient[i][i]).sum::<f64>();
        samples[s.index] = (weight, gradient);
    });
    let mut sums = [0.0; 2];
    for (index, &(weight, gradient)) in samples[..table.weights.len()].iter().enumerate() {
        let values = table.values(index);
        let here = match own {
            Own::Of(_) => stress_of_gradient(D, material, moduli, &gradient, dilatation / volume),
            Own::At(at) => interpolated(values, at),
        };
        let there = interpolated(values, recovered);
        let apart = NodeStress {
            strain: std::array::from_fn(|c| there.strain[c] - here.strain[c]),
            stress: std::array::from_fn(|c| there.stress[c] - here.stress[c]),
        };
        sums[0] += weight * work(&apart);
        sums[1] += weight * work(&here);
    }
    // With a mean dilatation σ is not ε times positive moduli at every point.
    [sums[0].max(0.0), sums[1]]
}

/// Σ N_a v_a.
fn interpolated(values: &[f64], at: &[NodeStress]) -> NodeStress {
    let mut out = NodeStress::default();
    for (n, node) in values.iter().zip(at) {
        for c in 0..6 {
            out.strain[c] += n * node.strain[c];
            out.stress[c] += n * node.stress[c];
        }
    }
    out
}

/// σ : ε; shear strains count twice.
fn work(at: &NodeStress) -> f64 {
    let each = (0..6).map(|c| [1.0, 2.0][c / 3] * at.strain[c] * at.stress[c]);
    each.sum()
}

#[cfg(test)]
#[path = "../../tests/element/fields.rs"]
mod tests;
