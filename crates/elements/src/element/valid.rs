//! Whether the map of a cell can be inverted.
//!
//! The points at which the stiffness is integrated decide, as in CalculiX and Abaqus: a cell is refused where det J is
//! not positive at one of them. Elsewhere, as at a corner that a bent edge folds over, it makes the cell doubtful and
//! no more.

use super::integration::Integration;
use super::loads::{check_dim, volume};
use super::map::{by_kind, jacobian, relative, slopes};
use super::quadrature::Purpose;
use super::table::table;
use crate::kind::CellKind;
use base::linalg::small::invert;
use std::fmt;

/// The defect of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BadCell {
    /// A coordinate is infinite or not a number.
    NotFinite,
    /// The nodes are numbered the wrong way round: det J is negative everywhere.
    Inverted,
    /// It has no volume somewhere: det J is zero where the cell is integrated.
    Degenerate,
    /// det J is negative where the cell is integrated, and positive in another place.
    Folded,
}

impl fmt::Display for BadCell {
    /// A clause of which the cell is the subject.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            BadCell::NotFinite => "has a coordinate that is not a finite number",
            BadCell::Inverted => "is inside out: its nodes are numbered the wrong way round",
            BadCell::Degenerate => "has no volume",
            BadCell::Folded => {
                "is folded: its Jacobian is positive in one place and negative in another"
            }
        })
    }
}

/// A cell that is integrated soundly, and is folded or has no volume somewhere else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Doubt {
    /// The node, as a place in the cell, where det J is least; `None`: it is negative between the nodes only.
    pub node: Option<usize>,
    /// det J there, in units of its mean over the cell. Not above zero.
    pub jacobian: f64,
}

/// The part of the product of its columns' lengths that det J has to exceed: far below it are only the roundings.
const ZERO: f64 = 1e-12;

/// How far a middle node may lie from the middle of its edge, in lengths of the edge, for a cell to count as straight.
const STRAIGHT: f64 = 1e-10;

/// Whether det J is positive wherever the stiffness is integrated; and if so, whether it is not in another place.
///
/// A cell of second order whose edges are straight, with their nodes in the middle, has the map of its corners, and its
/// nodes are judged by it. The sign is told from zero in relation to the lengths of the edges: a needle is not
/// degenerate.
///
/// # Errors
/// [`BadCell`].
///
/// # Panics
/// When the cell is not of dimension `dim`, or has another number of nodes.
pub fn check_jacobian(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    integration: Integration,
) -> Result<Option<Doubt>, BadCell> {
    check_dim(kind, dim);
    assert_eq!(points.len(), kind.nodes(), "a {}", kind.name());
    if !points.iter().flatten().all(|x| x.is_finite()) {
        return Err(BadCell::NotFinite);
    }
    let bilinear = matches!(kind, CellKind::Quad4 | CellKind::Hex8);
    let rules: &[Purpose] = match integration {
        // The mean gradient needs the volume alone, CalculiX the point in the middle.
        Integration::Reduced if bilinear => &[Purpose::Centre],
        Integration::Reduced => &[Purpose::Reduced],
        Integration::Incompatible => &[Purpose::Full, Purpose::Centre],
        Integration::Full => &[Purpose::Full],
    };
    let inside = rules
        .iter()
        .map(|rule| signs(kind, points, *rule))
        .reduce(JacobianSigns::and)
        .expect("a rule");
    let whole = volume(kind, dim, points);
    let affine = matches!(kind, CellKind::Triangle3 | CellKind::Tet4);
    if inside.negative || inside.zero || whole <= 0.0 {
        let elsewhere = || !affine && signs(kind, points, Purpose::Nodes).positive;
        return Err(match inside {
            JacobianSigns {
                negative: true,
                positive: true,
                ..
            } => BadCell::Folded,
            JacobianSigns { zero: true, .. } => BadCell::Degenerate,
            JacobianSigns { negative: true, .. } if whole > 0.0 && elsewhere() => BadCell::Folded,
            JacobianSigns { negative: true, .. } => BadCell::Inverted,
            _ => BadCell::Folded,
        });
    }
    if affine {
        return Ok(None);
    }
    let (shape, corners) = if is_straight(kind, points) {
        (kind.linear(), &points[..kind.corners()])
    } else {
        (kind, points)
    };
    // The map of the pyramid has no limit at the apex; on the way there it is that of a point of the base.
    let nodes = signs(shape, corners, Purpose::Nodes);
    let between = signs(shape, corners, Purpose::Error);
    let node = nodes.least.filter(|_| nodes.negative || nodes.zero);
    let least = match node {
        Some(_) => nodes.value,
        None if between.negative => between.value,
        None => return Ok(None),
    };
    let reference = Purpose::Load;
    let size: f64 = table(kind, reference).weights.iter().sum();
    Ok(Some(Doubt {
        node,
        jacobian: if nodes.negative || between.negative {
            least * size / whole
        } else {
            0.0
        },
    }))
}

/// Which signs det J has.
#[derive(Clone, Copy)]
struct JacobianSigns {
    positive: bool,
    zero: bool,
    negative: bool,
    /// Where det J is least, beside the lengths of its columns, and det J there.
    least: Option<usize>,
    value: f64,
    ratio: f64,
}

impl JacobianSigns {
    fn and(self, other: JacobianSigns) -> JacobianSigns {
        let (less, more) = if other.ratio < self.ratio {
            (other, self)
        } else {
            (self, other)
        };
        JacobianSigns {
            positive: less.positive || more.positive,
            zero: less.zero || more.zero,
            negative: less.negative || more.negative,
            ..less
        }
    }
}

fn signs(kind: CellKind, points: &[[f64; 3]], purpose: Purpose) -> JacobianSigns {
    by_kind!(kind, signs_of(kind, points, purpose))
}

fn signs_of<const D: usize, const N: usize>(
    kind: CellKind,
    points: &[[f64; 3]],
    purpose: Purpose,
) -> JacobianSigns {
    let table = table(kind, purpose);
    let at = relative::<D, N>(points);
    let mut signs = JacobianSigns {
        positive: false,
        zero: false,
        negative: false,
        least: None,
        value: 0.0,
        ratio: f64::INFINITY,
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
        let ratio = det / scale;
        if ratio < signs.ratio || signs.least.is_none() {
            (signs.least, signs.value, signs.ratio) = (Some(q), det, ratio);
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
#[path = "../../tests/element/valid.rs"]
mod tests;
