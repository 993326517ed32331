//! Messages on motions without energy.

use super::basis::at;
use super::body::BodySlack;
use crate::assembly::zero_energy::ZeroEnergyMode;
use crate::body::Body;
use elements::element::may_slack;
use elements::kind::CellKind;
use mesh::Mesh;

/// The remedy that messages name.
pub(super) const REMEDY: &str =
    "full integration has none (-fetifeti_full_integration for decks, `integration = \"full\"` in scenes)";

impl BodySlack {
    /// The note to the user on the motions without energy of this body.
    pub(super) fn note(&self, body: &Body) -> String {
        let (n, all) = (self.idle.len(), self.idle.len() + self.seen.len());
        let any = self.idle.iter().chain(&self.seen).next().expect("a motion");
        let (who, node, _) = most(body, any);
        let motions = match all {
            1 => "a motion without energy that is not rigid".to_string(),
            n => format!("{n} motions without energy that are not rigid"),
        };
        let end = match (n, all) {
            (0, _) => "rows of ties or contact see all of them".to_string(),
            (n, all) if n == all => "nothing holds them: no displacement is taken along them, and a load that drives \
                 them is refused"
                .into(),
            (n, all) => format!(
                "rows of ties or contact see {}, nothing holds the others: no displacement is taken along them, and a \
                 load that drives them is refused",
                all - n
            ),
        };
        format!(
        "body `{}`: its {who} leave {motions} (node {node} moves most in the first); {end}; {REMEDY}",
        body.spec.name
    )
    }
}

/// Which cells of a body leave a motion, the number of the node that moves most, and where to.
pub(super) fn most(body: &Body, motion: &ZeroEnergyMode) -> (String, u64, [f64; 3]) {
    let c = body.components;
    let largest = motion.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let node = largest.map_or(0, |e| e.0 as usize / c);
    let mut along = [0.0; 3];
    for (d, x) in along.iter_mut().enumerate().take(c) {
        *x = at(motion, (c * node + d) as u32);
    }
    let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
    let along = along.map(|x| (1e3 * x / length).round() / 1e3 + 0.0);
    let mut who = "cells".to_string();
    if let Mesh::Cells(mesh) = body.mesh() {
        let rules = &body.spec.integration;
        let has = |&k: &usize| {
            let weak = rules
                .get(k)
                .is_some_and(|rule| may_slack(mesh.cells.kind(k), *rule));
            weak && mesh.cells.nodes(k).contains(&(node as u32))
        };
        if let Some(k) = (0..mesh.cells.len()).find(has) {
            let kind = mesh.cells.kind(k);
            let points = match kind {
                CellKind::Wedge6 => 2,
                CellKind::Wedge15 => 9,
                CellKind::Hex20 => 8,
                _ => 4,
            };
            let (shape, of) = kind.name().split_once(" of ").unwrap_or((kind.name(), ""));
            let plural = match shape {
                "hexahedron" => "hexahedra".to_string(),
                other => format!("{other}s"),
            };
            who = format!("{plural} of {of} with {points} points of integration");
        }
    }
    (who, body.mesh().node_id(node), along)
}

/// The sentence for a load that drives a motion.
pub(super) fn driven(body: &Body, motion: &ZeroEnergyMode) -> String {
    let (who, node, along) = most(body, motion);
    let place = along[..body.components].iter().map(|x| x.to_string());
    let place = place.collect::<Vec<String>>().join(", ");
    format!(
        "body `{}`: the load drives a motion without energy of its {who}, in which node {node} moves most, along \
         ({place}), and which no support, tie or contact holds; expected full integration, which has no such motion \
         (-fetifeti_full_integration for decks, `integration = \"full\"` in scenes), or a load that does not drive it",
        body.spec.name
    )
}
