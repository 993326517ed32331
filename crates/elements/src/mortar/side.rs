//! A side of a body: its nodes, its faces, and the flat pieces that the faces consist of.

use super::tree::{bounds, Bounds, Tree};
use crate::element::{face_values, side_weights, FaceValues};
use crate::kind::CellKind;
use base::linalg::vec3::{cross, dot, minus, norm, unit};

/// Faces around a node count as one smooth piece if the cosine of the angle between their normals is above this.
const SMOOTH: f64 = 0.8;

/// A face of an element.
#[derive(Debug, Clone, PartialEq)]
pub struct MortarFace {
    /// Its kind: a segment in the plane, a triangle or a quadrilateral in space.
    pub kind: CellKind,
    /// Its nodes, as places in the list of points, in the order of the kind: the normal points out of the body.
    pub nodes: Vec<u32>,
}

impl MortarFace {
    /// The kind of the faces of so many nodes in dimension `dim`; `None` if there is none.
    pub fn kind_of(dim: usize, nodes: usize) -> Option<CellKind> {
        Some(match (dim, nodes) {
            (2, 2) => CellKind::Line2,
            (2, 3) => CellKind::Line3,
            (3, 3) => CellKind::Triangle3,
            (3, 4) => CellKind::Quad4,
            (3, 6) => CellKind::Triangle6,
            (3, 8) => CellKind::Quad8,
            (3, 9) => CellKind::Quad9,
            _ => return None,
        })
    }
}

/// A flat piece of a face: a segment, a triangle, or a quadrilateral that is flat but for its warping.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    pub face: u32,
    /// Its corners in order, as places in the list of points.
    pub corners: Vec<u32>,
    /// Where the corners are in the reference cell of the face.
    pub at: Vec<[f64; 3]>,
    /// The unit normal out of the body.
    pub normal: [f64; 3],
}

/// A side of a body, in the plane or in space.
#[derive(Debug, Clone, PartialEq)]
pub struct MortarSide {
    dim: usize,
    points: Vec<[f64; 3]>,
    faces: Vec<MortarFace>,
    pub(super) pieces: Vec<Piece>,
    tree: Tree,
    /// The pieces around each node.
    around: Vec<Vec<u32>>,
}

impl MortarSide {
    /// A side in dimension `dim`, 2 or 3.
    ///
    /// # Panics
    /// If a face is not of dimension `dim` − 1, or has another number of nodes than its kind.
    pub fn new(dim: usize, points: Vec<[f64; 3]>, faces: Vec<MortarFace>) -> MortarSide {
        let mut pieces = Vec::new();
        for (f, face) in (0..).zip(&faces) {
            assert_eq!(face.kind.dim() + 1, dim, "a face of dimension {dim} − 1");
            assert_eq!(
                face.nodes.len(),
                face.kind.nodes(),
                "nodes of a {}",
                face.kind.name()
            );
            let reference = face_values::nodes(face.kind);
            for list in flat(face.kind) {
                let corners: Vec<u32> = list.iter().map(|&a| face.nodes[a]).collect();
                let x: Vec<[f64; 3]> = corners.iter().map(|&k| points[k as usize]).collect();
                pieces.push(Piece {
                    face: f,
                    at: list.iter().map(|&a| reference[a]).collect(),
                    normal: unit(across(&x)).unwrap_or_default(),
                    corners,
                });
            }
        }
        let mut around = vec![Vec::new(); points.len()];
        for (k, piece) in (0..).zip(&pieces) {
            piece
                .corners
                .iter()
                .for_each(|&c| around[c as usize].push(k));
        }
        let corners = |p: &Piece| bounds(p.corners.iter().map(|&k| points[k as usize]));
        MortarSide {
            tree: Tree::new(pieces.iter().map(corners).collect()),
            dim,
            points,
            faces,
            pieces,
            around,
        }
    }

    /// The dimension of space.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The positions of the nodes.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// The faces.
    pub fn faces(&self) -> &[MortarFace] {
        &self.faces
    }

    /// This side with its normals reversed.
    pub fn reversed(&self) -> MortarSide {
        let turned = |face: &MortarFace| MortarFace {
            kind: face.kind,
            nodes: reversed(face.kind, &face.nodes),
        };
        let faces = self.faces.iter().map(turned).collect();
        MortarSide::new(self.dim, self.points.clone(), faces)
    }

    /// This side at another place, `way` from here.
    pub fn moved(&self, way: [f64; 3]) -> MortarSide {
        let points = self.points.iter().map(|x| [0, 1, 2].map(|d| x[d] + way[d]));
        MortarSide::new(self.dim, points.collect(), self.faces.clone())
    }

    /// The longest edge of a piece.
    pub fn longest(&self) -> f64 {
        self.pieces.iter().map(|p| self.size(p)).fold(0.0, f64::max)
    }

    /// The shortest edge of a piece.
    pub fn shortest(&self) -> f64 {
        let of = |piece: &Piece| {
            let x = self.corners(piece);
            let edge = |k: usize| norm(minus(x[k], x[(k + 1) % x.len()]));
            (0..x.len()).map(edge).fold(f64::INFINITY, f64::min)
        };
        self.pieces.iter().map(of).fold(f64::INFINITY, f64::min)
    }

