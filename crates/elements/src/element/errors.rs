//! Distance between a finite element function and an exact solution on one cell.

use super::axial::{is_axial, per_radius};
use super::integration::moduli;
use super::map::{by_kind, for_each_sample, interpolate_position, relative};
use super::quadrature::Purpose;
use super::table::table;
use super::Integration;
use crate::cell::{Material, Moduli};
use crate::kind::CellKind;
use std::f64::consts::TAU;

/// Squares of the L² norm, the H¹ seminorm (∫ |∇e|², all components) and the energy norm of e = u_h − u, by a rule of
/// higher order.
///
/// `nodal` has the cell's degrees of freedom; `exact` returns u and its gradient, `[i][j]` = ∂u_i/∂x_j, at a point. The
/// energy is ∫ ρ|∇e|², or ∫ 2μ ε:ε + λ(∇·e)² where [`Cure`](crate::cell::Cure) replaces ∇·e by its mean. u_h is
/// what the nodes say: incompatible modes do not count. With [`Plane::Axial`](crate::cell::Plane) all are of the
/// whole ring, and e_r/r belongs to the gradient.
///
/// # Panics
/// When a length is wrong, or [`check`](super::check) refuses.
pub fn error_squares<F>(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    material: &Material,
    nodal: &[f64],
    mut exact: F,
) -> [f64; 3]
where
    F: FnMut([f64; 3]) -> ([f64; 3], [[f64; 3]; 3]),
{
    let n = points.len() * material.components(dim);
    assert_eq!(nodal.len(), n, "a cell has {n} degrees of freedom");
    let moduli = moduli(kind, dim, material, Integration::Full);
    let exact: Exact = &mut exact;
    by_kind!(kind, squares(kind, points, material, moduli, nodal, exact))
}

/// The exact solution and its gradient. One type for all: the code of thirteen kinds of cells is not made for each
/// solution anew.
type Exact<'a> = &'a mut dyn FnMut([f64; 3]) -> ([f64; 3], [[f64; 3]; 3]);

fn squares<const D: usize, const N: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    material: &Material,
    moduli: Moduli,
    nodal: &[f64],
    exact: Exact,
) -> [f64; 3] {
    let components = material.components(D);
    let mut squares = [0.0; 3];
    let (mut volume, mut dilatation) = (0.0, 0.0);
    let table = table(kind, Purpose::Error);
    let axial = is_axial(D, material);
    for_each_sample::<D, N>(&relative(points), table, |s| {
        let values = table.values(s.index);
        let (u, slope) = exact(interpolate_position(points, values));
        let (mut value, mut gradient) = (u.map(|v| -v), slope.map(|row| row.map(|v| -v)));
        for (a, node) in nodal.chunks_exact(components).enumerate() {
            for (i, &x) in node.iter().enumerate() {
                value[i] += x * values[a];
                for j in 0..D {
                    gradient[i][j] += x * s.gradient[j][a];
                }
            }
        }
        // Around the axis: what a full turn has, and u_r/r.
        let (mut full, mut around) = (s.weight, 0.0);
        if axial {
            let inverse = per_radius(points, table, s.index);
            full *= TAU / inverse;
            around = value[0] * inverse;
        }
        let l2: f64 = value[..components].iter().map(|v| v * v).sum();
        let rows = gradient[..components].iter().flat_map(|row| &row[..D]);
        let h1: f64 = rows.map(|v| v * v).sum::<f64>() + around * around;
        let energy = if let Material::Scalar { rho } = material {
            rho * h1
        } else {
            let divergence: f64 = (0..D).map(|i| gradient[i][i]).sum::<f64>() + around;
            dilatation += full * divergence;
            // In the plane nothing else changes across it.
            if D == 2 {
                gradient.iter_mut().for_each(|row| row[2] = 0.0);
                gradient[2] = [0.0, 0.0, around];
            }
            moduli.energy(&gradient)
        };
        volume += full;
        squares[0] += full * l2;
        squares[1] += full * h1;
        squares[2] += full * energy;
    });
    squares[2] += moduli.mean() * dilatation * dilatation / volume;
    squares
}

#[cfg(test)]
#[path = "../../tests/element/errors.rs"]
mod tests;
