//! Messages of lists of any length: records, each with a list of values behind it.

use bytemuck::{cast_slice, pod_collect_to_vec, Pod};
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::exchange::{gather_words, Message};

/// Records and the list of values of each, in the order in which they were added. Ranks send them to each other by
/// [`exchange_by_rank`](super::exchange::exchange_by_rank). Lists that need no record have `()`.
#[derive(Debug, Clone, PartialEq)]
pub struct Parcels<H, V> {
    heads: Vec<H>,
    /// The end of the values of each record.
    ends: Vec<usize>,
    values: Vec<V>,
}

impl<H, V> Default for Parcels<H, V> {
    fn default() -> Parcels<H, V> {
        Parcels {
            heads: Vec::new(),
            ends: Vec::new(),
            values: Vec::new(),
        }
    }
}

impl<H: Pod, V: Pod> Parcels<H, V> {
    /// Empty messages for the ranks.
    pub fn for_each_rank(comm: &SimpleCommunicator) -> Vec<Parcels<H, V>> {
        vec![Parcels::default(); comm.size() as usize]
    }

    /// Adds a record with its values.
    pub fn push(&mut self, head: H, values: impl IntoIterator<Item = V>) {
        self.heads.push(head);
        self.values.extend(values);
        self.ends.push(self.values.len());
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.heads.len()
    }

    /// Whether there is no record.
    pub fn is_empty(&self) -> bool {
        self.heads.is_empty()
    }

    /// Record number `k` and its values.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn get(&self, k: usize) -> (H, &[V]) {
        let start = k.checked_sub(1).map_or(0, |before| self.ends[before]);
        (self.heads[k], &self.values[start..self.ends[k]])
    }

    /// The records with their values, in their order.
    pub fn iter(&self) -> impl Iterator<Item = (H, &[V])> {
        (0..self.len()).map(|k| self.get(k))
    }

    /// The records of all ranks with their values, in the order of the ranks. Collective.
    pub fn gather_all(self, comm: &SimpleCommunicator) -> Vec<Parcels<H, V>> {
        if comm.size() == 1 {
            return vec![self];
        }
        let mut words = Vec::new();
        self.write(&mut words);
        gather_words(comm, &words)
    }
}

impl<H: Pod, V: Pod> Message for Parcels<H, V> {
    fn write(&self, words: &mut Vec<u32>) {
        if !self.is_empty() {
            words.extend_from_slice(cast_slice(&[self.len()]));
            words.extend_from_slice(cast_slice(&self.ends));
            if size_of::<H>() > 0 {
                words.extend_from_slice(cast_slice(&self.heads));
            }
            words.extend_from_slice(cast_slice(&self.values));
        }
    }

    fn read(words: &[u32]) -> Parcels<H, V> {
        if words.is_empty() {
            return Parcels::default();
        }
        let mut rest = words;
        let n = take::<usize>(&mut rest, 1)[0];
        Parcels {
            ends: take(&mut rest, n),
            heads: take(&mut rest, n),
            values: pod_collect_to_vec(rest),
        }
    }
}

/// The first `n` records of these words, which lose them.
fn take<T: Pod>(words: &mut &[u32], n: usize) -> Vec<T> {
    let (taken, rest) = words.split_at(n * size_of::<T>() / size_of::<u32>());
    *words = rest;
    match size_of::<T>() {
        0 => vec![T::zeroed(); n],
        _ => pod_collect_to_vec(taken),
    }
}

#[cfg(test)]
#[path = "../tests/parcels.rs"]
mod tests;
