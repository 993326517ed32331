//! The columns of G that a rank knows, and vectors of columns.
//!
//! A rank needs numbers for the columns of its own bodies and rows, of its fronts of the factor and of what these lead
//! to: with bodies on many ranks these are few of all. They are numbered here from 0, in their order. A column has its
//! number among all columns as a name, by which ranks speak of it. Of few columns, and where ranks do not share one
//! factor, every rank knows all, and number and name are the same.
//!
//! A vector of columns has an entry for each column that is known here. Ranks add up their shares of it
//! ([`ColumnMap::sum`]); then it has the same entries wherever a column is known.

use std::ops::Range;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::kernel_motion::{Coefficient, KernelMotion};
use base::linalg::sorted::distinct;
use cholesky::team::FactorTeam;
use parallel::clock::{self, Phase};
use parallel::exchange::{exchange_by_rank, gather_all, max_all, sum_all};
use parallel::post::{posting, received, Address};

/// The columns that a rank knows.
#[derive(Debug, Default)]
pub struct ColumnMap {
    /// Number of all columns, r.
    r: usize,
    /// `None`: they are all known.
    part: Option<ColumnSubset>,
}

/// Some columns of all.
#[derive(Debug)]
struct ColumnSubset {
    /// Their names, increasing.
    names: Vec<u32>,
    /// Known columns that this rank has in the factor, by number, increasing.
    own: Vec<u32>,
    /// For each rank that has others of them, their numbers.
    of_others: Vec<(i32, Vec<u32>)>,
    /// For each rank that knows columns of this rank, their numbers.
    for_others: Vec<(i32, Vec<u32>)>,
}

/// The tag of messages with entries of vectors.
const TAG: i32 = 0;

impl ColumnMap {
    /// All of r columns.
    pub fn all(r: usize) -> ColumnMap {
        ColumnMap { r, part: None }
    }

    /// The columns with these names, which increase; `team`, which all ranks share, has r columns, and all of those in
    /// the rows of its fronts are among them. Collective.
    pub fn some(team: &FactorTeam, names: Vec<u32>) -> ColumnMap {
        let (size, rank) = (team.comm().size() as usize, team.comm().rank() as usize);
        let mut own = Vec::new();
        let mut of_others: Vec<Vec<u32>> = vec![Vec::new(); size];
        for (number, &name) in (0..).zip(&names) {
            match team.place(name).rank as usize {
                at if at == rank => own.push(number),
                at => of_others[at].push(number),
            }
        }
        let wanted = of_others.iter().map(|list| {
            let names = list.iter().map(|&n| names[n as usize]);
            names.collect()
        });
        let here = |name: &u32| {
            let at = names.binary_search(name);
            at.expect("a rank knows the columns of its fronts") as u32
        };
        let asked: Vec<Vec<u32>> = exchange_by_rank(team.comm(), wanted.collect());
        let for_others = asked.iter().map(|names| names.iter().map(here).collect());
        let by_rank = |lists: &mut dyn Iterator<Item = Vec<u32>>| {
            let ranks = (0..).zip(lists);
            ranks
                .filter(|r: &(i32, Vec<u32>)| !r.1.is_empty())
                .collect()
        };
        let for_others = by_rank(&mut for_others.into_iter());
        let of_others = by_rank(&mut of_others.into_iter());
        ColumnMap {
            r: team.n(),
            part: Some(ColumnSubset {
                own,
                of_others,
                for_others,
                names,
            }),
        }
    }

    /// Number of columns that are known here.
    pub fn n(&self) -> usize {
        self.part.as_ref().map_or(self.r, |part| part.names.len())
    }

    /// Number of all columns, r.
    pub fn r(&self) -> usize {
        self.r
    }

    /// Whether they are not all.
    pub fn is_part(&self) -> bool {
        self.part.is_some()
    }

    /// The name of a column.
    pub fn name(&self, column: u32) -> u32 {
        match &self.part {
            Some(part) => part.names[column as usize],
            None => column,
        }
    }

    /// The number of the column with this name, if it is known.
    pub fn here(&self, name: u32) -> Option<u32> {
        match &self.part {
            Some(part) => part.names.binary_search(&name).ok().map(|at| at as u32),
            None => Some(name),
        }
    }

    /// The number of a column that is known for sure.
    ///
    /// # Panics
    /// If it is not.
    pub fn number(&self, name: u32) -> u32 {
        let number = self.here(name);
        number.expect("columns of own bodies, rows and fronts are known")
    }

    /// The numbers of the columns with these names, as far as they are known.
    pub fn numbers(&self, names: Range<u32>) -> Range<usize> {
        match &self.part {
            Some(part) => {
                let at = |name: u32| part.names.partition_point(|&n| n < name);
                at(names.start)..at(names.end)
            }
            None => names.start as usize..names.end as usize,
        }
    }

    /// The columns that count here where ranks add something up over all columns: each counts on one rank. `None`: they
    /// all count here, and nothing is to be added up.
    fn counted(&self) -> Option<&[u32]> {
        self.part.as_ref().map(|part| &part.own[..])
    }

