//! Improvements to the parts of a graph partitioner: every part in one piece, none empty or too small, and smooth rims.
//!
//! From the second step on, a cell moves only to a part that it shares a side with, and only if the part that it leaves
//! stays connected: one piece stays one piece.

use std::collections::{BTreeMap, VecDeque};

use super::adjacency::Adjacency;
use crate::cells::Cells;
use base::linalg::lists::Lists;

/// Cells that are visited to see whether a part stays connected without a cell. A ring around a node or an edge of the
/// mesh has fewer. If more were needed, the cell stays.
const NEAR: usize = 150;

/// Rounds of moves that even out the sizes of the parts.
const EVENING: usize = 30;

/// Rounds of smoothing.
const SWEEPS: usize = 3;

/// How much more than the mean a part may have, in thousandths, when sizes are evened out and when rims are smoothed.
const EVEN: i64 = 45;
const SMOOTH: i64 = 75;

/// A part with less than this of the mean is too small, and smoothing leaves a part at least that, in thousandths.
const SMALL: i64 = 600;
const LEFT: i64 = 800;

pub(super) struct PartitionRefiner<'a> {
    adjacency: &'a Adjacency,
    /// Work of each cell.
    work: &'a [i64],
    pub part: Vec<u32>,
    sizes: Vec<i64>,
    counts: Vec<u32>,
    mean: i64,
    heaviest: i64,
    /// Marks of a search: the number of the search that met a cell last.
    met: Vec<u32>,
    search: u32,
}

