//! Equal subdomains share one factorisation.
//!
//! Two subdomains are equal if interface and averages are the same and one matrix is a multiple of the other, up to the
//! rounding of assembly. Their position does not matter. On a regular grid a handful of different subdomains remain,
//! whatever their coefficients, and the dense operators of these stay in the cache. Those that are equal but for a
//! rotation or reflection are found by `congruent`.

use std::collections::hash_map::DefaultHasher;
use std::collections::HashMap;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use super::congruent;
use super::turn::Turn;
use crate::feti::jump::operator::Jump;
use crate::substructures::Problem;
use base::linalg::csr::Csr;
use parallel::team::Team;

/// Likeness of a subdomain to local subdomain `first`: its matrix is `factor` · R K Rᵀ, K being the matrix of `first`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Likeness {
    /// The first subdomain of this kind.
    pub first: usize,
    /// φ.
    pub factor: f64,
    /// R; `None` for the identity.
    pub turn: Option<Turn>,
}

/// For every local subdomain, the first one that equals it up to a factor, a rotation and a reflection.
pub fn representatives(problem: &Problem, jump: &Jump, team: &Team) -> Vec<Likeness> {
    let equal = |(first, factor)| Likeness {
        first,
        factor,
        turn: None,
    };
    let multiples = multiples(problem, jump, team).into_iter();
    let mut out: Vec<Likeness> = multiples.map(equal).collect();
    congruent::merge(problem, jump, team, &mut out);
    out
}

/// For every local subdomain, the first one that equals it and the multiple of its matrix.
pub fn multiples(problem: &Problem, jump: &Jump, team: &Team) -> Vec<(usize, f64)> {
    let n = problem.local.len();
    let buckets: Vec<u64> = (0..n).map(|j| hash(problem, jump, j)).collect();
    first_of_each(team, &buckets, 1.0, |i, j| multiple(problem, jump, i, j))
}

/// For each item, the first one that it is like, and how. Only items of the same bucket are compared. `own` says how an
/// item is like itself.
pub(super) fn first_of_each<T: Copy + Send + Sync>(
    team: &Team,
    buckets: &[u64],
    own: T,
    like: impl Fn(usize, usize) -> Option<T> + Sync + Send,
) -> Vec<(usize, T)> {
    let n = buckets.len();
    let mut found: HashMap<u64, Vec<usize>> = HashMap::new();
    for (j, &bucket) in buckets.iter().enumerate() {
        found.entry(bucket).or_insert_with(|| vec![j]);
    }
    // Reading the matrices is the main cost. All are compared at once, each with the first of its bucket.
    let equal: Vec<Option<T>> = team.map(n, |j| match found[&buckets[j]][0] {
        first if first == j => Some(own),
        first => like(first, j),
    });
    let mut out = Vec::with_capacity(n);
    for (j, bucket) in buckets.iter().enumerate() {
        let candidates = found.entry(*bucket).or_default();
        if let Some(how) = equal[j] {
            out.push((candidates[0], how));
            continue;
        }
        let mut others = candidates[1..].iter();
        let known = others.find_map(|&i| Some((i, like(i, j)?)));
        out.push(known.unwrap_or_else(|| {
            candidates.push(j);
            (j, own)
        }));
    }
    out
}

/// Number of matrix entries that enter the hash.
pub const SAMPLES: usize = 64;

/// Ratios of entries enter the hash as multiples of one over this, so that rounding does not change it.
pub const UNIT: f64 = 1e6;

/// Entries may differ by this fraction of √(k_ii k_jj): a few additions in another order change them by as much.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Hash of some of the data that [`multiple`] compares; it tells most matrices apart.
fn hash(problem: &Problem, jump: &Jump, j: usize) -> u64 {
    let k = &problem.local[j].k;
    let mut state = DefaultHasher::new();
    (&jump.delta[j], &jump.primal[j]).hash(&mut state);
    hash_matrix(k, &mut state);
    state.finish()
}

/// Hashes what multiples of a matrix have in common.
pub fn hash_matrix(k: &Csr, state: &mut impl Hasher) {
    (k.n(), k.nnz()).hash(state);
    let step = (k.nnz() / SAMPLES).max(1);
    let first = reference(k);
    let samples = k.val.iter().step_by(step);
    samples.for_each(|v| ((UNIT * v / first).round() as i64).hash(state));
}

/// The entry that represents the stiffness of a matrix.
fn reference(k: &Csr) -> f64 {
    if k.n() == 0 {
        return 1.0;
    }
    k.get(0, 0)
}

/// Weights of averages may differ by this, which is a few digits more than their rounding. It is what the values of two
/// subdomains may differ by that have an average in common.
const WEIGHTS: f64 = 1e-11;

/// Whether two local subdomains have the same interface, as many averages, and matrices of the same pattern.
pub(super) fn same_pattern(problem: &Problem, jump: &Jump, i: usize, j: usize) -> bool {
    let (a, b) = (&problem.local[i].k, &problem.local[j].k);
    jump.delta[i] == jump.delta[j]
        && jump.primal[i] == jump.primal[j]
        && jump.averages[i].len() == jump.averages[j].len()
        && (Arc::ptr_eq(a, b) || (a.row_ptr == b.row_ptr && a.col == b.col))
}

/// Whether two local subdomains with as many averages have the same ones.
pub(super) fn same_averages(jump: &Jump, i: usize, j: usize) -> bool {
    let near = |a: &Vec<f64>, b: &Vec<f64>| {
        let mut pairs = a.iter().zip(b);
        pairs.all(|(a, b)| (a - b).abs() <= WEIGHTS)
    };
    let mut pairs = jump.averages[i].iter().zip(&jump.averages[j]);
    pairs.all(|(a, b)| {
        let weights = match (&a.weights, &b.weights) {
            (None, None) => true,
            (Some(x), Some(y)) => near(x, y),
            _ => false,
        };
        a.dofs == b.dofs && weights
    })
}

/// φ with K_j = φ K_i if the subdomains are equal, `None` otherwise.
pub fn multiple(problem: &Problem, jump: &Jump, i: usize, j: usize) -> Option<f64> {
    if !same_pattern(problem, jump, i, j) || !same_averages(jump, i, j) {
        return None;
    }
    let (a, b) = (&problem.local[i].k, &problem.local[j].k);
    if Arc::ptr_eq(a, b) {
        return Some(1.0);
    }
    multiple_of(a, b)
}

/// φ with B = φ A, up to the rounding of assembly, for matrices of the same pattern; `None` if there is none.
pub fn multiple_of(a: &Csr, b: &Csr) -> Option<f64> {
    if a.val == b.val {
        return Some(1.0);
    }
    let ratio = reference(b) / reference(a);
    if !(ratio.is_finite() && ratio > 0.0) {
        return None;
    }
    // Copies of one matrix that differ by rounding have φ = 1.
    let one = (ratio - 1.0).abs() <= ROUNDING;
    let ratio = if one { 1.0 } else { ratio };
    let diagonal = a.diagonal();
    (0..a.n())
        .all(|r| {
            let (cols, x) = a.row(r);
            let y = &b.val[b.row_ptr[r]..b.row_ptr[r + 1]];
            let size = ROUNDING * ratio;
            cols.iter().zip(x).zip(y).all(|((&c, x), y)| {
                let far = (y - ratio * x).abs();
                far <= size * x.abs() || {
                    let d = diagonal[r] * diagonal[c as usize];
                    d >= 0.0 && far * far <= size * size * d
                }
            })
        })
        .then_some(ratio)
}
