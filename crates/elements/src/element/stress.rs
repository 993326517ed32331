//! Strain and stress at the nodes of a cell, for output.
//!
//! They are taken at the points of the stiffness, on cells of second order at the reduced ones, where they are best,
//! and from there extrapolated to the nodes: by the polynomials of the table, which fit the values in the least squares
//! of the rule. On affine cells a linear displacement has exact stresses with every cell, a quadratic one with those of
//! second order.
//!
//! | cell | points | polynomials |
//! |---|---|---|
//! | triangle, tetrahedron | 1 | constant |
//! | quadrilateral, hexahedron, of 4 and 8 nodes | 2 per direction | 1 and s in each direction |
//! | the same, reduced integration | mean | constant |
//! | wedge of 6 nodes | 3 × 2 (reduced: 1 × 2) | linear × linear (constant × linear) |
//! | pyramid | 2 × 2 | linear in the plane of the points |
//! | triangle, tetrahedron of second order | 3, 4 | linear |
//! | other quadrilaterals and hexahedra | 2 per direction | 1 and s in each direction |
//! | wedge of 15 nodes | 3 × 3 | linear × linear |

use super::axial::{is_axial, per_radius};
use super::hourglass::mean_gradient;
use super::incompatible;
use super::integration::{moduli, Integration};
use super::map::{by_kind, for_each_sample, relative};
use super::quadrature::Purpose;
use super::table::table;
pub use crate::cell::NodeStress;
use crate::cell::{stress_of_gradient, Material};
use crate::kind::CellKind;
use std::sync::OnceLock;

/// Most points of a rule here: those of the wedge of 15 nodes.
const MOST_POINTS: usize = 9;

/// Strain and stress at the nodes of a cell, into `out`, an entry per node. `nodal` has the cell's degrees of freedom.
///
/// The dilatation in the stress is the one of the stiffness: with a [`Cure`](crate::cell::Cure) its mean over the
/// cell.
///
/// # Panics
/// When a length is wrong, or [`check`](super::check) refuses.
pub fn stress_at_nodes(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    material: &Material,
    integration: Integration,
    nodal: &[f64],
    out: &mut [NodeStress],
) {
    let n = points.len() * material.components(dim);
    assert_eq!(nodal.len(), n, "a cell has {n} degrees of freedom");
    assert_eq!(out.len(), points.len(), "an entry per node");
    let moduli = moduli(kind, dim, material, integration);
    let (purpose, extrapolation) = extrapolation(kind, integration);
    let mut gradients = Gradients::default();
    match (kind, integration) {
        (CellKind::Quad4, Integration::Reduced) => {
            mean::<2, 4>(kind, points, nodal, &mut gradients)
        }
        (CellKind::Hex8, Integration::Reduced) => mean::<3, 8>(kind, points, nodal, &mut gradients),
        (_, Integration::Incompatible) => {
            incompatible::for_each_gradient(kind, points, moduli, nodal, |q, gradient| {
                gradients.at[q] = gradient;
            });
        }
        _ => {
            let axial = is_axial(dim, material);
            by_kind!(
                kind,
                sample(kind, points, purpose, axial, nodal, &mut gradients)
            );
        }
    }
    let rows = extrapolation.len() / points.len();
    let mut values = [NodeStress::default(); MOST_POINTS];
    for (value, gradient) in values.iter_mut().zip(&gradients.at[..rows]) {
        *value = stress_of_gradient(dim, material, moduli, gradient, gradients.mean_dilatation);
    }
    for (node, factors) in out.iter_mut().zip(extrapolation.chunks_exact(rows)) {
        *node = NodeStress::default();
        for (factor, value) in factors.iter().zip(&values) {
            for c in 0..6 {
                node.strain[c] += factor * value.strain[c];
                node.stress[c] += factor * value.stress[c];
            }
        }
    }
}

/// ∂u_i/∂x_j at the points, and the mean of ∇·u.
#[derive(Default)]
struct Gradients {
    at: [[[f64; 3]; 3]; MOST_POINTS],
    mean_dilatation: f64,
}

fn sample<const D: usize, const N: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    purpose: Purpose,
    axial: bool,
    nodal: &[f64],
    out: &mut Gradients,
) {
    let (mut dilatation, mut volume) = (0.0, 0.0);
    let table = table(kind, purpose);
    for_each_sample::<D, N>(&relative(points), table, |s| {
        let gradient = &mut out.at[s.index];
        add_gradient(&s.gradient, nodal, gradient);
        let mut weight = s.weight;
        if axial {
            let inverse = per_radius(points, table, s.index);
            let radial = nodal.iter().step_by(2).zip(table.values(s.index));
            gradient[2][2] = inverse * radial.map(|(u, n)| u * n).sum::<f64>();
            weight /= inverse;
        }
        volume += weight;
        dilatation += weight * (0..3).map(|i| gradient[i][i]).sum::<f64>();
    });
    out.mean_dilatation = dilatation / volume;
}

fn mean<const D: usize, const N: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    nodal: &[f64],
    out: &mut Gradients,
) {
    let (gradient, _) = mean_gradient::<D, N>(kind, points);
    add_gradient(&gradient, nodal, &mut out.at[0]);
}

