//! The foot of a node on a side: the nearest point of its faces, to which a tie at single nodes holds the node.
//!
//! A node lies opposite a face if its nearest point there lies inside the face, or on an edge with another face beyond.
//! Beyond the rim of the side it has no foot, but for a little slack.

use std::collections::HashMap;

use super::side::{MortarSide, Piece};
use crate::element::FaceValues;
use crate::kind::CellKind;
use base::linalg::vec3::{cross, dot, minus, norm, unit};

/// This part of the typical size of a face is the tolerance of CalculiX's ties where a deck gives none, and how far a
/// node may lie beyond the rim.
const SMALL: f64 = 0.025;

/// Distances that exceed a tolerance by less than this part of it do not.
const ROUNDING: f64 = 1e-9;

/// The point of a side that is nearest to a node.
#[derive(Debug, Clone, PartialEq)]
pub struct Foot {
    /// The distance from the flat piece of the face.
    pub distance: f64,
    /// The point of the face.
    pub point: [f64; 3],
    /// The unit normal of the face, out of its body.
    pub normal: [f64; 3],
    /// The nodes of the face with the values of their shape functions there.
    pub values: Vec<(u32, f64)>,
}

/// The search for feet on a side.
pub struct Feet<'s> {
    side: &'s MortarSide,
    /// How many pieces have an edge, by its nodes; in the plane a corner, twice.
    edges: HashMap<[u32; 2], u32>,
    /// How far beyond the rim a node may lie.
    beside: f64,
}

impl<'s> Feet<'s> {
    /// Prepares the search.
    pub fn new(side: &'s MortarSide) -> Feet<'s> {
        let mut edges = HashMap::new();
        for edge in side.pieces.iter().flat_map(edges_of) {
            *edges.entry(edge).or_insert(0) += 1;
        }
        Feet {
            side,
            edges,
            beside: SMALL * side.typical(),
        }
    }

    /// The foot of `x` on the nearest of the faces that lie opposite it, at a distance of `reach` at most. Only faces
    /// count for whose normals `facing` holds.
    pub fn of(&self, x: [f64; 3], reach: f64, facing: &dyn Fn([f64; 3]) -> bool) -> Option<Foot> {
        let reach = reach * (1.0 + ROUNDING);
        let around = reach + self.beside;
        let place = [x.map(|v| v - around), x.map(|v| v + around)];
        let mut best: Option<(f64, &Piece)> = None;
        for k in self.side.near(&place) {
            let piece = &self.side.pieces[k as usize];
            if !facing(piece.normal) {
                continue;
            }
            let found = self.distance(piece, x).filter(|far| *far <= reach);
            if let Some(far) = found.filter(|far| best.is_none_or(|b| *far < b.0)) {
                best = Some((far, piece));
            }
        }
        let (distance, piece) = best?;
        let here = self.nearest(piece, x);
        let nodes = &self.side.faces()[piece.face as usize].nodes;
        let values = nodes.iter().copied().zip(here.values);
        Some(Foot {
            distance,
            point: here.x,
            normal: piece.normal,
            values: values.filter(|v| v.1.abs() > 1e-14).collect(),
        })
    }

    /// How far `x` is from a piece: across it where it lies opposite, from an edge with another piece beyond; `None`
    /// beyond the rim.
    fn distance(&self, piece: &Piece, x: [f64; 3]) -> Option<f64> {
        let corners = self.side.corners(piece);
        let n = corners.len() as f64;
        let middle = [0, 1, 2].map(|d| corners.iter().map(|c| c[d]).sum::<f64>() / n);
        let across = dot(minus(x, middle), piece.normal).abs();
        let mut far: Option<f64> = None;
        for (k, edge) in edges_of(piece).enumerate() {
            let (p, q) = (corners[k], corners[(k + 1) % corners.len()]);
            let outward = match self.side.dim() {
                2 => minus(p, q),
                _ => cross(minus(q, p), piece.normal),
            };
            let beyond = dot(minus(x, p), unit(outward).unwrap_or_default());
            if beyond <= 0.0 {
                continue;
            }
            if self.edges[&edge] > 1 {
                far = Some(far.unwrap_or(0.0).max(beyond));
            } else if beyond > self.beside {
                return None;
            }
        }
        Some(far.map_or(across, |beyond| across.hypot(beyond)))
    }

    /// The nearest point of the face of a piece.
    fn nearest(&self, piece: &Piece, x: [f64; 3]) -> FaceValues {
        let kind = self.side.faces()[piece.face as usize].kind;
        let n = piece.at.len() as f64;
        let mut at = [0, 1, 2].map(|d| piece.at.iter().map(|a| a[d]).sum::<f64>() / n);
        // Gauss's and Newton's method: one step on flat faces with straight edges, a few on others.
        for _ in 0..40 {
            let here = self.side.values(piece.face, at);
            let away = minus(x, here.x);
            let [s, t] = here.tangents;
            let step = match self.side.dim() {
                2 => [dot(away, s) / dot(s, s), 0.0],
                _ => {
                    let (a, b, c) = (dot(s, s), dot(s, t), dot(t, t));
                    let (u, v) = (dot(away, s), dot(away, t));
                    let det = a * c - b * b;
                    [(c * u - b * v) / det, (a * v - b * u) / det]
                }
            };
            let next = inside(kind, [at[0] + step[0], at[1] + step[1], 0.0]);
            let moved = norm(minus(next, at));
            at = next;
            if moved < 1e-15 {
                break;
            }
        }
        self.side.values(piece.face, at)
    }
}

/// The edges of a piece by their nodes, in the order of its corners; in the plane its ends.
fn edges_of(piece: &Piece) -> impl Iterator<Item = [u32; 2]> + '_ {
    let corners = &piece.corners;
    (0..corners.len()).map(move |k| match corners[..] {
        [p, q] => [[p, q][k]; 2],
        _ => {
            let (p, q) = (corners[k], corners[(k + 1) % corners.len()]);
            [p.min(q), p.max(q)]
        }
    })
}

