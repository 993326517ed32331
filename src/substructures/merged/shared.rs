//! The vertices, edges and faces that merged bodies share.
//!
//! They follow from the subdomains that have a dof. Every rank tells a rendezvous rank, which follows from the number
//! of the dof, what its subdomains have; that rank answers with all subdomains of the dof. The dofs that the same
//! subdomains have are a class, an edge or a face, and each of these subdomains has all of it.

use std::collections::BTreeMap;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use rustc_hash::FxHashMap;

use super::groups::Groups;
use super::interface::TiedDofs;
use crate::substructures::{Entity, EntityKind, Problem, Subdomain};
use base::linalg::apart::complete;
use parallel::exchange::{exchange_by_rank, gather_all, max_all};
use parallel::parcels::Parcels;

/// Keys of what merged bodies share begin here; those of what one body has are below.
const KEYS: u64 = 1 << 63;

/// The subdomains of dofs of merged bodies that several of them have. Dofs have the numbers of their groups.
pub struct SharedDofs {
    /// By dof: whether a subdomain has it as a vertex, and the subdomains, increasing.
    of: FxHashMap<u64, (bool, Vec<u32>)>,
    /// Whether each body lists edges and faces of its own; elsewhere those inside it are found here, too.
    lists: Vec<bool>,
    /// The kind of a face between merged bodies.
    averaged: EntityKind,
}

/// A node that two subdomains have.
#[derive(Default)]
struct CommonNode {
    at: [f64; 3],
    vertex: bool,
    dofs: Vec<u64>,
}

