//! Areas that belong to the nodes of interfaces and obstacles: a nodal force divided by its area is a pressure.

use std::collections::HashMap;

use super::contact::ContactRow;
use crate::scene::{Scene, Shape};

/// The sides of the first members' bodies that the rows of one source lie on; none where bodies meet in less than a side.
pub(super) fn side(scene: &Scene, rows: &[ContactRow]) -> Option<(usize, usize)> {
    let (body, _) = rows.first()?.members[0]?;
    let (kind, k) = rows[0].source;
    if kind == 1 {
        return Some((body, scene.obstacles[k].side));
    }
    let interface = &scene.interfaces[k];
    let which = usize::from(interface.bodies[0] != body);
    (interface.shape == Shape::Face).then(|| (body, interface.sides[which]))
}

/// Fills in [`ContactRow::area`], from the cells of the side with nodes on the interface only: where a body reaches beyond its neighbour, the
/// rest of its side carries nothing. Rows in less than a side keep the area 0.
pub(super) fn assign(scene: &Scene, rows: &mut [ContactRow]) {
    for rows in rows.chunk_by_mut(|a, b| a.source == b.source) {
        let Some((body, side)) = side(scene, rows) else {
            continue;
        };
        let spec = &scene.bodies[body].spec;
        let mut areas: HashMap<usize, f64> = HashMap::new();
        let (kind, k) = rows[0].source;
        if kind == 0 {
            let interface = &scene.interfaces[k];
            let which = usize::from(interface.bodies[0] != body);
            areas.extend(interface.shared.iter().map(|s| (s.nodes[which], 0.0)));
        } else {
            let nodes = spec.mesh.side_nodes(side);
            areas.extend(nodes.map(|p| (spec.mesh.node(p), 0.0)));
        }
        for cell in spec.side_cells(side) {
            if !cell.iter().all(|&p| areas.contains_key(&spec.mesh.node(p))) {
                continue;
            }
            let weights = spec.side_weights(side, &cell, scene.form.element);
            for (&p, area) in cell.iter().zip(weights.area) {
                *areas.entry(spec.mesh.node(p)).or_default() += area;
            }
        }
        for row in rows {
            let node = row.members[0].map(|(_, node)| node);
            row.area = node.and_then(|n| areas.get(&n)).copied().unwrap_or(0.0);
        }
    }
}
