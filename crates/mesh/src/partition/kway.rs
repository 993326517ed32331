//! Many parts at once: the graph is coarsened, divided where it is small, and refined on the way back.

use std::collections::BinaryHeap;

use super::bisect::divide;
use super::graph::{Dice, Graph};
use super::pairs::{improve, GraphPartition};

/// Vertices for each part on the coarsest level.
const COARSEST: usize = 24;

/// Rounds of refinement on every level.
const ROUNDS: usize = 8;

/// How much more than the mean a part may have, in thousandths.
const PLAY: i64 = 30;

/// How much less than the mean a part may become for the sake of a shorter cut, in thousandths.
const SHRINK: i64 = 150;

/// The part of every vertex, in 0..n. Parts of neighbouring numbers are near each other. Parts may be empty where
/// there are few vertices or heavy ones, and need not be connected.
pub(super) fn parts(graph: &Graph, n: usize, dice: &mut Dice) -> Vec<u32> {
    if n <= 1 {
        return vec![0; graph.n()];
    }
    let target = (COARSEST * n).max(200);
    let heaviest = (graph.total() * 3 / 2 / target as i64).max(1);
    let levels = graph.coarsen(target, heaviest, dice);
    let at = |k: usize| if k == 0 { graph } else { &levels[k - 1].0 };
    let mut part = divide(at(levels.len()), n, 0, dice);
    for k in (0..=levels.len()).rev() {
        KwayRefinement::new(at(k), &mut part, n).run();
        if k > 0 {
            part = levels[k - 1].1.iter().map(|&v| part[v as usize]).collect();
        }
    }
    part
}

struct KwayRefinement<'a> {
    graph: &'a Graph,
    part: &'a mut [u32],
    sizes: Vec<i64>,
    counts: Vec<u32>,
    limit: i64,
    least: i64,
    /// Weight of the edges from a vertex to each part, and the parts where it is not 0.
    pull: Vec<i64>,
    pulling: Vec<u32>,
}

/// A move that is worth trying: how much shorter it makes the cut, the vertex, and the state that it was found in.
type Try = (i64, u32, u32);

impl<'a> KwayRefinement<'a> {
    fn new(graph: &'a Graph, part: &'a mut [u32], n: usize) -> KwayRefinement<'a> {
        let mut sizes = vec![0; n];
        let mut counts = vec![0; n];
        for (&p, &s) in part.iter().zip(&graph.size) {
            sizes[p as usize] += s;
            counts[p as usize] += 1;
        }
        let total = graph.total();
        let heaviest = graph.size.iter().copied().max().unwrap_or(0);
        let mean = total / n as i64;
        let limit = (mean + mean * PLAY / 1000).max(mean + heaviest / 2) + 1;
        let least = mean - mean * SHRINK / 1000;
        KwayRefinement {
            graph,
            part,
            sizes,
            counts,
            limit,
            least,
            pull: vec![0; n],
            pulling: Vec::new(),
        }
    }

    fn run(&mut self) {
        for _ in 0..ROUNDS {
            if !self.round() {
                break;
            }
        }
        improve(&mut GraphPartition {
            graph: self.graph,
            part: self.part,
            sizes: &mut self.sizes,
            counts: &mut self.counts,
            limit: self.limit,
            least: self.least,
        });
    }

    /// Fills `pull` for a vertex. Tells whether it has a neighbour in another part.
    fn look(&mut self, v: usize) -> bool {
        self.pulling.iter().for_each(|&p| self.pull[p as usize] = 0);
        self.pulling.clear();
        for (w, bond) in self.graph.bonds(v) {
            let p = self.part[w];
            if self.pull[p as usize] == 0 {
                self.pulling.push(p);
            }
            self.pull[p as usize] += bond;
        }
        self.pulling.iter().any(|&p| p != self.part[v])
    }

    /// The largest possible gain of a vertex; `None` inside a part.
    fn hope(&mut self, v: usize) -> Option<i64> {
        if !self.look(v) {
            return None;
        }
        let own = self.part[v];
        let others = self.pulling.iter().filter(|&&p| p != own);
        let most = others.map(|&p| self.pull[p as usize]).max()?;
        Some(most - self.pull[own as usize])
    }

    /// The part that a vertex had better move to.
    fn goal(&mut self, v: usize) -> Option<u32> {
        self.look(v);
        let own = self.part[v] as usize;
        let s = self.graph.size[v];
        let crowded = self.sizes[own] > self.limit;
        let mut best: Option<((i64, i64), u32)> = None;
        for &p in self.pulling.iter().filter(|&&p| p as usize != own) {
            let after = self.sizes[p as usize] + s;
            let gain = self.pull[p as usize] - self.pull[own];
            let left = self.sizes[own] - s;
            let evens = after <= left;
            let fits = after <= self.limit && left >= self.least;
            let good = match (fits || evens, gain.signum()) {
                (true, 1) => true,
                (true, 0) => evens,
                _ => crowded && evens,
            };
            let score = (gain, -after);
            if good && best.is_none_or(|b| score > b.0) {
                best = Some((score, p));
            }
        }
        best.map(|b| b.1)
    }

    /// One round: every vertex moves at most once. Tells whether one did.
    fn round(&mut self) -> bool {
        let n = self.graph.n();
        let mut open: BinaryHeap<Try> = BinaryHeap::new();
        // How often a vertex has been looked at again; the last number says that it has moved.
        let mut state = vec![0u32; n];
        for v in 0..n {
            if let Some(gain) = self.hope(v) {
                if gain >= 0 || self.sizes[self.part[v] as usize] > self.limit {
                    open.push((gain, v as u32, 0));
                }
            }
        }
        let mut moved = false;
        while let Some((_, v, found_in)) = open.pop() {
            let v = v as usize;
            if state[v] != found_in || self.counts[self.part[v] as usize] == 1 {
                continue;
            }
            let Some(goal) = self.goal(v) else { continue };
            let (from, to) = (self.part[v] as usize, goal as usize);
            self.sizes[from] -= self.graph.size[v];
            self.sizes[to] += self.graph.size[v];
            self.counts[from] -= 1;
            self.counts[to] += 1;
            self.part[v] = goal;
            state[v] = u32::MAX;
            moved = true;
            let row = self.graph.start[v] as usize..self.graph.start[v + 1] as usize;
            for k in row {
                let w = self.graph.near[k] as usize;
                if state[w] == u32::MAX {
                    continue;
                }
                if let Some(gain) = self.hope(w) {
                    if gain >= 0 || self.sizes[self.part[w] as usize] > self.limit {
                        state[w] += 1;
                        open.push((gain, w as u32, state[w]));
                    }
                }
            }
        }
        moved
    }
}
