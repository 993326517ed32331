//! Vertices, edges and faces of the subdomains of a body.

use super::adjacency::Adjacency;
use super::classes::{Classes, Kind};
use super::incidence::Incidence;
use super::sharing::Sharing;
use super::vertices;
use crate::mesh::cells::Cells;

/// What the subdomains of a body share. Every shared node is in one vertex, one edge or one face.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interface {
    /// Nodes at which subdomains hold each other, increasing. All subdomains that have such a node share it.
    pub vertices: Vec<u32>,
    /// Open edges: connected nodes of the same subdomains, without vertices. In the plane, all that two subdomains
    /// share is edges. In space, three or more subdomains share an edge, or two share it where their face ends on the
    /// surface of the body.
    pub edges: Vec<Entity>,
    /// Open faces, in space only: connected nodes of two subdomains, without edges and vertices.
    pub faces: Vec<Entity>,
    /// What each subdomain has.
    pub of: Vec<Held>,
}

/// An edge or a face.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entity {
    /// Its nodes, increasing.
    pub nodes: Vec<u32>,
    /// The subdomains that share it, increasing: two or more.
    pub sharers: Vec<u32>,
}

/// The places in the lists of an [`Interface`] of what a subdomain has, increasing.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Held {
    /// Places in [`Interface::vertices`].
    pub vertices: Vec<u32>,
    /// Places in [`Interface::edges`].
    pub edges: Vec<u32>,
    /// Places in [`Interface::faces`].
    pub faces: Vec<u32>,
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
        let incidence = Incidence::new(cells, points.len());
        let vertex = vertices::choose(cells, &incidence, points, sharing, &classes);
        let mut found = Interface {
            vertices: sharing.shared().filter(|&n| vertex[n as usize]).collect(),
            edges: Vec::new(),
            faces: Vec::new(),
            of: vec![Held::default(); sharing.n],
        };
        let space = cells.kinds().first().is_some_and(|k| k.dim() == 3);
        for (kind, nodes) in classes.entities(cells, &vertex) {
            let sharers = sharing.of(nodes[0]).to_vec();
            let face = space && kind == Kind::Face;
            let list = if face {
                &mut found.faces
            } else {
                &mut found.edges
            };
            let place = list.len() as u32;
            for &p in &sharers {
                let held = &mut found.of[p as usize];
                if face {
                    &mut held.faces
                } else {
                    &mut held.edges
                }
                .push(place);
            }
            list.push(Entity { nodes, sharers });
        }
        for (&node, place) in found.vertices.iter().zip(0..) {
            for &p in sharing.of(node) {
                found.of[p as usize].vertices.push(place);
            }
        }
        found
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/mesh/partition/interface.rs"]
mod tests;
