//! Axisymmetric cells: x is the radius r ≥ 0, y the axis, and u = (u_r, u_y) at every angle.
//!
//! Stiffness, energy and norms are those of the whole ring, 2π r times the plane's: a nodal force is the sum around the
//! ring, and a load per volume or area has to be multiplied by 2π r before it goes into
//! [`body_load`](super::body_load) or [`side_load`](super::side_load). The strain around is ε_θθ = u_r/r, the component
//! zz of stresses. The only rigid motion is that along the axis.

use super::map::{for_each_sample, interpolate_position, relative};
use super::quadrature::Purpose;
use super::table::{table, ShapeTable};
use crate::cell::{IsotropicModuli, Material, Moduli, Plane};
use crate::kind::CellKind;
use crate::law::Tangent;
use std::f64::consts::TAU;

/// Whether a material is axisymmetric.
pub(super) fn is_axial(dim: usize, material: &Material) -> bool {
    let Material::Elastic { plane, .. } = material else {
        return false;
    };
    dim == 2 && *plane == Plane::Axial
}

/// The rule for the stiffness: with one point a triangle could turn about it without energy.
pub(super) fn rule(kind: CellKind, purpose: Purpose) -> Purpose {
    match (kind, purpose) {
        (CellKind::Triangle3, Purpose::Full) => Purpose::Load,
        _ => purpose,
    }
}

/// 1/r at a point of the rule.
pub(super) fn per_radius(points: &[[f64; 3]], table: &ShapeTable, index: usize) -> f64 {
    1.0 / interpolate_position(points, table.values(index))[0]
}

/// The stiffness of the ring.
pub(super) fn stiffness(
    kind: CellKind,
    points: &[[f64; 3]],
    moduli: Moduli,
    purpose: Purpose,
    out: &mut [f64],
) {
    let table = table(kind, rule(kind, purpose));
    match kind {
        CellKind::Triangle3 => ring_of::<3>(points, table, moduli, out),
        CellKind::Triangle6 => ring_of::<6>(points, table, moduli, out),
        CellKind::Quad4 => ring_of::<4>(points, table, moduli, out),
        CellKind::Quad8 => ring_of::<8>(points, table, moduli, out),
        _ => ring_of::<9>(points, table, moduli, out),
    }
}

fn ring_of<const N: usize>(
    points: &[[f64; 3]],
    table: &ShapeTable,
    moduli: Moduli,
    out: &mut [f64],
) {
    match moduli {
        Moduli::Isotropic(moduli) => ring::<N>(points, table, moduli, out),
        Moduli::General(tangent) => general::<N>(points, table, &tangent, out),
    }
}

/// 2π ∫ γ_a · C γ_b r, where γ has the strains xx, yy, around, 2xy of a node's unit displacements.
fn general<const N: usize>(
    points: &[[f64; 3]],
    table: &ShapeTable,
    tangent: &Tangent,
    out: &mut [f64],
) {
    let n = 2 * N;
    out.fill(0.0);
    for_each_sample::<2, N>(&relative(points), table, |s| {
        let inverse = per_radius(points, table, s.index);
        let weight = TAU * s.weight / inverse;
        let values = table.values(s.index);
        let gamma = |dof: usize| -> [f64; 6] {
            let (a, i) = (dof / 2, dof % 2);
            let [x, y] = [s.gradient[0][a], s.gradient[1][a]];
            match i {
                0 => [x, 0.0, values[a] * inverse, y, 0.0, 0.0],
                _ => [0.0, y, 0.0, x, 0.0, 0.0],
            }
        };
        for row in 0..n {
            let stress = tangent.stress(&gamma(row));
            for col in row..n {
                let work: f64 = stress.iter().zip(gamma(col)).map(|(s, g)| s * g).sum();
                out[n * row + col] += weight * work;
            }
        }
    });
    for row in 0..n {
        for col in row..n {
            out[n * col + row] = out[n * row + col];
        }
    }
}

fn ring<const N: usize>(
    points: &[[f64; 3]],
    table: &ShapeTable,
    moduli: IsotropicModuli,
    out: &mut [f64],
) {
    let n = 2 * N;
    let (mut mean, mut volume) = ([[0.0; N]; 2], 0.0);
    out.fill(0.0);
    for_each_sample::<2, N>(&relative(points), table, |s| {
        let inverse = per_radius(points, table, s.index);
        let weight = TAU * s.weight / inverse;
        let values = table.values(s.index);
        let around: [f64; N] = std::array::from_fn(|a| values[a] * inverse);
        // ∇·u = Σ divergence[i][a] u_a,i.
        let mut divergence = s.gradient;
        for (d, h) in divergence[0].iter_mut().zip(around) {
            *d += h;
        }
        volume += weight;
        for i in 0..2 {
            for a in 0..N {
                mean[i][a] += weight * divergence[i][a];
            }
        }
        let (point, shear) = (weight * moduli.point, weight * moduli.shear);
        for a in 0..N {
            for b in a..N {
                let gradient = |i: usize, j: usize| s.gradient[i][a] * s.gradient[j][b];
                let trace = gradient(0, 0) + gradient(1, 1);
                for i in 0..2 {
                    for j in 0..2 {
                        // 2μ ε:ε = μ (∇u:∇u + ∇u:∇uᵀ), and around 2μ (u_r/r)².
                        let mut entry =
                            point * divergence[i][a] * divergence[j][b] + shear * gradient(j, i);
                        if i == j {
                            entry += shear * trace;
                        }
                        if i + j == 0 {
                            entry += 2.0 * shear * around[a] * around[b];
                        }
                        out[n * (2 * a + i) + 2 * b + j] += entry;
                    }
                }
            }
        }
    });
    for row in 0..n {
        for col in row..n {
            let by_mean = mean[row % 2][row / 2] * mean[col % 2][col / 2];
            let entry = out[n * row + col] + moduli.mean / volume * by_mean;
            out[n * row + col] = entry;
            out[n * col + row] = entry;
        }
    }
}

#[cfg(test)]
#[path = "../../tests/element/axial.rs"]
mod tests;
