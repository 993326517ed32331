//! Dual bases on the faces of the multiplier side, and the rows that follow.
//!
//! On a face let p run over the nodes that carry multipliers. Functions φ̂_p with the sum 1 take part of the functions
//! of the other nodes: where a node of the face carries none, because it lies beyond the other side, is held, or has a
//! multiplier of another pair, its function goes to the others in equal parts. With M̂ = ∫ φ̂ φ̂ and D̂ = diag ∫ φ̂
//! over the part of the face that lies opposite the other side,
//!
//! ```text
//!     ψ = D̂ M̂⁻¹ φ̂,    ∫ ψ_p φ̂_q = δ_pq D̂_p,    Σ ψ_p = 1,
//! ```
//!
//! so that constant pressures are in the span of ψ, also beside an edge of the contact zone. On triangles of 6 and
//! quadrilaterals of 8 nodes ∫ φ_p ≤ 0 at corners, and signs of multipliers would mean nothing: φ̂ there begins with
//! the locally modified functions of Popp, Wohlmuth, Gee and Wall (2012), of which all integrals are positive.

use std::collections::BTreeMap;

use super::sample::MortarSample;
use super::side::MortarSide;
use crate::kind::CellKind;
use base::linalg::dense::{self, Dense, Scratch};

/// A node carries a multiplier if its function has at least this part of its integral opposite the other side. Values
/// far outside would be extrapolated from small parts.
const COVERED: f64 = 0.1;

/// Part of the functions in the middle of edges that each of the two corners takes, on sides with 6 and 8 nodes.
const SHARE: f64 = 0.2;

/// A row: Σ own · u − Σ other · u°.
#[derive(Debug, Clone, PartialEq)]
pub struct DualMortarRow {
    /// The node of the multiplier side.
    pub node: u32,
    /// Nodes of the multiplier side with D_pk / D_p, by increasing number; the coefficients sum to 1.
    pub own: Vec<(u32, f64)>,
    /// Nodes of the other side with M_pq / D_p, by increasing number; the coefficients sum to 1.
    pub other: Vec<(u32, f64)>,
    /// D_p: the multiplier divided by it is a pressure.
    pub area: f64,
}

/// The rows of the nodes of `side` that lie opposite `other`, by increasing node. `samples` are those of both sides,
/// `excluded` says which nodes of `side` must not carry a multiplier, and `factor` multiplies weights (2π r for rings).
pub fn rows(
    side: &MortarSide,
    other: &MortarSide,
    samples: &[MortarSample],
    excluded: &dyn Fn(u32) -> bool,
    factor: &dyn Fn([f64; 3]) -> f64,
) -> Vec<DualMortarRow> {
    let faces: Vec<Covered> = samples
        .chunk_by(|a, b| a.face == b.face)
        .map(|of_face| Covered::new(side, other, of_face, factor))
        .collect();
    let carries = carriers(side, &faces, excluded, factor);
    let mut sums: BTreeMap<u32, RowIntegrals> = BTreeMap::new();
    for face in &faces {
        face.add(side, other, &carries, &mut sums);
    }
    let finish = |(node, sum): (u32, RowIntegrals)| {
        let share = |(k, v): (u32, f64)| (k, v / sum.area);
        // What is left of terms that cancel.
        let counts = |t: &(u32, f64)| t.1.abs() > 1e-13;
        DualMortarRow {
            node,
            own: sum.own.into_iter().map(share).filter(counts).collect(),
            other: sum.other.into_iter().map(share).filter(counts).collect(),
            area: sum.area,
        }
    };
    sums.into_iter().map(finish).collect()
}

/// The integrals of a row.
#[derive(Default)]
struct RowIntegrals {
    own: BTreeMap<u32, f64>,
    other: BTreeMap<u32, f64>,
    area: f64,
}

