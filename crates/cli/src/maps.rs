//! Contact on the faces of solids, for [`report::pictures::contact_map`].

use std::collections::HashMap;

use super::contact::{carrier, nodes, side, with_inequalities};
use super::friction::FrictionRows;
use elements::kind::CellKind;
use fetifeti::solution::SolvedRow;
use report::pictures::contact_map::ContactMap;
use report::pictures::pieces::pieces;
use scene::Scene;

/// A side is drawn in two of its coordinates where all its normals are within a certain angle of the third coordinate;
/// this is the cosine of the angle. Other sides are drawn in their parameters.
const STEEP: f64 = 0.4;

/// The maps of all interfaces and obstacles that have inequalities.
pub(super) fn of(scene: &Scene, rows: &[SolvedRow], friction: &FrictionRows) -> Vec<ContactMap> {
    with_inequalities(scene, rows)
        .map(|found| map(scene, found, friction))
        .collect()
}

fn map(
    scene: &Scene,
    (rows, smoothed): (&[SolvedRow], Vec<f64>),
    friction: &FrictionRows,
) -> ContactMap {
    let along = |d: usize| {
        let least = |a: f64, r: &SolvedRow| a.min(r.normal()[d].abs());
        rows.iter()
            .filter(|r| r.is_inequality())
            .fold(1.0_f64, least)
    };
    let across = (0..3)
        .max_by(|&a, &b| along(a).total_cmp(&along(b)))
        .unwrap_or(2);
    let flat = along(across) > STEEP;
    let shown: Vec<usize> = (0..3).filter(|&d| d != across).collect();
    let (labels, at): (_, Vec<[f64; 2]>) = if flat {
        let labels = [shown[0], shown[1]].map(|d| ["x", "y", "z"][d].to_string());
        let at = |r: &SolvedRow| [r.label.point[shown[0]], r.label.point[shown[1]]];
        (labels, rows.iter().map(at).collect())
    } else {
        (
            ["s", "t"].map(String::from),
            rows.iter().map(|r| r.label.t).collect(),
        )
    };
    let mut cells = Vec::new();
    if let Some((body, side)) = side(scene, rows) {
        let spec = &scene.bodies[body].spec;
        let numbered = rows.iter().enumerate();
        let of: HashMap<usize, u32> = numbered
            .filter_map(|(k, r)| Some((carrier(scene, r)?.node, k as u32)))
            .collect();
        for face in spec.faces(side) {
            let nodes: Vec<usize> = match face.kind {
                Some(_) => face.nodes.to_vec(),
                None => face.outline(),
            };
            let nodes = nodes.iter().map(|node| of.get(node).copied());
            if let Some(nodes) = nodes.collect::<Option<Vec<u32>>>() {
                let pieces = pieces(face.kind.unwrap_or(CellKind::Quad4)).iter();
                cells.extend(pieces.map(|piece| piece.map(|a| nodes[usize::from(a)])));
            }
        }
    }
    ContactMap {
        nodes: nodes(scene, (rows, smoothed), friction, true),
        labels,
        at,
        cells,
    }
}
