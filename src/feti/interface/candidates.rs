//! Dofs that may have copies: a cheap sieve before the search for the copies themselves.
//!
//! Nearly all dofs of a subdomain are its own alone. Their numbers, and nothing else, go to the rendezvous rank. A
//! table with two bits for each hash of a number records which hashes came more than once. All shared dofs pass, and
//! one in twenty of the others.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use std::hash::{BuildHasherDefault, Hasher};

use crate::substructures::Problem;
use parallel::exchange::exchange_by_rank;

/// Multiplicative hashing: dof numbers are not chosen by an adversary.
#[derive(Debug, Default, Clone, Copy)]
pub struct DofHasher(u64);

impl Hasher for DofHasher {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u64(u64::from(b)));
    }
    fn write_u64(&mut self, n: u64) {
        self.0 = (self.0.rotate_left(5) ^ n).wrapping_mul(GOLDEN);
    }
    fn finish(&self) -> u64 {
        // Hash tables use the low bits, and products mix the high ones.
        self.0.rotate_left(26)
    }
}

/// 2⁶⁴ divided by the golden ratio.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// A map from dofs.
pub type DofMap<T> = std::collections::HashMap<u64, T, BuildHasherDefault<DofHasher>>;

/// Bits of the table for each number that is expected.
const BITS: usize = 16;

/// Hashes that came once, and more than once.
struct HashTable {
    once: Vec<u64>,
    more: Vec<u64>,
    shift: u32,
}

impl HashTable {
    /// For about `n` numbers.
    fn new(n: usize) -> HashTable {
        let bits = (BITS * n).next_power_of_two().max(64);
        HashTable {
            once: vec![0; bits / 64],
            more: vec![0; bits / 64],
            shift: 64 - bits.trailing_zeros(),
        }
    }

    fn place(&self, dof: u64) -> (usize, u64) {
        let hash = dof.wrapping_mul(GOLDEN) >> self.shift;
        ((hash / 64) as usize, 1 << (hash % 64))
    }

    fn see(&mut self, dof: u64) {
        let (word, bit) = self.place(dof);
        self.more[word] |= self.once[word] & bit;
        self.once[word] |= bit;
    }

    /// Marks a dof so that it passes, whether or not it came more than once.
    fn mark(&mut self, dof: u64) {
        let (word, bit) = self.place(dof);
        self.more[word] |= bit;
    }

    fn passes(&self, dof: u64) -> bool {
        let (word, bit) = self.place(dof);
        self.more[word] & bit != 0
    }
}

/// The local dofs of every local subdomain, increasing, that another subdomain may have too or that may be in a row.
/// `home` is the rendezvous rank of a dof. Collective.
pub fn candidates(
    comm: &SimpleCommunicator,
    problem: &Problem,
    home: &dyn Fn(u64) -> usize,
) -> Vec<Vec<u32>> {
    let size = comm.size() as usize;
    let in_rows = || {
        let terms = problem.rows.iter().flat_map(|row| &row.terms);
        terms.map(|term| term.0)
    };
    let select = |passes: &mut dyn FnMut(u64) -> bool| -> Vec<Vec<u32>> {
        let chosen = |dofs: &Vec<u64>, passes: &mut dyn FnMut(u64) -> bool| {
            let numbered = dofs.iter().zip(0..);
            let kept = numbered.filter(|(dof, _)| passes(**dof));
            kept.map(|(_, i)| i).collect()
        };
        let subs = problem.local.iter();
        subs.map(|sub| chosen(&sub.dofs, passes)).collect()
    };
    if size == 1 {
        let all = problem.local.iter().flat_map(|sub| &sub.dofs);
        let mut table = HashTable::new(problem.local.iter().map(|sub| sub.dofs.len()).sum());
        all.for_each(|&dof| table.see(dof));
        in_rows().for_each(|dof| table.mark(dof));
        return select(&mut |dof| table.passes(dof));
    }
    let spread = |dofs: &mut dyn Iterator<Item = u64>| {
        let mut lists: Vec<Vec<u64>> = vec![Vec::new(); size];
        dofs.for_each(|dof| lists[home(dof)].push(dof));
        exchange_by_rank(comm, lists)
    };
    let named = spread(&mut in_rows());
    let held = spread(&mut problem.local.iter().flat_map(|s| s.dofs.iter().copied()));
    let mut table = HashTable::new(held.iter().map(Vec::len).sum());
    held.iter().flatten().for_each(|&dof| table.see(dof));
    named.iter().flatten().for_each(|&dof| table.mark(dof));
    // One bit for each dof that was asked about, in the order of the questions.
    let answer = |asked: &Vec<u64>| {
        let word = |dofs: &[u64]| {
            let bits = dofs.iter().zip(0..);
            bits.fold(0, |w, (&dof, k)| w | u64::from(table.passes(dof)) << k)
        };
        asked.chunks(64).map(word).collect()
    };
    let answers: Vec<Vec<u64>> = exchange_by_rank(comm, held.iter().map(answer).collect());
    let mut next = vec![0usize; size];
    select(&mut |dof| {
        let from = home(dof);
        let k = next[from];
        next[from] += 1;
        answers[from][k / 64] >> (k % 64) & 1 == 1
    })
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/interface/candidates.rs"]
mod tests;
