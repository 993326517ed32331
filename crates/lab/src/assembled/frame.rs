//! The coordinates w = M u at a node in contact. In them every contact row at the node is a difference of two unknowns,
//! or one unknown alone.
//!
//! The first rows of M are the directions of the contact rows; the remaining ones are unit vectors orthogonal to them.
//! Directions must be linearly independent, but need not be orthogonal to each other.

use base::linalg::vec3::{dot, norm};

/// Two directions count as dependent where the sine of the angle between one and the span of the earlier ones is below
/// this.
const INDEPENDENT: f64 = 0.05;

/// Directions that differ by less than this are equal.
const SAME: f64 = 1e-10;

/// w = M u and u = T w at one node. Rows beyond the number of components are those of the identity.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeFrame {
    /// M, from u to w.
    pub to: [[f64; 3]; 3],
    /// T = M⁻¹, from w to u.
    pub from: [[f64; 3]; 3],
}

impl NodeFrame {
    /// The identity: w = u.
    pub const IDENTITY: NodeFrame = NodeFrame {
        to: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        from: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };

    /// A frame with these directions; each has entries in the `free` components only. `None` where they are not
    /// independent.
    pub fn new(directions: &[[f64; 3]], free: [bool; 3]) -> Option<NodeFrame> {
        let mut to = NodeFrame::IDENTITY.to;
        let mut open = free;
        // An orthonormal basis of the rows of M found so far.
        let mut span: Vec<[f64; 3]> = Vec::new();
        for d in directions {
            let rest = beside(&span, *d);
            let size = norm(rest);
            if size < INDEPENDENT * norm(*d) {
                return None;
            }
            let by_size =
                |a: &usize, b: &usize| rest[*a].abs().total_cmp(&rest[*b].abs()).then(b.cmp(a));
            let slot = (0..3).filter(|&c| open[c]).max_by(by_size)?;
            (to[slot], open[slot]) = (*d, false);
            span.push(rest.map(|v| v / size));
        }
        for slot in (0..3).filter(|&c| open[c]) {
            let axes = (0..3)
                .filter(|&c| free[c])
                .map(|c| beside(&span, NodeFrame::IDENTITY.to[c]));
            // The axis with this number is taken where it is independent: frames of directions along axes are the
            // identity.
            let own = beside(&span, NodeFrame::IDENTITY.to[slot]);
            let best = axes.max_by(|a, b| norm(*a).total_cmp(&norm(*b)))?;
            let rest = if norm(own) > 0.3 { own } else { best };
            let size = norm(rest);
            to[slot] = rest.map(|v| v / size);
            span.push(to[slot]);
        }
        let from = inverse(&to)?;
        Some(NodeFrame { to, from })
    }

    /// Whether w = u.
    pub fn is_identity(&self) -> bool {
        *self == NodeFrame::IDENTITY
    }

    /// The component of w along a direction; where none is, the one that has most of it.
    pub fn along(&self, direction: [f64; 3]) -> usize {
        let cosine = |row: &[f64; 3]| dot(*row, direction).abs() / norm(*row);
        let by_cosine = |a: &usize, b: &usize| {
            let [a_is, b_is] = [a, b].map(|k| cosine(&self.to[*k]));
            a_is.total_cmp(&b_is).then(b.cmp(a))
        };
        (0..3).max_by(by_cosine).unwrap_or_default()
    }

    /// The component of w that a direction is, with the sign 1, or −1 where it is the opposite of that component's
    /// direction.
    pub fn place(&self, direction: [f64; 3]) -> Option<(usize, f64)> {
        [1.0, -1.0].into_iter().find_map(|sign| {
            let same = |row: &[f64; 3]| (0..3).all(|c| (sign * row[c] - direction[c]).abs() < SAME);
            self.to.iter().position(same).map(|slot| (slot, sign))
        })
    }
}

/// Whether two directions are equal or opposite.
pub fn parallel(a: [f64; 3], b: [f64; 3]) -> bool {
    [1.0, -1.0]
        .iter()
        .any(|sign| (0..3).all(|c| (a[c] - sign * b[c]).abs() < SAME))
}

/// The part of `a` that is orthogonal to an orthonormal `span`.
fn beside(span: &[[f64; 3]], a: [f64; 3]) -> [f64; 3] {
    let mut rest = a;
    // Twice: once leaves rounding along the span.
    for q in span.iter().chain(span) {
        let along = dot(*q, rest);
        (0..3).for_each(|c| rest[c] -= along * q[c]);
    }
    rest
}

fn inverse(m: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let minor = |r: usize, c: usize| {
        let (a, b) = ((r + 1) % 3, (r + 2) % 3);
        let (d, e) = ((c + 1) % 3, (c + 2) % 3);
        m[a][d] * m[b][e] - m[a][e] * m[b][d]
    };
    let det: f64 = (0..3).map(|c| m[0][c] * minor(0, c)).sum();
    let entry = |r: usize, c: usize| minor(c, r) / det + 0.0;
    (det.abs() > 1e-9).then(|| [0, 1, 2].map(|r| [0, 1, 2].map(|c| entry(r, c))))
}

#[cfg(test)]
#[path = "../../tests/assembled/frame.rs"]
mod tests;
