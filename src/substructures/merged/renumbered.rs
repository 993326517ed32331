//! The problem of groups: the numbers and the motions of merged bodies.

use std::collections::BTreeMap;

use mpi::topology::SimpleCommunicator;

use super::groups::Groups;
use super::interface::TiedDofs;
use super::shared::{component, SharedDofs};
use crate::substructures::{EntityKind, FrictionNode, Problem, Row, Subdomain};
use parallel::exchange::{max_all, sum_all};

/// The problem of the groups. Collective.
pub fn problem(
    comm: &SimpleCommunicator,
    given: &Problem,
    groups: &Groups,
    dofs: &TiedDofs,
    inside: &[bool],
    averaged: EntityKind,
) -> Problem {
    let shared = SharedDofs::new(comm, given, groups, dofs, averaged);
    let frames = frames(comm, given, groups);
    let local = given.local.iter().map(|sub| {
        let mut sub = sub.clone();
        let group = groups.of[sub.body];
        if groups.is_merged(sub.body) {
            shared.put_into(&mut sub, dofs);
            turn_about(&mut sub, frames[group]);
            sub.dofs = sub.dofs.iter().map(|&d| dofs.number(d)).collect();
        }
        sub.body = group;
        sub
    });
    let names = groups.members.iter().map(|m| name(given, m));
    let (rows, friction) = rows(&given.rows, &given.friction, dofs, inside);
    let mut out = Problem::new(names, given.n_subdomains)
        .with_subdomains(local)
        .with_rows(rows)
        .with_friction(friction);
    out.ragged = given.ragged;
    let weak = given.weak.iter();
    out.weak = weak
        .map(|(b, text)| (groups.of[*b], text.clone()))
        .collect();
    out
}

/// The name of a group: those of its first bodies.
fn name(given: &Problem, members: &[usize]) -> String {
    const NAMED: usize = 3;
    let names: Vec<&str> = { members.iter().take(NAMED) }
        .map(|&b| given.body_names[b].as_str())
        .collect();
    match members.len() - names.len() {
        0 => names.join(" + "),
        more => format!("{} + {more} more", names.join(" + ")),
    }
}

/// The rows that are left, with the friction among them.
pub fn rows(
    given: &[Row],
    friction: &[FrictionNode],
    dofs: &TiedDofs,
    inside: &[bool],
) -> (Vec<Row>, Vec<FrictionNode>) {
    let mut place = Vec::new();
    let mut rows = Vec::new();
    for (row, inside) in given.iter().zip(inside) {
        place.push(rows.len());
        if !inside {
            let mut row = row.clone();
            let mut terms: BTreeMap<u64, f64> = BTreeMap::new();
            for (dof, value) in row.terms {
                *terms.entry(dofs.number(dof)).or_insert(0.0) += value;
            }
            row.terms = terms.into_iter().collect();
            rows.push(row);
        }
    }
    let moved = friction.iter().map(|node| FrictionNode {
        normal: place[node.normal],
        tangential: node.tangential.iter().map(|&r| place[r]).collect(),
        bound: node.bound,
    });
    (rows, moved.collect())
}

/// The centre of a group, and its extent.
type Frame = ([f64; 3], f64);

/// Centre and extent of every group. Collective.
fn frames(comm: &SimpleCommunicator, given: &Problem, groups: &Groups) -> Vec<Frame> {
    let points = |sub: &'_ Subdomain| sub.coordinates.clone().unwrap_or_default();
    let mut sums = vec![0.0; 4 * groups.members.len()];
    for sub in &given.local {
        let sum = &mut sums[4 * groups.of[sub.body]..][..4];
        for x in points(sub) {
            (0..3).for_each(|d| sum[d] += x[d]);
            sum[3] += 1.0;
        }
    }
    sum_all(comm, &mut sums);
    let centres: Vec<[f64; 3]> = { sums.chunks_exact(4) }
        .map(|s| [0, 1, 2].map(|d| s[d] / s[3].max(1.0)))
        .collect();
    let mut extents = vec![0.0; centres.len()];
    for sub in &given.local {
        let group = groups.of[sub.body];
        for x in points(sub) {
            let far = (0..3).map(|d| (x[d] - centres[group][d]).abs());
            extents[group] = far.fold(extents[group], f64::max);
        }
    }
    max_all(comm, &mut extents);
    let sized = extents.into_iter().map(|e| if e > 0.0 { e } else { 1.0 });
    centres.into_iter().zip(sized).collect()
}

/// Replaces the rotations of a subdomain by those about the centre of its group.
fn turn_about(sub: &mut Subdomain, (centre, extent): Frame) {
    let (Some(columns), Some(points)) = (&sub.near_kernel, &sub.coordinates) else {
        return;
    };
    let dim = match columns.len() {
        3 => 2,
        6 => 3,
        // Constants, and motions along an axis, are those of all bodies.
        _ => return,
    };
    let components: Vec<usize> = (0..points.len()).map(|i| component(sub, i)).collect();
    let mut out = columns[..dim].to_vec();
    // The rotation from axis a to axis b: x_a moves along b, x_b against a.
    for (a, b) in [(0, 1), (1, 2), (2, 0)].into_iter().take(2 * dim - 3) {
        let at = |(&c, x): (&usize, &[f64; 3])| match c {
            c if c == b => (x[a] - centre[a]) / extent,
            c if c == a => -(x[b] - centre[b]) / extent,
            _ => 0.0,
        };
        out.push(components.iter().zip(points).map(at).collect());
    }
    sub.near_kernel = Some(out);
}
