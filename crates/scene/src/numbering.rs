//! The numbering of the assembled problem: tied copies share an unknown, given values have none.
//!
//! Baselines that work on the assembled matrix need it; the method itself does not. Every rank computes the same
//! numbering from the scene alone. The memory is proportional to the number of nodes on boundaries of bodies: numbers
//! inside a subdomain are counted, and only the exceptions are stored (given nodes, and nodes that share a number of
//! another body). Each unknown belongs to the lowest subdomain that contains its node, and unknowns are numbered by
//! subdomain: a contiguous range of subdomains has a contiguous range of unknowns.

use super::checked::Scene;
use crate::rows::at_node::AtNode;
use mesh::Mesh;
use std::collections::HashMap;
use std::ops::Range;

/// Map from body dofs to the unknowns 0..len of the assembled problem.
#[derive(Debug, Clone)]
pub struct Numbering {
    /// Mesh, first body dof, first subdomain of every body.
    bodies: Vec<(Mesh, u64, usize)>,
    /// First unknown of every subdomain, and the total.
    starts: Vec<u64>,
    /// Number C of components.
    components: usize,
    /// Body dofs without a number of their own, as (owning subdomain, rank among the dofs it owns), sorted.
    holes: Vec<(usize, usize)>,
    /// Start of every subdomain's part of `holes`.
    hole_starts: Vec<usize>,
    /// The body dof whose number a tied body dof shares.
    shared: HashMap<u64, u64>,
}

impl Numbering {
    /// The numbering of `scene`.
    pub fn new(scene: &Scene) -> Numbering {
        debug_assert!(scene.is_whole, "a part does not have all ties");
        let bodies: Vec<(Mesh, u64, usize)> = scene
            .bodies
            .iter()
            .map(|b| (b.mesh().clone(), b.first_dof, b.first_subdomain))
            .collect();
        let components = scene.components();
        let mut shared = HashMap::new();
        let mut holes = Vec::new();
        let mut hole = |body: usize, dof: usize| {
            let (mesh, _, first) = &bodies[body];
            let (owner, rank) = mesh.owned_rank(dof / components);
            holes.push((first + owner, rank * components + dof % components));
        };
        for (b, body) in scene.bodies.iter().enumerate() {
            for &(dof, _) in &body.prescribed {
                hole(b, dof);
            }
        }
        for point in &scene.points {
            for (m, member) in point.members.iter().enumerate() {
                let to = &point.members[point.tied_to[m]];
                if point.tied_to[m] == m {
                    continue;
                }
                for c in 0..components {
                    if member.given(&scene.bodies, c).is_none() {
                        hole(member.body, member.node * components + c);
                        shared.insert(member.dof(&scene.bodies, c), to.dof(&scene.bodies, c));
                    }
                }
            }
        }
        holes.sort_unstable();
        let n = scene.n_subdomains();
        let mut hole_starts = vec![0; n + 1];
        for (subdomain, _) in &holes {
            hole_starts[subdomain + 1] += 1;
        }
        let mut starts = vec![0; n + 1];
        for (mesh, _, first) in &bodies {
            for s in 0..mesh.n_subdomains() {
                starts[first + s + 1] = (mesh.n_owned(s) * components) as u64;
            }
        }
        for s in 0..n {
            starts[s + 1] -= hole_starts[s + 1] as u64;
            starts[s + 1] += starts[s];
            hole_starts[s + 1] += hole_starts[s];
        }
        Numbering {
            bodies,
            starts,
            components,
            holes,
            hole_starts,
            shared,
        }
    }

    /// Number of unknowns N.
    pub fn len(&self) -> u64 {
        self.starts[self.starts.len() - 1]
    }

    /// Whether every node is given.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The unknowns that subdomains `subdomains` own: the rows of a rank that holds this contiguous share.
    pub fn range(&self, subdomains: Range<usize>) -> Range<u64> {
        self.starts[subdomains.start]..self.starts[subdomains.end]
    }

    /// The unknown of a free body dof (one that a [`Subdomain`](fetifeti::Subdomain) lists). The result for a given
    /// node is meaningless.
    pub fn global(&self, body_dof: u64) -> u64 {
        let dof = self.shared.get(&body_dof).copied().unwrap_or(body_dof);
        let body = self.bodies.partition_point(|b| b.1 <= dof) - 1;
        let (mesh, first_dof, first_subdomain) = &self.bodies[body];
        let inside = (dof - first_dof) as usize;
        let (owner, rank) = mesh.owned_rank(inside / self.components);
        let rank = rank * self.components + inside % self.components;
        let s = first_subdomain + owner;
        let holes = &self.holes[self.hole_starts[s]..self.hole_starts[s + 1]];
        let before = holes.partition_point(|&(_, h)| h < rank);
        self.starts[s] + (rank - before) as u64
    }

    /// Position of unknown `global` < N.
    pub fn coordinates(&self, scene: &Scene, global: u64) -> [f64; 3] {
        let (body, node, _) = self.place(global);
        scene.bodies[body].spec.position(node)
    }

    /// Body, node and component of unknown `global` < N.
    pub fn place(&self, global: u64) -> (usize, usize, usize) {
        let s = self.starts.partition_point(|&start| start <= global) - 1;
        let holes = &self.holes[self.hole_starts[s]..self.hole_starts[s + 1]];
        // Finds the rank r, no hole itself, with r − (holes below r) = number.
        let mut rank = (global - self.starts[s]) as usize;
        for &(_, hole) in holes {
            if hole <= rank {
                rank += 1;
            }
        }
        let body = self.bodies.partition_point(|b| b.2 <= s) - 1;
        let (mesh, _, first) = &self.bodies[body];
        let node = mesh.owned_node(s - first, rank / self.components);
        (body, node, rank % self.components)
    }
}
