//! Entries that name surfaces, and contacts that are found: both become entries that name bodies and their sides.

use super::origin::{with, BodyNames, SideOrigin};
use crate::body::Body;
use crate::geometry::facing::is_face;
use crate::geometry::interface::BodyInterface;
use crate::geometry::matching::{apart, Mismatch, NodeMatching};
use crate::geometry::single::ReachedNodes;
use crate::geometry::sweep::{are_apart, extent, may_face, may_meet, near};
use crate::model::joints::{AutoContact, ContactSpec, Extent, PairSelector, TieSpec};
use crate::model::profile::Profile;
use crate::model::spec::SceneSpec;
use base::linalg::vec3::{dot, minus};
use base::{Error, Location, Result};
use elements::form::Form;

/// Where nothing is said, sides of bodies are in contact if their distance is at most this fraction of their edges.
pub(super) const NEAR: f64 = 0.1;

/// Up to this ratio of the edges the coarser side carries multipliers.
const COARSER: f64 = 4.0;

/// A body is thicker than this part of the edges on its sides.
const THIN: f64 = 1e-3;

/// Up to this ratio edges count as equal.
const EQUAL: f64 = 1.05;

/// Replaces the surfaces in the entries by bodies and sides, and adds the contacts that `auto` finds. What the entries
/// were that name sides is returned.
pub(crate) fn expand(
    bodies: &[Body],
    matching: &mut NodeMatching<'_>,
    spec: &mut SceneSpec,
) -> Result<Vec<SideOrigin>> {
    let names = BodyNames::of(bodies);
    let mut origins = Vec::new();
    let mut ties = Vec::with_capacity(spec.ties.len());
    for tie in std::mem::take(&mut spec.ties) {
        match &tie.pair {
            PairSelector::Surfaces(a, b) => {
                let (reach, tolerance) = match tie.extent {
                    Extent::Within { distance, .. } => (distance, Some(distance)),
                    _ => (tie.adjust.max(0.0), None),
                };
                let found = pairs(
                    bodies,
                    matching,
                    &spec.form,
                    [a, b],
                    (tie.multipliers, reach, tolerance.is_some()),
                    &tie.location,
                )?;
                let entries = ties.len()..ties.len() + found.len();
                origins.extend(SideOrigin::of_tie(&names, &tie, entries));
                ties.extend(found.into_iter().map(|(pair, sides)| TieSpec {
                    pair,
                    sides: Some(sides),
                    ..tie.clone()
                }));
            }
            _ => {
                origins.extend(SideOrigin::of_tie(&names, &tie, ties.len()..ties.len() + 1));
                ties.push(tie);
            }
        }
    }
    spec.ties = ties;
    let mut contacts = Vec::with_capacity(spec.contacts.len());
    for contact in std::mem::take(&mut spec.contacts) {
        match &contact.pair {
            PairSelector::Surfaces(a, b) => {
                let reach = contact.distance.unwrap_or(f64::INFINITY);
                let found = pairs(
                    bodies,
                    matching,
                    &spec.form,
                    [a, b],
                    (contact.multipliers, reach, false),
                    &contact.location,
                )?;
                let first = contacts.len();
                let entries = first..first + found.len();
                origins.extend(SideOrigin::of_contact(&names, &contact, entries));
                contacts.extend(found.into_iter().map(|(pair, sides)| ContactSpec {
                    pair,
                    sides: Some(sides),
                    ..contact.clone()
                }));
            }
            _ => {
                let first = contacts.len();
                origins.extend(SideOrigin::of_contact(&names, &contact, first..first + 1));
                contacts.push(contact);
            }
        }
    }
    if let Some(auto) = spec.auto.clone() {
        contacts.extend(found(bodies, matching, &spec.form, &auto)?);
    }
    spec.contacts = contacts;
    Ok(origins)
}

/// Does the same for the contacts alone, on bodies that have moved. Surfaces that do not meet any more are left out.
pub(crate) fn expand_contacts(
    bodies: &[Body],
    matching: &mut NodeMatching<'_>,
    spec: &mut SceneSpec,
) {
    let mut contacts = Vec::with_capacity(spec.contacts.len());
    for contact in std::mem::take(&mut spec.contacts) {
        let PairSelector::Surfaces(a, b) = &contact.pair else {
            contacts.push(contact);
            continue;
        };
        let reach = contact.distance.unwrap_or(f64::INFINITY);
        let wanted = (contact.multipliers, reach, false);
        let found = pairs(
            bodies,
            matching,
            &spec.form,
            [a, b],
            wanted,
            &contact.location,
        );
        contacts.extend(
            found
                .into_iter()
                .flatten()
                .map(|(pair, sides)| ContactSpec {
                    pair,
                    sides: Some(sides),
                    ..contact.clone()
                }),
        );
    }
    if let Some(auto) = &spec.auto {
        let found = found(bodies, matching, &spec.form, auto);
        contacts.extend(found.into_iter().flatten());
    }
    spec.contacts = contacts;
}

