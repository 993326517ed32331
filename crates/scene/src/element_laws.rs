//! Elastic laws and expansion by heat, element by element, along the axes of space.

use super::body::Body;
use super::coefficient::{evaluate, middles};
use super::model::heat::{HeatSpec, Temperature};
use super::model::law::LawSpec;
use super::quantity::TEMPERATURE;
use crate::assembly::{ElementHeat, ElementLaws, SubdomainMesh};
use base::linalg::orthogonal::IDENTITY;
use base::Result;
use elements::law::COMPONENTS;
use std::collections::HashMap;

/// The cells of a body's mesh that a subdomain has.
fn cells_of(body: &Body, inside: usize) -> Option<&[u32]> {
    body.mesh().cells().map(|cells| cells.parts.cells(inside))
}

/// The law of every element, along the axes in its middle.
pub(super) fn laws_by_element(
    body: &Body,
    inside: usize,
    mesh: &SubdomainMesh,
    law: &LawSpec,
) -> ElementLaws {
    let frame = body.spec.frame.as_ref();
    let cells = cells_of(body, inside);
    let mut out = ElementLaws::default();
    // Places of laws by their number where axes are the same everywhere, else by their entries.
    let mut fixed: HashMap<u32, u32> = HashMap::new();
    let mut known: HashMap<[u64; 36], u32> = HashMap::new();
    for (e, point) in middles(mesh).enumerate() {
        let number = law.number(cells.map_or(e, |cells| cells[e] as usize));
        if number == LawSpec::ISOTROPIC {
            out.of.push([number, 0]);
            continue;
        }
        let own = &law.laws[number as usize];
        let tangents = &mut out.tangents;
        let mut place = || {
            let tangent = own.at(body.spec.own(point), frame);
            let entries = tangent.0.as_flattened();
            let bits = std::array::from_fn(|k| entries[k].to_bits());
            *known.entry(bits).or_insert_with(|| {
                tangents.push(tangent);
                tangents.len() as u32 - 1
            })
        };
        let place = match own.axes.is_fixed() {
            true => *fixed.entry(number).or_insert_with(place),
            false => place(),
        };
        out.of.push([number, place]);
    }
    out
}

/// The expansion of every element, along the axes in its middle, and ΔT at the nodes.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for a temperature that is not finite, with body and point.
pub(super) fn heat_by_element(
    body: &Body,
    inside: usize,
    mesh: &SubdomainMesh,
    (heat, temperature): (&HeatSpec, &Temperature),
) -> Result<ElementHeat> {
    let spec = &body.spec;
    let nodes = body.mesh().subdomain_nodes(inside);
    let mut change = Vec::with_capacity(nodes.len());
    for (node, &point) in nodes.into_iter().zip(&mesh.points) {
        let temperature = match temperature {
            Temperature::Field(field) => evaluate(body, inside, field, point),
            Temperature::AtNodes(values) => values[node],
        };
        change.push(TEMPERATURE.at(spec, temperature - heat.reference, point)?);
    }
    let cells = cells_of(body, inside);
    let mut expansion = Vec::with_capacity(mesh.n_elements());
    for (e, point) in middles(mesh).enumerate() {
        let cell = cells.map_or(e, |cells| cells[e] as usize);
        let law = spec.law.as_ref().and_then(|law| law.of(cell));
        let own = law.map_or(IDENTITY, |law| law.axes.at(spec.own(point)));
        let axes = match &spec.frame {
            Some(frame) => frame.turned(&own),
            None => own,
        };
        expansion.push(along(heat.of(cell), &axes));
    }
    Ok(ElementHeat {
        expansion,
        change,
        factor: 1.0,
    })
}

/// Σ α_k a_k a_kᵀ, with shear strains twice.
fn along(alpha: [f64; 3], axes: &[[f64; 3]; 3]) -> [f64; 6] {
    if alpha[0] == alpha[1] && alpha[1] == alpha[2] {
        return [alpha[0], alpha[0], alpha[0], 0.0, 0.0, 0.0];
    }
    COMPONENTS.map(|(i, j)| {
        let twice = if i == j { 1.0 } else { 2.0 };
        let sum = (0..3).map(|k| alpha[k] * axes[k][i] * axes[k][j]);
        twice * sum.sum::<f64>()
    })
}
