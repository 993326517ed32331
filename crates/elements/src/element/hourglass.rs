//! Quadrilaterals and hexahedra by their mean gradient, with a stiffness against hourglasses.
//!
//! Flanagan and Belytschko (1981): the energy is that of the mean strain, plus E a |γ_k·u|² for every hourglass mode k
//! and direction, where γ_k is the mode without its linear part, and a = 0.0005 V Σ |mean gradient|². This is C3D8R of
//! CalculiX 2.20, where it is right: there γ_k is without the linear part in z only, and on cells that are no
//! parallelepipeds resists linear displacements. A quadrilateral is a thick layer of such hexahedra, as CPE4R.

use super::map::{for_each_sample, relative};
use super::products::GradientProducts;
use super::quadrature::Purpose;
use super::table::table;
use crate::cell::{Element, Material};
use crate::kind::CellKind;

/// The factor of CalculiX 2.20; from 2025 on it is ten times as large.
const FACTOR: f64 = 0.0005;

/// The stiffness of a cell; elastic only.
pub(super) fn stiffness(kind: CellKind, points: &[[f64; 3]], material: &Material, out: &mut [f64]) {
    match kind {
        CellKind::Quad4 => cell::<2, 4, 1>(kind, points, material, out),
        _ => cell::<3, 8, 2>(kind, points, material, out),
    }
}

/// The mean gradient `[i][a]` and the volume.
pub(super) fn mean_gradient<const D: usize, const N: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
) -> ([[f64; N]; D], f64) {
    let table = table(kind, Purpose::Full);
    let (mut mean, mut volume) = ([[0.0; N]; D], 0.0);
    for_each_sample::<D, N>(&relative(points), table, |s| {
        volume += s.weight;
        for a in 0..N {
            for i in 0..D {
                mean[i][a] += s.weight * s.gradient[i][a];
            }
        }
    });
    (mean.map(|row| row.map(|g| g / volume)), volume)
}

fn cell<const D: usize, const N: usize, const L: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    material: &Material,
    out: &mut [f64],
) {
    let (mean, volume) = mean_gradient::<D, N>(kind, points);
    let mut products = GradientProducts::<D, N, L>::new();
    products.add(volume, &mean);
    products.stiffness(material.moduli(D, Element::Q1), out);

    let Material::Elastic { law, .. } = material else {
        panic!("hourglass stiffness is for elastic cells");
    };
    let young = law.young();
    let squares: f64 = mean.iter().flatten().map(|g| g * g).sum();
    // A layer has half of each gradient at either face and each mode twice. Its gradients across, 1/thickness², are
    // left out: with them the stiffness would hang on the unit of lengths.
    let layer = if D == 2 { 2.0 } else { 1.0 };
    let factor = layer * young * FACTOR * volume * squares;
    let at = relative::<D, N>(points);
    let modes = modes::<N>(kind).map(|mode| {
        let mut orthogonal = mode;
        for (x, gradient) in at.iter().zip(&mean) {
            let slope: f64 = x.iter().zip(&mode).map(|(x, h)| x * h).sum();
            for (entry, g) in orthogonal.iter_mut().zip(gradient) {
                *entry -= slope * g;
            }
        }
        orthogonal
    });
    let n = D * N;
    for a in 0..N {
        for b in a..N {
            let sum: f64 = modes.iter().map(|mode| mode[a] * mode[b]).sum();
            for i in 0..D {
                let (row, col) = (D * a + i, D * b + i);
                out[n * row + col] += factor * sum;
                out[n * col + row] = out[n * row + col];
            }
        }
    }
}

/// Products of at least two coordinates at the corners: four of a hexahedron, one of a quadrilateral (the others zero).
fn modes<const N: usize>(kind: CellKind) -> [[f64; N]; 4] {
    let corners = &table(kind, Purpose::Nodes).at;
    let mut modes = [[0.0; N]; 4];
    for (a, &[x, y, z]) in corners.iter().enumerate() {
        modes[0][a] = x * y;
        if N == 8 {
            modes[1][a] = y * z;
            modes[2][a] = x * z;
            modes[3][a] = x * y * z;
        }
    }
    modes
}

#[cfg(test)]
#[path = "../../tests/element/hourglass.rs"]
mod tests;
