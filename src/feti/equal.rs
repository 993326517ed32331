//! Equal subdomains share one factorisation.
//!
//! Two subdomains are equal when matrix, interface and averages are the same, bit for bit; where they lie does not matter. On a
//! regular grid with one coefficient a handful of different ones remain, and their dense operators stay in the cache.

use std::collections::hash_map::DefaultHasher;
use std::collections::HashMap;
use std::hash::{Hash, Hasher};

use super::jump::Jump;
use super::team::Team;
use crate::substructures::Substructures;

/// For every local subdomain, the first one that equals it.
pub fn representatives(problem: &Substructures, jump: &Jump, team: &Team) -> Vec<usize> {
    let n = problem.local.len();
    let mut found: HashMap<u64, Vec<usize>> = HashMap::new();
    let buckets: Vec<u64> = (0..n).map(|j| hash(problem, jump, j)).collect();
    for (j, &bucket) in buckets.iter().enumerate() {
        found.entry(bucket).or_insert_with(|| vec![j]);
    }
    // Reading the matrices is what it costs: all at once, each beside the first of its bucket.
    let equal: Vec<bool> = team.map(n, |j| {
        let first = found[&buckets[j]][0];
        first == j || same(problem, jump, first, j)
    });
    let mut out = Vec::with_capacity(n);
    for (j, bucket) in buckets.iter().enumerate() {
        let candidates = found.entry(*bucket).or_default();
        if equal[j] {
            out.push(candidates[0]);
            continue;
        }
        let mut others = candidates[1..].iter().copied();
        match others.find(|&i| same(problem, jump, i, j)) {
            Some(i) => out.push(i),
            None => {
                candidates.push(j);
                out.push(j);
            }
        }
    }
    out
}

/// Entries of a matrix that its hash looks at.
const SAMPLES: usize = 64;

/// Hash of some of what [`same`] compares: enough to tell most matrices apart.
fn hash(problem: &Substructures, jump: &Jump, j: usize) -> u64 {
    let k = &problem.local[j].k;
    let mut state = DefaultHasher::new();
    (k.n(), k.nnz(), &jump.delta[j], &jump.primal[j]).hash(&mut state);
    let step = (k.nnz() / SAMPLES).max(1);
    let samples = k.val.iter().step_by(step);
    samples.for_each(|v| v.to_bits().hash(&mut state));
    state.finish()
}

fn same(problem: &Substructures, jump: &Jump, i: usize, j: usize) -> bool {
    let averaged = |j: usize| jump.averages[j].iter().map(|a| &a.dofs);
    // Equality of floats is meant: -0.0 against 0.0 would only cost a factorisation.
    jump.delta[i] == jump.delta[j]
        && jump.primal[i] == jump.primal[j]
        && averaged(i).eq(averaged(j))
        && problem.local[i].k == problem.local[j].k
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feti::settings::Primal;
    use crate::feti::sharing::Sharing;
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
            let mut kinds = first.clone();
            kinds.sort_unstable();
            kinds.dedup();
            // Subdomains inside a body, at its faces and corners, and at the sides and corners of the square.
            assert!(
                kinds.len() <= 40,
                "{} kinds of {}",
                kinds.len(),
                first.len()
            );
            for (j, &i) in first.iter().enumerate() {
                assert!(i <= j && same(&problem, &jump, i, j));
            }
        });
    }
}