/// The point of the reference cell that is nearest to a point, or nearly so beyond a corner.
fn inside(kind: CellKind, at: [f64; 3]) -> [f64; 3] {
    match kind {
        CellKind::Triangle3 | CellKind::Triangle6 => {
            let [s, t] = [at[0].max(0.0), at[1].max(0.0)];
            let over = (s + t - 1.0).max(0.0);
            let [s, t] = [s - 0.5 * over, t - 0.5 * over];
            // What goes beyond a corner ends there.
            [(s + t.min(0.0)).max(0.0), (t + s.min(0.0)).max(0.0), 0.0]
        }
        _ => [at[0].clamp(-1.0, 1.0), at[1].clamp(-1.0, 1.0), 0.0],
    }
}

impl MortarSide {
    /// A small part of the typical size of its faces: the tolerance of CalculiX's *TIE where a deck gives none. The
    /// size of a triangle is the distance of its centre from an edge.
    pub fn small(&self) -> f64 {
        SMALL * self.typical()
    }

    /// The mean over the triangles of all faces of the distance of the centre from an edge; in the plane a third of the
    /// mean length.
    fn typical(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0_f64);
        for face in self.faces() {
            let at = |k: usize| self.points()[face.nodes[k] as usize];
            if self.dim() == 2 {
                (sum, count) = (sum + norm(minus(at(1), at(0))) / 3.0, count + 1.0);
                continue;
            }
            for &[a, b, c] in triangles(face.kind) {
                let along = minus(at(c), at(b));
                let double = norm(cross(minus(at(b), at(a)), along));
                sum += double / (3.0 * norm(along));
                count += 1.0;
            }
        }
        sum / count.max(1.0)
    }
}

/// The triangles between the nodes of a face, as CalculiX makes them.
fn triangles(kind: CellKind) -> &'static [[usize; 3]] {
    match kind {
        CellKind::Triangle3 => &[[0, 1, 2]],
        CellKind::Triangle6 => &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
        CellKind::Quad4 => &[[0, 1, 3], [1, 2, 3]],
        _ => &[
            [0, 4, 7],
            [4, 1, 5],
            [6, 5, 2],
            [7, 6, 3],
            [7, 4, 6],
            [4, 5, 6],
        ],
    }
}

#[cfg(test)]
#[path = "../../tests/mortar/foot.rs"]
mod tests;
