//! Shared nodes by what they belong to: nodes that the same subdomains share, as far as they hang together.
//!
//! In space the nodes of a face have two subdomains, and hang together by the sides between them. The nodes of an edge
//! have more, or are where a face ends on the surface of the body; they hang together by edges of cells. In the plane
//! the nodes between two subdomains are an edge, and all others are vertices.

use std::collections::{BTreeSet, HashMap};

use super::adjacency::Adjacency;
use super::sharing::Sharing;
use crate::cells::Cells;
use base::linalg::union_find::UnionFind;

/// The kind of class that a shared node belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ClassKind {
    /// Always a vertex: the plane.
    Vertex,
    /// Hangs together by edges of cells.
    Edge,
    /// Hangs together by sides between two subdomains; in the plane this is an edge.
    Face,
}

/// No class: a node of one subdomain.
const NONE: u32 = u32::MAX;

pub(super) struct Classes<'a> {
    sharing: &'a Sharing,
    /// The class of every node: same subdomains, and alike on the surface or not.
    class: Vec<u32>,
    kinds: Vec<ClassKind>,
    /// Whether a node lies on the surface of the body.
    surface: Vec<bool>,
    /// Sides between subdomains, as cell and side of the cell in the lower part.
    sides: Vec<(u32, u8)>,
    /// The subdomains that share sides, the lower first.
    neighbours: BTreeSet<(u32, u32)>,
    /// Pairs of shared nodes of edges at the ends of an edge of a cell, or of half of one with a middle node; the lower
    /// first, increasing.
    pairs: Vec<(u32, u32)>,
}

