//! The ranks that share a factor, and who of them has which part of it.
//!
//! Subtrees of the elimination tree are dealt out to the ranks. What is above them, the top, belongs to all.

use std::cmp::{Ordering, Reverse};
use std::collections::{BTreeMap, BinaryHeap};
use std::sync::Arc;

use mpi::topology::{Color, SimpleCommunicator};
use mpi::traits::Communicator;

use super::symbolic::{Front, Symbolic};

/// Ranks that share a factor, and who of them has which front.
pub struct Team {
    pub(super) comm: SimpleCommunicator,
    /// The pattern; it has room for the panels of the own fronts and of the top alone.
    pub(super) symbolic: Arc<Symbolic>,
    /// Fronts in the order of elimination.
    pub(super) own: Vec<usize>,
    pub(super) top: Vec<usize>,
    /// The own fronts whose parents are in the top.
    pub(super) roots: Vec<usize>,
    /// Where each row is kept, in the order of elimination.
    places: Vec<Place>,
    /// The rows of this rank's subtrees and of the top, increasing.
    pub(super) own_rows: Vec<u32>,
    pub(super) top_rows: Vec<u32>,
}

/// Where the entry of a dof is kept in a vector that no rank has whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// With the rank that has it in its subtrees, in a distributed vector that has these rows, rank after rank.
    Subtree {
        /// The rank.
        rank: u32,
        /// The number in the vector.
        number: u32,
    },
    /// Among the rows of the top.
    Top(u32),
}

impl Team {
    /// Divides the ranks of `comm` into `copies` teams of the same size, which have the same factor, and deals out the
    /// fronts of `symbolic`. `home` has, for each dof, the rank that would have it rather than others; it is empty if
    /// that does not matter. Collective.
    ///
    /// # Panics
    /// If `copies` does not divide the number of ranks.
    pub fn new(comm: &SimpleCommunicator, symbolic: Symbolic, copies: usize, home: &[u32]) -> Team {
        let size = comm.size() as usize;
        assert_eq!(size % copies, 0, "teams of the same size");
        let team = comm.rank() / (size / copies) as i32;
        let comm = comm.split_by_color(Color::with_value(team));
        let comm = comm.expect("every rank has a colour");
        let rank = comm.rank() as u32;
        let homes: Vec<u32> = match copies {
            1 if !home.is_empty() => symbolic.dofs().map(|dof| home[dof as usize]).collect(),
            _ => Vec::new(),
        };
        let ranks = deal(&symbolic.fronts, comm.size() as usize, &homes);
        let of = |whose: Option<u32>| (0..ranks.len()).filter(|&f| ranks[f] == whose).collect();
        let (own, top): (Vec<usize>, Vec<usize>) = (of(Some(rank)), of(None));
        let above = |f: &usize| symbolic.fronts[*f].parent.map(|t| ranks[t]) == Some(None);
        let roots = own.iter().copied().filter(above).collect();
        let rows_of = |fronts: &[usize]| -> Vec<u32> {
            let fronts = fronts.iter().map(|&f| &symbolic.fronts[f]);
            fronts.flat_map(|f| f.start as u32..f.end as u32).collect()
        };
        let (own_rows, top_rows) = (rows_of(&own), rows_of(&top));
        let places = places(&symbolic.fronts, &ranks, comm.size() as usize);
        let symbolic = symbolic.with_panels(|f| ranks[f].is_none_or(|r| r == rank));
        Team {
            comm,
            symbolic: symbolic.into(),
            own,
            top,
            roots,
            places,
            own_rows,
            top_rows,
        }
    }

    /// Whether it has all ranks of `comm`, and more than one.
    pub fn is_whole(&self, comm: &SimpleCommunicator) -> bool {
        self.comm.size() > 1 && self.comm.size() == comm.size()
    }

    /// Number of rows.
    pub fn n(&self) -> usize {
        self.places.len()
    }

    /// Whether this rank has a row, by its place in the order of elimination, in its subtrees or in the top.
    pub(super) fn has_row(&self, row: usize) -> bool {
        match self.places[row] {
            Place::Subtree { rank, .. } => rank == self.comm.rank() as u32,
            Place::Top(_) => true,
        }
    }

    /// Whether it is this rank that tells the others about a row.
    pub(super) fn tells_row(&self, row: usize) -> bool {
        match self.places[row] {
            Place::Subtree { rank, .. } => rank == self.comm.rank() as u32,
            Place::Top(_) => self.comm.rank() == 0,
        }
    }

