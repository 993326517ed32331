//! Irregular messages during set-up: every rank sends every rank a list of records.
//!
//! Records travel as 64-bit words. The iteration does not use this module: it uses PETSc's scatters, which are set up
//! once.

use mpi::collective::SystemOperation;
use mpi::datatype::{Partition, PartitionMut};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives};

use super::traffic::Traffic;
use crate::traffic;

/// A value that is sent as a fixed number of words.
pub trait Record: Sized {
    /// Words of one record.
    const WORDS: usize;
    /// Appends the record.
    fn pack(&self, out: &mut Vec<u64>);
    /// Reads a record of `WORDS` words.
    fn unpack(words: &[u64]) -> Self;
}

/// Sends `outgoing[r]` to rank r and returns what all ranks sent here, one after the other by rank of the sender.
/// Collective.
pub fn exchange<T: Record>(comm: &SimpleCommunicator, mut outgoing: Vec<Vec<T>>) -> Vec<T> {
    let rank = comm.rank() as usize;
    // Records for this rank itself are the majority; they are not packed.
    let mut own = Some(std::mem::take(&mut outgoing[rank]));
    let pack = |list: &Vec<T>| {
        let mut words = Vec::with_capacity(list.len() * T::WORDS);
        list.iter().for_each(|record| record.pack(&mut words));
        words
    };
    let packed = outgoing.iter().map(pack).collect();
    drop(outgoing);
    let mut all = Vec::new();
    for (from, words) in exchange_words(comm, packed).into_iter().enumerate() {
        match own.take_if(|_| from == rank) {
            Some(own) if all.is_empty() => all = own,
            Some(own) => all.extend(own),
            None => all.extend(words.chunks_exact(T::WORDS).map(T::unpack)),
        }
    }
    all
}

/// Sends `outgoing[r]`, words and lists of any length, to rank r and returns what every rank sent here, by rank of the
/// sender. Collective.
pub fn exchange_words(comm: &SimpleCommunicator, mut outgoing: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
    let (size, rank) = (comm.size() as usize, comm.rank() as usize);
    debug_assert_eq!(outgoing.len(), size);
    let own = std::mem::take(&mut outgoing[rank]);
    if size == 1 {
        return vec![own];
    }
    let send_counts: Vec<i32> = outgoing.iter().map(|w| count(w.len())).collect();
    let mut counts = vec![0i32; size];
    comm.all_to_all_into(&send_counts[..], &mut counts[..]);
    let (sent, send_starts) = (outgoing.concat(), starts(&send_counts));
    let from = Partition::new(&sent[..], &send_counts[..], &send_starts[..]);
    let mut all = received(&counts, |into| comm.all_to_all_varcount_into(&from, into));
    all[rank] = own;
    all
}

/// Start of each list when the lists are stored one after the other.
fn starts(counts: &[i32]) -> Vec<i32> {
    let mut sum = 0;
    let before = counts.iter().map(|&c| {
        sum += c;
        sum - c
    });
    before.collect()
}

/// Views the received words, given the number of words from each rank.
fn received(
    counts: &[i32],
    receive: impl FnOnce(&mut PartitionMut<[u64], &[i32], &[i32]>),
) -> Vec<Vec<u64>> {
    let starts = starts(counts);
    let mut words = vec![0u64; counts.iter().map(|&c| c as usize).sum()];
    receive(&mut PartitionMut::new(&mut words[..], counts, &starts[..]));
    let lists = counts.iter().zip(&starts);
    lists
        .map(|(&c, &s)| words[s as usize..(s + c) as usize].to_vec())
        .collect()
}

/// Converts to a C int, the type of MPI counts: 2³¹ words to one rank would be 16 GB of interface.
fn count(n: usize) -> i32 {
    i32::try_from(n).expect("fewer than 2^31 words go to one rank")
}

/// Sum of each entry over the ranks. Collective.
pub fn sum_all(comm: &SimpleCommunicator, values: &mut [f64]) {
    reduce(comm, values, SystemOperation::sum());
}

/// Largest of each entry over the ranks. Collective.
pub fn max_all(comm: &SimpleCommunicator, values: &mut [f64]) {
    reduce(comm, values, SystemOperation::max());
}

/// Smallest of each entry over the ranks. Collective.
pub fn min_all(comm: &SimpleCommunicator, values: &mut [f64]) {
    reduce(comm, values, SystemOperation::min());
}

/// Sum of a number over the ranks. Collective.
pub fn total(comm: &SimpleCommunicator, value: f64) -> f64 {
    let mut values = [value];
    sum_all(comm, &mut values);
    values[0]
}

/// Largest number of a rank. Collective.
pub fn highest(comm: &SimpleCommunicator, value: f64) -> f64 {
    let mut values = [value];
    max_all(comm, &mut values);
    values[0]
}

/// Smallest number of a rank. Collective.
pub fn lowest(comm: &SimpleCommunicator, value: f64) -> f64 {
    let mut values = [value];
    min_all(comm, &mut values);
    values[0]
}

/// Whether something is true on some rank. Collective.
pub fn any(comm: &SimpleCommunicator, here: bool) -> bool {
    highest(comm, f64::from(here)) > 0.0
}

fn reduce(comm: &SimpleCommunicator, values: &mut [f64], operation: SystemOperation) {
    if comm.size() > 1 && !values.is_empty() {
        traffic::count(Traffic::reduction(values.len()));
        let mine = values.to_vec();
        comm.all_reduce_into(&mine[..], values, operation);
    }
}

/// Every rank's words, in the order of the ranks. Collective.
pub fn gather_all(comm: &SimpleCommunicator, mine: &[u64]) -> Vec<Vec<u64>> {
    if comm.size() == 1 {
        return vec![mine.to_vec()];
    }
    let mut counts = vec![0i32; comm.size() as usize];
    comm.all_gather_into(&count(mine.len()), &mut counts[..]);
    received(&counts, |into| comm.all_gather_varcount_into(mine, into))
}

/// (Σ of `n` over the lower ranks, Σ over all ranks). Collective.
pub fn offsets(comm: &SimpleCommunicator, n: usize) -> (usize, usize) {
    let all = gather_all(comm, &[n as u64]);
    let counts = all.iter().map(|w| w[0] as usize);
    let before = counts.clone().take(comm.rank() as usize).sum();
    (before, counts.sum())
}