impl<'a> Classes<'a> {
    /// With `rims`, edges run where faces end on the surface, too.
    pub fn new(
        cells: &Cells,
        adjacency: &Adjacency,
        part: &[u32],
        sharing: &'a Sharing,
        rims: bool,
    ) -> Classes<'a> {
        let plane = cells.kinds().first().is_some_and(|k| k.dim() == 2);
        let mut surface = vec![false; sharing.n_nodes()];
        for &(c, side) in &adjacency.boundary {
            for node in cells.side_nodes(c as usize, usize::from(side)) {
                surface[node as usize] = true;
            }
        }
        let (sides, neighbours): (Vec<_>, BTreeSet<_>) = between(cells, adjacency, part).unzip();
        let mut faced = vec![false; sharing.n_nodes()];
        for &(c, side) in &sides {
            for node in cells.side_nodes(c as usize, usize::from(side)) {
                faced[node as usize] = true;
            }
        }
        let mut known: HashMap<(&[u32], bool, bool), u32> = HashMap::new();
        let mut class = vec![NONE; sharing.n_nodes()];
        let mut kinds = Vec::new();
        for node in sharing.shared() {
            let (parts, i) = (sharing.of(node), node as usize);
            let edge_like = parts.len() > 2 || !faced[i] || (surface[i] && (rims || plane));
            let kind = match (edge_like, plane) {
                (true, true) => ClassKind::Vertex,
                (true, false) => ClassKind::Edge,
                (false, _) => ClassKind::Face,
            };
            let key = (parts, surface[i] && rims, kind == ClassKind::Face);
            class[i] = *known.entry(key).or_insert_with(|| {
                kinds.push(kind);
                kinds.len() as u32 - 1
            });
        }
        let mut found = Classes {
            sharing,
            class,
            kinds,
            surface,
            sides,
            neighbours,
            pairs: Vec::new(),
        };
        if !plane {
            found.pairs = found.edge_pairs(cells, adjacency, rims);
        }
        found
    }

    /// The kind of class that a node belongs to; `None` for a node of one subdomain.
    pub fn kind(&self, node: u32) -> Option<ClassKind> {
        let class = self.class[node as usize];
        (class != NONE).then(|| self.kinds[class as usize])
    }

    /// Pairs of neighbouring nodes of edges, of the same edge or of two.
    pub fn pairs(&self) -> &[(u32, u32)] {
        &self.pairs
    }

    /// Whether two subdomains share a side; the lower first.
    pub fn neighbours(&self, pair: (u32, u32)) -> bool {
        self.neighbours.contains(&pair)
    }

    pub fn same(&self, a: u32, b: u32) -> bool {
        self.class[a as usize] == self.class[b as usize]
    }

    /// Whether an edge through `a` ends at `b`: `b` has more subdomains, or lies on the surface and `a` does not.
    pub fn ends_at(&self, a: u32, b: u32) -> bool {
        let (few, many) = (self.sharing.of(a), self.sharing.of(b));
        let deeper = self.surface[a as usize] && !self.surface[b as usize];
        !deeper && !self.same(a, b) && few.iter().all(|p| many.binary_search(p).is_ok())
    }

    /// The nodes of each edge or face, without those in `left_out`. Each list is increasing.
    pub fn entities(&self, cells: &Cells, left_out: &[bool]) -> Vec<(ClassKind, Vec<u32>)> {
        let mut joined = UnionFind::new(self.class.len());
        let stays = |node: &u32| !left_out[*node as usize];
        for &(a, b) in self.pairs.iter().filter(|(a, b)| self.same(*a, *b)) {
            if stays(&a) && stays(&b) {
                joined.join(a as usize, b as usize);
            }
        }
        for &(c, side) in &self.sides {
            let nodes = cells.side_nodes(c as usize, usize::from(side));
            let mut nodes = nodes.filter(|n| stays(n) && self.kind(*n) == Some(ClassKind::Face));
            let first = nodes.next();
            // Two subdomains meet at a side: nodes of faces on it have these two.
            nodes.for_each(|n| joined.join(first.unwrap_or(n) as usize, n as usize));
        }
        let mut place = vec![NONE; self.class.len()];
        let mut entities: Vec<(ClassKind, Vec<u32>)> = Vec::new();
        for node in self.sharing.shared().filter(stays) {
            let Some(kind) = self.kind(node).filter(|k| *k != ClassKind::Vertex) else {
                continue;
            };
            let set = joined.find(node as usize);
            if place[set] == NONE {
                place[set] = entities.len() as u32;
                entities.push((kind, Vec::new()));
            }
            entities[place[set] as usize].1.push(node);
        }
        entities
    }

    fn edge_pairs(&self, cells: &Cells, adjacency: &Adjacency, rims: bool) -> Vec<(u32, u32)> {
        let of_edge = |node: u32| self.kind(node) == Some(ClassKind::Edge);
        let outside = |node: u32| rims && self.surface[node as usize];
        let mut pairs = Vec::new();
        let mut take = |nodes: &[u32], corners: usize, edges: &[[u8; 2]], on_surface: bool| {
            for (e, ends) in edges.iter().enumerate() {
                let [a, b] = ends.map(|k| nodes[usize::from(k)]);
                let mut add = |a: u32, b: u32| {
                    let both = of_edge(a) && of_edge(b);
                    // Two nodes on the surface are neighbours along the surface only: a thin plate has two of them.
                    if both && (on_surface || !(outside(a) && outside(b))) {
                        pairs.push((a.min(b), a.max(b)));
                    }
                };
                add(a, b);
                if nodes.len() > corners {
                    let middle = nodes[corners + e];
                    add(a, middle);
                    add(middle, b);
                }
            }
        };
        for (kind, nodes) in cells.iter() {
            if nodes.iter().filter(|&&n| of_edge(n)).count() > 1 {
                take(nodes, kind.corners(), kind.edges(), false);
            }
        }
        if rims {
            for &(c, side) in &adjacency.boundary {
                let nodes: Vec<u32> = cells.side_nodes(c as usize, usize::from(side)).collect();
                let kind = cells.kind(c as usize).sides()[usize::from(side)].kind;
                if nodes.iter().filter(|&&n| of_edge(n)).count() > 1 {
                    take(&nodes, kind.corners(), kind.edges(), true);
                }
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }
}

/// A side of a cell in the lower of two parts, and the two.
type SharedSide = ((u32, u8), (u32, u32));

/// The sides between two parts.
fn between<'a>(
    cells: &'a Cells,
    adjacency: &'a Adjacency,
    part: &'a [u32],
) -> impl Iterator<Item = SharedSide> + 'a {
    let all = (0..cells.len()).flat_map(|c| (0..cells.kind(c).sides().len()).map(move |s| (c, s)));
    all.filter_map(|(c, side)| {
        let pair = (part[c], part[adjacency.across(c, side)? as usize]);
        (pair.0 < pair.1).then_some(((c as u32, side as u8), pair))
    })
}