    /// Whether it is this rank that tells the others about the row of a dof.
    pub fn tells(&self, dof: u32) -> bool {
        self.tells_row(self.symbolic.position[dof as usize] as usize)
    }

    /// The ranks.
    pub fn comm(&self) -> &SimpleCommunicator {
        &self.comm
    }

    /// Where a dof of the matrix is kept.
    pub fn place(&self, dof: u32) -> Place {
        self.places[self.symbolic.position[dof as usize] as usize]
    }

    /// Number of rows in this rank's subtrees and in the top.
    pub fn sizes(&self) -> (usize, usize) {
        (self.own_rows.len(), self.top_rows.len())
    }

    /// The number of the first row of this rank's subtrees in vectors that no rank has whole.
    pub fn first_own(&self) -> u32 {
        match self.own_rows.first().map(|&row| self.places[row as usize]) {
            Some(Place::Subtree { number, .. }) => number,
            _ => 0,
        }
    }

    /// The dofs of this rank's subtrees, in the order in which their entries are kept.
    pub fn own_dofs(&self) -> impl Iterator<Item = u32> + '_ {
        self.own_rows
            .iter()
            .map(|&p| self.symbolic.interior[p as usize])
    }

    /// The dofs of the top, in the order in which their entries are kept.
    pub fn top_dofs(&self) -> impl Iterator<Item = u32> + '_ {
        self.top_rows
            .iter()
            .map(|&p| self.symbolic.interior[p as usize])
    }

    pub(super) fn fronts<'a>(
        &'a self,
        numbers: &'a [usize],
    ) -> impl DoubleEndedIterator<Item = &'a Front> + 'a {
        numbers.iter().map(|&f| &self.symbolic.fronts[f])
    }
}

/// A rank has its share if it has this many times the average.
const FULL: f64 = 1.1;

/// For the subtree under each front the rank where most of its rows are at home; empty without homes.
fn home_of_subtrees(fronts: &[Front], homes: &[u32]) -> Vec<u32> {
    if homes.is_empty() {
        return Vec::new();
    }
    // (rank, number of rows) for each subtree, until its parent takes them.
    let mut counts: Vec<BTreeMap<u32, usize>> = vec![BTreeMap::new(); fronts.len()];
    let mut out = Vec::with_capacity(fronts.len());
    for (f, front) in fronts.iter().enumerate() {
        for &home in &homes[front.start..front.end] {
            *counts[f].entry(home).or_default() += 1;
        }
        let mine = std::mem::take(&mut counts[f]);
        let most = mine.iter().max_by_key(|(rank, n)| (**n, Reverse(**rank)));
        out.push(most.map_or(0, |m| *m.0));
        if let Some(parent) = front.parent {
            for (rank, n) in mine {
                *counts[parent].entry(rank).or_default() += n;
            }
        }
    }
    out
}

/// The rank of each front, `None` for those of the top: the cut through the tree with the shortest way, counted in
/// operations of the top and of the rank that has most, among cuts into at least [`least_subtrees`]. A subtree goes to
/// the rank where most of its rows are at home, by `homes`, unless that rank has more than its share already.
fn deal(fronts: &[Front], ranks: usize, homes: &[u32]) -> Vec<Option<u32>> {
    let home = home_of_subtrees(fronts, homes);
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); fronts.len()];
    let mut work: Vec<f64> = fronts.iter().map(Front::flops).collect();
    // The largest subtree comes first; of equal ones, the first.
    let mut subtrees: BinaryHeap<(Flops, Reverse<usize>)> = BinaryHeap::new();
    for (f, front) in fronts.iter().enumerate() {
        match front.parent {
            Some(t) => {
                work[t] += work[f];
                children[t].push(f);
            }
            None => subtrees.push((Flops(work[f]), Reverse(f))),
        }
    }
    let mut top = 0.0;
    let mut best: Option<(f64, Vec<(usize, u32)>)> = None;
    let mut next = 0;
    loop {
        let largest = subtrees.peek().map(|s| s.1 .0);
        let divisible = largest.filter(|&f| ranks > 1 && !children[f].is_empty());
        let enough = subtrees.len() as f64 >= least_subtrees(ranks as f64);
        // Few cuts are tried all, of many one in ten.
        if divisible.is_none() || (enough && subtrees.len() >= next) {
            next = subtrees.len() + subtrees.len() / 10;
            let (most, dealt) = dealt(subtrees.clone().into_sorted_vec(), ranks, &home);
            if best
                .as_ref()
                .is_none_or(|(shortest, _)| top + most < *shortest)
            {
                best = Some((top + most, dealt));
            }
        }
        // More pieces than this are smaller than what they could balance.
        let Some(f) = divisible.filter(|_| subtrees.len() < 16 * ranks) else {
            break;
        };
        subtrees.pop();
        subtrees.extend(children[f].iter().map(|&c| (Flops(work[c]), Reverse(c))));
        top += fronts[f].flops();
    }
    let mut rank = vec![None; fronts.len()];
    for (f, r) in best.map_or(Vec::new(), |b| b.1) {
        rank[f] = Some(r);
    }
    // Parents come after their children: from the roots of the subtrees down.
    for f in (0..fronts.len()).rev() {
        if let (None, Some(t)) = (rank[f], fronts[f].parent) {
            rank[f] = rank[t];
        }
    }
    rank
}

