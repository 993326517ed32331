//! The dofs of tied faces: which of them are one.

use std::collections::BTreeSet;

use mpi::topology::SimpleCommunicator;

use super::groups::{is_tie, Groups};
use crate::substructures::{Problem, Row};
use base::linalg::union_find::UnionFind;
use parallel::exchange::gather_all;

/// The tied dofs of all ranks.
pub struct TiedDofs {
    /// All of them, increasing.
    pub all: Vec<u64>,
    /// For each the lowest one that it is tied to, or itself, as an index into `all`.
    pub first: Vec<usize>,
    /// Whether nothing is tied to it.
    alone: Vec<bool>,
}

/// The dofs that rows of all ranks name, of those for which `counts` holds; increasing. Collective.
pub fn named(
    comm: &SimpleCommunicator,
    problem: &Problem,
    counts: impl Fn(&Row) -> bool,
) -> Vec<u64> {
    let rows = problem.rows.iter().filter(|r| counts(r));
    let mine: BTreeSet<u64> = rows.flat_map(|r| &r.terms).map(|t| t.0).collect();
    let mine: Vec<u64> = mine.into_iter().collect();
    let all: BTreeSet<u64> = gather_all(comm, &mine).into_iter().flatten().collect();
    all.into_iter().collect()
}

impl TiedDofs {
    /// The dofs of the ties inside groups. Collective.
    pub fn new(comm: &SimpleCommunicator, problem: &Problem, groups: &Groups) -> TiedDofs {
        let all = named(comm, problem, is_tie);
        let at = |dof: u64| all.binary_search(&dof).ok();
        // The group of each of them.
        let mut mine: BTreeSet<[u64; 2]> = BTreeSet::new();
        for sub in &problem.local {
            let tied = sub.dofs.iter().filter(|d| at(**d).is_some());
            mine.extend(tied.map(|&dof| [dof, groups.of[sub.body] as u64]));
        }
        let mine: Vec<[u64; 2]> = mine.into_iter().collect();
        let mut group = vec![u64::MAX; all.len()];
        for [dof, of] in gather_all(comm, &mine).into_iter().flatten() {
            group[at(dof).expect("it is one of them")] = of;
        }
        let ties = problem.rows.iter().filter(|r| is_tie(r));
        let ties: Vec<[u64; 2]> = ties.map(|r| [r.terms[0].0, r.terms[1].0]).collect();
        let mut sets = UnionFind::new(all.len());
        for [a, b] in gather_all(comm, &ties).into_iter().flatten() {
            let [a, b] = [a, b].map(|d| at(d).expect("it is one of them"));
            if group[a] == group[b] {
                sets.join(a, b);
            }
        }
        let first: Vec<usize> = (0..all.len()).map(|k| sets.find(k)).collect();
        let mut alone = vec![true; all.len()];
        for (k, &first) in first.iter().enumerate().filter(|(k, f)| k != *f) {
            (alone[k], alone[first]) = (false, false);
        }
        TiedDofs { all, first, alone }
    }

    /// Whether a dof is tied to another one of its group.
    pub fn is_tied(&self, dof: u64) -> bool {
        self.all.binary_search(&dof).is_ok_and(|k| !self.alone[k])
    }

    /// The number that a dof has in its group.
    pub fn number(&self, dof: u64) -> u64 {
        match self.all.binary_search(&dof) {
            Ok(k) => self.all[self.first[k]],
            Err(_) => dof,
        }
    }

    /// Whether two dofs are one.
    pub fn are_one(&self, a: u64, b: u64) -> bool {
        let at = |dof: u64| self.all.binary_search(&dof).ok().map(|k| self.first[k]);
        at(a).is_some() && at(a) == at(b)
    }
}
