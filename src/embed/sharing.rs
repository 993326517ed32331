//! Shared dofs over all bodies: the subdomains that hold each of them.

use std::collections::HashMap;

use rustc_hash::FxHashMap;

use super::parts::TornSubdomain;
use base::linalg::sorted::distinct;
use bytemuck::{Pod, Zeroable};
use mpi::traits::Communicator;
use parallel::exchange::{exchange_by_rank, offsets};
use parallel::owners::Owners;
use parallel::parcels::Parcels;
use petsc::Session;

/// The subdomains of all ranks, and for each dof of this rank the subdomains that hold it.
pub struct Sharers {
    /// Index of this rank's first subdomain; its other subdomains follow.
    pub first: usize,
    /// Subdomains over all ranks.
    pub n_subdomains: usize,
    /// For each shared dof of this rank's subdomains, the subdomains that hold it, increasing.
    pub of: FxHashMap<u32, Vec<u32>>,
    /// For each local subdomain, its neighbours (increasing) and the local dofs shared with each.
    pub neighbours: Vec<Vec<(u32, Vec<u32>)>>,
    /// The ranks of subdomains.
    pub owners: Owners,
}

/// A dof, and a subdomain that holds it.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
struct DofHolder {
    dof: u32,
    subdomain: u32,
}

impl Sharers {
    /// Finds the shared dofs. Collective.
    pub fn new(session: &Session, parts: &[TornSubdomain]) -> Sharers {
        let comm = session.comm();
        let size = comm.size() as usize;
        let (first, n_subdomains) = offsets(comm, parts.len());
        let mut reports: Vec<Vec<DofHolder>> = vec![Vec::new(); size];
        for (j, part) in parts.iter().enumerate() {
            let subdomain = (first + j) as u32;
            for &dof in &part.dofs {
                reports[dof as usize % size].push(DofHolder { dof, subdomain });
            }
        }
        let received = exchange_by_rank(comm, reports);
        let mut all: Vec<(DofHolder, usize)> = Vec::new();
        for (rank, list) in received.into_iter().enumerate() {
            all.extend(list.into_iter().map(|holder| (holder, rank)));
        }
        all.sort_unstable();
        // Every rank that holds a shared dof gets the subdomains that hold it once.
        let mut replies = Parcels::for_each_rank(comm);
        for group in all.chunk_by(|a, b| a.0.dof == b.0.dof) {
            if group.len() < 2 {
                continue;
            }
            let mut ranks: Vec<usize> = group.iter().map(|g| g.1).collect();
            ranks.dedup();
            for rank in ranks {
                let subdomains = group.iter().map(|g| g.0.subdomain);
                replies[rank].push(group[0].0.dof, subdomains);
            }
        }
        let received = exchange_by_rank(comm, replies);
        let shared = received.iter().flat_map(Parcels::iter);
        let of = shared.map(|(dof, list)| (dof, list.to_vec())).collect();
        let mut sharers = Sharers {
            first,
            n_subdomains,
            of,
            neighbours: Vec::new(),
            owners: Owners::new(comm, first),
        };
        sharers.neighbours = (0..parts.len())
            .map(|j| sharers.of_part(j, &parts[j]))
            .collect();
        sharers
    }

    /// The subdomains that hold a dof; empty if only one does.
    pub fn of(&self, dof: u32) -> &[u32] {
        self.of.get(&dof).map_or(&[], |list| &list[..])
    }

    /// A value of every subdomain of this rank and of their neighbours; `mine` has those of this rank. Collective.
    pub fn around<T: Pod>(&self, session: &Session, mine: &[T]) -> HashMap<u32, T> {
        let mut outgoing = Parcels::for_each_rank(session.comm());
        let own = (self.first as u32..).zip(mine.iter().copied());
        for (list, (s, value)) in self.neighbours.iter().zip(own.clone()) {
            for rank in distinct(list.iter().map(|n| self.owners.of(n.0))) {
                outgoing[rank].push(s, [value]);
            }
        }
        let received = exchange_by_rank(session.comm(), outgoing);
        let theirs = received.iter().flat_map(Parcels::iter);
        own.chain(theirs.map(|(s, values)| (s, values[0])))
            .collect()
    }

    fn of_part(&self, j: usize, part: &TornSubdomain) -> Vec<(u32, Vec<u32>)> {
        let mut found: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        let me = (self.first + j) as u32;
        for (i, &dof) in part.dofs.iter().enumerate() {
            for &t in self.of(dof).iter().filter(|&&t| t != me) {
                found.entry(t).or_default().push(i as u32);
            }
        }
        let mut list: Vec<(u32, Vec<u32>)> = found.into_iter().collect();
        list.sort_unstable();
        list
    }
}