/// A face of the multiplier side, as far as it lies opposite the other side.
struct Covered<'s> {
    face: u32,
    samples: &'s [MortarSample],
    /// The modified functions at the samples, of both sides the values of shape functions, and the weights.
    modified: Vec<[f64; 9]>,
    own: Vec<[f64; 9]>,
    other: Vec<[f64; 9]>,
    weights: Vec<f64>,
}

impl<'s> Covered<'s> {
    fn new(
        side: &MortarSide,
        other: &MortarSide,
        samples: &'s [MortarSample],
        factor: &dyn Fn([f64; 3]) -> f64,
    ) -> Covered<'s> {
        let face = samples[0].face;
        let kind = side.faces()[face as usize].kind;
        let here: Vec<_> = samples.iter().map(|s| side.values(face, s.at)).collect();
        let there = samples
            .iter()
            .map(|s| other.values(s.other, s.opposite).values);
        Covered {
            face,
            samples,
            modified: here.iter().map(|v| positive(kind, v.values)).collect(),
            own: here.iter().map(|v| v.values).collect(),
            other: there.collect(),
            weights: here
                .iter()
                .zip(samples)
                .map(|(v, s)| s.weight * factor(v.x))
                .collect(),
        }
    }

    /// Adds the integrals of the face to the rows of its nodes.
    fn add(
        &self,
        side: &MortarSide,
        other: &MortarSide,
        carries: &[bool],
        sums: &mut BTreeMap<u32, RowIntegrals>,
    ) {
        let nodes = &side.faces()[self.face as usize].nodes;
        let active: Vec<usize> = (0..nodes.len())
            .filter(|&a| carries[nodes[a] as usize])
            .collect();
        if active.is_empty() {
            return;
        }
        let part = 1.0 / active.len() as f64;
        let hat = |m: &[f64; 9]| {
            let others = (0..nodes.len()).filter(|a| !active.contains(a));
            let rest: f64 = others.map(|a| m[a]).sum();
            let mut hat = [0.0; 9];
            let carried = hat.iter_mut().zip(&active);
            carried.for_each(|(hat, &a)| *hat = m[a] + part * rest);
            hat
        };
        let hats: Vec<[f64; 9]> = self.modified.iter().map(hat).collect();
        let n = active.len();
        let dual = self.dual(&hats, n);
        let facing = self.samples.chunk_by(|a, b| a.other == b.other);
        let mut points = hats
            .iter()
            .zip(&self.weights)
            .zip(&self.own)
            .zip(&self.other);
        for samples in facing {
            let theirs = &other.faces()[samples[0].other as usize].nodes;
            // ∫ φ̂ φ, ∫ φ̂ φ° and ∫ φ̂ over the part of the face that is opposite this one.
            let (mut own, mut opposite, mut area) = ([[0.0; 9]; 9], [[0.0; 9]; 9], [0.0; 9]);
            for (((hat, weight), here), there) in points.by_ref().take(samples.len()) {
                for r in 0..n {
                    let weight = weight * hat[r];
                    area[r] += weight;
                    add_scaled(&mut own[r], weight, here);
                    add_scaled(&mut opposite[r], weight, there);
                }
            }
            for (psi, &a) in dual.iter().zip(&active) {
                let (mut row, mut there) = ([0.0; 9], [0.0; 9]);
                let sum = sums.entry(nodes[a]).or_default();
                for r in 0..n {
                    sum.area += psi[r] * area[r];
                    add_scaled(&mut row, psi[r], &own[r]);
                    add_scaled(&mut there, psi[r], &opposite[r]);
                }
                for (&k, value) in nodes.iter().zip(row) {
                    *sum.own.entry(k).or_default() += value;
                }
                for (&k, value) in theirs.iter().zip(there) {
                    *sum.other.entry(k).or_default() += value;
                }
            }
        }
    }

    /// The first `n` rows and columns of D̂ M̂⁻¹: each row is a dual function, as a combination of the φ̂.
    fn dual(&self, hats: &[[f64; 9]], n: usize) -> [[f64; 9]; 9] {
        let mut mass = Dense::zeros(n, n);
        let mut diagonal = vec![0.0; n];
        for (hat, w) in hats.iter().zip(&self.weights) {
            for i in 0..n {
                diagonal[i] += w * hat[i];
                for j in 0..n {
                    mass.set(i, j, mass.get(i, j) + w * hat[i] * hat[j]);
                }
            }
        }
        let size: Vec<f64> = (0..n).map(|i| mass.get(i, i)).collect();
        let regular = dense::cholesky(mass.view_mut(), &mut Scratch::default()).is_ok()
            && (0..n).all(|i| mass.get(i, i).powi(2) > SINGULAR * size[i]);
        let mut out = [[0.0; 9]; 9];
        if !regular {
            // A sliver, in which no two functions can be told apart: constants remain. The sum of the φ̂ is 1.
            let rows = out[..n].iter_mut();
            rows.for_each(|row| row[..n].fill(1.0 / n as f64));
            return out;
        }
        for (p, row) in out[..n].iter_mut().enumerate() {
            let mut x = Dense::zeros(n, 1);
            x.set(p, 0, diagonal[p]);
            dense::solve_lower(mass.view(), x.view_mut());
            dense::solve_lower_transpose(mass.view(), x.view_mut());
            row[..n].copy_from_slice(x.col(0));
        }
        out
    }
}