impl SharedDofs {
    /// Finds them; `averaged` is the kind of the faces. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        given: &Problem,
        groups: &Groups,
        dofs: &TiedDofs,
        averaged: EntityKind,
    ) -> SharedDofs {
        let mut lists = vec![0.0; given.n_bodies];
        for sub in given.local.iter().filter(|s| !s.entities.is_empty()) {
            lists[sub.body] = 1.0;
        }
        max_all(comm, &mut lists);
        let mut shared = SharedDofs {
            of: FxHashMap::default(),
            lists: lists.into_iter().map(|l| l > 0.0).collect(),
            averaged,
        };
        let size = comm.size() as u64;
        // Dof and subdomain, with 1 for a vertex.
        let mut reports: Vec<Vec<[u64; 2]>> = vec![Vec::new(); size as usize];
        for sub in given.local.iter().filter(|s| groups.is_merged(s.body)) {
            let vertices = &sub.primal;
            for (i, &dof) in (0..).zip(&sub.dofs) {
                if shared.concerns(sub, dof, dofs) {
                    let vertex = u64::from(vertices.binary_search(&i).is_ok());
                    let number = dofs.number(dof);
                    let had = [number, 2 * sub.index as u64 + vertex];
                    reports[(number % size) as usize].push(had);
                }
            }
        }
        let mut all: Vec<([u64; 2], usize)> = Vec::new();
        for (rank, list) in exchange_by_rank(comm, reports).into_iter().enumerate() {
            all.extend(list.into_iter().map(|had| (had, rank)));
        }
        all.sort_unstable();
        let mut replies: Vec<Parcels<[u64; 2], u32>> = Parcels::for_each_rank(comm);
        for copies in all.chunk_by(|a, b| a.0[0] == b.0[0]) {
            let mut sharers: Vec<u32> = copies.iter().map(|c| (c.0[1] / 2) as u32).collect();
            sharers.dedup();
            if sharers.len() < 2 {
                continue;
            }
            let vertex = copies.iter().any(|c| c.0[1] % 2 == 1);
            let mut ranks: Vec<usize> = copies.iter().map(|c| c.1).collect();
            ranks.sort_unstable();
            ranks.dedup();
            for rank in ranks {
                replies[rank].push([copies[0].0[0], vertex.into()], sharers.iter().copied());
            }
        }
        let received = exchange_by_rank(comm, replies);
        let entries = received.iter().flat_map(Parcels::iter);
        shared.of = entries
            .map(|([dof, vertex], sharers)| (dof, (vertex != 0, sharers.to_vec())))
            .collect();
        shared.add_vertices(comm, given, groups, dofs);
        shared
    }

    /// Makes more nodes vertices until each two subdomains with a common face hold each other. Collective.
    fn add_vertices(
        &mut self,
        comm: &SimpleCommunicator,
        given: &Problem,
        groups: &Groups,
        dofs: &TiedDofs,
    ) {
        let merged = given.local.iter().filter(|s| groups.is_merged(s.body));
        let more: Vec<u64> = merged.flat_map(|sub| self.missing(sub, dofs)).collect();
        for dof in gather_all(comm, &more).into_iter().flatten() {
            if let Some((vertex, _)) = self.of.get_mut(&dof) {
                *vertex = true;
            }
        }
    }

    /// The dofs that are to be vertices, too, for a subdomain and those after it that share a face with it to hold each
    /// other.
    fn missing(&self, sub: &Subdomain, dofs: &TiedDofs) -> Vec<u64> {
        let at = sub.coordinates.as_deref().unwrap_or_default();
        // By neighbour: the nodes in common, each with its dofs, and whether there is a face.
        let mut common: BTreeMap<u32, (BTreeMap<[u64; 3], CommonNode>, bool)> = BTreeMap::new();
        for (&dof, &x) in sub.dofs.iter().zip(at) {
            let number = dofs.number(dof);
            let found = self.of.get(&number);
            let Some((vertex, sharers)) = found.filter(|_| self.concerns(sub, dof, dofs)) else {
                continue;
            };
            for &other in sharers.iter().filter(|&&s| s as usize > sub.index) {
                let (nodes, face) = common.entry(other).or_default();
                *face |= sharers.len() == 2;
                let node = nodes.entry(x.map(f64::to_bits)).or_default();
                node.at = x;
                node.vertex |= vertex;
                node.dofs.push(number);
            }
        }
        let mut out = Vec::new();
        for (nodes, face) in common.into_values() {
            let nodes: Vec<CommonNode> = nodes.into_values().collect();
            let mut chosen: Vec<usize> = (0..nodes.len()).filter(|&k| nodes[k].vertex).collect();
            let known = chosen.len();
            // One edge around may be all they share; they hold each other through others.
            if face || chosen.is_empty() {
                complete(nodes.len(), |k| nodes[k].at, face, &mut chosen);
            }
            let more = chosen[known..].iter();
            out.extend(more.flat_map(|&k| nodes[k].dofs.iter().copied()));
        }
        out
    }

    /// Whether the edges and faces of a dof of a subdomain are to be found here.
    fn concerns(&self, sub: &Subdomain, dof: u64, dofs: &TiedDofs) -> bool {
        !self.lists[sub.body] || dofs.is_tied(dof)
    }

    /// Puts the vertices, edges and faces of a subdomain in the place of those that it has where bodies are tied. The
    /// subdomain still has the dofs of its body.
    pub fn put_into(&self, sub: &mut Subdomain, dofs: &TiedDofs) {
        let mut classes: BTreeMap<&[u32], Vec<u32>> = BTreeMap::new();
        let mut here = vec![false; sub.dofs.len()];
        let mut primal = std::mem::take(&mut sub.primal);
        for (i, &dof) in (0u32..).zip(&sub.dofs) {
            if !self.concerns(sub, dof, dofs) {
                continue;
            }
            here[i as usize] = true;
            match self.of.get(&dofs.number(dof)) {
                Some((true, _)) => primal.push(i),
                Some((false, sharers)) => classes.entry(sharers).or_default().push(i),
                None => (),
            }
        }
        for entity in &mut sub.entities {
            entity.dofs.retain(|&i| !here[i as usize]);
        }
        sub.entities.retain(|e| !e.dofs.is_empty());
        for (sharers, list) in classes {
            if is_one_node(sub, &list) {
                primal.extend(list);
            } else {
                self.add(sub, dofs, sharers.len(), list);
            }
        }
        primal.sort_unstable();
        primal.dedup();
        sub.primal = primal;
    }

    /// Adds an edge or a face that `n` subdomains share, by component.
    fn add(&self, sub: &mut Subdomain, dofs: &TiedDofs, n: usize, mut list: Vec<u32>) {
        let number = |i: &u32| dofs.number(sub.dofs[*i as usize]);
        list.sort_unstable_by_key(number);
        let kind = match n {
            2 => self.averaged,
            _ => EntityKind::Edge,
        };
        let whole = KEYS + number(&list[0]);
        let mut parts: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for &i in &list {
            parts.entry(component(sub, i as usize)).or_default().push(i);
        }
        let entity = |list: Vec<u32>| {
            let key = KEYS + number(&list[0]);
            Entity::new(kind, key, list).of_whole(whole)
        };
        let more: Vec<Entity> = parts.into_values().map(entity).collect();
        sub.entities.extend(more);
    }
}

/// Whether these dofs are at one place.
fn is_one_node(sub: &Subdomain, list: &[u32]) -> bool {
    let at = sub.coordinates.as_deref().unwrap_or_default();
    let first = at.get(list[0] as usize);
    list.iter().all(|&i| at.get(i as usize) == first)
}

/// The component of a local dof: the one whose translation moves it.
pub fn component(sub: &Subdomain, i: usize) -> usize {
    let columns = sub.near_kernel.as_deref().unwrap_or_default();
    match columns.len() {
        // Rings move along their axis alone.
        1 => usize::from(columns[0][i] != 0.0),
        n => (0..n / 3 + 1).find(|&c| columns[c][i] != 0.0).unwrap_or(0),
    }
}
