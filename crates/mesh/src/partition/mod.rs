//! Cuts the mesh of a body into subdomains, and finds what they share.
//!
//! ```text
//!     cells ─> Adjacency ─> Partition ─> Sharing ─> Interface
//!              sides        parts        nodes      vertices, edges, faces
//! ```
//!
//! The partitioner is our own: a multilevel one, as METIS is, in integers. It gives the same parts on every machine
//! and rank, has no state that threads could share, and links with any PETSc. A METIS in our archive would replace the
//! functions of the METIS that CHOLMOD and MUMPS load, which may be of another version.

mod adjacency;
mod bisect;
mod classes;
mod graph;
mod interface;
mod kway;
mod pairs;
mod shape;
mod sharing;
mod size;
mod vertices;

pub use adjacency::{Adjacency, Components};
pub use interface::Interface;
pub use sharing::Sharing;
pub use size::subdomains_for;

use self::graph::{Dice, Graph};
use self::shape::PartitionRefiner;
use super::cells::Cells;

/// The subdomains of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Partition {
    /// The part of every cell. Each part is connected through sides and not empty.
    pub part: Vec<u32>,
    /// Number of parts.
    pub n: usize,
    /// Number of pieces of the mesh that no side connects. Pieces have no part in common. If there are several, they
    /// hang together by single nodes or edges, which may let them turn like hinges, or not at all.
    pub pieces: usize,
}

/// The seed of all random choices.
const SEED: u64 = 0x5EED;

/// The work of the heaviest cell in integers.
const UNITS: f64 = (1u64 << 20) as f64;

impl Partition {
    /// Cuts a mesh of one dimension into `n` parts of about equal work; `work` has that of every cell, > 0. There are
    /// more parts if the mesh has more pieces, and fewer if it has fewer cells.
    ///
    /// Parts are numbered such that parts of neighbouring numbers are near each other: cutting 0..n in the middle cuts
    /// the mesh in two halves with a short cut between them, and so on for the halves.
    ///
    /// # Panics
    /// When the lengths of the arguments do not fit.
    pub fn new(cells: &Cells, adjacency: &Adjacency, work: &[f64], n: usize) -> Partition {
        assert_eq!(cells.len(), adjacency.len(), "the adjacency of these cells");
        assert_eq!(cells.len(), work.len(), "the work of every cell");
        let most = work.iter().copied().fold(0.0, f64::max);
        let units = |w: &f64| ((w / most * UNITS).round() as i64).max(1);
        let work: Vec<i64> = work.iter().map(units).collect();
        let components = Components::by_sides(adjacency);
        let members = components.members();
        let shares = shares(&members, &work, n);
        let graph = whole(adjacency, &work);
        let mut place = vec![u32::MAX; cells.len()];
        let mut part = vec![0; cells.len()];
        let mut first = 0;
        for (kept, &n) in members.iter().zip(&shares) {
            let inner = if n == 1 {
                vec![0; kept.len()]
            } else if members.len() == 1 {
                kway::parts(&graph, n, &mut Dice(SEED))
            } else {
                kway::parts(&graph.between(kept, &mut place), n, &mut Dice(SEED))
            };
            kept.iter()
                .zip(inner)
                .for_each(|(&c, p)| part[c as usize] = first + p);
            first += n as u32;
        }
        let n = first as usize;
        let mut shape = PartitionRefiner::new(adjacency, &work, part, n);
        if n > members.len() {
            shape.fill();
            shape.connect();
            shape.even();
            shape.smooth(cells, &cells.around_nodes(cells.n_nodes()));
        }
        Partition {
            part: shape.part,
            n,
            pieces: members.len(),
        }
    }
}

/// The graph of all cells. Sides of three or more cells are no edges.
fn whole(adjacency: &Adjacency, work: &[i64]) -> Graph {
    let mut graph = Graph {
        start: vec![0],
        ..Graph::default()
    };
    for c in 0..adjacency.len() {
        graph.near.extend(adjacency.neighbours(c));
        graph.start.push(graph.near.len() as u32);
    }
    graph.bond = vec![1; graph.near.len()];
    graph.size = work.to_vec();
    graph
}

/// How many parts each piece of the mesh gets: one, and then one more where the parts are heaviest.
fn shares(members: &[Vec<u32>], work: &[i64], n: usize) -> Vec<usize> {
    let weight = |cells: &Vec<u32>| cells.iter().map(|&c| work[c as usize]).sum::<i64>();
    let weights: Vec<i64> = members.iter().map(weight).collect();
    let mut shares = vec![1; members.len()];
    for _ in members.len()..n {
        let open = (0..members.len()).filter(|&k| shares[k] < members[k].len());
        // Ratios in doubles are the same everywhere.
        let each = |&k: &usize| weights[k] as f64 / shares[k] as f64;
        match open.max_by(|a, b| each(a).total_cmp(&each(b)).then(b.cmp(a))) {
            Some(k) => shares[k] += 1,
            None => break,
        }
    }
    shares
}

#[cfg(test)]
#[path = "../../tests/partition/meshes.rs"]
mod meshes;

#[cfg(test)]
#[path = "../../tests/partition/mod.rs"]
mod tests;