/// Number of subtrees and number of rows of the top when so many ranks share a factor.
#[cfg(test)]
pub fn shared_parts(symbolic: &Symbolic, ranks: usize) -> (usize, usize) {
    let fronts = &symbolic.fronts;
    let dealt = deal(fronts, ranks, &[]);
    let above = |f: &Front| f.parent.is_none_or(|t| dealt[t].is_none());
    let pairs = || fronts.iter().zip(&dealt);
    let roots = pairs().filter(|(f, rank)| rank.is_some() && above(f));
    let top = pairs().filter(|(_, rank)| rank.is_none());
    (roots.count(), top.map(|(f, _)| f.width()).sum())
}

/// The least number of subtrees for so many ranks. Vectors go to and from the owners of subtrees: the more of these,
/// the fewer others an owner has to do with, but the larger is the top, with which every rank solves. This power of the
/// ranks has the shortest iterations in the model of `study scaling` around 10⁵ ranks.
pub fn least_subtrees(ranks: f64) -> f64 {
    ranks.powf(0.6)
}

/// Operations, ordered by their number.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Flops(f64);

impl Eq for Flops {}

impl Ord for Flops {
    fn cmp(&self, other: &Flops) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Flops {
    fn partial_cmp(&self, other: &Flops) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The rank of each subtree, and the most that a rank has. Subtrees come by increasing work.
fn dealt(
    subtrees: Vec<(Flops, Reverse<usize>)>,
    ranks: usize,
    home: &[u32],
) -> (f64, Vec<(usize, u32)>) {
    let share = subtrees.iter().map(|s| s.0 .0).sum::<f64>() / ranks as f64;
    let mut loads = vec![0.0; ranks];
    // The rank with the least load comes first. Entries are out of date if the load has changed since.
    let mut least: BinaryHeap<Reverse<(Flops, usize)>> =
        (0..ranks).map(|r| Reverse((Flops(0.0), r))).collect();
    let mut out = Vec::with_capacity(subtrees.len());
    for (Flops(work), Reverse(f)) in subtrees.into_iter().rev() {
        let to = match home.get(f) {
            Some(&h) if loads[h as usize] + work <= FULL * share => h as usize,
            _ => loop {
                let Reverse((load, r)) = *least.peek().expect("every rank has an entry");
                if load.0 == loads[r] {
                    break r;
                }
                least.pop();
            },
        };
        loads[to] += work;
        least.push(Reverse((Flops(loads[to]), to)));
        out.push((f, to as u32));
    }
    (loads.iter().fold(0.0, |a, b| a.max(*b)), out)
}

/// The place of each row, in the order of elimination.
fn places(fronts: &[Front], ranks: &[Option<u32>], size: usize) -> Vec<Place> {
    let fronts = || fronts.iter().zip(ranks);
    // The number of the next row of each rank.
    let mut next = vec![0u32; size + 1];
    for (front, rank) in fronts() {
        if let Some(r) = rank {
            next[*r as usize + 1] += front.width() as u32;
        }
    }
    for r in 0..size {
        next[r + 1] += next[r];
    }
    let mut of_top = 0;
    let mut places = Vec::new();
    for (front, rank) in fronts() {
        for _ in 0..front.width() {
            let counter = rank.map_or(&mut of_top, |r| &mut next[r as usize]);
            let number = *counter;
            *counter += 1;
            places.push(match *rank {
                Some(rank) => Place::Subtree { rank, number },
                None => Place::Top(number),
            });
        }
    }
    places
}

#[cfg(test)]
#[path = "../../tests/inside/cholesky/team.rs"]
mod tests;
