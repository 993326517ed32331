//! The ranks that share a factor, and what each of them does.
//!
//! A front belongs to one rank (`deal`). A rank eliminates its subtrees, then its fronts above subtrees. What a front
//! leaves to its parent goes in a message where another rank has that.

use std::ops::Range;
use std::sync::Arc;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::deal::{deal, FrontOwner};
use super::symbolic::{Front, Symbolic, ABSENT};
use base::linalg::sorted::distinct;
use parallel::post::Address;

/// Ranks that share a factor, and who of them has which front.
pub struct FactorTeam {
    pub(super) comm: SimpleCommunicator,
    /// The pattern; it has room for the panels of the own fronts alone. Of a team that is [narrowed](Team::narrowed) it
    /// has the own fronts and those with which they exchange something, and the rows of these.
    pub(super) symbolic: Arc<Symbolic>,
    /// The own fronts, in the order in which this rank eliminates them.
    pub(super) own: Vec<usize>,
    /// The own fronts in parts, between messages.
    pub(super) runs: Vec<FrontChain>,
    /// Where each dof is kept.
    pub(super) places: Vec<DistributedIndex>,
    /// The number of each dof among those of all ranks; `None`: they are all numbered here.
    pub(super) names: Option<Vec<u32>>,
    /// The rows of the own fronts, increasing, and the rows of others below them.
    pub(super) own_rows: Vec<u32>,
    pub(super) ghost_rows: Vec<u32>,
}

/// Number of fronts in a bundle: they take some ten microseconds of a solve.
const BUNDLE: usize = 8;

/// Fronts that follow each other without a message between them.
pub(super) struct FrontChain {
    /// The children of the first front that other ranks have.
    pub children: Vec<(usize, Address)>,
    /// Places in the list of own fronts.
    pub fronts: Range<usize>,
    /// Who has the parent of the last front, if it is another rank.
    pub parent: Option<Address>,
}

/// Where the entry of a dof is kept in a vector that no rank has whole: a distributed vector that has the rows of the
/// ranks' fronts, rank after rank.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DistributedIndex {
    /// The rank that has its front.
    pub rank: u32,
    /// The number in the vector.
    pub number: u32,
}

impl FactorTeam {
    /// Deals out the fronts of `symbolic` to the ranks of `comm`. `home` has, for each dof, the rank that would have it
    /// rather than others; it is empty if that does not matter. Collective.
    pub fn new(comm: &SimpleCommunicator, symbolic: Symbolic, home: &[u32]) -> FactorTeam {
        let comm = comm.duplicate();
        let rank = comm.rank() as u32;
        let homes: Vec<u32> = if home.is_empty() {
            Vec::new()
        } else {
            symbolic.dofs().map(|dof| home[dof as usize]).collect()
        };
        let shares = deal(&symbolic.fronts, comm.size() as usize, &homes);
        let mine = |above: bool| {
            let share = FrontOwner { rank, above };
            let shares = &shares;
            (0..shares.len()).filter(move |&f| shares[f] == share)
        };
        let own: Vec<usize> = mine(false).chain(mine(true)).collect();
        let runs = runs(&symbolic.fronts, &shares, &own, comm.size() as usize);
        let places = places(&symbolic, &shares, comm.size() as usize);
        let place = |p: u32| places[symbolic.interior[p as usize] as usize];
        let rows = own.iter().map(|&f| &symbolic.fronts[f]);
        let own_rows = distinct(rows.clone().flat_map(|f| f.start as u32..f.end as u32));
        let below = rows.flat_map(|f| f.below.iter().copied());
        let ghost_rows = distinct(below.filter(|&p| place(p).rank != rank));
        let symbolic = symbolic.with_panels(&own);
        FactorTeam {
            comm,
            symbolic: symbolic.into(),
            own,
            runs,
            places,
            names: None,
            own_rows,
            ghost_rows,
        }
    }

    /// Whether it has more than one rank.
    pub fn is_shared(&self) -> bool {
        self.comm.size() > 1
    }

    /// Number of dofs that have a number here.
    pub fn n(&self) -> usize {
        self.places.len()
    }

    /// Whether this rank has a row, by its place in the order of elimination.
    pub(super) fn has_row(&self, row: usize) -> bool {
        self.has(self.symbolic.interior[row])
    }

    /// Whether this rank has the row of a dof.
    pub fn has(&self, dof: u32) -> bool {
        self.place(dof).rank == self.comm.rank() as u32
    }

    /// The place of a dof in the order of elimination, if its row is an own one, a ghost, or if there are all rows.
    pub(super) fn row(&self, dof: u32) -> Option<usize> {
        let row = self.symbolic.position[dof as usize];
        (row != ABSENT).then_some(row as usize)
    }

    /// The number of a dof among those of all ranks.
    pub(super) fn name(&self, dof: u32) -> u32 {
        self.names.as_ref().map_or(dof, |names| names[dof as usize])
    }

    /// The dof with this number among those of all ranks, if it has a number here.
    pub(super) fn dof(&self, name: u32) -> Option<u32> {
        match &self.names {
            Some(names) => names.binary_search(&name).ok().map(|dof| dof as u32),
            None => Some(name),
        }
    }

    /// Whether some dofs have no number here.
    pub(super) fn is_narrow(&self) -> bool {
        self.names.is_some()
    }

    /// The ranks.
    pub fn comm(&self) -> &SimpleCommunicator {
        &self.comm
    }

