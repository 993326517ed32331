//! Equal subdomains share one factorisation.
//!
//! Two subdomains are equal if interface and averages are the same and one matrix is a multiple of the other, up to the
//! rounding of assembly. Their position does not matter. On a regular grid a handful of different subdomains remain,
//! whatever their coefficients, and the dense operators of these stay in the cache.

use std::collections::hash_map::DefaultHasher;
use std::collections::HashMap;
use std::hash::{Hash, Hasher};

use crate::feti::jump::operator::Jump;
use crate::linalg::csr::Csr;
use crate::parallel::team::Team;
use crate::substructures::Substructures;

/// For every local subdomain, the first one that equals it and the multiple of its matrix.
pub fn representatives(problem: &Substructures, jump: &Jump, team: &Team) -> Vec<(usize, f64)> {
    let n = problem.local.len();
    let mut found: HashMap<u64, Vec<usize>> = HashMap::new();
    let buckets: Vec<u64> = (0..n).map(|j| hash(problem, jump, j)).collect();
    for (j, &bucket) in buckets.iter().enumerate() {
        found.entry(bucket).or_insert_with(|| vec![j]);
    }
    // Reading the matrices is the main cost. All are compared at once, each with the first of its bucket.
    let equal: Vec<Option<f64>> = team.map(n, |j| match found[&buckets[j]][0] {
        first if first == j => Some(1.0),
        first => multiple(problem, jump, first, j),
    });
    let mut out = Vec::with_capacity(n);
    for (j, bucket) in buckets.iter().enumerate() {
        let candidates = found.entry(*bucket).or_default();
        if let Some(factor) = equal[j] {
            out.push((candidates[0], factor));
            continue;
        }
        let mut others = candidates[1..].iter();
        let known = others.find_map(|&i| Some((i, multiple(problem, jump, i, j)?)));
        out.push(known.unwrap_or_else(|| {
            candidates.push(j);
            (j, 1.0)
        }));
    }
    out
}

/// Number of matrix entries that enter the hash.
const SAMPLES: usize = 64;

/// Ratios of entries enter the hash as multiples of one over this, so that rounding does not change it.
const UNIT: f64 = 1e6;

/// Entries may differ by this fraction of √(k_ii k_jj): a few additions in another order change them by as much.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Hash of some of the data that [`multiple`] compares; it tells most matrices apart.
fn hash(problem: &Substructures, jump: &Jump, j: usize) -> u64 {
    let k = &problem.local[j].k;
    let mut state = DefaultHasher::new();
    (k.n(), k.nnz(), &jump.delta[j], &jump.primal[j]).hash(&mut state);
    let step = (k.nnz() / SAMPLES).max(1);
    let first = reference(k);
    let samples = k.val.iter().step_by(step);
    samples.for_each(|v| ((UNIT * v / first).round() as i64).hash(&mut state));
    state.finish()
}

/// The entry that represents the stiffness of a matrix.
fn reference(k: &Csr) -> f64 {
    if k.n() == 0 {
        return 1.0;
    }
    k.get(0, 0)
}

/// φ with K_j = φ K_i if the subdomains are equal, `None` otherwise.
fn multiple(problem: &Substructures, jump: &Jump, i: usize, j: usize) -> Option<f64> {
    let averaged = |j: usize| jump.averages[j].iter().map(|a| &a.dofs);
    let same = jump.delta[i] == jump.delta[j]
        && jump.primal[i] == jump.primal[j]
        && averaged(i).eq(averaged(j));
    let (a, b) = (&problem.local[i].k, &problem.local[j].k);
    if !same || a.row_ptr != b.row_ptr || a.col != b.col {
        return None;
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feti::interface::sharing::Sharing;
    use crate::feti::settings::Primal;
    use crate::petsc::testing::with_session;
    use crate::scene::{Faces, Scene};

    #[test]
    fn a_regular_grid_has_one_matrix_per_kind_of_boundary() {
        with_session(|session| {
            let scene = Scene::lee(3, 4, 3, Faces::Whole).expect("a scene");
            let problem = scene.substructures(&|_| true).expect("substructures");
            let weights: Vec<Vec<f64>> = problem.local.iter().map(|s| s.rho.clone()).collect();
            let sharing = Sharing::new(session.comm(), &problem, &weights, Primal::default())
                .expect("shared");
            let jump = Jump::new(session.comm(), &problem, &sharing);
            let first = representatives(&problem, &jump, &Team::new(2).expect("threads"));
            let mut kinds: Vec<usize> = first.iter().map(|f| f.0).collect();
            kinds.sort_unstable();
            kinds.dedup();
            // Subdomains inside a body, at its faces and corners, and at the sides and corners of the square.
            assert!(
                kinds.len() <= 40,
                "{} kinds of {}",
                kinds.len(),
                first.len()
            );
            for (j, &(i, factor)) in first.iter().enumerate() {
                assert!(i <= j && factor == 1.0);
                assert_eq!(multiple(&problem, &jump, i, j), Some(1.0));
            }
        });
    }

    #[test]
    fn coefficients_of_subdomains_do_not_make_kinds_but_those_of_elements_do() {
        with_session(|session| {
            let scene = Scene::lee(2, 3, 4, Faces::Whole).expect("a scene");
            let mut problem = scene.substructures(&|_| true).expect("substructures");
            let count = |problem: &Substructures| {
                let weights: Vec<Vec<f64>> = problem.local.iter().map(|s| s.rho.clone()).collect();
                let sharing = Sharing::new(session.comm(), problem, &weights, Primal::default())
                    .expect("shared");
                let jump = Jump::new(session.comm(), problem, &sharing);
                let first = representatives(problem, &jump, &Team::new(1).expect("threads"));
                let kinds = first.iter().enumerate().filter(|(j, f)| f.0 == *j).count();
                (kinds, first)
            };
            let (plain, before) = count(&problem);
            // 1/3 is no power of two: products are rounded.
            for (j, sub) in problem.local.iter_mut().enumerate() {
                let rho = (j as f64 + 1.0) / 3.0;
                sub.k.val.iter_mut().for_each(|v| *v *= rho);
            }
            let (scaled, first) = count(&problem);
            assert_eq!(plain, scaled);
            for (j, (f, b)) in first.iter().zip(&before).enumerate() {
                assert_eq!(f.0, b.0);
                let expected = (j as f64 + 1.0) / (f.0 as f64 + 1.0);
                assert!((f.1 - expected).abs() < 1e-14 * expected);
            }
            // One element that is stiffer by a millionth is another matrix.
            let last = first.iter().rposition(|f| f.0 + 1 < first.len());
            let j = last.expect("a subdomain");
            let k = &mut problem.local[j].k;
            let at = k.row_ptr[1] - 1;
            k.val[at] *= 1.0 + 1e-6;
            assert!(count(&problem).0 > scaled || first[j].0 == j);
        });
    }
}
