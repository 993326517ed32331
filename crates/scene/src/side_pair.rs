//! How the sides of two bodies lie to each other: what `plan` says of a pair.

use super::checked::Scene;
use super::geometry::interface::{InterfaceShape, Link};
use super::geometry::normals::of_side;
use super::model::steps::Factors;
use base::linalg::vec3::dot;
use fetifeti::problem::RowSource;
use std::collections::HashSet;

/// The sides of two bodies that touch or face each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SidePair {
    /// The area (in the plane the length) of the first body's cells that have all their nodes opposite the second body;
    /// where each pair of nodes was given an area, the sum of these.
    pub area: f64,
    /// The smallest and the largest gap: the distance of opposite nodes, with the gap of the contact added to it;
    /// negative where the bodies overlap.
    pub gap: [f64; 2],
    /// The largest angle at a node between the normal of one side and the opposite of the other's, in degrees.
    pub angle: f64,
}

/// A rigid surface beside a side of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceObstacle {
    /// Its name in reports.
    pub name: String,
    /// The number of nodes that carry multipliers.
    pub nodes: usize,
    /// The area (in the plane the length) of the side that lies opposite the surface.
    pub area: f64,
    /// The smallest and the largest gap at the last load step, with the gap of the obstacle and its motion.
    pub gap: [f64; 2],
}

impl Scene {
    /// The rigid surfaces among the obstacles.
    pub fn surface_obstacles(&self) -> Vec<SurfaceObstacle> {
        let last = Factors::last(&self.steps);
        let obstacles = self.obstacles.iter().enumerate();
        let found = obstacles.filter_map(|(k, o)| {
            let rows = self.mortar_rows();
            let rows = rows.filter(|r| r.source == RowSource::Obstacle(k));
            let gaps = rows.filter_map(|r| Some(r.bound.as_ref()?.gap(&last)));
            let gaps: Vec<f64> = gaps.collect();
            let ends = [f64::INFINITY, f64::NEG_INFINITY];
            Some(SurfaceObstacle {
                name: o.name.clone(),
                nodes: gaps.len(),
                area: o.surface.as_ref()?.area,
                gap: gaps
                    .iter()
                    .fold(ends, |[low, high], g| [low.min(*g), high.max(*g)]),
            })
        });
        found.collect()
    }

    /// The sides of interface `k`. At corners everything is zero but the area and the gaps of pairs of nodes that have
    /// an area of their own.
    pub fn side_pair(&self, k: usize) -> SidePair {
        let interface = &self.interfaces[k];
        let mut out = SidePair {
            area: 0.0,
            gap: [0.0; 2],
            angle: 0.0,
        };
        let given = interface.area;
        if interface.shape == InterfaceShape::Corner && given.is_none() {
            return out;
        }
        let gaps = interface.shared.iter().zip(&interface.distances);
        let gaps = gaps.map(|(s, &distance)| match s.link {
            Link::Contact { gap } => gap + distance,
            _ => distance,
        });
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        out.gap = gaps.fold(ends, |[low, high], g| [low.min(g), high.max(g)]);
        if let Some(area) = given {
            out.area = area * interface.shared.len() as f64;
            return out;
        }

        let [first, second] = [0, 1].map(|i| {
            let nodes: Vec<usize> = interface.shared.iter().map(|s| s.nodes[i]).collect();
            of_side(
                &self.bodies[interface.bodies[i]].spec,
                interface.sides[i],
                &nodes,
            )
        });
        let cosines = first.iter().zip(&second).map(|(a, b)| -dot(*a, *b));
        let least = cosines.fold(1.0, f64::min);
        out.angle = least.max(-1.0).acos().to_degrees();

        if let Some(mortar) = &interface.mortar {
            out.area = mortar.area;
            return out;
        }
        let spec = &self.bodies[interface.bodies[0]].spec;
        let mut shared: HashSet<usize> = interface.shared.iter().map(|s| s.nodes[0]).collect();
        shared.extend(interface.common(&self.bodies));
        for face in spec.faces(interface.sides[0]) {
            if face.nodes.iter().all(|node| shared.contains(node)) {
                let areas = spec.face_areas(interface.sides[0], &face, &self.form);
                out.area += areas.iter().sum::<f64>();
            }
        }
        out
    }
}
