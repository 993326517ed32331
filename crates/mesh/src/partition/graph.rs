//! Weighted graphs and their coarsening.
//!
//! Vertices are matched with neighbours and merged, level by level, until few are left. Everything counts in integers
//! and the random numbers are our own, so that a partition is the same on every machine.

/// Random numbers that are the same everywhere (splitmix64).
pub(super) struct Dice(pub u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.next()) * n as u128) >> 64) as usize
    }

    /// The numbers below `n` in random order.
    pub fn shuffled(&mut self, n: usize) -> Vec<u32> {
        let mut order: Vec<u32> = (0..n as u32).collect();
        for i in (1..n).rev() {
            order.swap(i, self.below(i + 1));
        }
        order
    }
}

/// A symmetric graph without loops in compressed rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Graph {
    pub start: Vec<u32>,
    pub near: Vec<u32>,
    /// Weight of each edge: the number of sides that its ends share.
    pub bond: Vec<u32>,
    /// Weight of each vertex: its work.
    pub size: Vec<i64>,
}

const NONE: u32 = u32::MAX;

impl Graph {
    pub fn n(&self) -> usize {
        self.size.len()
    }

    pub fn total(&self) -> i64 {
        self.size.iter().sum()
    }

    /// The neighbours of `v` with the weights of the edges.
    pub fn bonds(&self, v: usize) -> impl Iterator<Item = (usize, i64)> + '_ {
        let row = self.start[v] as usize..self.start[v + 1] as usize;
        let pairs = self.near[row.clone()].iter().zip(&self.bond[row]);
        pairs.map(|(&w, &b)| (w as usize, i64::from(b)))
    }

    /// The part of the graph between some of its vertices. `place` is `NONE` for all vertices, before and after.
    pub fn between(&self, kept: &[u32], place: &mut [u32]) -> Graph {
        for (&v, k) in kept.iter().zip(0..) {
            place[v as usize] = k;
        }
        let mut out = Graph {
            start: vec![0],
            ..Graph::default()
        };
        for &v in kept {
            for (w, bond) in self.bonds(v as usize) {
                if place[w] != NONE {
                    out.near.push(place[w]);
                    out.bond.push(bond as u32);
                }
            }
            out.start.push(out.near.len() as u32);
            out.size.push(self.size[v as usize]);
        }
        kept.iter().for_each(|&v| place[v as usize] = NONE);
        out
    }

    /// Levels with fewer and fewer vertices, down to about `target`: the coarser graph, and the vertex of it that each
    /// vertex went into. `heaviest` bounds merged vertices.
    pub fn coarsen(&self, target: usize, heaviest: i64, dice: &mut Dice) -> Vec<(Graph, Vec<u32>)> {
        let mut levels: Vec<(Graph, Vec<u32>)> = Vec::new();
        loop {
            let finest = levels.last().map_or(self, |l| &l.0);
            if finest.n() <= target {
                return levels;
            }
            let (map, n) = finest.matching(heaviest, dice);
            if n as f64 > 0.95 * finest.n() as f64 {
                return levels;
            }
            let coarser = finest.merged(&map, n);
            levels.push((coarser, map));
        }
    }

    /// Pairs vertices with the neighbours that they share most with, relative to the sizes of both: merged vertices
    /// stay round and of similar size. Returns the pair of each vertex and the number of pairs and single ones.
    fn matching(&self, heaviest: i64, dice: &mut Dice) -> (Vec<u32>, usize) {
        let mut mate = vec![NONE; self.n()];
        for v in dice.shuffled(self.n()) {
            let v = v as usize;
            if mate[v] != NONE {
                continue;
            }
            let mut best: Option<(f64, usize)> = None;
            for (w, bond) in self.bonds(v) {
                if mate[w] != NONE || self.size[v] + self.size[w] > heaviest {
                    continue;
                }
                // The size of v is the same for all candidates.
                let score = (bond * bond) as f64 / self.size[w] as f64;
                if best.is_none_or(|b| score > b.0) {
                    best = Some((score, w));
                }
            }
            let w = best.map_or(v, |b| b.1);
            mate[v] = w as u32;
            mate[w] = v as u32;
        }
        let mut map = vec![NONE; self.n()];
        let mut n = 0;
        for v in 0..self.n() {
            if map[v] == NONE {
                map[v] = n;
                map[mate[v] as usize] = n;
                n += 1;
            }
        }
        (map, n as usize)
    }

    /// The graph of merged vertices.
    fn merged(&self, map: &[u32], n: usize) -> Graph {
        let mut members = vec![[NONE; 2]; n];
        for (&k, v) in map.iter().zip(0..) {
            let pair = &mut members[k as usize];
            let place = usize::from(pair[0] != NONE);
            pair[place] = v;
        }
        let mut out = Graph {
            start: Vec::with_capacity(n + 1),
            near: Vec::with_capacity(self.near.len() / 2),
            bond: Vec::with_capacity(self.near.len() / 2),
            size: Vec::with_capacity(n),
        };
        out.start.push(0);
        // Where a neighbour stands in the row that is being made.
        let mut place = vec![NONE; n];
        for (k, pair) in members.iter().enumerate() {
            let first = out.near.len();
            let mut size = 0;
            for &v in pair.iter().filter(|&&v| v != NONE) {
                size += self.size[v as usize];
                for (w, bond) in self.bonds(v as usize) {
                    let other = map[w] as usize;
                    if other == k {
                        continue;
                    }
                    let at = place[other] as usize;
                    if place[other] != NONE && at >= first {
                        out.bond[at] += bond as u32;
                    } else {
                        place[other] = out.near.len() as u32;
                        out.near.push(other as u32);
                        out.bond.push(bond as u32);
                    }
                }
            }
            out.start.push(out.near.len() as u32);
            out.size.push(size);
        }
        out
    }
}