    /// x ← Σ x: the sum of the shares of the ranks, in the columns that are known here. Collective.
    pub fn sum(&self, comm: &SimpleCommunicator, x: &mut [f64]) {
        let Some(part) = &self.part else {
            return sum_all(comm, x);
        };
        clock::timed(Phase::Exchange, || {
            let entries = |x: &[f64], list: &[u32]| list.iter().map(|&c| x[c as usize]).collect();
            let with = |rank: i32| Address { rank, tag: TAG };
            // What others have a share in goes to the owner, who adds it up by rank and sends the sum back.
            posting(comm, part.of_others.len(), |post| {
                for (rank, list) in &part.of_others {
                    post.send(with(*rank), entries(x, list));
                }
                for (rank, list) in &part.for_others {
                    let shares = received(comm, with(*rank), list.len());
                    let pairs = list.iter().zip(shares);
                    pairs.for_each(|(&c, share)| x[c as usize] += share);
                }
            });
            self.tell(comm, x);
        });
    }

    /// Sets the entries of x at columns of other ranks to what these have there. Collective.
    pub fn tell(&self, comm: &SimpleCommunicator, x: &mut [f64]) {
        let Some(part) = &self.part else {
            return;
        };
        let with = |rank: i32| Address { rank, tag: TAG };
        posting(comm, part.for_others.len(), |post| {
            for (rank, list) in &part.for_others {
                let entries = list.iter().map(|&c| x[c as usize]).collect();
                post.send(with(*rank), entries);
            }
            for (rank, list) in &part.of_others {
                let values = received(comm, with(*rank), list.len());
                let pairs = list.iter().zip(values);
                pairs.for_each(|(&c, value)| x[c as usize] = value);
            }
        });
    }

    /// Σ f(c) over all columns, for quantities that are the same wherever a column is known. Collective.
    pub fn total<const N: usize>(
        &self,
        comm: &SimpleCommunicator,
        f: impl Fn(usize) -> [f64; N],
    ) -> [f64; N] {
        let add = |mut sums: [f64; N], c: usize| {
            sums.iter_mut().zip(f(c)).for_each(|(s, v)| *s += v);
            sums
        };
        match self.counted() {
            Some(own) => {
                let mut sums = own.iter().map(|&c| c as usize).fold([0.0; N], add);
                sum_all(comm, &mut sums);
                sums
            }
            None => (0..self.r).fold([0.0; N], add),
        }
    }

    /// The largest |entry| of a vector that is the same wherever a column is known. Collective.
    pub fn largest(&self, comm: &SimpleCommunicator, x: &[f64]) -> f64 {
        self.most(comm, x.iter().map(|v| v.abs()).fold(0.0, f64::max))
    }

    /// The largest of numbers of the ranks, each from what it knows. Collective.
    pub fn most(&self, comm: &SimpleCommunicator, here: f64) -> f64 {
        let mut most = [here];
        if self.is_part() {
            max_all(comm, &mut most);
        }
        most[0]
    }

    /// All entries of a vector that is the same wherever a column is known, on every rank. Collective.
    pub fn whole(&self, comm: &SimpleCommunicator, x: &[f64]) -> Vec<f64> {
        let Some(part) = &self.part else {
            return x.to_vec();
        };
        let mut whole = vec![0.0; self.r];
        for &c in &part.own {
            whole[part.names[c as usize] as usize] = x[c as usize];
        }
        sum_all(comm, &mut whole);
        whole
    }

    /// The entries of a vector of all columns that are known here.
    pub fn part_of(&self, whole: &[f64]) -> Vec<f64> {
        match &self.part {
            Some(part) => part.names.iter().map(|&n| whole[n as usize]).collect(),
            None => whole.to_vec(),
        }
    }

    /// The entries of a vector that is the same wherever a column is known as a motion, without those below `least`
    /// relative to the largest. The same on every rank. Collective.
    pub fn motion(&self, comm: &SimpleCommunicator, x: &[f64], least: f64) -> KernelMotion {
        let Some(own) = self.counted() else {
            return KernelMotion::above(least, (0..).zip(x.iter().copied()));
        };
        let bound = least * self.largest(comm, x);
        let entries = own.iter().map(|&c| (c, x[c as usize]));
        let entries = entries.filter(|e| e.1.abs() > bound);
        let mine = entries.map(|(c, v)| Coefficient::new(self.name(c), v));
        let all = gather_all(comm, &mine.collect::<Vec<_>>()).concat();
        let mut entries: Vec<(u32, f64)> = all.iter().map(Coefficient::pair).collect();
        entries.sort_by_key(|e| e.0);
        KernelMotion(entries)
    }

    /// x ← x + α times the coefficients of a motion.
    pub fn add(&self, alpha: f64, motion: &KernelMotion, x: &mut [f64]) {
        for &(name, v) in &motion.0 {
            if let Some(c) = self.here(name) {
                x[c as usize] += alpha * v;
            }
        }
    }

    /// The entries of vectors, which are the same wherever a column is known, at the columns of these motions: the
    /// names, which increase, and the entries of each vector. The same on every rank. Collective.
    pub fn at<const N: usize>(
        &self,
        comm: &SimpleCommunicator,
        motions: &[KernelMotion],
        vectors: [&[f64]; N],
    ) -> (Vec<u32>, [Vec<f64>; N]) {
        let names = distinct(motions.iter().flat_map(|m| m.0.iter().map(|e| e.0)));
        let counts = |c: &u32| {
            self.counted()
                .is_none_or(|own| own.binary_search(c).is_ok())
        };
        let here: Vec<Option<u32>> = (names.iter())
            .map(|&name| self.here(name).filter(counts))
            .collect();
        let mut entries = vectors.map(|x| {
            let of = |c: &Option<u32>| c.map_or(0.0, |c| x[c as usize]);
            here.iter().map(of).collect::<Vec<f64>>()
        });
        if self.is_part() {
            entries.iter_mut().for_each(|list| sum_all(comm, list));
        }
        (names, entries)
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/projector/column_map.rs"]
mod tests;