pub(super) fn add_gradient<const D: usize, const N: usize>(
    slopes: &[[f64; N]; D],
    nodal: &[f64],
    gradient: &mut [[f64; 3]; 3],
) {
    for (a, node) in nodal.chunks_exact(nodal.len() / N).enumerate() {
        for (i, x) in node.iter().enumerate() {
            for j in 0..D {
                gradient[i][j] += x * slopes[j][a];
            }
        }
    }
}

/// The equivalent stress of von Mises, (3/2 s:s)^½ with the deviator s.
pub fn von_mises(stress: &[f64; 6]) -> f64 {
    let [xx, yy, zz, xy, yz, xz] = *stress;
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + xz * xz)).sqrt()
}

/// The principal stresses, the largest first.
pub fn principal_stresses(stress: &[f64; 6]) -> [f64; 3] {
    let mut s = [[0.0; 3]; 3];
    for (c, (i, j)) in crate::law::COMPONENTS.into_iter().enumerate() {
        s[i][j] = stress[c];
        s[j][i] = stress[c];
    }
    // Jacobi's rotations: each makes one entry beside the diagonal zero; the others shrink quadratically.
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if s[p][q] == 0.0 {
                continue;
            }
            let theta = (s[q][q] - s[p][p]) / (2.0 * s[p][q]);
            let tangent = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            let sine = tangent * cosine;
            for row in &mut s {
                let (x, y) = (row[p], row[q]);
                row[p] = cosine * x - sine * y;
                row[q] = sine * x + cosine * y;
            }
            for k in 0..3 {
                let (x, y) = (s[p][k], s[q][k]);
                s[p][k] = cosine * x - sine * y;
                s[q][k] = sine * x + cosine * y;
            }
            s[p][q] = 0.0;
            s[q][p] = 0.0;
        }
    }
    let mut values = [s[0][0], s[1][1], s[2][2]];
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// The rule at whose points stresses are taken, and for each node a row of factors of the values there.
fn extrapolation(kind: CellKind, integration: Integration) -> (Purpose, &'static [f64]) {
    static ROWS: [OnceLock<Vec<f64>>; 2 * CellKind::ALL.len()] =
        [const { OnceLock::new() }; 2 * CellKind::ALL.len()];
    let reduced = integration == Integration::Reduced;
    let constant = reduced && matches!(kind, CellKind::Quad4 | CellKind::Hex8);
    let purpose = match kind {
        _ if constant => Purpose::Centre,
        _ if reduced || kind.order() == 2 => Purpose::Reduced,
        _ => Purpose::Full,
    };
    let place = 2 * kind as usize + usize::from(reduced);
    let rows = ROWS[place].get_or_init(|| {
        let basis: fn([f64; 3]) -> Vec<f64> = match kind {
            _ if constant => |_| vec![1.0],
            CellKind::Triangle3 | CellKind::Tet4 => |_| vec![1.0],
            CellKind::Triangle6 | CellKind::Pyramid5 => |[x, y, _]| vec![1.0, x, y],
            CellKind::Tet10 => |[x, y, z]| vec![1.0, x, y, z],
            CellKind::Quad4 | CellKind::Quad8 | CellKind::Quad9 => {
                |[x, y, _]| vec![1.0, x, y, x * y]
            }
            CellKind::Wedge6 if reduced => |[_, _, z]| vec![1.0, z],
            CellKind::Wedge6 | CellKind::Wedge15 => |[x, y, z]| vec![1.0, x, y, z, x * z, y * z],
            _ => |[x, y, z]| vec![1.0, x, y, z, x * y, y * z, x * z, x * y * z],
        };
        fit(kind, purpose, basis)
    });
    (purpose, rows)
}

/// For each node the factors of the values at the points of a rule: that of the polynomials which fit the values best.
fn fit(kind: CellKind, purpose: Purpose, basis: fn([f64; 3]) -> Vec<f64>) -> Vec<f64> {
    let table = table(kind, purpose);
    let at: Vec<Vec<f64>> = table.at.iter().map(|&s| basis(s)).collect();
    let n = at[0].len();
    // Normal equations, a right-hand side per point: [Bᵀ W B | Bᵀ W].
    let mut rows = vec![vec![0.0; n + at.len()]; n];
    for (q, (values, weight)) in at.iter().zip(&table.weights).enumerate() {
        for i in 0..n {
            for j in 0..n {
                rows[i][j] += weight * values[i] * values[j];
            }
            rows[i][n + q] = weight * values[i];
        }
    }
    for i in 0..n {
        let pivot = rows[i][i];
        rows[i].iter_mut().for_each(|x| *x /= pivot);
        let by = rows[i].clone();
        for (k, row) in rows.iter_mut().enumerate() {
            if k != i {
                let factor = row[i];
                row.iter_mut().zip(&by).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    let nodes = super::table::table(kind, Purpose::Nodes).at.iter();
    nodes
        .flat_map(|&s| {
            let values = basis(s);
            let rows = &rows;
            (0..at.len()).map(move |q| (0..n).map(|i| values[i] * rows[i][n + q]).sum::<f64>())
        })
        .collect()
}

#[cfg(test)]
#[path = "../../tests/element/stress.rs"]
mod tests;
