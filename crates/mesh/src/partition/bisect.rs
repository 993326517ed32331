//! Cuts a graph into two, and these into two again.
//!
//! A graph is coarsened, cut where it is small, and the cut improved on the way back by moves of single vertices
//! (Fiduccia and Mattheyses): the best vertex moves even if it makes the cut longer, and the best cut that was passed
//! is kept.

use std::collections::BinaryHeap;

use super::graph::{Dice, Graph};

/// A graph of this many vertices is cut without coarsening.
const SMALL: usize = 80;

/// First cuts that are tried; the best is kept.
const TRIES: usize = 8;

/// Moves after the best cut until the search for a better one is given up.
const PATIENCE: usize = 60;

/// Rounds of moves on every level.
const ROUNDS: usize = 6;

/// Numbers the vertices by parts `first..first + n`. Parts of neighbouring numbers are near each other: the lower half
/// of the numbers is one side of the first cut. A part may stay empty if vertices are few or heavy.
pub(super) fn divide(graph: &Graph, n: usize, first: u32, dice: &mut Dice) -> Vec<u32> {
    let mut part = vec![first; graph.n()];
    if n <= 1 || graph.n() <= 1 {
        return part;
    }
    let lower = n / 2;
    let total = graph.total();
    let wanted = (total as i128 * lower as i128 / n as i128) as i64;
    let side = bisect(graph, wanted, dice);
    let mut place = vec![u32::MAX; graph.n()];
    for (which, n, first) in [
        (false, lower, first),
        (true, n - lower, first + lower as u32),
    ] {
        let chosen = (0..graph.n() as u32).filter(|&v| side[v as usize] == which);
        let kept: Vec<u32> = chosen.collect();
        let inner = divide(&graph.between(&kept, &mut place), n, first, dice);
        kept.iter()
            .zip(inner)
            .for_each(|(&v, p)| part[v as usize] = p);
    }
    part
}

/// The upper side of a cut with about `wanted` below it.
fn bisect(graph: &Graph, wanted: i64, dice: &mut Dice) -> Vec<bool> {
    let heaviest = (graph.total() / 40).max(1);
    let levels = graph.coarsen(SMALL, heaviest, dice);
    let at = |k: usize| if k == 0 { graph } else { &levels[k - 1].0 };
    let mut cut = first_cut(at(levels.len()), wanted, dice);
    for k in (0..levels.len()).rev() {
        let upper = levels[k].1.iter().map(|&v| cut.upper[v as usize]).collect();
        cut = Bisection::new(at(k), upper, wanted);
        cut.improve();
    }
    cut.upper
}

/// The best of some cuts of a small graph: sides that grow around a random vertex.
fn first_cut<'a>(graph: &'a Graph, wanted: i64, dice: &mut Dice) -> Bisection<'a> {
    let mut best: Option<((i64, i64), Bisection)> = None;
    for _ in 0..TRIES {
        let mut cut = Bisection::new(graph, grown(graph, wanted, dice), wanted);
        cut.improve();
        let score = (cut.excess(), cut.length);
        if best.as_ref().is_none_or(|b| score < b.0) {
            best = Some((score, cut));
        }
    }
    best.expect("at least one try").1
}

/// Grows the lower side from a random vertex by the vertex that lengthens the cut least, until it is large enough.
fn grown(graph: &Graph, wanted: i64, dice: &mut Dice) -> Vec<bool> {
    let n = graph.n();
    let mut upper = vec![true; n];
    let mut gain: Vec<i64> = (0..n)
        .map(|v| -graph.bonds(v).map(|b| b.1).sum::<i64>())
        .collect();
    let mut open = BinaryHeap::new();
    let mut size = 0;
    let start = dice.below(n);
    open.push((gain[start], start));
    let mut rest = dice.shuffled(n).into_iter();
    while size < wanted {
        let next = match open.pop() {
            Some((g, v)) if upper[v] && g == gain[v] => Some(v),
            Some(_) => continue,
            // Nothing more can be reached: another start.
            None => rest.by_ref().map(|v| v as usize).find(|&v| upper[v]),
        };
        let Some(v) = next else { break };
        if size + graph.size[v] / 2 > wanted {
            break;
        }
        upper[v] = false;
        size += graph.size[v];
        for (w, bond) in graph.bonds(v) {
            if upper[w] {
                gain[w] += 2 * bond;
                open.push((gain[w], w));
            }
        }
    }
    upper
}

