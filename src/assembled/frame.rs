//! The coordinates of u at a node in contact: w = M u, so that every row there is a difference of two unknowns, or one alone.
//!
//! The directions of the rows at the node are rows of M, unit vectors orthogonal to them the others. Directions need not be
//! orthogonal to each other, but independent.

use crate::linalg::vec3::{dot, norm};

/// A direction that is less than this off the span of those before it (its sine) cannot be told from them.
const INDEPENDENT: f64 = 0.05;

/// Directions that differ by less are one.
const SAME: f64 = 1e-10;

/// w = M u and u = T w at one node; what lies beyond the components of the field is that of the identity.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// M.
    pub to: [[f64; 3]; 3],
    /// T = M⁻¹.
    pub from: [[f64; 3]; 3],
}

impl Frame {
    /// w = u.
    pub const IDENTITY: Frame = Frame {
        to: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        from: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };

    /// A frame with these directions; each has entries in the `free` components only. `None` where they are not independent.
    pub fn new(directions: &[[f64; 3]], free: [bool; 3]) -> Option<Frame> {
        let mut to = Frame::IDENTITY.to;
        let mut open = free;
        // Orthonormal, spanning what M has so far.
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
                .map(|c| beside(&span, Frame::IDENTITY.to[c]));
            // The own axis if it will do: frames of directions along axes are the identity.
            let own = beside(&span, Frame::IDENTITY.to[slot]);
            let best = axes.max_by(|a, b| norm(*a).total_cmp(&norm(*b)))?;
            let rest = if norm(own) > 0.3 { own } else { best };
            let size = norm(rest);
            to[slot] = rest.map(|v| v / size);
            span.push(to[slot]);
        }
        let from = inverse(&to)?;
        Some(Frame { to, from })
    }

    /// Whether w = u.
    pub fn is_identity(&self) -> bool {
        *self == Frame::IDENTITY
    }

    /// The place of a direction in w, and 1 or −1 where it is that of the place or its opposite.
    pub fn place(&self, direction: [f64; 3]) -> Option<(usize, f64)> {
        [1.0, -1.0].into_iter().find_map(|sign| {
            let same = |row: &[f64; 3]| (0..3).all(|c| (sign * row[c] - direction[c]).abs() < SAME);
            self.to.iter().position(same).map(|slot| (slot, sign))
        })
    }
}

/// Whether two directions are one or each other's opposite.
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
mod tests {
    use super::*;

    #[test]
    fn directions_are_found_again_and_the_rest_is_orthogonal() {
        let n = [0.6, 0.8, 0.0];
        let frame = Frame::new(&[n], [true, true, false]).expect("one direction");
        assert_eq!(frame.place(n.map(|v| -v)), Some((1, -1.0)));
        assert!(dot(frame.to[0], frame.to[1]).abs() < 1e-15);
        assert_eq!(frame.to[2], [0.0, 0.0, 1.0]);
        // Two walls that are not at right angles.
        let frame = Frame::new(&[n, [1.0, 0.0, 0.0]], [true; 3]).expect("independent");
        for r in 0..3 {
            for c in 0..3 {
                let sum: f64 = (0..3).map(|k| frame.to[r][k] * frame.from[k][c]).sum();
                assert!((sum - f64::from(r == c)).abs() < 1e-14);
            }
        }
        assert!(frame.place(n).is_some() && frame.place([1.0, 0.0, 0.0]).is_some());
        assert_eq!(frame.place([0.0, 1.0, 0.0]), None);
    }

    #[test]
    fn axes_change_nothing_and_dependent_directions_have_no_frame() {
        let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        assert!(Frame::new(&[y], [true; 3]).is_some_and(|f| f.is_identity()));
        assert!(Frame::new(&[y, x], [true; 3]).is_some_and(|f| f.is_identity()));
        assert_eq!(
            Frame::new(&[x, y, [0.6, 0.8, 0.0]], [true, true, false]),
            None
        );
        assert_eq!(Frame::new(&[x, y], [true, false, false]), None);
        let close = [1.0, 0.01, 0.0];
        assert_eq!(Frame::new(&[x, close], [true; 3]), None);
    }
}
