//! Sides that overlap to begin with: a sentence where it is much of a face, an error where it is so much that they
//! cannot be meant to face each other.

use super::interface::{BodyInterface, InterfaceShape};
use super::mortar::surface;
use crate::body::Body;
use crate::rows::obstacles::Obstacle;
use elements::form::Form;

/// Sides may overlap by this part of the thinner body, measured along the normal: what is given by mistake, such as the
/// far side of a body, overlaps by the whole body.
const MOST: f64 = 0.25;

/// Overlaps deeper than this part of the shortest edge of the faces have a sentence.
const MUCH: f64 = 0.1;

/// Overlaps that have a sentence of their own.
const LIST: usize = 8;

/// A sentence for each interface and obstacle whose sides overlap by much of a face to begin with. What `adjust` takes
/// as touching does not overlap.
pub(crate) fn sentences(
    bodies: &[Body],
    interfaces: &[BodyInterface],
    obstacles: &[Obstacle],
    form: &Form,
) -> Vec<String> {
    let edge = |body: usize, side: usize| {
        let (side, _) = surface(&bodies[body].spec, side, form.element);
        side.shortest()
    };
    let faces = interfaces
        .iter()
        .filter(|i| i.shape == InterfaceShape::Face);
    let of_faces = faces.filter_map(|interface| {
        let depth = deepest(interface.distances.iter().copied())?;
        let [a, b] = [0, 1].map(|k| (interface.bodies[k], interface.sides[k]));
        let edge = edge(a.0, a.1).min(edge(b.0, b.1));
        let (names, contact) = (names(bodies, interface), interface.has_contact());
        (depth > MUCH * edge).then(|| beginning(&names, depth, edge, contact))
    });
    let of_obstacles = obstacles.iter().filter_map(|obstacle| {
        let opposite = obstacle.surface.as_ref().filter(|s| s.name.is_some())?;
        let at_nodes = opposite.distances();
        let free = at_nodes.filter(|(node, _)| !obstacle.counts_as_touching(*node));
        let depth = deepest(free.map(|(_, distance)| distance))?;
        let edge = edge(obstacle.body, obstacle.side);
        let names = opposite.names(&bodies[obstacle.body], obstacle.side);
        (depth > MUCH * edge).then(|| beginning(&names, depth, edge, true))
    });
    let mut out: Vec<String> = of_faces.chain(of_obstacles).collect();
    if out.len() > LIST {
        let more = out.split_off(LIST).len();
        out.push(format!(
            "{more} more pairs of surfaces overlap by more than a tenth of an edge to begin with."
        ));
    }
    out
}

/// The deepest overlap, if there is one.
fn deepest(distances: impl Iterator<Item = f64>) -> Option<f64> {
    let least = distances.fold(0.0, f64::min);
    (least < 0.0).then_some(-least)
}

fn beginning(names: &[String; 2], depth: f64, edge: f64, contact: bool) -> String {
    let then = if contact {
        "contact presses them apart; where that is not meant, `adjust` takes overlaps as touching"
    } else {
        "the tie keeps the overlap"
    };
    let mut text = format!(
        "{} and {} overlap by {depth:.3e} to begin with, more than a tenth of the shortest edge of their faces \
         ({edge:.3e}): {then}.",
        names[0], names[1]
    );
    text[..1].make_ascii_uppercase();
    text
}

/// The sides of an interface, by name.
fn names(bodies: &[Body], interface: &BodyInterface) -> [String; 2] {
    [0, 1].map(|k| {
        let spec = &bodies[interface.bodies[k]].spec;
        let side = spec.mesh.side_name(interface.sides[k]);
        format!("side `{side}` of `{}`", spec.name)
    })
}

/// The end of a sentence if the sides of an interface overlap by more.
pub(crate) fn too_large(bodies: &[Body], interface: &BodyInterface) -> Option<String> {
    let nodes = interface.distances.iter().zip(&interface.normals);
    let (distance, normal) = nodes.min_by(|a, b| a.0.total_cmp(b.0))?;
    let thickness = |b: &usize| thickness(&bodies[*b], *normal);
    let thin = *interface
        .bodies
        .iter()
        .min_by(|a, b| thickness(a).total_cmp(&thickness(b)))?;
    sentence(names(bodies, interface), -distance, &bodies[thin], *normal)
}

/// The end of a sentence if a side overlaps something by too much: `overlap` is the length, `thin` the thinner body.
pub(crate) fn sentence(
    names: [String; 2],
    overlap: f64,
    thin: &Body,
    normal: [f64; 3],
) -> Option<String> {
    let thickness = thickness(thin, normal);
    (overlap > MOST * thickness).then(|| {
        format!(
            "{} and {} overlap by {overlap}, where `{}` is {thickness} thick (sides that face each other, with an \
             overlap of a quarter of that at most, were expected)",
            names[0], names[1], thin.spec.name
        )
    })
}

/// The extent of a body's box along a direction.
fn thickness(body: &Body, n: [f64; 3]) -> f64 {
    let [low, high] = body.bounds;
    (0..3).map(|d| n[d].abs() * (high[d] - low[d])).sum()
}