/// A cut in two and what it costs.
struct Bisection<'a> {
    graph: &'a Graph,
    upper: Vec<bool>,
    /// Weight below and above.
    sizes: [i64; 2],
    /// Least and most that is allowed below.
    least: i64,
    most: i64,
    /// Weight of the edges that are cut.
    length: i64,
    /// By how much the cut becomes shorter if a vertex moves.
    gain: Vec<i64>,
}

impl<'a> Bisection<'a> {
    fn new(graph: &'a Graph, upper: Vec<bool>, wanted: i64) -> Bisection<'a> {
        let mut sizes = [0; 2];
        let mut gain = vec![0; graph.n()];
        let mut length = 0;
        for v in 0..graph.n() {
            sizes[usize::from(upper[v])] += graph.size[v];
            for (w, bond) in graph.bonds(v) {
                if upper[v] == upper[w] {
                    gain[v] -= bond;
                } else {
                    gain[v] += bond;
                    length += bond;
                }
            }
        }
        let heaviest = graph.size.iter().copied().max().unwrap_or(0);
        let play = (graph.total() / 200).max(heaviest / 2 + 1);
        let (least, most) = (wanted - play, wanted + play);
        Bisection {
            graph,
            upper,
            sizes,
            least,
            most,
            length: length / 2,
            gain,
        }
    }

    /// How far the sizes are from what is allowed.
    fn excess(&self) -> i64 {
        (self.sizes[0] - self.most)
            .max(self.least - self.sizes[0])
            .max(0)
    }

    fn turn(&mut self, v: usize) {
        let s = self.graph.size[v];
        let from = usize::from(self.upper[v]);
        self.sizes[from] -= s;
        self.sizes[1 - from] += s;
        self.length -= self.gain[v];
        self.gain[v] = -self.gain[v];
        self.upper[v] = !self.upper[v];
        for (w, bond) in self.graph.bonds(v) {
            let same = self.upper[v] == self.upper[w];
            self.gain[w] += if same { -2 * bond } else { 2 * bond };
        }
    }

    fn improve(&mut self) {
        for _ in 0..ROUNDS {
            if !self.round() {
                return;
            }
        }
    }

    /// One round: every vertex moves at most once. Tells whether the cut became better.
    fn round(&mut self) -> bool {
        let n = self.graph.n();
        let mut open = [BinaryHeap::new(), BinaryHeap::new()];
        let unbalanced = self.excess() > 0;
        for v in 0..n {
            let rim = self
                .graph
                .bonds(v)
                .any(|(w, _)| self.upper[w] != self.upper[v]);
            if rim || unbalanced {
                open[usize::from(self.upper[v])].push((self.gain[v], v));
            }
        }
        let mut done = vec![false; n];
        let mut moves: Vec<usize> = Vec::new();
        let before = (self.excess(), self.length);
        let (mut best, mut kept) = (before, 0);
        while moves.len() < kept + PATIENCE.max(n / 100) {
            for (from, heap) in open.iter_mut().enumerate() {
                while let Some(&(g, v)) = heap.peek() {
                    if !done[v] && g == self.gain[v] && usize::from(self.upper[v]) == from {
                        break;
                    }
                    heap.pop();
                }
            }
            let excess = self.excess();
            let fits = |from: usize| {
                let v = open[from].peek()?.1;
                let s = self.graph.size[v];
                let below = self.sizes[0] + if from == 0 { -s } else { s };
                let over = (below - self.most).max(self.least - below).max(0);
                (over == 0 || over < excess).then_some((over < excess, self.gain[v], from))
            };
            let Some((_, _, from)) = fits(0).max(fits(1)) else {
                break;
            };
            let Some((_, v)) = open[from].pop() else {
                break;
            };
            done[v] = true;
            self.turn(v);
            moves.push(v);
            for (w, _) in self.graph.bonds(v) {
                if !done[w] {
                    open[usize::from(self.upper[w])].push((self.gain[w], w));
                }
            }
            let now = (self.excess(), self.length);
            if now < best {
                (best, kept) = (now, moves.len());
            }
        }
        for &v in moves[kept..].iter().rev() {
            self.turn(v);
        }
        best < before
    }
}
