//! Whether the map of a cell can be inverted.

use super::loads::check_dim;
use super::map::{by_kind, jacobian, relative, slopes};
use super::quadrature::Purpose;
use super::table::table;
use crate::linalg::small::invert;
use crate::mesh::CellKind;
use std::fmt;

/// What is wrong with a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BadCell {
    /// A coordinate is infinite or not a number.
    NotFinite,
    /// The nodes are numbered the wrong way round: det J is negative everywhere.
    Inverted,
    /// It has no volume somewhere: det J is zero where the cell is integrated.
    Degenerate,
    /// It has no volume at some node, and is sound inside: corners that coincide, middle nodes at a quarter of an edge.
    /// Its stiffness is finite.
    Pinched,
    /// det J has both signs.
    Folded,
}

impl fmt::Display for BadCell {
    /// A clause of which the cell is the subject.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            BadCell::NotFinite => "has a coordinate that is not a finite number",
            BadCell::Inverted => "is inside out: its nodes are numbered the wrong way round",
            BadCell::Degenerate => "has no volume",
            BadCell::Pinched => "has no volume at one of its nodes",
            BadCell::Folded => {
                "is folded: its Jacobian is positive in one place and negative in another"
            }
        })
    }
}

/// What of the product of its columns' lengths det J has to exceed: far below it are only the roundings.
const ZERO: f64 = 1e-12;

/// How far a middle node may lie from the middle of its edge, in lengths of the edge, for a cell to count as straight.
const STRAIGHT: f64 = 1e-10;

/// Whether det J is positive at the nodes and wherever the cell is integrated, errors included.
///
/// A cell of second order whose edges are straight, with their nodes in the middle, has the map of its corners, and is
/// judged by it. The sign is told from zero in relation to the lengths of the edges: a needle is not degenerate.
///
/// # Errors
/// [`BadCell`].
///
/// # Panics
/// When the cell is not of dimension `dim`, or has another number of nodes.
pub fn check_jacobian(kind: CellKind, dim: usize, points: &[[f64; 3]]) -> Result<(), BadCell> {
    check_dim(kind, dim);
    assert_eq!(points.len(), kind.nodes(), "a {}", kind.name());
    if !points.iter().flatten().all(|x| x.is_finite()) {
        return Err(BadCell::NotFinite);
    }
    let kind = if is_straight(kind, points) {
        kind.linear()
    } else {
        kind
    };
    let points = &points[..kind.nodes()];
    let inside = match kind {
        // Their map is affine.
        CellKind::Triangle3 | CellKind::Tet4 => signs(kind, points, Purpose::Full),
        _ => signs(kind, points, Purpose::Full).and(signs(kind, points, Purpose::Error)),
    };
    // The map of the pyramid has no limit at the apex; on the way there it is that of a point of the base.
    let nodes = signs(kind, points, Purpose::Nodes);
    let all = inside.and(nodes);
    match (all.negative, all.positive) {
        (true, true) => Err(BadCell::Folded),
        _ if inside.zero => Err(BadCell::Degenerate),
        (true, false) => Err(BadCell::Inverted),
        _ if nodes.zero => Err(BadCell::Pinched),
        _ => Ok(()),
    }
}

/// Which signs det J has.
#[derive(Clone, Copy)]
struct Signs {
    positive: bool,
    zero: bool,
    negative: bool,
}

impl Signs {
    fn and(self, other: Signs) -> Signs {
        Signs {
            positive: self.positive || other.positive,
            zero: self.zero || other.zero,
            negative: self.negative || other.negative,
        }
    }
}

fn signs(kind: CellKind, points: &[[f64; 3]], purpose: Purpose) -> Signs {
    by_kind!(kind, signs_of(kind, points, purpose))
}

fn signs_of<const D: usize, const N: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    purpose: Purpose,
) -> Signs {
    let table = table(kind, purpose);
    let at = relative::<D, N>(points);
    let mut signs = Signs {
        positive: false,
        zero: false,
        negative: false,
    };
    for q in 0..table.weights.len() {
        let j = jacobian(&at, &slopes::<D, N>(table, q));
        let (det, _) = invert(&j);
        let mut scale = 1.0;
        for column in 0..D {
            scale *= j
                .iter()
                .map(|row| row[column] * row[column])
                .sum::<f64>()
                .sqrt();
        }
        // A determinant that is not a number comes from an overflow: as good as zero.
        if det > ZERO * scale {
            signs.positive = true;
        } else if det < -ZERO * scale {
            signs.negative = true;
        } else {
            signs.zero = true;
        }
    }
    signs
}

/// Whether all middle nodes lie in the middle of the corners around them.
fn is_straight(kind: CellKind, points: &[[f64; 3]]) -> bool {
    (kind.corners()..kind.nodes()).all(|a| {
        let around = around(kind, a);
        let first = points[usize::from(around[0])];
        let (mut mean, mut size) = ([0.0; 3], 0.0_f64);
        for &corner in around {
            for d in 0..3 {
                let x = points[usize::from(corner)][d] - first[d];
                mean[d] += x / around.len() as f64;
                size = size.max(x.abs());
            }
        }
        (0..3).all(|d| (points[a][d] - first[d] - mean[d]).abs() <= STRAIGHT * size)
    })
}

/// The corners around the middle node `a`: of its edge, of its face, or all.
fn around(kind: CellKind, a: usize) -> &'static [u8] {
    if let Some(edge) = kind.edges().get(a - kind.corners()) {
        return edge;
    }
    let mut faces = kind.sides().iter().filter(|side| side.nodes.len() == 9);
    match faces.find(|side| usize::from(side.nodes[8]) == a) {
        Some(face) => &face.nodes[..4],
        None => &[0, 1, 2, 3, 4, 5, 6, 7][..kind.corners()],
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/fem/element/valid.rs"]
mod tests;
