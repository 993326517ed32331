//! Turned and mirrored copies: subdomains with K_j = φ R K_i Rᵀ, R the same rotation or reflection at every node.
//!
//! The blocks of the matrices at some nodes propose R, all blocks decide. Positions are not needed. Of a scalar field R
//! is the identity. The search is among the subdomains that no plain comparison has found equal. Hashes of numbers that
//! turns do not change come first, so that it costs next to nothing where nothing is turned.
//!
//! A subdomain takes part if all its nodes have all components, and so have the nodes of Δ and the vertices: a node
//! held in one direction only has another matrix in another frame. So has a node that touches something in one
//! direction along an axis and inside the body in the others. The averages of a copy must see what the turned averages
//! see.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

use super::equal::{Likeness, SAMPLES, UNIT};
use super::problem::basis;
use super::turn::Turn;
use crate::feti::interface::entities::Average;
use crate::feti::jump::operator::Jump;
use crate::feti::subdomain::equal;
use crate::substructures::Problem;
use base::linalg::csr::Csr;
use base::linalg::orthogonal::{Matrix, IDENTITY};
use base::linalg::similar::similarity;
use parallel::team::Team;

/// Blocks may differ by this fraction of √(k_ii k_jj). Positions that a file has with sixteen digits are rounded at
/// another place in a copy. This changes the shape of a cell that is a thousandth of the whole by 1e-13, and the matrix
/// by a few times as much; the solution changes no more than it does in a mesh rounded in this way.
const ROUNDING: f64 = 1e-12;

/// Ratios enter the hash after this is added: the ratios of regular meshes are not near a limit then.
const OFFSET: f64 = 0.381_966;

/// Replaces first subdomains that are turned copies of earlier ones.
pub(super) fn merge(problem: &Problem, jump: &Jump, team: &Team, all: &mut [Likeness]) {
    let first: Vec<usize> = (0..all.len()).filter(|&j| all[j].first == j).collect();
    if first.len() < 2 {
        return;
    }
    let hashes = team.map(first.len(), |k| hash(problem, jump, first[k]));
    // One that cannot be turned is alone in its bucket.
    let alone = |k: usize| (k as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let found = (0..first.len()).map(|k| hashes[k].unwrap_or(alone(k)));
    let buckets: Vec<u64> = found.collect();
    let turns = equal::first_of_each(team, &buckets, (1.0, None), |i, j| {
        let components = components(problem, jump, first[i])?;
        turned(problem, jump, components, [first[i], first[j]])
    });
    for own in all {
        let k = first.binary_search(&own.first).expect("a first one");
        let (to, (factor, turn)) = turns[k];
        if to != k {
            own.first = first[to];
            own.factor *= factor;
            own.turn = turn;
        }
    }
}

/// Number of components at every node if all nodes have the same, side by side and in one place. Without positions it
/// is the largest number, up to three, that makes Δ, the vertices and the matrix consist of whole nodes.
fn components(problem: &Problem, jump: &Jump, j: usize) -> Option<usize> {
    let sub = &problem.local[j];
    let whole = |c: &usize| has_whole_nodes(jump, j, *c) && NodeBlocks::new(&sub.k, *c).is_whole();
    let Some(places) = &sub.coordinates else {
        return (1..=3).rev().find(whole);
    };
    let here = places.iter().take_while(|&x| *x == places[0]).count();
    let counts = (1..=3).contains(&here) && places.len() % here == 0;
    let mut nodes = places.chunks_exact(here.max(1));
    let alike = counts && nodes.all(|node| node.iter().all(|x| *x == node[0]));
    Some(here).filter(|c| alike && whole(c))
}

/// Whether Δ and the vertices of a local subdomain consist of whole nodes.
fn has_whole_nodes(jump: &Jump, j: usize, components: usize) -> bool {
    let c = components as u32;
    let whole = |dofs: &[u32]| {
        let mut nodes = dofs.chunks(components);
        nodes.all(|node| {
            let all = node.iter().copied().eq(node[0]..node[0] + c);
            all && node[0] % c == 0
        })
    };
    whole(&jump.delta[j]) && whole(&jump.primal[j])
}

/// Hash of some numbers that a turn does not change; `None` if the subdomain cannot be turned.
fn hash(problem: &Problem, jump: &Jump, j: usize) -> Option<u64> {
    let c = components(problem, jump, j)?;
    let k = &problem.local[j].k;
    let blocks = NodeBlocks::new(k, c);
    let scale = blocks.trace(0);
    if scale <= 0.0 || scale.is_nan() {
        return None;
    }
    let mut state = DefaultHasher::new();
    (k.n(), k.nnz(), &jump.delta[j], &jump.primal[j]).hash(&mut state);
    let mut size = |square: f64| {
        let ratio = UNIT * square.sqrt() / scale + OFFSET;
        (ratio.floor() as i64).hash(&mut state);
    };
    for node in blocks.sample() {
        // The block on the diagonal, the last one, and the sum of all.
        let squares = (0..blocks.row(node)?).map(|b| {
            let block = blocks.at(node, b);
            block.iter().flatten().map(|v| v * v).sum::<f64>()
        });
        let (mut last, mut sum) = (0.0, 0.0);
        for square in squares {
            last = square;
            sum += square;
        }
        size(last);
        size(sum);
    }
    Some(state.finish())
}

/// φ and R with K_j = φ R K_i Rᵀ for the two subdomains [i, j]; `None` if there are none.
fn turned(
    problem: &Problem,
    jump: &Jump,
    components: usize,
    [i, j]: [usize; 2],
) -> Option<(f64, Option<Turn>)> {
    if self::components(problem, jump, j) != Some(components)
        || !equal::same_pattern(problem, jump, i, j)
    {
        return None;
    }
    let blocks = [i, j].map(|j| NodeBlocks::new(&problem.local[j].k, components));
    let ratio = ratio(&blocks)?;
    let q = proposed(&blocks, ratio)?;
    if !are_similar(&blocks, ratio, &q) {
        return None;
    }
    if q == IDENTITY {
        return equal::same_averages(jump, i, j).then_some((ratio, None));
    }
    let turn = Turn::new(components, q);
    let basis = |j: usize| {
        let averages: Vec<&Average> = jump.averages[j].iter().collect();
        basis(&jump.delta[j], &averages)
    };
    let alike = turn.takes(jump.delta[i].len(), &basis(i), &basis(j));
    alike.then_some((ratio, Some(turn)))
}

/// φ, the ratio of the traces of two matrices; `None` if a node has no stiffness.
fn ratio([a, b]: &[NodeBlocks; 2]) -> Option<f64> {
    let sum = |m: &NodeBlocks| {
        let traces = (0..m.nodes()).map(|n| m.trace(n));
        traces.fold(0.0, |sum, t| if t > 0.0 { sum + t } else { f64::NAN })
    };
    let ratio = sum(b) / sum(a);
    // Copies of one matrix that differ by rounding have φ = 1.
    let one = (ratio - 1.0).abs() <= ROUNDING;
    let ratio = if one { 1.0 } else { ratio };
    (ratio.is_finite() && ratio > 0.0).then_some(ratio)
}

/// R at every node by the blocks of some nodes, of matrices with the same pattern.
fn proposed([a, b]: &[NodeBlocks; 2], ratio: f64) -> Option<Matrix> {
    if a.components == 1 {
        return Some(IDENTITY);
    }
    let mut pairs = Vec::new();
    for node in a.sample() {
        let row = 0..a.row(node)?;
        pairs.extend(row.map(|block| [a.at(node, block), b.at(node, block)]));
    }
    similarity(pairs.len(), a.components, ratio, |k| pairs[k])
}

/// Whether B = φ R A Rᵀ. Both matrices have the same pattern.
fn are_similar([a, b]: &[NodeBlocks; 2], ratio: f64, q: &Matrix) -> bool {
    let traces: Vec<f64> = (0..a.nodes()).map(|n| a.trace(n)).collect();
    let c = a.components;
    let similar = |node: usize, block: usize| {
        let (x, y) = (a.at(node, block), b.at(node, block));
        let mut half = [[0.0; 3]; 3];
        for (i, row) in half[..c].iter_mut().enumerate() {
            for (k, h) in row[..c].iter_mut().enumerate() {
                *h = (0..c).map(|l| q[i][l] * x[l][k]).sum();
            }
        }
        let other = a.column(node, block);
        // The trace of a block is at least its largest diagonal entry.
        let size = ROUNDING * ratio * (traces[node] * traces[other]).sqrt();
        let near = |(i, k): (usize, usize)| {
            let sum: f64 = (0..c).map(|l| half[i][l] * q[k][l]).sum();
            (y[i][k] - ratio * sum).abs() <= size
        };
        (0..c * c).all(|e| near((e / c, e % c)))
    };
    (0..a.nodes()).all(|node| {
        let blocks = a.row(node);
        blocks.is_some_and(|n| (0..n).all(|block| similar(node, block)))
    })
}

/// A matrix by blocks: a row and a column for each node.
struct NodeBlocks<'a> {
    k: &'a Csr,
    components: usize,
}

