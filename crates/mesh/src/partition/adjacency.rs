//! Which cells share which sides, and what hangs together.

use crate::cells::Cells;
use base::linalg::union_find::UnionFind;

/// The number that stands for "no cell" in [`Adjacency`].
const NONE: u32 = u32::MAX;

/// The cell behind every side of every cell.
///
/// Two sides are the same if they have the same corners. Time and memory grow linearly with the number of cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adjacency {
    /// Where the sides of each cell begin in `behind`, and the end of the last.
    starts: Vec<u32>,
    /// The cell behind each side.
    behind: Vec<u32>,
    /// The sides with one cell only: the cell and the number of its side, in the order of the cells.
    pub boundary: Vec<(u32, u8)>,
    /// Sides of three or more cells, each as a list of cell and side. No sound mesh has such sides: cells overlap or
    /// are there twice. They separate their cells, as if they were boundary, but are not in `boundary`.
    pub crowded: Vec<Vec<(u32, u8)>>,
}

/// A side on its way to its twin.
#[derive(Clone, Copy)]
struct Half {
    /// The corners but the lowest, increasing; the last is `NONE` on sides with fewer corners.
    others: [u32; 3],
    cell: u32,
    side: u8,
}

impl Adjacency {
    /// Pairs the sides of cells of one dimension.
    ///
    /// # Panics
    /// When the cells have 2³² sides or more.
    pub fn new(cells: &Cells) -> Adjacency {
        let mut starts = Vec::with_capacity(cells.len() + 1);
        starts.push(0);
        let mut n_sides = 0;
        for kind in cells.kinds() {
            n_sides += kind.sides().len();
            starts.push(u32::try_from(n_sides).expect("less than 2³² sides"));
        }
        let mut found = Adjacency {
            starts,
            behind: vec![NONE; n_sides],
            boundary: Vec::new(),
            crowded: Vec::new(),
        };
        let mut alone = vec![false; n_sides];
        let (ends, mut halves) = by_lowest_corner(cells, n_sides);
        let mut start = 0;
        for end in ends {
            let bucket = &mut halves[start..end];
            bucket.sort_unstable_by_key(|h| (h.others, h.cell, h.side));
            for same in bucket.chunk_by(|a, b| a.others == b.others) {
                match same {
                    [one] => alone[found.place(one)] = true,
                    [a, b] => {
                        let (at_a, at_b) = (found.place(a), found.place(b));
                        found.behind[at_a] = b.cell;
                        found.behind[at_b] = a.cell;
                    }
                    many => found
                        .crowded
                        .push(many.iter().map(|h| (h.cell, h.side)).collect()),
                }
            }
            start = end;
        }
        for c in 0..cells.len() {
            let sides = found.starts[c] as usize..found.starts[c + 1] as usize;
            let open = sides.zip(0u8..).filter(|(place, _)| alone[*place]);
            found
                .boundary
                .extend(open.map(|(_, side)| (c as u32, side)));
        }
        found
    }

    fn place(&self, half: &Half) -> usize {
        self.starts[half.cell as usize] as usize + usize::from(half.side)
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The cell behind a side of cell `c`; `None` on the boundary.
    pub fn across(&self, c: usize, side: usize) -> Option<u32> {
        Some(self.all(c)[side]).filter(|&d| d != NONE)
    }

    /// The cells that share a side with cell `c`, in the order of its sides.
    pub fn neighbours(&self, c: usize) -> impl Iterator<Item = u32> + '_ {
        self.all(c).iter().copied().filter(|&d| d != NONE)
    }

    fn all(&self, c: usize) -> &[u32] {
        &self.behind[self.starts[c] as usize..self.starts[c + 1] as usize]
    }
}

/// All sides, sorted by their lowest corner, and where those of each corner end.
fn by_lowest_corner(cells: &Cells, n_sides: usize) -> (Vec<usize>, Vec<Half>) {
    let n_nodes = cells.n_nodes();
    let corners = |c: usize, side: usize| {
        let nodes = cells.nodes(c);
        let side = &cells.kind(c).sides()[side];
        let mut all = [NONE; 4];
        for (corner, &p) in all.iter_mut().zip(&side.nodes[..side.kind.corners()]) {
            *corner = nodes[usize::from(p)];
        }
        all.sort_unstable();
        all
    };
    let sides =
        || (0..cells.len()).flat_map(|c| (0..cells.kind(c).sides().len()).map(move |s| (c, s)));
    let mut next = vec![0usize; n_nodes + 1];
    for (c, s) in sides() {
        next[corners(c, s)[0] as usize + 1] += 1;
    }
    for i in 0..n_nodes {
        next[i + 1] += next[i];
    }
    let nothing = Half {
        others: [NONE; 3],
        cell: 0,
        side: 0,
    };
    let mut halves = vec![nothing; n_sides];
    for (c, s) in sides() {
        let [lowest, a, b, d] = corners(c, s);
        let place = &mut next[lowest as usize];
        halves[*place] = Half {
            others: [a, b, d],
            cell: c as u32,
            side: s as u8,
        };
        *place += 1;
    }
    next.pop();
    (next, halves)
}

/// Which cells hang together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Components {
    /// The component of each cell. Components are numbered in the order of their first cells.
    pub of: Vec<u32>,
    /// Number of components.
    pub count: usize,
}

impl Components {
    /// Cells hang together that share a side. Crowded sides do not count.
    pub fn by_sides(adjacency: &Adjacency) -> Components {
        let n = adjacency.len();
        let mut sets = UnionFind::new(n);
        for c in 0..n {
            for d in adjacency.neighbours(c) {
                sets.join(c, d as usize);
            }
        }
        numbered(&mut sets, n, 0..n)
    }

    /// Cells hang together that share a node.
    pub fn by_nodes(cells: &Cells) -> Components {
        let n_nodes = cells.n_nodes();
        let mut sets = UnionFind::new(n_nodes);
        for (_, nodes) in cells.iter() {
            let pairs = nodes.windows(2);
            pairs.for_each(|pair| sets.join(pair[0] as usize, pair[1] as usize));
        }
        let firsts = cells.iter().map(|(_, nodes)| nodes[0] as usize);
        numbered(&mut sets, n_nodes, firsts)
    }

    /// The cells of each component, increasing.
    pub fn members(&self) -> Vec<Vec<u32>> {
        let mut members = vec![Vec::new(); self.count];
        for (&k, c) in self.of.iter().zip(0..) {
            members[k as usize].push(c);
        }
        members
    }
}

/// Numbers the sets in the order in which `items` meet them.
fn numbered(sets: &mut UnionFind, n: usize, items: impl Iterator<Item = usize>) -> Components {
    let mut number = vec![NONE; n];
    let mut count = 0;
    let mut of = Vec::new();
    for item in items {
        let set = sets.find(item);
        if number[set] == NONE {
            number[set] = count;
            count += 1;
        }
        of.push(number[set]);
    }
    Components {
        of,
        count: count as usize,
    }
}

#[cfg(test)]
#[path = "../../tests/partition/adjacency.rs"]
mod tests;