    /// Where a dof of the matrix is kept.
    pub fn place(&self, dof: u32) -> DistributedIndex {
        self.places[dof as usize]
    }

    /// Where this rank has the entry of a dof in a vector that no rank has whole, if the dof is its own or a ghost.
    pub fn here(&self, dof: u32) -> Option<u32> {
        if self.has(dof) {
            return Some(self.place(dof).number - self.first_own());
        }
        let row = self.row(dof)? as u32;
        let at = self.ghost_rows.binary_search(&row).ok()?;
        Some((self.own_rows.len() + at) as u32)
    }

    /// The number of rows that this rank has, and of rows of others below its fronts: ghosts. Vectors that no rank has
    /// whole have the entries of both here.
    pub fn sizes(&self) -> (usize, usize) {
        (self.own_rows.len(), self.ghost_rows.len())
    }

    /// The number of this rank's first row in vectors that no rank has whole.
    fn first_own(&self) -> u32 {
        let first = self.own_dofs().next();
        first.map_or(0, |dof| self.place(dof).number)
    }

    /// The dofs that this rank has, then its ghosts, in the order in which their entries are kept.
    pub fn dofs(&self) -> impl Iterator<Item = u32> + '_ {
        let rows = self.own_rows.iter().chain(&self.ghost_rows);
        rows.map(|&p| self.symbolic.interior[p as usize])
    }

    /// The dofs that this rank has.
    pub fn own_dofs(&self) -> impl Iterator<Item = u32> + '_ {
        self.dofs().take(self.own_rows.len())
    }

    pub(super) fn fronts(&self, run: &FrontChain) -> impl DoubleEndedIterator<Item = &Front> + '_ {
        let numbers = self.own[run.fronts.clone()].iter();
        numbers.map(|&f| &self.symbolic.fronts[f])
    }

    /// The fronts of a run in bundles, after each of which a solve looks after its messages.
    pub(super) fn bundles<'a>(
        &'a self,
        run: &FrontChain,
    ) -> impl DoubleEndedIterator<Item = impl DoubleEndedIterator<Item = &'a Front> + 'a> + 'a {
        let bundles = self.own[run.fronts.clone()].chunks(BUNDLE);
        bundles.map(|numbers| numbers.iter().map(|&f| &self.symbolic.fronts[f]))
    }

    /// The last front of a run.
    pub(super) fn last(&self, run: &FrontChain) -> usize {
        self.own[run.fronts.end - 1]
    }

    /// The number of messages that this rank sends to parents, and to children.
    pub(super) fn messages(&self) -> (usize, usize) {
        let to_parents = self.runs.iter().filter(|r| r.parent.is_some()).count();
        let to_children = self.runs.iter().map(|r| r.children.len()).sum();
        (to_parents, to_children)
    }
}

/// The own fronts in parts that begin where something arrives and end where something leaves.
fn runs(fronts: &[Front], shares: &[FrontOwner], own: &[usize], ranks: usize) -> Vec<FrontChain> {
    let Some(rank) = own.first().map(|&f| shares[f].rank) else {
        return Vec::new();
    };
    // Messages between a rank and the ranks of its fronts' children have numbers of their own.
    let mut count = vec![0; ranks];
    let mut children: Vec<Vec<(usize, Address)>> = vec![Vec::new(); fronts.len()];
    let mut parent: Vec<Option<Address>> = vec![None; fronts.len()];
    for (f, front) in fronts.iter().enumerate() {
        let Some(t) = front.parent.filter(|&t| shares[t].rank != shares[f].rank) else {
            continue;
        };
        let (from, to) = (shares[f].rank, shares[t].rank);
        let tag = count[to as usize];
        count[to as usize] += 1;
        let with = |rank: u32| Address {
            rank: rank as i32,
            tag,
        };
        if to == rank {
            children[t].push((f, with(from)));
        } else if from == rank {
            parent[f] = Some(with(to));
        }
    }
    let mut runs: Vec<FrontChain> = Vec::new();
    for (at, &f) in own.iter().enumerate() {
        let arriving = std::mem::take(&mut children[f]);
        match runs.last_mut() {
            Some(run) if arriving.is_empty() && run.parent.is_none() => {
                run.fronts.end = at + 1;
                run.parent = parent[f];
            }
            _ => runs.push(FrontChain {
                children: arriving,
                fronts: at..at + 1,
                parent: parent[f],
            }),
        }
    }
    runs
}

/// The place of each dof.
fn places(symbolic: &Symbolic, shares: &[FrontOwner], size: usize) -> Vec<DistributedIndex> {
    let fronts = &symbolic.fronts;
    // The number of the next row of each rank.
    let mut next = vec![0u32; size + 1];
    for (front, share) in fronts.iter().zip(shares) {
        next[share.rank as usize + 1] += front.width() as u32;
    }
    for r in 0..size {
        next[r + 1] += next[r];
    }
    // Dofs in no front are nowhere.
    let nowhere = DistributedIndex { rank: 0, number: 0 };
    let mut places = vec![nowhere; symbolic.position.len()];
    for (front, share) in fronts.iter().zip(shares) {
        let next = &mut next[share.rank as usize];
        for &dof in &symbolic.interior[front.start..front.end] {
            places[dof as usize] = DistributedIndex {
                rank: share.rank,
                number: *next,
            };
            *next += 1;
        }
    }
    places
}
