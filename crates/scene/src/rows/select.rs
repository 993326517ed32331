//! The selection of nodes of a common face, or of a side, by an entry.

use super::entry::Entry;
use crate::body::Body;
use crate::geometry::interface::{BodyInterface, InterfaceShape, TOLERANCE};
use crate::model::joints::{Extent, PairSelector};
use base::{Error, Result};

/// Tolerance of the parameter t at the ends of a range.
const T_TOLERANCE: f64 = 1e-9;

/// A node that an entry asks for and that the face or side does not have.
pub(crate) enum Missing {
    /// A node at this t.
    At([f64; 2]),
    /// A node of this number.
    Number(usize),
}

impl std::fmt::Display for Missing {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Missing::At(t) => write!(out, "t = {}", Parameters(*t)),
            Missing::Number(k) => write!(out, "number {k}"),
        }
    }
}

fn inside(t: [f64; 2], range: [[f64; 2]; 2]) -> bool {
    t.into_iter()
        .zip(range)
        .all(|(t, [low, high])| low - T_TOLERANCE <= t && t <= high + T_TOLERANCE)
}

/// Parameters along a face in the user's notation: one number in the plane.
pub(crate) struct Parameters(pub [f64; 2]);

impl std::fmt::Display for Parameters {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            [s, 0.0] => write!(out, "{s}"),
            [s, t] => write!(out, "({s}, {t})"),
        }
    }
}

fn near(t: [f64; 2], wanted: [f64; 2]) -> bool {
    (0..2).all(|k| (t[k] - wanted[k]).abs() <= TOLERANCE)
}

/// Whether `t` is an end of the range `extent`.
pub(crate) fn is_end(extent: &Extent, t: [f64; 2]) -> bool {
    match extent {
        Extent::Range(ranges) => {
            let at_end = |k: usize| {
                ranges[k]
                    .iter()
                    .any(|end| (t[k] - end).abs() <= T_TOLERANCE)
            };
            // In the plane the second parameter is always 0.
            at_end(0) || (t[1] != 0.0 && at_end(1))
        }
        _ => false,
    }
}

/// The nodes that `extent` selects among nodes with parameters `t`, in increasing order.
pub(crate) fn pick(extent: &Extent, t: &[[f64; 2]]) -> std::result::Result<Vec<usize>, Missing> {
    let all = 0..t.len();
    let mut out: Vec<usize> = match extent {
        Extent::None => Vec::new(),
        // The interface has those within a tolerance alone.
        Extent::All | Extent::Within { .. } => all.collect(),
        Extent::Range(range) => all.filter(|&k| inside(t[k], *range)).collect(),
        Extent::Points(points) => {
            let find = |wanted| t.iter().position(|&t| near(t, wanted));
            let found = points.iter().map(|&p| find(p).ok_or(Missing::At(p)));
            found.collect::<std::result::Result<_, _>>()?
        }
        Extent::Nodes(nodes) => match nodes.iter().find(|k| !all.contains(k)) {
            Some(&k) => return Err(Missing::Number(k)),
            None => nodes.clone(),
        },
    };
    out.sort_unstable();
    out.dedup();
    Ok(out)
}

/// The nodes of `interface` (indices into `shared`) that `entry` selects.
pub(crate) fn selected(
    bodies: &[Body],
    interface: &BodyInterface,
    entry: &Entry<'_>,
) -> Result<Vec<usize>> {
    let extent = entry.extent;
    if interface.shape == InterfaceShape::Corner {
        // A contact of all pairs applies to faces only: a contact in a corner must name the pair.
        let meant = !entry.is_contact() || *entry.pair != PairSelector::All;
        return Ok(if *extent == Extent::All && meant {
            (0..interface.shared.len()).collect()
        } else {
            Vec::new()
        });
    }
    let lone = match extent {
        Extent::None | Extent::Points(_) | Extent::Within { .. } => None,
        Extent::All => interface.unmatched.first(),
        Extent::Range(range) => interface.unmatched.iter().find(|u| inside(u.0, *range)),
        // Node numbers refer to the common face; they make sense only if both bodies have the same nodes there.
        Extent::Nodes(_) => interface.unmatched.first(),
    };
    if let Some(lone) = lone {
        return Err(unmatched(bodies, interface, entry, lone));
    }
    let t: Vec<[f64; 2]> = interface.shared.iter().map(|s| s.t).collect();
    pick(extent, &t).map_err(|missing| {
        if let Missing::At(wanted) = missing {
            if let Some(lone) = interface.unmatched.iter().find(|u| near(u.0, wanted)) {
                return unmatched(bodies, interface, entry, lone);
            }
        }
        let [a, b] = interface.bodies.map(|k| &bodies[k].spec.name);
        Error::input(format!(
            "the {} of bodies `{a}` and `{b}` names the node with {missing}, but their common face has {} nodes and \
             none like that",
            entry.what(),
            interface.shared.len()
        ))
        .at(entry.location)
    })
}

fn unmatched(
    bodies: &[Body],
    interface: &BodyInterface,
    entry: &Entry<'_>,
    &(t, side, node): &([f64; 2], usize, usize),
) -> Error {
    let has = &bodies[interface.bodies[side]];
    let other = &bodies[interface.bodies[1 - side]];
    let at = has.spec.spot(node);
    let t = Parameters(t);
    // Messages name the body that was written later.
    let later = &bodies[interface.bodies[1]].spec.location;
    let location = entry.location.unwrap_or(later);
    let (are, face) = if entry.is_contact() {
        ("are in contact", "contact face")
    } else {
        ("are tied", "tied face")
    };
    Error::input(format!(
        "bodies `{}` and `{}` {are}, but node {at} of `{}` (t = {t}) meets no node of `{}` \
         (matching nodes were expected on a {face})",
        bodies[interface.bodies[0]].spec.name,
        bodies[interface.bodies[1]].spec.name,
        has.spec.name,
        other.spec.name,
    ))
    .at(location)
}