    /// The longest edge of a piece.
    pub(super) fn size(&self, piece: &Piece) -> f64 {
        let x = self.corners(piece);
        let edge = |k: usize| norm(minus(x[k], x[(k + 1) % x.len()]));
        (0..x.len()).map(edge).fold(0.0, f64::max)
    }

    /// Whether a piece lies opposite a piece of another side at a gap along the normal: at most `reach`, and as an
    /// overlap at most an edge. Sides do not face each other through a body.
    pub(super) fn meets(
        &self,
        piece: &Piece,
        other: &MortarSide,
        facing: &Piece,
        gap: f64,
        reach: f64,
    ) -> bool {
        gap <= reach && -gap <= reach.min(self.size(piece).max(other.size(facing)))
    }

    /// The positions of the corners of a piece.
    pub(super) fn corners(&self, piece: &Piece) -> Vec<[f64; 3]> {
        piece
            .corners
            .iter()
            .map(|&k| self.points[k as usize])
            .collect()
    }

    /// The pieces whose boxes meet a box.
    pub(super) fn near(&self, place: &Bounds) -> Vec<u32> {
        self.tree.meet(place)
    }

    /// The unit normal at a corner of a piece: the mean over the pieces around it that form one smooth surface with it.
    pub(super) fn normal(&self, piece: &Piece, corner: usize) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for &k in &self.around[piece.corners[corner] as usize] {
            let other = &self.pieces[k as usize];
            if dot(other.normal, piece.normal) > SMOOTH {
                (0..3).for_each(|d| sum[d] += other.normal[d]);
            }
        }
        unit(sum).unwrap_or(piece.normal)
    }

    /// The unit normals at the nodes: the means over the faces around a node, weighted by area. They are 0 at nodes
    /// without faces.
    pub fn normals(&self) -> Vec<[f64; 3]> {
        let mut sums = vec![[0.0; 3]; self.points.len()];
        for (f, face) in (0..).zip(&self.faces) {
            let x: Vec<[f64; 3]> = face
                .nodes
                .iter()
                .map(|&k| self.points[k as usize])
                .collect();
            let area: f64 = side_weights(face.kind, self.dim, &x).area.iter().sum();
            for (&k, at) in face.nodes.iter().zip(face_values::nodes(face.kind)) {
                let [s, t] = self.values(f, at).tangents;
                let vector = match self.dim {
                    2 => [s[1], -s[0], 0.0],
                    _ => cross(s, t),
                };
                let normal = unit(vector).unwrap_or_default();
                (0..3).for_each(|d| sums[k as usize][d] += area * normal[d]);
            }
        }
        let normal = |sum: [f64; 3]| unit(sum).unwrap_or_default();
        sums.into_iter().map(normal).collect()
    }

    /// Shape functions, position and tangents at a point of a face.
    pub(super) fn values(&self, face: u32, at: [f64; 3]) -> FaceValues {
        let face = &self.faces[face as usize];
        let x = face.nodes.iter().map(|&k| self.points[k as usize]);
        face_values::at(face.kind, x, at)
    }
}

/// The nodes of the flat pieces of a face: segments, triangles and quadrilaterals between its nodes.
fn flat(kind: CellKind) -> &'static [&'static [usize]] {
    match kind {
        CellKind::Line2 => &[&[0, 1]],
        CellKind::Line3 => &[&[0, 2], &[2, 1]],
        CellKind::Triangle3 => &[&[0, 1, 2]],
        CellKind::Triangle6 => &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]],
        CellKind::Quad4 => &[&[0, 1, 2, 3]],
        CellKind::Quad8 => &[
            &[0, 4, 7],
            &[4, 1, 5],
            &[5, 2, 6],
            &[6, 3, 7],
            &[4, 5, 6, 7],
        ],
        _ => &[&[0, 4, 8, 7], &[4, 1, 5, 8], &[8, 5, 2, 6], &[7, 8, 6, 3]],
    }
}

/// The vector across a segment (to the right of the way along it), triangle or quadrilateral, of the length of its area
/// or of twice that.
pub fn across(x: &[[f64; 3]]) -> [f64; 3] {
    match *x {
        [a, b] => [b[1] - a[1], a[0] - b[0], 0.0],
        [a, b, c] => cross(minus(b, a), minus(c, a)),
        _ => cross(minus(x[2], x[0]), minus(x[3], x[1])),
    }
}

/// The nodes of a face in the order in which its normal points to the other side.
pub fn reversed(kind: CellKind, nodes: &[u32]) -> Vec<u32> {
    let order: &[usize] = match kind {
        CellKind::Line2 => &[1, 0],
        CellKind::Line3 => &[1, 0, 2],
        CellKind::Triangle3 => &[0, 2, 1],
        CellKind::Triangle6 => &[0, 2, 1, 5, 4, 3],
        CellKind::Quad4 => &[0, 3, 2, 1],
        CellKind::Quad8 => &[0, 3, 2, 1, 7, 6, 5, 4],
        _ => &[0, 3, 2, 1, 7, 6, 5, 4, 8],
    };
    order.iter().map(|&k| nodes[k]).collect()
}

#[cfg(test)]
#[path = "../../tests/mortar/side.rs"]
mod tests;
