//! Irregular messages during set-up: every rank sends every rank a list of records.
//!
//! Records are plain data ([`Pod`]) and travel as the bytes that they have in memory, in words of 32 bits. The
//! iteration does not use this module: it uses PETSc's scatters, which are set up once.

use bytemuck::{cast_slice, pod_collect_to_vec, Pod};
use mpi::collective::SystemOperation;
use mpi::datatype::{Partition, PartitionMut};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives};

use super::traffic::Traffic;
use crate::traffic;

/// A message of a rank to another one: a list of records, or [`Parcels`](super::parcels::Parcels).
pub trait Message: Default {
    /// Appends the message; an empty one has no words.
    fn write(&self, words: &mut Vec<u32>);
    /// The message of these words.
    fn read(words: &[u32]) -> Self;
}

impl<T: Pod> Message for Vec<T> {
    fn write(&self, words: &mut Vec<u32>) {
        words.extend_from_slice(cast_slice(self));
    }
    fn read(words: &[u32]) -> Vec<T> {
        pod_collect_to_vec(words)
    }
}

/// Sends `outgoing[r]` to rank r and returns what all ranks sent here, one after the other by rank of the sender.
/// Collective.
///
/// # Panics
/// For records that are no whole words: types smaller than 32 bits.
pub fn exchange<T: Pod>(comm: &SimpleCommunicator, outgoing: Vec<Vec<T>>) -> Vec<T> {
    let mut all = Vec::new();
    for list in exchange_by_rank(comm, outgoing) {
        // Most records are those of this rank for itself; they are not copied where they come first.
        if all.is_empty() {
            all = list;
        } else {
            all.extend(list);
        }
    }
    all
}

/// Sends `outgoing[r]` to rank r and returns what every rank sent here, by rank of the sender. Collective.
///
/// # Panics
/// As [`exchange`].
pub fn exchange_by_rank<M: Message>(comm: &SimpleCommunicator, mut outgoing: Vec<M>) -> Vec<M> {
    let (size, rank) = (comm.size() as usize, comm.rank() as usize);
    debug_assert_eq!(outgoing.len(), size);
    if size == 1 {
        return outgoing;
    }
    let own = std::mem::take(&mut outgoing[rank]);
    let mut words = Vec::new();
    let written = outgoing.into_iter().map(|message| {
        let before = words.len();
        message.write(&mut words);
        count(words.len() - before)
    });
    let send_counts: Vec<i32> = written.collect();
    let mut counts = vec![0i32; size];
    comm.all_to_all_into(&send_counts[..], &mut counts[..]);
    let send_starts = starts(&send_counts);
    let from = Partition::new(&words[..], &send_counts[..], &send_starts[..]);
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

/// The messages of all ranks, given the number of words of each.
fn received<M: Message>(
    counts: &[i32],
    receive: impl FnOnce(&mut PartitionMut<[u32], &[i32], &[i32]>),
) -> Vec<M> {
    let starts = starts(counts);
    let mut words = vec![0u32; counts.iter().map(|&c| c as usize).sum()];
    receive(&mut PartitionMut::new(&mut words[..], counts, &starts[..]));
    let lists = counts.iter().zip(&starts);
    lists
        .map(|(&c, &s)| M::read(&words[s as usize..(s + c) as usize]))
        .collect()
}

/// Converts to a C int, the type of MPI counts: 2³¹ words to one rank would be 8 GB of interface.
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

/// Every rank's records, in the order of the ranks. Collective.
///
/// # Panics
/// As [`exchange`].
pub fn gather_all<T: Pod>(comm: &SimpleCommunicator, mine: &[T]) -> Vec<Vec<T>> {
    match comm.size() {
        1 => vec![mine.to_vec()],
        _ => gather_words(comm, cast_slice(mine)),
    }
}

/// The messages of all ranks, in the order of the ranks; this one's has these words. Collective.
pub(super) fn gather_words<M: Message>(comm: &SimpleCommunicator, mine: &[u32]) -> Vec<M> {
    let mut counts = vec![0i32; comm.size() as usize];
    comm.all_gather_into(&count(mine.len()), &mut counts[..]);
    received(&counts, |into| comm.all_gather_varcount_into(mine, into))
}

/// (Σ of `n` over the lower ranks, Σ over all ranks). Collective.
pub fn offsets(comm: &SimpleCommunicator, n: usize) -> (usize, usize) {
    let counts = gather_all(comm, &[n]).concat();
    let before = counts[..comm.rank() as usize].iter().sum();
    (before, counts.iter().sum())
}
