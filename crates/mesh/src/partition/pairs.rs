//! Moves between two neighbouring parts at a time, beyond what is a gain at once.
//!
//! As in a cut in two (`bisect.rs`), the best vertex moves even if it makes the cut longer, and the shortest cut that
//! was passed is kept. Rims become shorter that no single move could improve: straight ones on grids above all.

use std::collections::BinaryHeap;

use super::graph::Graph;

/// Rounds over all pairs of neighbours. From the second on, only pairs with a part that changed take part.
const ROUNDS: usize = 2;

/// Moves after the best state until the search for a better one is given up: this many, or one for so many vertices on
/// the rim of the pair.
const PATIENCE: usize = 25;
const PATIENCE_OF_RIM: usize = 8;

/// The parts of a graph and their sizes.
pub(super) struct GraphPartition<'a> {
    pub graph: &'a Graph,
    pub part: &'a mut [u32],
    pub sizes: &'a mut [i64],
    pub counts: &'a mut [u32],
    /// The largest size allowed, and the smallest that a part may shrink to.
    pub limit: i64,
    pub least: i64,
}

/// The state of a vertex in a search; valid if `search` is that of the present search.
#[derive(Clone, Copy, Default)]
struct VisitedVertex {
    search: u32,
    gain: i64,
    moved: bool,
}

/// Improves all pairs of neighbours.
pub(super) fn improve(parts: &mut GraphPartition) {
    let mut seen = vec![VisitedVertex::default(); parts.graph.n()];
    let mut changed = vec![true; parts.sizes.len()];
    let mut search = 0;
    for _ in 0..ROUNDS {
        let rims = rims(parts, &changed);
        changed.fill(false);
        for rim in rims.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            search += 1;
            let pair = [rim[0].0, rim[0].1];
            if between(parts, pair, rim.iter().map(|r| r.2), &mut seen, search) {
                pair.iter().for_each(|&p| changed[p as usize] = true);
            }
        }
    }
}

/// The vertices with neighbours in another part, for every pair of parts of which one changed.
fn rims(parts: &GraphPartition, changed: &[bool]) -> Vec<(u32, u32, u32)> {
    let mut rims = Vec::new();
    for v in 0..parts.graph.n() {
        let own = parts.part[v];
        let first = rims.len();
        for (w, _) in parts.graph.bonds(v) {
            let other = parts.part[w];
            if other != own && (changed[own as usize] || changed[other as usize]) {
                let entry = (own.min(other), own.max(other), v as u32);
                if !rims[first..].contains(&entry) {
                    rims.push(entry);
                }
            }
        }
    }
    rims.sort_unstable();
    rims
}

/// Improves the cut between two parts. Tells whether it changed.
fn between(
    parts: &mut GraphPartition,
    pair: [u32; 2],
    rim: impl Iterator<Item = u32>,
    seen: &mut [VisitedVertex],
    search: u32,
) -> bool {
    let side_of = |part: &[u32], v: usize| pair.iter().position(|&p| p == part[v]);
    let mut open = [BinaryHeap::new(), BinaryHeap::new()];
    let mut on_rim = 0;
    for v in rim {
        on_rim += 1;
        if let Some(side) = side_of(parts.part, v as usize) {
            let gain = gain(parts, v as usize, pair[1 - side]);
            seen[v as usize] = VisitedVertex {
                search,
                gain,
                moved: false,
            };
            open[side].push((gain, v));
        }
    }
    let patience = PATIENCE.max(on_rim / PATIENCE_OF_RIM);
    let mut length = 0;
    let state = |parts: &GraphPartition, length: i64| {
        let [a, b] = pair.map(|p| parts.sizes[p as usize]);
        (
            (a - parts.limit).max(0) + (b - parts.limit).max(0),
            length,
            (a - b).abs(),
        )
    };
    let before = state(parts, 0);
    let (mut best, mut kept) = (before, 0);
    let mut moves: Vec<u32> = Vec::new();
    while moves.len() < kept + patience {
        for (side, heap) in open.iter_mut().enumerate() {
            while let Some(&(g, v)) = heap.peek() {
                let known = &seen[v as usize];
                if !known.moved && known.gain == g && parts.part[v as usize] == pair[side] {
                    break;
                }
                heap.pop();
            }
        }
        let candidate = |side: usize| {
            let &(gain, v) = open[side].peek()?;
            let [from, to] = [pair[side], pair[1 - side]].map(|p| p as usize);
            let size = parts.graph.size[v as usize];
            let (left, after) = (parts.sizes[from] - size, parts.sizes[to] + size);
            let fits = (after <= parts.limit && left >= parts.least) || after <= left;
            (fits && parts.counts[from] > 1).then_some((gain, left - after, side))
        };
        let Some((gain_now, _, side)) = candidate(0).max(candidate(1)) else {
            break;
        };
        let Some((_, v)) = open[side].pop() else {
            break;
        };
        shift(parts, v as usize, pair[1 - side]);
        seen[v as usize].moved = true;
        length -= gain_now;
        moves.push(v);
        for (w, bond) in parts.graph.bonds(v as usize) {
            let Some(its) = side_of(parts.part, w) else {
                continue;
            };
            let known = &mut seen[w];
            if known.search != search {
                let gain = gain(parts, w, pair[1 - its]);
                *known = VisitedVertex {
                    search,
                    gain,
                    moved: false,
                };
            } else if known.moved {
                continue;
            } else {
                known.gain += if its == side { 2 * bond } else { -2 * bond };
            }
            open[its].push((known.gain, w as u32));
        }
        let now = state(parts, length);
        if now < best {
            (best, kept) = (now, moves.len());
        }
    }
    for &v in moves[kept..].iter().rev() {
        let back = if parts.part[v as usize] == pair[0] {
            pair[1]
        } else {
            pair[0]
        };
        shift(parts, v as usize, back);
    }
    best < before
}

/// By how much the cut becomes shorter if a vertex moves to a part.
fn gain(parts: &GraphPartition, v: usize, to: u32) -> i64 {
    let own = parts.part[v];
    let worth = |(w, bond): (usize, i64)| match parts.part[w] {
        p if p == to => bond,
        p if p == own => -bond,
        _ => 0,
    };
    parts.graph.bonds(v).map(worth).sum()
}

fn shift(parts: &mut GraphPartition, v: usize, to: u32) {
    let from = std::mem::replace(&mut parts.part[v], to) as usize;
    let (to, size) = (to as usize, parts.graph.size[v]);
    parts.sizes[from] -= size;
    parts.sizes[to] += size;
    parts.counts[from] -= 1;
    parts.counts[to] += 1;
}
