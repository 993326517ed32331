//! Sides that overlap by so much that they cannot be meant to face each other.

use super::interface::Interface;
use crate::scene::body::Body;

/// Sides may overlap by this part of the thinner body, measured along the normal: what is given by mistake, such as the
/// far side of a body, overlaps by the whole body.
const MOST: f64 = 0.25;

/// The end of a sentence if the sides of an interface overlap by more.
pub(crate) fn too_large(bodies: &[Body], interface: &Interface) -> Option<String> {
    let nodes = interface.distances.iter().zip(&interface.normals);
    let (distance, normal) = nodes.min_by(|a, b| a.0.total_cmp(b.0))?;
    let thickness = |b: &usize| thickness(&bodies[*b], *normal);
    let thin = *interface
        .bodies
        .iter()
        .min_by(|a, b| thickness(a).total_cmp(&thickness(b)))?;
    let names = [0, 1].map(|k| {
        let spec = &bodies[interface.bodies[k]].spec;
        let side = spec.mesh.side_name(interface.sides[k]);
        format!("side `{side}` of `{}`", spec.name)
    });
    sentence(names, -distance, &bodies[thin], *normal)
}

/// The same for a side and what it overlaps, by `overlap`, with the body that is the thinner one.
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