impl<'a> PartitionRefiner<'a> {
    pub fn new(
        adjacency: &'a Adjacency,
        work: &'a [i64],
        part: Vec<u32>,
        n: usize,
    ) -> PartitionRefiner<'a> {
        let mut sizes = vec![0; n];
        let mut counts = vec![0; n];
        for (&p, &w) in part.iter().zip(work) {
            sizes[p as usize] += w;
            counts[p as usize] += 1;
        }
        let mean = (work.iter().sum::<i64>() / n.max(1) as i64).max(1);
        let heaviest = work.iter().copied().max().unwrap_or(0);
        let met = vec![0; part.len()];
        PartitionRefiner {
            adjacency,
            work,
            part,
            sizes,
            counts,
            mean,
            heaviest,
            met,
            search: 0,
        }
    }

    fn limit(&self, play: i64) -> i64 {
        // One cell more than the mean cannot always be avoided.
        (self.mean + self.mean * play / 1000).max(self.mean + self.heaviest)
    }

    fn change(&mut self, c: usize, to: u32) {
        let from = std::mem::replace(&mut self.part[c], to) as usize;
        self.sizes[from] -= self.work[c];
        self.sizes[to as usize] += self.work[c];
        self.counts[from] -= 1;
        self.counts[to as usize] += 1;
    }

    /// The cells of the part of `start` that hang together with it, at most `most` of them; marks them.
    fn piece(&mut self, start: u32, most: usize) -> Vec<u32> {
        let own = self.part[start as usize];
        let mut cells = vec![start];
        self.met[start as usize] = self.search;
        let mut next = 0;
        while next < cells.len() && cells.len() < most {
            let c = cells[next] as usize;
            next += 1;
            for d in self.adjacency.neighbours(c) {
                if self.part[d as usize] == own && self.met[d as usize] != self.search {
                    self.met[d as usize] = self.search;
                    cells.push(d);
                }
            }
        }
        cells
    }

    /// All connected pieces of all parts.
    fn pieces(&mut self) -> Vec<Vec<u32>> {
        self.search += 1;
        let mut pieces = Vec::new();
        for c in 0..self.part.len() as u32 {
            if self.met[c as usize] != self.search {
                pieces.push(self.piece(c, usize::MAX));
            }
        }
        pieces
    }

    /// Gives every part at least one cell: a part without any gets half of the heaviest part that can be cut.
    pub fn fill(&mut self) {
        for empty in 0..self.counts.len() {
            if self.counts[empty] > 0 {
                continue;
            }
            let rich = (0..self.counts.len()).filter(|&p| self.counts[p] > 1);
            let Some(rich) = rich.max_by_key(|&p| (self.sizes[p], usize::MAX - p)) else {
                return;
            };
            let first = self.part.iter().position(|&p| p as usize == rich);
            let Some(first) = first else { return };
            // The cell that a search meets last lies at an end; cells near it are taken.
            self.search += 1;
            let reached = self.piece(first as u32, usize::MAX);
            let end = reached[reached.len() - 1];
            self.search += 1;
            let ordered = self.piece(end, usize::MAX);
            let (half, count) = (self.sizes[rich] / 2, self.counts[rich]);
            for (taken, c) in (0..).zip(ordered) {
                if taken + 1 == count || (taken > 0 && self.sizes[empty] >= half) {
                    break;
                }
                self.change(c as usize, empty as u32);
            }
        }
    }

    /// Makes every part connected: of its pieces it keeps the heaviest, and the others go to the neighbours that they
    /// share most sides with.
    pub fn connect(&mut self) {
        loop {
            let pieces = self.pieces();
            let weight =
                |piece: &Vec<u32>| piece.iter().map(|&c| self.work[c as usize]).sum::<i64>();
            let mut kept: Vec<Option<(i64, usize)>> = vec![None; self.sizes.len()];
            for (k, piece) in pieces.iter().enumerate() {
                let best = &mut kept[self.part[piece[0] as usize] as usize];
                let w = weight(piece);
                if best.is_none_or(|b| w > b.0) {
                    *best = Some((w, k));
                }
            }
            let mut moved = false;
            for (k, piece) in pieces.iter().enumerate() {
                let own = self.part[piece[0] as usize];
                if kept[own as usize].is_some_and(|b| b.1 == k) {
                    continue;
                }
                let mut shared: BTreeMap<u32, usize> = BTreeMap::new();
                for &c in piece {
                    for d in self.adjacency.neighbours(c as usize) {
                        let p = self.part[d as usize];
                        if p != own {
                            *shared.entry(p).or_default() += 1;
                        }
                    }
                }
                let most = shared
                    .iter()
                    .max_by_key(|(&p, &n)| (n, -self.sizes[p as usize]));
                if let Some((&to, _)) = most {
                    piece.iter().for_each(|&c| self.change(c as usize, to));
                    moved = true;
                }
            }
            if !moved {
                return;
            }
        }
    }

    /// Whether the part of `c` stays connected, and is left, if `c` leaves it. May say no where a longer search would
    /// say yes.
    fn may_leave(&mut self, c: usize) -> bool {
        let own = self.part[c];
        let mates = self
            .adjacency
            .neighbours(c)
            .filter(|&d| self.part[d as usize] == own);
        let mut mates: Vec<u32> = mates.collect();
        mates.sort_unstable();
        mates.dedup();
        match mates[..] {
            [] => return false,
            [_] => return true,
            _ => {}
        }
        self.search += 1;
        self.met[c] = self.search;
        let mut left = mates.len() - 1;
        let mut queue = VecDeque::from([mates[0]]);
        self.met[mates[0] as usize] = self.search;
        let mut visited = 0;
        while let Some(d) = queue.pop_front() {
            visited += 1;
            if visited > NEAR {
                return false;
            }
            for e in self.adjacency.neighbours(d as usize) {
                if self.part[e as usize] != own || self.met[e as usize] == self.search {
                    continue;
                }
                self.met[e as usize] = self.search;
                if mates.binary_search(&e).is_ok() {
                    left -= 1;
                    if left == 0 {
                        return true;
                    }
                }
                queue.push_back(e);
            }
        }
        false
    }

    /// The other parts that a cell shares sides with: how many more sides it shares with them than with its own.
    fn gains(&self, c: usize) -> Vec<(u32, i64)> {
        let own = self.part[c];
        let mut sides: Vec<(u32, i64)> = Vec::new();
        let mut inside = 0;
        for d in self.adjacency.neighbours(c) {
            let p = self.part[d as usize];
            if p == own {
                inside += 1;
            } else if let Some(known) = sides.iter_mut().find(|s| s.0 == p) {
                known.1 += 1;
            } else {
                sides.push((p, 1));
            }
        }
        sides.iter_mut().for_each(|s| s.1 -= inside);
        sides
    }

    /// Moves cells from parts that are too large to smaller neighbours, and into parts that are too small. Cells whose
    /// move makes rims shorter go first.
    pub fn even(&mut self) {
        let (limit, small) = (self.limit(EVEN), self.mean * SMALL / 1000);
        for round in 0..EVENING {
            let least = [1, 0, -1, -2, -6][round.min(4)];
            let mut moved = false;
            let uneven = self.sizes.iter().any(|&s| s > limit || s < small);
            if !uneven {
                return;
            }
            for c in 0..self.part.len() {
                let own = self.part[c] as usize;
                let w = self.work[c];
                let too_large = self.sizes[own] > limit;
                if !too_large && self.sizes[own] - w <= small {
                    continue;
                }
                let gains = self.gains(c);
                let fits = |&&(p, gain): &&(u32, i64)| {
                    let size = self.sizes[p as usize];
                    let wanted = too_large || size < small;
                    wanted && gain >= least && size + w < self.sizes[own]
                };
                let best = gains
                    .iter()
                    .filter(fits)
                    .max_by_key(|g| (g.1, -self.sizes[g.0 as usize]));
                let Some(&(to, _)) = best else { continue };
                if self.may_leave(c) {
                    self.change(c, to);
                    moved = true;
                }
            }
            if !moved && least < -2 {
                return;
            }
        }
    }

    /// Smooths rims: a cell moves where fewer subdomains then share nodes, or as many and parts share fewer sides.
    /// Tells how many copies of nodes were saved.
    pub fn smooth(&mut self, cells: &Cells, around: &Lists) -> i64 {
        let limit = self.limit(SMOOTH);
        let mut saved = 0;
        for _ in 0..SWEEPS {
            let mut moved = false;
            for c in 0..self.part.len() {
                let own = self.part[c] as usize;
                let gains = self.gains(c);
                if gains.is_empty() || self.sizes[own] - self.work[c] < self.mean * LEFT / 1000 {
                    continue;
                }
                let alone = self.nodes_without(cells, around, c, own as u32);
                let mut best: Option<((i64, i64), u32)> = None;
                for (p, gain) in gains {
                    if self.sizes[p as usize] + self.work[c] > limit {
                        continue;
                    }
                    let copies = alone - self.nodes_without(cells, around, c, p);
                    let score = (copies, gain);
                    if score > (0, 0) && best.is_none_or(|b| score > b.0) {
                        best = Some((score, p));
                    }
                }
                let Some(((copies, _), to)) = best else {
                    continue;
                };
                if self.may_leave(c) {
                    self.change(c, to);
                    saved += copies;
                    moved = true;
                }
            }
            if !moved {
                break;
            }
        }
        saved
    }

    /// The nodes of `c` that no other cell of part `p` has.
    fn nodes_without(&self, cells: &Cells, around: &Lists, c: usize, p: u32) -> i64 {
        let lacks = |&&node: &&u32| {
            let mut having = around.at(node as usize).iter();
            !having.any(|&d| d as usize != c && self.part[d as usize] == p)
        };
        cells.nodes(c).iter().filter(lacks).count() as i64
    }
}
