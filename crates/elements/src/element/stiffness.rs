//! The stiffness of one cell.

use super::axial::is_axial;
use super::hourglass;
use super::incompatible;
use super::integration::{moduli, Integration};
use super::map::{by_kind, fma, for_each_sample, relative};
use super::products::GradientProducts;
use super::quadrature::Purpose;
use super::table::{table, ShapeTable};
use crate::cell::{Material, Moduli};
use crate::element::axial;
use crate::kind::CellKind;

/// The stiffness matrix of a cell, row-major into `out`, of length (nodes · C)²; symmetric to the last bit.
///
/// Scalar: ∫ ρ ∇N_a·∇N_b. Elastic: ∫ 2μ ε(u):ε(v) + λ (∇·u)(∇·v), the last term as [`Cure`](crate::cell::Cure)
/// says, integrated as [`Integration`] says; around the axis as [`Plane::Axial`](crate::cell::Plane) says.
///
/// # Panics
/// When a length is wrong, or [`check`](super::check) refuses.
pub fn stiffness(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    material: &Material,
    integration: Integration,
    out: &mut [f64],
) {
    let n = kind.nodes() * material.components(dim);
    assert_eq!(out.len(), n * n, "a cell has {n} degrees of freedom");
    let moduli = moduli(kind, dim, material, integration);
    let bilinear = matches!(kind, CellKind::Quad4 | CellKind::Hex8);
    if is_axial(dim, material) {
        let purpose = match integration {
            Integration::Reduced => Purpose::Reduced,
            _ => Purpose::Full,
        };
        return axial::stiffness(kind, points, moduli, purpose, out);
    }
    let table = match integration {
        Integration::Reduced if bilinear => {
            return hourglass::stiffness(kind, points, material, out)
        }
        Integration::Incompatible => return incompatible::stiffness(kind, points, moduli, out),
        Integration::Reduced => table(kind, Purpose::Reduced),
        Integration::Full => table(kind, Purpose::Full),
    };
    match material {
        Material::Scalar { rho } => by_kind!(kind, scalar(points, table, *rho, out)),
        Material::Elastic { .. } => elastic_of(kind, points, table, moduli, out),
    }
}

fn scalar<const D: usize, const N: usize>(
    points: &[[f64; 3]],
    table: &ShapeTable,
    rho: f64,
    out: &mut [f64],
) {
    let mut k = [[0.0; N]; N];
    for_each_sample::<D, N>(&relative(points), table, |s| {
        for (a, row) in k.iter_mut().enumerate() {
            let left: [f64; D] = std::array::from_fn(|i| s.weight * s.gradient[i][a]);
            for (b, entry) in row.iter_mut().enumerate() {
                for i in 0..D {
                    *entry = fma(left[i], s.gradient[i][b], *entry);
                }
            }
        }
    });
    for a in 0..N {
        for b in a..N {
            out[N * a + b] = rho * k[a][b];
            out[N * b + a] = rho * k[a][b];
        }
    }
}

fn elastic_of(
    kind: CellKind,
    points: &[[f64; 3]],
    table: &ShapeTable,
    moduli: Moduli,
    out: &mut [f64],
) {
    match kind {
        CellKind::Triangle3 => elastic::<2, 3, 1>(points, table, moduli, out),
        CellKind::Triangle6 => elastic::<2, 6, 2>(points, table, moduli, out),
        CellKind::Quad4 => elastic::<2, 4, 1>(points, table, moduli, out),
        CellKind::Quad8 => elastic::<2, 8, 2>(points, table, moduli, out),
        CellKind::Quad9 => elastic::<2, 9, 3>(points, table, moduli, out),
        CellKind::Tet4 => elastic::<3, 4, 1>(points, table, moduli, out),
        CellKind::Tet10 => elastic::<3, 10, 3>(points, table, moduli, out),
        CellKind::Pyramid5 => elastic::<3, 5, 2>(points, table, moduli, out),
        CellKind::Wedge6 => elastic::<3, 6, 2>(points, table, moduli, out),
        CellKind::Wedge15 => elastic::<3, 15, 4>(points, table, moduli, out),
        CellKind::Hex8 => elastic::<3, 8, 2>(points, table, moduli, out),
        CellKind::Hex20 => elastic::<3, 20, 5>(points, table, moduli, out),
        CellKind::Hex27 => elastic::<3, 27, 7>(points, table, moduli, out),
        kind => panic!("a {} is no plane or solid cell", kind.name()),
    }
}

fn elastic<const D: usize, const N: usize, const L: usize>(
    points: &[[f64; 3]],
    table: &ShapeTable,
    moduli: Moduli,
    out: &mut [f64],
) {
    let mut products = GradientProducts::<D, N, L>::new();
    for_each_sample::<D, N>(&relative(points), table, |s| {
        products.add(s.weight, &s.gradient);
    });
    products.stiffness(moduli, out);
}

#[cfg(test)]
#[path = "../../tests/element/stiffness.rs"]
mod tests;
