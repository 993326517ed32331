//! Shared dofs over all bodies: the subdomains that hold each of them.

use std::collections::HashMap;

use super::parts::Part;
use base::linalg::sorted::distinct;
use mpi::traits::Communicator;
use parallel::exchange::{exchange_words, offsets};
use parallel::owners::Owners;
use petsc::Session;

/// The subdomains of all ranks, and for each dof of this rank the subdomains that hold it.
pub struct Sharers {
    /// Index of this rank's first subdomain; its other subdomains follow.
    pub first: usize,
    /// Subdomains over all ranks.
    pub n_subdomains: usize,
    /// For each shared dof of this rank's subdomains, the subdomains that hold it, increasing.
    pub of: HashMap<u32, Vec<u32>>,
    /// For each local subdomain, its neighbours (increasing) and the local dofs shared with each.
    pub neighbours: Vec<Vec<(u32, Vec<u32>)>>,
    /// The ranks of subdomains.
    pub owners: Owners,
}

impl Sharers {
    /// Finds the shared dofs. Collective.
    pub fn new(session: &Session, parts: &[Part]) -> Sharers {
        let comm = session.comm();
        let size = comm.size() as usize;
        let (first, n_subdomains) = offsets(comm, parts.len());
        let mut reports: Vec<Vec<u64>> = vec![Vec::new(); size];
        for (j, part) in parts.iter().enumerate() {
            for &dof in &part.dofs {
                let word = u64::from(dof) << 32 | (first + j) as u64;
                reports[dof as usize % size].push(word);
            }
        }
        let received = exchange_words(comm, reports);
        let mut all: Vec<(u64, u32)> = Vec::new();
        for (rank, words) in received.iter().enumerate() {
            all.extend(words.iter().map(|&w| (w, rank as u32)));
        }
        all.sort_unstable();
        // Every rank that holds a shared dof gets [dof, count, subdomains…] once.
        let mut replies: Vec<Vec<u64>> = vec![Vec::new(); size];
        for group in all.chunk_by(|a, b| a.0 >> 32 == b.0 >> 32) {
            if group.len() < 2 {
                continue;
            }
            let mut ranks: Vec<u32> = group.iter().map(|g| g.1).collect();
            ranks.dedup();
            for &r in &ranks {
                let list = &mut replies[r as usize];
                list.extend([group[0].0 >> 32, group.len() as u64]);
                list.extend(group.iter().map(|g| g.0 & u64::from(u32::MAX)));
            }
        }
        let mut of = HashMap::new();
        for words in exchange_words(comm, replies) {
            let mut rest = &words[..];
            while let [dof, n, tail @ ..] = rest {
                let (list, tail) = tail.split_at(*n as usize);
                of.insert(*dof as u32, list.iter().map(|&s| s as u32).collect());
                rest = tail;
            }
        }
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

    /// A word of every subdomain of this rank and of their neighbours; `mine` has those of this rank. Collective.
    pub fn around(&self, session: &Session, mine: &[u64]) -> HashMap<u32, u64> {
        let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); session.size()];
        for (j, (list, &word)) in self.neighbours.iter().zip(mine).enumerate() {
            for rank in distinct(list.iter().map(|n| self.owners.of(n.0))) {
                outgoing[rank].extend([(self.first + j) as u64, word]);
            }
        }
        let received = exchange_words(session.comm(), outgoing).concat();
        let theirs = received.chunks_exact(2).map(|w| (w[0] as u32, w[1]));
        (self.first as u32..)
            .zip(mine.iter().copied())
            .chain(theirs)
            .collect()
    }

    fn of_part(&self, j: usize, part: &Part) -> Vec<(u32, Vec<u32>)> {
        let mut found: HashMap<u32, Vec<u32>> = HashMap::new();
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
