//! Incompatible modes of quadrilaterals and hexahedra: bending without locking.
//!
//! To the shape functions come 1 − s_j², one per direction, whose coefficients belong to the cell alone and are
//! condensed. Their gradients are taken with the map at the middle of the cell, times det J(middle)/det J (Taylor,
//! Beresford and Wilson 1976): then constant stresses do no work on them, and the patch test holds on any cell. This
//! is C3D8I of CalculiX.

use super::map::{for_each_sample, jacobian, relative, slopes, ElementSample};
use super::products::GradientProducts;
use super::quadrature::Purpose;
use super::table::table;
use crate::cell::Moduli;
use crate::kind::CellKind;
use base::linalg::small::invert;

/// Rows of the largest matrix: three directions of eight nodes and three modes.
const MOST: usize = 33;

/// The stiffness of a cell, condensed.
pub(super) fn stiffness(kind: CellKind, points: &[[f64; 3]], moduli: Moduli, out: &mut [f64]) {
    match kind {
        CellKind::Quad4 => condensed::<2, 4, 6, 2>(kind, points, moduli, out),
        _ => condensed::<3, 8, 11, 3>(kind, points, moduli, out),
    }
}

/// Calls `f` with the points of the full rule and the gradient ∂u_i/∂x_j of the displacement, modes included.
pub(super) fn for_each_gradient(
    kind: CellKind,
    points: &[[f64; 3]],
    moduli: Moduli,
    nodal: &[f64],
    f: impl FnMut(usize, [[f64; 3]; 3]),
) {
    match kind {
        CellKind::Quad4 => gradients::<2, 4, 6, 2>(kind, points, moduli, nodal, f),
        _ => gradients::<3, 8, 11, 3>(kind, points, moduli, nodal, f),
    }
}

fn condensed<const D: usize, const N: usize, const M: usize, const L: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    moduli: Moduli,
    out: &mut [f64],
) {
    let (n, m) = (D * N, D * M);
    let k = CondensedModes::new::<D, N, M, L>(kind, points, moduli);
    for i in 0..n {
        for j in i..n {
            let inner: f64 = (n..m).map(|q| k.0[q][i] * k.0[q][j]).sum();
            let entry = k.0[i][j] - inner;
            out[i * n + j] = entry;
            out[j * n + i] = entry;
        }
    }
}

fn gradients<const D: usize, const N: usize, const M: usize, const L: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    moduli: Moduli,
    nodal: &[f64],
    mut f: impl FnMut(usize, [[f64; 3]; 3]),
) {
    let all =
        CondensedModes::new::<D, N, M, L>(kind, points, moduli).with_modes(D * N, D * M, nodal);
    for_each_extended::<D, N, M>(kind, points, |s| {
        let mut gradient = [[0.0; 3]; 3];
        for (a, node) in all[..D * M].chunks_exact(D).enumerate() {
            for (i, x) in node.iter().enumerate() {
                for j in 0..D {
                    gradient[i][j] += x * s.gradient[j][a];
                }
            }
        }
        f(s.index, gradient);
    });
}

/// The stiffness of nodes u and modes m, where the rows of the modes are replaced: by L⁻¹ K_mu in the columns of the
/// nodes, by L in those of the modes, with K_mm = L Lᵀ.
struct CondensedModes([[f64; MOST]; MOST]);

impl CondensedModes {
    fn new<const D: usize, const N: usize, const M: usize, const L: usize>(
        kind: CellKind,
        points: &[[f64; 3]],
        moduli: Moduli,
    ) -> CondensedModes {
        let mut products = GradientProducts::<D, M, L>::new();
        for_each_extended::<D, N, M>(kind, points, |s| products.add(s.weight, &s.gradient));
        let (n, m) = (D * N, D * M);
        let mut flat = [0.0; MOST * MOST];
        products.stiffness(moduli, &mut flat[..m * m]);
        let mut k = [[0.0; MOST]; MOST];
        for (row, values) in k.iter_mut().zip(flat[..m * m].chunks_exact(m)) {
            row[..m].copy_from_slice(values);
        }
        for q in n..m {
            for p in n..=q {
                let known: f64 = (n..p).map(|r| k[q][r] * k[p][r]).sum();
                let rest = k[q][p] - known;
                k[q][p] = if p == q { rest.sqrt() } else { rest / k[p][p] };
            }
            for j in 0..n {
                let known: f64 = (n..q).map(|r| k[q][r] * k[r][j]).sum();
                k[q][j] = (k[q][j] - known) / k[q][q];
            }
        }
        CondensedModes(k)
    }

    /// The values of the nodes and of the modes, −K_mm⁻¹ K_mu u.
    fn with_modes(&self, n: usize, m: usize, nodal: &[f64]) -> [f64; MOST] {
        let k = &self.0;
        let mut all = [0.0; MOST];
        all[..n].copy_from_slice(nodal);
        for q in (n..m).rev() {
            let forward: f64 = (0..n).map(|j| k[q][j] * nodal[j]).sum();
            let known: f64 = (q + 1..m).map(|r| k[r][q] * all[r]).sum();
            all[q] = (-forward - known) / k[q][q];
        }
        all
    }
}

/// Calls `f` with the points of the full rule; the modes come behind the nodes.
fn for_each_extended<const D: usize, const N: usize, const M: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    mut f: impl FnMut(&ElementSample<D, M>),
) {
    let at = relative::<D, N>(points);
    let middle = slopes::<D, N>(table(kind, Purpose::Centre), 0);
    let (det, inverse) = invert(&jacobian(&at, &middle));
    let full = table(kind, Purpose::Full);
    for_each_sample::<D, N>(&at, full, |s| {
        let shrink = det * full.weights[s.index] / s.weight;
        let mut gradient = [[0.0; M]; D];
        for (i, row) in gradient.iter_mut().enumerate() {
            row[..N].copy_from_slice(&s.gradient[i]);
            for j in 0..D {
                row[N + j] = -2.0 * full.at[s.index][j] * inverse[j][i] * shrink;
            }
        }
        f(&ElementSample {
            index: s.index,
            gradient,
            weight: s.weight,
        });
    });
}

#[cfg(test)]
#[path = "../../tests/element/incompatible.rs"]
mod tests;
