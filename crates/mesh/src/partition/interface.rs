//! Vertices, edges and faces of the subdomains of a body.

use super::adjacency::Adjacency;
use super::classes::{ClassKind, Classes};
use super::sharing::Sharing;
use super::vertices;
use crate::cells::Cells;

/// The nodes that the subdomains of a body share. Every shared node is in one vertex, one edge or one face.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Interface {
    /// Nodes at which continuity is primal, increasing: there subdomains hold each other. All subdomains that have such
    /// a node share it.
    pub vertices: Vec<u32>,
    /// The nodes of open edges, increasing: connected nodes of the same subdomains, without vertices. In the plane, all
    /// that two subdomains share is edges. In space, three or more subdomains share an edge, or two share it where
    /// their face ends on the surface of the body.
    pub edges: Vec<Vec<u32>>,
    /// The nodes of open faces, increasing, in space only: connected nodes of two subdomains, without edges and
    /// vertices.
    pub faces: Vec<Vec<u32>>,
}

impl Interface {
    /// The interface of the parts of a mesh. `rims`: whether in space edges also run where faces end on the surface of
    /// the body, as they do on boxes; without, these nodes belong to the faces.
    ///
    /// # Panics
    /// When the arguments do not belong to each other.
    pub fn new(
        cells: &Cells,
        adjacency: &Adjacency,
        points: &[[f64; 3]],
        part: &[u32],
        sharing: &Sharing,
        rims: bool,
    ) -> Interface {
        assert_eq!(
            points.len(),
            sharing.n_nodes(),
            "the sharing of these nodes"
        );
        let classes = Classes::new(cells, adjacency, part, sharing, rims);
        let around = cells.around_nodes(points.len());
        let vertex = vertices::choose(cells, &around, points, sharing, &classes);
        let mut found = Interface {
            vertices: sharing.shared().filter(|&n| vertex[n as usize]).collect(),
            ..Interface::default()
        };
        let space = cells.kinds().first().is_some_and(|k| k.dim() == 3);
        for (kind, nodes) in classes.entities(cells, &vertex) {
            match kind {
                ClassKind::Face if space => found.faces.push(nodes),
                _ => found.edges.push(nodes),
            }
        }
        found
    }
}

#[cfg(test)]
#[path = "../../tests/partition/interface.rs"]
mod tests;
