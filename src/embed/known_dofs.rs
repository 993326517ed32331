//! The values of known dofs in rows, from the ranks that have them to those that take the rows.

use std::collections::HashMap;

use base::linalg::sorted::distinct;
use parallel::exchange::{exchange, exchange_by_rank};
use petsc::Session;

/// The known dofs in the rows that this rank takes.
pub struct KnownDofs {
    /// (rank that has the value, dof), increasing.
    wanted: Vec<(usize, u32)>,
    /// The dofs whose values each rank takes from this one.
    given: Vec<Vec<u32>>,
}

impl KnownDofs {
    /// `wanted` lists ranks that have values, and dofs. Collective.
    pub fn new(session: &Session, wanted: impl Iterator<Item = (usize, u32)>) -> KnownDofs {
        let wanted = distinct(wanted);
        let mut outgoing = vec![Vec::new(); session.size()];
        for &(rank, dof) in &wanted {
            outgoing[rank].push(dof);
        }
        KnownDofs {
            wanted,
            given: exchange_by_rank(session.comm(), outgoing),
        }
    }

    /// The place of a dof in the result of [`fetch`](Self::fetch).
    pub fn place(&self, rank: usize, dof: u32) -> usize {
        let place = self.wanted.binary_search(&(rank, dof));
        place.expect("the dof is wanted")
    }

    /// The values; `here` has those of this rank's known dofs. Collective.
    pub fn fetch(&self, session: &Session, here: &HashMap<u32, f64>) -> Vec<f64> {
        let values = |dofs: &Vec<u32>| dofs.iter().map(|dof| here[dof]).collect();
        exchange(session.comm(), self.given.iter().map(values).collect())
    }
}
