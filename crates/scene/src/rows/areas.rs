//! Areas that belong to the nodes of interfaces and obstacles: a nodal force divided by its area is a pressure.

use std::collections::HashMap;

use crate::checked::Scene;
use crate::geometry::interface::InterfaceShape;
use fetifeti::problem::{BodyNode, RowSource};

impl Scene {
    /// Whether multipliers are reported as pressures, too: everywhere but in plane scalar problems.
    pub fn has_pressure(&self) -> bool {
        self.dim() == 3 || self.form.is_elastic()
    }

    /// The side of a body on which rows from `source` lie, and the first of them if it touches itself; `None` if the
    /// interface is no face.
    pub fn side_of(&self, source: RowSource, body: usize) -> Option<usize> {
        match source {
            RowSource::Obstacle(k) => Some(self.obstacles[k].side),
            RowSource::Equation(_) => None,
            RowSource::Interface(k) => {
                let interface = &self.interfaces[k];
                let which = interface.bodies.iter().position(|&b| b == body)?;
                (interface.shape == InterfaceShape::Face).then_some(interface.sides[which])
            }
        }
    }

    /// The bodies on which rows from `source` lie, in the order of the rows' members, each with its side. It is empty
    /// if the interface is no face.
    pub fn sides_of(&self, source: RowSource) -> Vec<(usize, usize)> {
        match source {
            RowSource::Obstacle(k) => vec![(self.obstacles[k].body, self.obstacles[k].side)],
            RowSource::Equation(_) => Vec::new(),
            RowSource::Interface(k) => {
                let interface = &self.interfaces[k];
                let of = |k: usize| (interface.bodies[k], interface.sides[k]);
                match interface.shape {
                    InterfaceShape::Face => interface.order.map(of).to_vec(),
                    InterfaceShape::Corner => Vec::new(),
                }
            }
        }
    }
}

/// Nodal areas of the sides that have inequalities, each found once.
pub(super) struct Areas<'a> {
    scene: &'a Scene,
    /// The area of each node, by source of the rows and body.
    known: HashMap<(RowSource, usize), HashMap<usize, f64>>,
}

impl<'a> Areas<'a> {
    pub fn new(scene: &'a Scene) -> Areas<'a> {
        Areas {
            scene,
            known: HashMap::new(),
        }
    }

    /// The area of a node, as its source says or by its faces; 0 on interfaces without contact, on interfaces that are
    /// no faces, and in problems without pressures.
    pub fn at(&mut self, source: RowSource, BodyNode { body, node }: BodyNode) -> f64 {
        let may_touch = match source {
            RowSource::Interface(k) => self.scene.interfaces[k].has_contact(),
            RowSource::Obstacle(_) => true,
            RowSource::Equation(_) => false,
        };
        if !(may_touch && self.scene.has_pressure()) {
            return 0.0;
        }
        let given = match source {
            RowSource::Interface(k) => self.scene.interfaces[k].area,
            RowSource::Obstacle(k) => self.scene.obstacles[k].area,
            RowSource::Equation(_) => None,
        };
        if let Some(area) = given {
            return area;
        }
        let found = self.known.entry((source, body));
        let areas = found.or_insert_with(|| areas(self.scene, source, body));
        areas.get(&node).copied().unwrap_or(0.0)
    }
}

/// Areas by node, summed over the cells of the side that have all nodes on the interface. Where a body reaches beyond
/// its neighbour, the rest of its side carries no pressure.
fn areas(scene: &Scene, source: RowSource, body: usize) -> HashMap<usize, f64> {
    let mut areas: HashMap<usize, f64> = HashMap::new();
    let Some(side) = scene.side_of(source, body) else {
        return areas;
    };
    let spec = &scene.bodies[body].spec;
    match source {
        RowSource::Interface(k) => {
            let interface = &scene.interfaces[k];
            let which = usize::from(interface.bodies[0] != body);
            areas.extend(interface.shared.iter().map(|s| (s.nodes[which], 0.0)));
            let common = interface.common(&scene.bodies).into_iter();
            areas.extend(common.map(|node| (node, 0.0)));
        }
        RowSource::Obstacle(_) => {
            let nodes = spec.mesh.side_nodes(side).into_iter();
            areas.extend(nodes.map(|node| (node, 0.0)));
        }
        RowSource::Equation(_) => {}
    }
    for face in spec.faces(side) {
        if !face.nodes.iter().all(|node| areas.contains_key(node)) {
            continue;
        }
        let weights = spec.face_areas(side, &face, &scene.form);
        for (&node, area) in face.nodes.iter().zip(weights) {
            *areas.entry(node).or_default() += area;
        }
    }
    areas
}