/// y ← y + α x.
fn add_scaled(y: &mut [f64; 9], alpha: f64, x: &[f64; 9]) {
    for i in 0..9 {
        y[i] += alpha * x[i];
    }
}

/// A mass matrix counts as singular if a pivot is below this part of its diagonal.
const SINGULAR: f64 = 1e-12;

/// Which nodes of the side carry multipliers.
fn carriers(
    side: &MortarSide,
    faces: &[Covered<'_>],
    excluded: &dyn Fn(u32) -> bool,
    factor: &dyn Fn([f64; 3]) -> f64,
) -> Vec<bool> {
    let n = side.points().len();
    let (mut covered, mut whole) = (vec![0.0; n], vec![0.0; n]);
    for face in faces {
        let nodes = &side.faces()[face.face as usize].nodes;
        for (values, w) in face.modified.iter().zip(&face.weights) {
            nodes
                .iter()
                .zip(values)
                .for_each(|(&k, v)| covered[k as usize] += w * v);
        }
    }
    for face in side.faces() {
        let x: Vec<[f64; 3]> = face
            .nodes
            .iter()
            .map(|&k| side.points()[k as usize])
            .collect();
        let weights = crate::element::side_weights(face.kind, side.dim(), &x);
        let middle = [0, 1, 2].map(|d| x.iter().map(|x| x[d]).sum::<f64>() / x.len() as f64);
        let areas = positive(face.kind, weights.area);
        for (&k, area) in face.nodes.iter().zip(areas) {
            whole[k as usize] += area * factor(middle);
        }
    }
    let carries = |k: usize| covered[k] > COVERED * whole[k] && !excluded(k as u32);
    (0..n).map(carries).collect()
}

/// Whether the shape functions of a face have positive integrals. At the corners of triangles of 6 and quadrilaterals
/// of 8 nodes these are zero and negative.
pub fn has_positive_integrals(kind: CellKind) -> bool {
    !matches!(kind, CellKind::Triangle6 | CellKind::Quad8)
}

/// Functions with positive integrals whose sum is 1, from shape functions (or their integrals).
pub fn positive(kind: CellKind, values: [f64; 9]) -> [f64; 9] {
    if has_positive_integrals(kind) {
        return values;
    }
    let mut out = values;
    for (edge, ends) in kind.edges().iter().enumerate() {
        let middle = kind.corners() + edge;
        out[middle] -= 2.0 * SHARE * values[middle];
        for &corner in &ends[..2] {
            out[usize::from(corner)] += SHARE * values[middle];
        }
    }
    out
}

#[cfg(test)]
#[path = "../../tests/mortar/dual.rs"]
mod tests;
