//! Which rank eliminates which front.
//!
//! Subtrees of the elimination tree are dealt out to the ranks. A front above them belongs to a rank that has one of
//! its children, so that a rank has its subtrees and a part of the way from there to the root.

use std::cmp::{Ordering, Reverse};
use std::collections::{BTreeMap, BinaryHeap};

use super::symbolic::Front;

/// A rank has its share if it has this many times the average.
const FULL: f64 = 1.1;

/// A finer cut has more messages, and bodies that are not with their subtree: its way has to be so much shorter.
const SHORTER: f64 = 0.95;

/// Solves for each factorisation, four for an iteration: what is dealt out is the work of both.
const SOLVES: f64 = 20.0;

/// Number of operations of a factorisation in the time in which a solve reads an entry of the factor, up and down.
const READ: f64 = 40.0;

/// Number of operations of a factorisation in the time in which a number goes from one rank to another.
const SENT: f64 = 20.0;

/// Number of operations of a factorisation in the time in which an empty message goes from one rank to another.
const LATENCY: f64 = 4e4;

/// The work of a front.
fn work_of(front: &Front) -> f64 {
    let (w, m) = (front.width() as f64, front.below.len() as f64);
    front.flops() + SOLVES * READ * w * (0.5 * w + m)
}

/// The cost of the messages between a front and its parent: its update, and in solves the way there and back.
fn way_of(front: &Front) -> f64 {
    let m = front.below.len() as f64;
    SENT * 0.5 * m * m + SOLVES * 2.0 * (LATENCY + SENT * m)
}

/// Who has a front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrontOwner {
    /// The rank that eliminates it.
    pub rank: u32,
    /// Whether it is above the subtrees that are dealt out.
    pub above: bool,
}

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

/// Deals out the fronts: of the cuts through the tree into at least as many subtrees as there are ranks, where there
/// are so many, the one with which a factorisation and its solves are done first. A subtree goes to the rank where most
/// of its rows are at home, by `homes`, unless that rank has more than its share already.
pub fn deal(fronts: &[Front], ranks: usize, homes: &[u32]) -> Vec<FrontOwner> {
    let home = home_of_subtrees(fronts, homes);
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); fronts.len()];
    let mut work: Vec<f64> = fronts.iter().map(work_of).collect();
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
    let mut schedule = Schedule {
        fronts,
        children: &children,
        ready: vec![0.0; ranks],
        done: vec![0.0; fronts.len()],
        rank: vec![0; fronts.len()],
    };
    let mut above: Vec<usize> = Vec::new();
    // Subtrees that are single fronts.
    let mut single: Vec<(Flops, Reverse<usize>)> = Vec::new();
    let mut best: Option<TreeCut> = None;
    let mut next = 0;
    loop {
        let is_single = |f: &(Flops, Reverse<usize>)| children[f.1 .0].is_empty();
        while subtrees.peek().is_some_and(is_single) {
            single.extend(subtrees.pop());
        }
        let n = subtrees.len() + single.len();
        // More pieces than this are smaller than what they could balance.
        let divisible = ranks > 1 && n < 16 * ranks && !subtrees.is_empty();
        // Few cuts are tried all, of many one in ten.
        if !divisible || (n >= ranks && n >= next) {
            next = n + n / 10;
            let mut all: Vec<_> = subtrees.iter().chain(&single).copied().collect();
            all.sort_unstable();
            let dealt = dealt(all, ranks, &home);
            let end = schedule.run(&dealt, &work, &mut above);
            if best.as_ref().is_none_or(|b| end < SHORTER * b.end) {
                let above = above.clone();
                best = Some(TreeCut { end, dealt, above });
            }
        }
        let Some((_, Reverse(f))) = subtrees.pop().filter(|_| divisible) else {
            break;
        };
        subtrees.extend(children[f].iter().map(|&c| (Flops(work[c]), Reverse(c))));
        above.push(f);
    }
    let best = best.expect("the last cut is tried");
    let (dealt, mut above) = (best.dealt, best.above);
    schedule.run(&dealt, &work, &mut above);
    let mut shares: Vec<Option<FrontOwner>> = vec![None; fronts.len()];
    let share = |rank: u32, above: bool| Some(FrontOwner { rank, above });
    dealt
        .iter()
        .for_each(|&(f, rank)| shares[f] = share(rank, false));
    above
        .iter()
        .for_each(|&f| shares[f] = share(schedule.rank[f], true));
    // Parents come after their children: from the roots of the subtrees down.
    for f in (0..fronts.len()).rev() {
        if let (None, Some(t)) = (shares[f], fronts[f].parent) {
            shares[f] = shares[t];
        }
    }
    let all = shares.into_iter().map(|s| s.expect("every front is dealt"));
    all.collect()
}

/// A cut through the tree.
struct TreeCut {
    /// When all is done, in operations.
    end: f64,
    /// The subtrees below it with their ranks, and the fronts above it.
    dealt: Vec<(usize, u32)>,
    above: Vec<usize>,
}

/// When fronts are done, counted in operations.
struct Schedule<'a> {
    fronts: &'a [Front],
    children: &'a [Vec<usize>],
    /// When each rank has done what it has so far.
    ready: Vec<f64>,
    /// When a front is eliminated, and by whom.
    done: Vec<f64>,
    rank: Vec<u32>,
}

impl Schedule<'_> {
    /// Chooses ranks for the fronts `above` the subtrees, which it sorts: of the ranks that have a child, the one that
    /// can begin first. Returns when all is done.
    fn run(&mut self, dealt: &[(usize, u32)], work: &[f64], above: &mut [usize]) -> f64 {
        self.ready.fill(0.0);
        let mut subtrees = dealt.to_vec();
        subtrees.sort_unstable();
        for (f, rank) in subtrees {
            let ready = &mut self.ready[rank as usize];
            *ready += work[f];
            (self.done[f], self.rank[f]) = (*ready, rank);
        }
        above.sort_unstable();
        for &f in &*above {
            let begin = |rank: u32| {
                self.children[f]
                    .iter()
                    .fold(self.ready[rank as usize], |at, &c| {
                        let way = if self.rank[c] == rank {
                            0.0
                        } else {
                            way_of(&self.fronts[c])
                        };
                        at.max(self.done[c] + way)
                    })
            };
            let of_children = self.children[f].iter().map(|&c| self.rank[c]);
            let (at, rank) = of_children
                .map(|rank| (begin(rank), rank))
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
                .expect("a front that is divided has children");
            let end = at + work_of(&self.fronts[f]);
            (self.done[f], self.rank[f]) = (end, rank);
            self.ready[rank as usize] = end;
        }
        self.ready.iter().fold(0.0, |a, b| a.max(*b))
    }
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

/// The rank of each subtree. Subtrees come by increasing work.
fn dealt(subtrees: Vec<(Flops, Reverse<usize>)>, ranks: usize, home: &[u32]) -> Vec<(usize, u32)> {
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
    out
}

#[cfg(test)]
#[path = "../tests/deal.rs"]
mod tests;
