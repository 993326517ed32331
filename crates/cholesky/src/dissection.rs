//! Nested dissection: the elimination tree of a subdomain's interior, or of a graph of blocks of dofs.
//!
//! The tree's nodes are the supernodes of the factorisation. A leaf is a small set eliminated as one dense front; an
//! inner node is the separator of its two children. Sets are cut at the median of a coordinate, which gives orderings
//! of METIS quality on boxes at no cost. Without coordinates, sets are cut by the breadth-first distance from a far
//! node. The separator is the smallest one that the cut allows (`cover.rs`): it is one layer of nodes, even where the
//! mesh is distorted and the cut runs to and fro between two layers. Graphs of blocks are cut both ways, and the better
//! cut is kept: a grid of bodies has smaller diagonal separators than straight ones, unless a straight one takes a part
//! of each body alone.

use super::cover;
use super::nodes::Nodes;
use base::linalg::csr::Csr;

/// Sets of at most this many dofs are eliminated as one dense front: below it the dense kernels' overhead
/// outweighs the fill that cutting further would save.
const LEAF: usize = 12;

/// Sets of blocks with at most this many dofs are eliminated as one dense front: the factor of blocks is small and is
/// solved with often, and below this size a front takes more time than its entries.
const LEAF_OF_BLOCKS: usize = 48;

/// Cost of a separator of a cut that has everything on one side, relative to one between equal halves.
const ONE_SIDED: f64 = 5.0;

/// The vertices of a graph of blocks.
pub struct Vertices {
    /// Number of dofs of each.
    pub sizes: Vec<usize>,
    /// Their positions, where they are known.
    pub at: Option<Vec<[f64; 3]>>,
}

/// Orders the dofs listed in `interior` of the graph of `k` by nested dissection. Returns the dofs of each supernode,
/// in the order of elimination (children before parents).
///
/// `coordinates`, if given, has one position per dof of `k`.
pub fn nested_dissection(
    k: &Csr,
    interior: &[u32],
    coordinates: Option<&[[f64; 3]]>,
) -> Vec<Vec<u32>> {
    let nodes = Nodes::new(k, interior);
    if nodes.members.len() == interior.len() {
        let mut work = Cutting::new(k, coordinates, None);
        work.dissect(interior.to_vec());
        return work.out;
    }
    let at = |dofs: &Vec<u32>| coordinates.map(|x| x[dofs[0] as usize]);
    let at: Option<Vec<[f64; 3]>> = nodes.members.iter().map(at).collect();
    let sizes: Vec<usize> = nodes.members.iter().map(Vec::len).collect();
    let mut work = Cutting::new(&nodes.graph, at.as_deref(), Some(&sizes));
    (work.leaf, work.both) = (LEAF, false);
    work.dissect((0..sizes.len() as u32).collect());
    let members = |node: &u32| nodes.members[*node as usize].iter().copied();
    let sets = work.out.iter();
    sets.map(|set| set.iter().flat_map(members).collect())
        .collect()
}

/// The part of the nested dissection of these blocks that belongs to one of several ranks, which are (rank, number).
/// The parts of all ranks, one after the other, are the whole.
///
/// At each cut the ranks divide in proportion to the blocks: a rank makes the cuts of the sets that lead to its own,
/// and all of its own. So it looks at 2 n blocks and at its own, and not at n log n.
pub fn part_of_dissection(
    k: &Csr,
    blocks: &[u32],
    vertices: &Vertices,
    (rank, ranks): (usize, usize),
) -> Vec<Vec<u32>> {
    let mut work = Cutting::new(k, vertices.at.as_deref(), Some(&vertices.sizes));
    let (mut set, mut among) = (blocks.to_vec(), 0..ranks);
    // Separators follow after what they separate.
    let mut separators: Vec<Vec<u32>> = Vec::new();
    while among.len() > 1 {
        let (lower, upper, separator) = match work.halves(set) {
            Ok(halves) => halves,
            Err(whole) => {
                set = if rank == among.start {
                    whole
                } else {
                    Vec::new()
                };
                break;
            }
        };
        if rank + 1 == among.end {
            separators.push(separator);
        }
        let part = lower.len() as f64 / (lower.len() + upper.len()).max(1) as f64;
        let of_lower = (part * among.len() as f64).round() as usize;
        let middle = among.start + of_lower.clamp(1, among.len() - 1);
        (set, among) = if rank < middle {
            (lower, among.start..middle)
        } else {
            (upper, middle..among.end)
        };
    }
    work.dissect(set);
    let separators = separators.into_iter().rev();
    work.out.extend(separators.filter(|s| !s.is_empty()));
    work.out
}

const NONE: u32 = u32::MAX;

/// Lower half, upper half, separator.
type Halves = (Vec<u32>, Vec<u32>, Vec<u32>);

