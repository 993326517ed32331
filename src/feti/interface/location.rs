//! Where subdomains and bodies are. A rank knows this of its own ones and of the subdomains with which these share dofs
//! or rows; no rank has a list of all. What is to be found without being known first is asked of a rendezvous rank.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use rustc_hash::FxHashMap;

use crate::substructures::Problem;
use crate::{Error, Result};
use parallel::exchange::{any, exchange, exchange_by_rank};

/// Where a subdomain is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Location {
    /// The rank that holds it.
    pub rank: u32,
    /// Its body.
    pub body: u32,
}

/// Where subdomains are that this rank knows of.
#[derive(Debug, Default, Clone)]
pub struct Locations(FxHashMap<u32, Location>);

impl Locations {
    /// The locations of the subdomains of this rank.
    pub fn own(comm: &SimpleCommunicator, problem: &Problem) -> Locations {
        let at = |body: usize| Location {
            rank: comm.rank() as u32,
            body: body as u32,
        };
        let own = problem.local.iter().map(|s| (s.index as u32, at(s.body)));
        Locations(own.collect())
    }

    /// Notes where a subdomain is.
    pub fn insert(&mut self, subdomain: u32, at: Location) {
        self.0.insert(subdomain, at);
    }

    /// Where a subdomain is.
    ///
    /// # Panics
    /// If neither the subdomain itself nor one with which it shares a dof or a row is on this rank.
    pub fn of(&self, subdomain: u32) -> Location {
        self.0[&subdomain]
    }

    /// The rank that holds a subdomain.
    ///
    /// # Panics
    /// As [`of`](Locations::of).
    pub fn rank(&self, subdomain: u32) -> usize {
        self.of(subdomain).rank as usize
    }
}

/// The facts about a body that every rank with one of its subdomains knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Home {
    /// The rank of the body's lowest subdomain.
    pub rank: u32,
    /// Whether the body has more than one subdomain.
    pub is_cut: bool,
}

/// The homes of the bodies of this rank. Collective.
pub fn homes(comm: &SimpleCommunicator, problem: &Problem) -> FxHashMap<usize, Home> {
    let size = comm.size() as usize;
    let own = problem.local.iter().map(|s| (s.body, s.index));
    let mut own: Vec<(usize, usize)> = own.collect();
    own.sort_unstable();
    let mut reports: Vec<Vec<[usize; 3]>> = vec![Vec::new(); size];
    for group in own.chunk_by(|a, b| a.0 == b.0) {
        let (body, lowest) = group[0];
        reports[body % size].push([body, lowest, group.len()]);
    }
    let received = exchange_by_rank(comm, reports);
    let mut found: FxHashMap<usize, (usize, Home)> = FxHashMap::default();
    for (rank, parts) in (0..).zip(&received) {
        for &[body, lowest, subdomains] in parts {
            let is_cut = subdomains > 1;
            let new = (lowest, Home { rank, is_cut });
            let known = found.entry(body);
            let known = known.and_modify(|old| {
                let lower = if lowest < old.0 { new } else { *old };
                *old = lower;
                old.1.is_cut = true;
            });
            known.or_insert(new);
        }
    }
    let home = |&[body, ..]: &[usize; 3]| {
        let Home { rank, is_cut } = found[&body].1;
        [body, rank as usize, is_cut.into()]
    };
    let answers = received
        .iter()
        .map(|parts| parts.iter().map(home).collect());
    let home = |[body, rank, cut]: [usize; 3]| {
        let (rank, is_cut) = (rank as u32, cut != 0);
        (body, Home { rank, is_cut })
    };
    let answers = exchange(comm, answers.collect()).into_iter();
    answers.map(home).collect()
}

/// Whether each subdomain number below n_subdomains is used once, and each body exists. Each rank looks at a part of
/// the numbers, so errors need not be those of all ranks. Collective.
///
/// # Errors
/// A number is used twice, is not used, or is too large; a subdomain names a body that does not exist.
pub fn check(comm: &SimpleCommunicator, problem: &Problem) -> Result<()> {
    let (size, n) = (comm.size() as usize, problem.n_subdomains);
    let mut found = Ok(());
    let mut numbers: Vec<Vec<usize>> = vec![Vec::new(); size];
    for sub in &problem.local {
        if sub.index >= n {
            found = Err(twice_or_above(sub.index, n));
        } else if sub.body >= problem.n_bodies {
            found = Err(Error::input(format!(
                "subdomain {} names body {}, but there are {} bodies",
                sub.index, sub.body, problem.n_bodies
            )));
        }
        numbers[sub.index % size].push(sub.index);
    }
    let mut all = exchange(comm, numbers);
    all.retain(|&index| index < n);
    all.sort_unstable();
    let twice = all.windows(2).find(|w| w[0] == w[1]);
    found = found.and(twice.map_or(Ok(()), |w| Err(twice_or_above(w[0], n))));
    // A number that is used twice usually leaves another one unused, which says less.
    if any(comm, found.is_err()) {
        return found;
    }
    let expected = (comm.rank() as usize..n).step_by(size);
    let present = all.iter().map(|&index| Some(index));
    let present = present.chain(std::iter::repeat(None));
    match expected.zip(present).find(|(e, p)| Some(*e) != *p) {
        Some((missing, _)) => Err(Error::input(format!("no rank holds subdomain {missing}"))),
        None => Ok(()),
    }
}

fn twice_or_above(index: usize, n: usize) -> Error {
    Error::input(format!(
        "subdomain index {index} is used twice or is not below {n}"
    ))
}
