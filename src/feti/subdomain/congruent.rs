//! Turned and mirrored copies: subdomains with K_j = φ R K_i Rᵀ, R the same rotation or reflection at every node.
//!
//! The positions of the nodes propose R, the matrices decide, block by block. Of a scalar field R is the identity. The
//! search is among the subdomains that no plain comparison has found equal. Hashes of numbers that turns do not change
//! come first, so that it costs next to nothing where nothing is turned.
//!
//! A subdomain takes part if all its nodes have all components, and so have the nodes of Δ, the vertices and the
//! averages: a node held in one direction only has another matrix in another frame. So has a node that touches
//! something in one direction along an axis and inside the body in the others.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

use super::equal::{Likeness, SAMPLES, UNIT};
use super::turn::Turn;
use crate::feti::jump::operator::Jump;
use crate::feti::subdomain::equal;
use crate::substructures::Problem;
use base::linalg::csr::Csr;
use base::linalg::orthogonal::{fit, Fit, Matrix, IDENTITY};
use parallel::team::Team;

/// Nodes may be this far from their turned counterparts, relative to the extent of the subdomain. The bound only saves
/// comparisons of matrices.
const PLACED: f64 = 1e-9;

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
        let components = components(problem, first[i])?;
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

/// Number of components at every node if all nodes have the same, side by side and in one place.
fn components(problem: &Problem, j: usize) -> Option<usize> {
    let sub = &problem.local[j];
    let places = sub.coordinates.as_ref()?;
    let here = places.iter().take_while(|&x| *x == places[0]).count();
    let whole = (1..=3).contains(&here) && places.len() % here == 0;
    let mut nodes = places.chunks_exact(here.max(1));
    (whole && nodes.all(|node| node.iter().all(|x| *x == node[0]))).then_some(here)
}

/// Whether Δ, vertices and averages of a local subdomain consist of whole nodes.
fn has_whole_nodes(jump: &Jump, j: usize, components: usize) -> bool {
    let c = components as u32;
    let whole = |dofs: &[u32]| {
        let mut nodes = dofs.chunks(components);
        nodes.all(|node| {
            let all = node.iter().copied().eq(node[0]..node[0] + c);
            all && node[0] % c == 0
        })
    };
    let averages = &jump.averages[j];
    let each = averages.len() / components;
    let alike = |k: usize| {
        let (a, first) = (&averages[k], &averages[k % each]);
        let shift = (k / each) as u32;
        let dofs = first.dofs.iter().map(|d| d + shift);
        a.weights.is_none()
            && first.dofs.iter().all(|d| d % c == 0)
            && dofs.eq(a.dofs.iter().copied())
    };
    whole(&jump.delta[j])
        && whole(&jump.primal[j])
        && averages.len() % components == 0
        && (0..averages.len()).all(alike)
}

/// Hash of some numbers that a turn does not change; `None` if the subdomain cannot be turned.
fn hash(problem: &Problem, jump: &Jump, j: usize) -> Option<u64> {
    let c = components(problem, j)?;
    let k = &problem.local[j].k;
    let blocks = NodeBlocks::new(k, c);
    let scale = blocks.trace(0);
    if !has_whole_nodes(jump, j, c) || scale <= 0.0 || scale.is_nan() {
        return None;
    }
    let mut state = DefaultHasher::new();
    (k.n(), k.nnz(), &jump.delta[j], &jump.primal[j]).hash(&mut state);
    let nodes = k.n() / c;
    let mut size = |square: f64| {
        let ratio = UNIT * square.sqrt() / scale + OFFSET;
        (ratio.floor() as i64).hash(&mut state);
    };
    for node in (0..nodes).step_by((nodes / SAMPLES).max(1)) {
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
    if self::components(problem, j) != Some(components) || !equal::same_pattern(problem, jump, i, j)
    {
        return None;
    }
    let (from, to) = (&problem.local[i], &problem.local[j]);
    let (x, y) = (from.coordinates.as_ref()?, to.coordinates.as_ref()?);
    let nodes = x.len() / components;
    let plane = [x, y].iter().all(|x| x.iter().all(|p| p[2] == x[0][2]));
    let dim = if plane { 2 } else { 3 };
    if components > 1 && components != dim {
        return None;
    }
    let Fit { q, far } = fit(nodes, dim, |k| [x[components * k], y[components * k]])?;
    if far > PLACED {
        return None;
    }
    let q = if components == 1 { IDENTITY } else { q };
    let factor = factor(&from.k, &to.k, components, &q)?;
    let turn = (q != IDENTITY).then(|| Turn::new(components, q));
    Some((factor, turn))
}

/// φ with B = φ R A Rᵀ, if there is one. Both matrices have the same pattern.
fn factor(a: &Csr, b: &Csr, components: usize, q: &Matrix) -> Option<f64> {
    let (a, b) = (
        NodeBlocks::new(a, components),
        NodeBlocks::new(b, components),
    );
    let nodes = a.nodes();
    let traces: Vec<f64> = (0..nodes).map(|n| a.trace(n)).collect();
    let sum = |m: &NodeBlocks| (0..nodes).map(|n| m.trace(n)).sum::<f64>();
    let ratio = sum(&b) / sum(&a);
    if !(ratio.is_finite() && ratio > 0.0) || traces.iter().any(|t| *t <= 0.0 || t.is_nan()) {
        return None;
    }
    // Copies of one matrix that differ by rounding have φ = 1.
    let one = (ratio - 1.0).abs() <= ROUNDING;
    let ratio = if one { 1.0 } else { ratio };
    let c = components;
    for node in 0..nodes {
        for block in 0..a.row(node)? {
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
            for i in 0..c {
                for k in 0..c {
                    let sum: f64 = (0..c).map(|l| half[i][l] * q[k][l]).sum();
                    let far = (y[i][k] - ratio * sum).abs();
                    if far > size || far.is_nan() {
                        return None;
                    }
                }
            }
        }
    }
    Some(ratio)
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