type SelectedSurfaces = (PairSelector, [usize; 2]);

/// The pairs of bodies that have the surfaces, and whose nodes there face each other, or are within a tolerance. A body
/// that has both may touch itself.
fn pairs(
    bodies: &[Body],
    matching: &mut NodeMatching<'_>,
    form: &Form,
    names: [&String; 2],
    (multipliers, reach, is_tolerance): (Option<usize>, f64, bool),
    location: &Location,
) -> Result<Vec<SelectedSurfaces>> {
    let lists = names.map(|name| with(bodies, name));
    let same = names[0] == names[1];
    let fits = |first: &(usize, usize), second: &(usize, usize)| {
        if first.0 == second.0 {
            first.1 != second.1
        } else {
            !(same && second.0 < first.0)
        }
    };
    // The last of all pairs, first body by first body: its sentence is told if none meets.
    let last = lists[0].iter().rev().find_map(|first| {
        let second = lists[1].iter().rev().find(|second| fits(first, second));
        second.map(|second| (*first, *second))
    });
    let Some(last) = last else {
        let body = lists[0].first().or(lists[1].first());
        let body = body.map_or("", |b| bodies[b.0].spec.name.as_str());
        return Err(Error::input(format!(
            "the surface `{}` is named twice, and only body `{body}` has it (sides of two bodies were expected, or two \
             sides of one body: the parts of its surface that meet)",
            names[0]
        ))
        .at(location));
    };
    let found = |first: (usize, usize), second: (usize, usize)| {
        let [a, b] = [first, second].map(|(body, _)| bodies[body].spec.name.clone());
        (PairSelector::Named(a, b), [first.1, second.1])
    };
    let pairs = lists[0].iter().flat_map(|first| {
        let seconds = lists[1].iter().filter(move |second| fits(first, second));
        seconds.map(move |second| (*first, *second))
    });
    if pairs.take(2).count() == 1 {
        // Whether a single pair meets is found where its interface is made.
        return Ok(vec![found(last.0, last.1)]);
    }
    let reach = if reach > 0.0 { reach } else { f64::INFINITY };
    let mut surfaces = |list: &[(usize, usize)]| -> Vec<_> {
        let each = list.iter();
        each.map(|&(body, side)| matching.surface(body, side))
            .collect()
    };
    let near = may_face(&surfaces(&lists[0]), &surfaces(&lists[1]), reach);
    let mut out = Vec::new();
    for [k, l] in near {
        let (first, second) = (lists[0][k], lists[1][l]);
        if !fits(&first, &second) {
            continue;
        }
        let both = ([first.0, second.0], [first.1, second.1]);
        let which = multipliers.unwrap_or(0);
        if is_tolerance {
            let reached = ReachedNodes::new(bodies, form, both, which, reach);
            out.extend((!reached.is_empty()).then(|| found(first, second)));
            continue;
        }
        let edge = shortest(&matching.surface(first.0, first.1).edges);
        let met = match matching.find(both.0, both.1, reach) {
            Ok(interface) => Some(interface),
            Err(Mismatch::Lonely) => matching.mortar(form, both, which, reach).as_ref(),
            Err(Mismatch::Apart(_)) => None,
        };
        if met.is_some_and(|interface| !is_through(interface, edge)) {
            out.push(found(first, second));
        }
    }
    if out.is_empty() {
        let (first, second) = last;
        let why = apart(bodies, [first.0, second.0], [first.1, second.1]);
        return Err(Error::input(format!(
            "the surfaces `{}` and `{}` do not meet: {why}",
            names[0], names[1]
        ))
        .at(location));
    }
    Ok(out)
}