impl<'a> NodeBlocks<'a> {
    fn new(k: &'a Csr, components: usize) -> NodeBlocks<'a> {
        NodeBlocks { k, components }
    }

    fn nodes(&self) -> usize {
        self.k.n() / self.components
    }

    /// Some nodes, from first to last.
    fn sample(&self) -> impl Iterator<Item = usize> {
        let step = (self.nodes() / SAMPLES).max(1);
        (0..self.nodes()).step_by(step)
    }

    /// Whether the rows of some nodes consist of blocks.
    fn is_whole(&self) -> bool {
        let whole = self.k.n() % self.components == 0;
        whole && self.sample().all(|node| self.row(node).is_some())
    }

    /// Number of blocks in the row of a node; `None` if the pattern is not one of blocks.
    fn row(&self, node: usize) -> Option<usize> {
        let c = self.components;
        let first = self.k.row(c * node).0;
        let mut others = (1..c).map(|i| self.k.row(c * node + i).0);
        let mut blocks = first.chunks(c);
        let whole = blocks.all(|b| {
            let all = b.iter().copied().eq(b[0]..b[0] + c as u32);
            all && b[0] as usize % c == 0
        });
        (whole && others.all(|o| o == first)).then_some(first.len() / c)
    }

    /// The node of a block's column.
    fn column(&self, node: usize, block: usize) -> usize {
        self.k.row(self.components * node).0[self.components * block] as usize / self.components
    }

    fn at(&self, node: usize, block: usize) -> Matrix {
        let c = self.components;
        let mut out = [[0.0; 3]; 3];
        for (i, row) in out[..c].iter_mut().enumerate() {
            let from = &self.k.row(c * node + i).1[c * block..c * (block + 1)];
            row[..c].copy_from_slice(from);
        }
        out
    }

    /// The trace of a node's own block.
    fn trace(&self, node: usize) -> f64 {
        let c = self.components;
        let own = c * node..c * (node + 1);
        own.map(|i| self.k.get(i, i)).sum()
    }
}