struct Cutting<'a> {
    k: &'a Csr,
    coordinates: Option<&'a [[f64; 3]]>,
    /// Number of dofs of each vertex of a graph of blocks.
    sizes: Option<&'a [usize]>,
    /// The set that a dof belongs to at the moment; `NONE` for dofs outside every live set.
    part: Vec<u32>,
    /// Breadth-first distance, valid inside the set that is being cut.
    distance: Vec<u32>,
    out: Vec<Vec<u32>>,
    next_part: u32,
    /// Sets of at most this many dofs are not cut.
    leaf: usize,
    /// Whether sets are cut both ways.
    both: bool,
}

impl<'a> Cutting<'a> {
    fn new(
        k: &'a Csr,
        coordinates: Option<&'a [[f64; 3]]>,
        sizes: Option<&'a [usize]>,
    ) -> Cutting<'a> {
        Cutting {
            k,
            coordinates,
            sizes,
            part: vec![NONE; k.n()],
            distance: vec![0; k.n()],
            out: Vec::new(),
            next_part: 0,
            leaf: if sizes.is_some() {
                LEAF_OF_BLOCKS
            } else {
                LEAF
            },
            both: sizes.is_some(),
        }
    }

    fn dissect(&mut self, set: Vec<u32>) {
        match self.halves(set) {
            Ok((lower, upper, separator)) => {
                self.dissect(lower);
                self.dissect(upper);
                self.out.extend(Some(separator).filter(|s| !s.is_empty()));
            }
            Err(set) => self.out.extend(Some(set).filter(|s| !s.is_empty())),
        }
    }

    /// (lower, upper, separator) of a set; the set itself if it is to be one front.
    fn halves(&mut self, set: Vec<u32>) -> Result<Halves, Vec<u32>> {
        if self.n_dofs(&set) <= self.leaf {
            return Err(set);
        }
        let by_coordinate = self.cut_by_coordinate(&set);
        let by_distance = if !self.both && by_coordinate.is_some() {
            None
        } else {
            self.cut_by_distance(&set)
        };
        let cuts = [by_distance, by_coordinate].into_iter().flatten();
        let cuts: Vec<Halves> = cuts.map(|(l, u)| self.separate(l, u)).collect();
        let best = cuts
            .into_iter()
            .min_by(|a, b| self.cost(a).total_cmp(&self.cost(b)));
        // A dense block cannot be cut: the whole set is one front.
        best.ok_or(set)
    }

    /// Number of dofs of these vertices.
    fn n_dofs(&self, set: &[u32]) -> usize {
        let of = |sizes: &[usize]| set.iter().map(|&v| sizes[v as usize]).sum();
        self.sizes.map_or(set.len(), of)
    }

    /// The cost of a cut: the size of its separator, more if the halves differ.
    fn cost(&self, (lower, upper, separator): &Halves) -> f64 {
        let [l, u, s] = [lower, upper, separator].map(|set| self.n_dofs(set) as f64);
        let one_sided = (l - u) / (l + u).max(1.0);
        // Of cuts without a separator the more even one.
        s.max(0.5) * (1.0 + (ONE_SIDED - 1.0) * one_sided * one_sided)
    }

    /// Takes the fewest dofs out of both sides such that no edge joins the two: (lower, upper, separator).
    fn separate(&mut self, lower: Vec<u32>, upper: Vec<u32>) -> Halves {
        // Dofs of `upper` that are neighbours of `lower` get numbers in the order in which they are found.
        let (unseen, first) = (self.next_part, self.next_part + 1);
        upper.iter().for_each(|&i| self.part[i as usize] = unseen);
        let (mut edges, mut layer, mut seen) = (Vec::new(), Vec::new(), Vec::new());
        for &i in &lower {
            let mut of = Vec::new();
            for &j in self.k.row(i as usize).0 {
                let part = &mut self.part[j as usize];
                if *part == unseen {
                    *part = first + seen.len() as u32;
                    seen.push(j);
                }
                if *part != NONE && *part >= first {
                    of.push(*part - first);
                }
            }
            if !of.is_empty() {
                edges.push(of);
                layer.push(i);
            }
        }
        upper.iter().for_each(|&i| self.part[i as usize] = NONE);
        let (left, right) = cover::smallest(&edges, seen.len());
        let chosen = |dofs: &[u32], cover: &[bool]| -> Vec<u32> {
            let both = dofs.iter().zip(cover).filter(|c| *c.1);
            both.map(|c| *c.0).collect()
        };
        let separator = [chosen(&layer, &left), chosen(&seen, &right)].concat();
        separator
            .iter()
            .for_each(|&i| self.part[i as usize] = unseen);
        let rest = |set: Vec<u32>| -> Vec<u32> {
            let outside = set.into_iter().filter(|&i| self.part[i as usize] == NONE);
            outside.collect()
        };
        let (lower, upper) = (rest(lower), rest(upper));
        separator.iter().for_each(|&i| self.part[i as usize] = NONE);
        (lower, upper, separator)
    }

    /// Halves the set at the median of its longest extent; `None` without coordinates, or when all positions coincide.
    fn cut_by_coordinate(&self, set: &[u32]) -> Option<(Vec<u32>, Vec<u32>)> {
        let x = self.coordinates?;
        let axis_of = |axis: usize| {
            let values = set.iter().map(|&i| x[i as usize][axis]);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
                (l.min(v), h.max(v))
            });
            (high - low, low, high)
        };
        let axis = (0..3)
            .max_by(|&a, &b| axis_of(a).0.total_cmp(&axis_of(b).0).then(b.cmp(&a)))
            .expect("there are three axes");
        let (extent, _, high) = axis_of(axis);
        if extent <= 0.0 || !extent.is_finite() {
            return None;
        }
        let mut values: Vec<f64> = set.iter().map(|&i| x[i as usize][axis]).collect();
        let middle = values.len() / 2;
        let (_, &mut median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
        // Equal coordinates stay on one side, and the upper side is never empty.
        let tolerance = 1e-9 * extent;
        let cut = if median >= high - tolerance {
            high - tolerance
        } else {
            median + tolerance
        };
        let (lower, upper): (Vec<u32>, Vec<u32>) =
            set.iter().partition(|&&i| x[i as usize][axis] < cut);
        (!lower.is_empty() && !upper.is_empty()).then_some((lower, upper))
    }

    /// Halves the set by breadth-first distance from a node at its rim.
    fn cut_by_distance(&mut self, set: &[u32]) -> Option<(Vec<u32>, Vec<u32>)> {
        let first = self.breadth_first(set, set[0]);
        let far = *first.last().expect("the start itself is reached");
        let order = self.breadth_first(set, far);
        if order.len() < set.len() {
            return Some(self.parted(set, &order));
        }
        let level = self.distance[order[order.len() / 2] as usize];
        let last = self.distance[*order.last().expect("not empty") as usize];
        let level = level.min(last.checked_sub(1)?);
        let (lower, upper): (Vec<u32>, Vec<u32>) = set
            .iter()
            .partition(|&&i| self.distance[i as usize] <= level);
        (!lower.is_empty() && !upper.is_empty()).then_some((lower, upper))
    }

    /// Divides a set that is not connected between its components: no separator is needed. `first` is one of them.
    fn parted(&mut self, set: &[u32], first: &[u32]) -> (Vec<u32>, Vec<u32>) {
        let mark = self.next_part;
        self.next_part += 1;
        set.iter().for_each(|&i| self.part[i as usize] = mark);
        let mut lower: Vec<u32> = Vec::new();
        let mut component = first.to_vec();
        component.iter().for_each(|&i| self.part[i as usize] = NONE);
        let mut next = set.iter();
        loop {
            // A component that goes far beyond the half stays on the other side, if it is not the first one.
            let with = lower.len() + component.len();
            if !lower.is_empty() && 2 * with > set.len() + component.len() {
                break;
            }
            lower.append(&mut component);
            if 2 * lower.len() >= set.len() {
                break;
            }
            let start = next.find(|&&i| self.part[i as usize] == mark);
            component.push(*start.expect("the other components"));
            self.part[component[0] as usize] = NONE;
            let mut head = 0;
            while let Some(&i) = component.get(head) {
                head += 1;
                for &j in self.k.row(i as usize).0 {
                    if self.part[j as usize] == mark {
                        self.part[j as usize] = NONE;
                        component.push(j);
                    }
                }
            }
        }
        let inside = self.next_part;
        self.next_part += 1;
        set.iter().for_each(|&i| self.part[i as usize] = NONE);
        lower.iter().for_each(|&i| self.part[i as usize] = inside);
        let upper = set.iter().copied();
        let upper = upper.filter(|&i| self.part[i as usize] == NONE).collect();
        lower.iter().for_each(|&i| self.part[i as usize] = NONE);
        (lower, upper)
    }

    fn breadth_first(&mut self, set: &[u32], start: u32) -> Vec<u32> {
        let mark = self.next_part;
        self.next_part += 1;
        for &i in set {
            self.part[i as usize] = mark;
            self.distance[i as usize] = NONE;
        }
        let mut order = vec![start];
        self.distance[start as usize] = 0;
        let mut head = 0;
        while head < order.len() {
            let i = order[head] as usize;
            head += 1;
            let (col, _) = self.k.row(i);
            for &j in col {
                let j = j as usize;
                if self.part[j] == mark && self.distance[j] == NONE {
                    self.distance[j] = self.distance[i] + 1;
                    order.push(j as u32);
                }
            }
        }
        set.iter().for_each(|&i| self.part[i as usize] = NONE);
        order
    }
}

#[cfg(test)]
#[path = "../tests/dissection.rs"]
mod tests;
