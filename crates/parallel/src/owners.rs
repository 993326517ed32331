//! The owners of numbers that are divided among the ranks in order: entries of a vector, rows, subdomains.

use mpi::topology::SimpleCommunicator;

use super::exchange::gather_all;

/// The first number of every rank.
pub struct Owners(Vec<usize>);

impl Owners {
    /// `first` is the first number of this rank. Collective.
    pub fn new(comm: &SimpleCommunicator, first: usize) -> Owners {
        Owners(gather_all(comm, &[first]).concat())
    }

    /// The rank that owns a number.
    pub fn of(&self, number: impl Into<u64>) -> usize {
        let number = number.into() as usize;
        // The last rank that starts at or before the number: a rank without numbers starts where the next one does.
        self.0.partition_point(|&first| first <= number) - 1
    }
}