/// Contacts between all bodies whose sides are near each other.
fn found(
    bodies: &[Body],
    matching: &mut NodeMatching<'_>,
    form: &Form,
    auto: &AutoContact,
) -> Result<Vec<ContactSpec>> {
    let mut edge = |k: usize| {
        let sides = bodies[k].mesh().outer_sides();
        sides.fold(f64::INFINITY, |least, side| {
            least.min(shortest(&matching.surface(k, side).edges))
        })
    };
    let edges: Vec<f64> = (0..bodies.len()).map(&mut edge).collect();
    let reach_of = |edge: &f64| auto.distance.unwrap_or(NEAR * edge);
    let reaches: Vec<f64> = edges.iter().map(reach_of).collect();
    let mut out = Vec::new();
    for [a, b] in near(bodies, |k| reaches[k]) {
        let reach = reaches[a].min(reaches[b]);
        if are_apart([&bodies[a], &bodies[b]], reach) {
            continue;
        }
        // A mesh of cells has one side, its skin; a box has four or six.
        let sides = bodies[a].mesh().outer_sides().flat_map(|first| {
            let others = bodies[b].mesh().outer_sides();
            others.map(move |second| [first, second])
        });
        for sides in sides {
            let both = [0, 1].map(|k| matching.surface([a, b][k], sides[k]));
            if !may_meet(&both[0], &both[1], reach) {
                continue;
            }
            let extents = [0, 1].map(|k| extent(&both[k]));
            let which = carrier([edges[a], edges[b]], extents);
            let interface = match matching.find([a, b], sides, reach) {
                Err(Mismatch::Apart(_)) => None,
                Err(Mismatch::Lonely) => {
                    matching.mortar(form, ([a, b], sides), which, reach).clone()
                }
                Ok(interface) => Some(interface.clone()),
            };
            match interface {
                Some(interface) if !is_no_pair(bodies, &interface) => out.push(ContactSpec {
                    pair: PairSelector::Named(
                        bodies[a].spec.name.clone(),
                        bodies[b].spec.name.clone(),
                    ),
                    sides: Some(sides),
                    extent: Extent::All,
                    gap: Profile::constant(0.0),
                    distance: Some(reach),
                    multipliers: Some(which),
                    adjust: auto.adjust,
                    adjusted: Vec::new(),
                    opposed: None,
                    law: auto.law.clone(),
                    ramp: None,
                    location: auto.location.clone(),
                }),
                _ => {}
            }
        }
    }
    if out.is_empty() {
        let message = "no two bodies are near each other with opposite normals (a larger `distance` was expected)";
        Err(Error::input(message).at(&auto.location))
    } else {
        Ok(out)
    }
}

/// The side that carries the multipliers where nodes do not match, from the shortest edges of both bodies and the
/// extents of both sides: the coarser one, whose pressures are smoother (docs/benchmarks.md). If it is coarser by far,
/// one of its faces may reach beyond the other side, and the finer one takes them. Between equal meshes it is the
/// smaller side, all of whose nodes have something opposite.
fn carrier([a, b]: [f64; 2], extents: [f64; 2]) -> usize {
    let coarser = usize::from(b > a);
    let ratio = a.max(b) / a.min(b);
    if ratio <= EQUAL {
        usize::from(extents[1] < extents[0] / EQUAL)
    } else if ratio <= COARSER {
        coarser
    } else {
        1 - coarser
    }
}

/// Whether two sides of one body, with edges of this length, seem to face each other through it, as those of a plate of
/// one layer do.
fn is_through(interface: &BodyInterface, edge: f64) -> bool {
    let [a, b] = interface.bodies;
    a == b && interface.distances.iter().all(|d| *d < -THIN * edge)
}

/// Whether two sides, of which one at least is a box's, are no pair although some of their nodes face each other: they
/// meet in a corner, or they are the far sides of two thin bodies, which seem to overlap by both thicknesses.
fn is_no_pair(bodies: &[Body], interface: &BodyInterface) -> bool {
    let both = interface.bodies.map(|b| &bodies[b]);
    if both.iter().all(|b| b.mesh().cells().is_some()) {
        return false;
    }
    if interface.mortar.is_none() && !is_face(both, interface.sides, &interface.shared) {
        return true;
    }
    let centre = |b: usize| {
        let [low, high] = bodies[b].bounds;
        [0, 1, 2].map(|d| 0.5 * (low[d] + high[d]))
    };
    let [a, b] = interface.bodies.map(centre);
    let overlap = interface.distances.iter().all(|d| *d < 0.0);
    let across = interface.normals.iter().map(|n| dot(minus(b, a), *n));
    overlap && across.sum::<f64>() < 0.0
}

pub(super) fn shortest(edges: &[f64]) -> f64 {
    edges.iter().copied().fold(f64::INFINITY, f64::min)
}
