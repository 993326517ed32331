//! Equal subdomains share one factorisation.
//!
//! Two subdomains are equal when matrix, interface and averages are the same, bit for bit; where they lie does not matter. On a
//! regular grid with one coefficient a handful of different ones remain, and their dense operators stay in the cache.

use std::collections::hash_map::DefaultHasher;
use std::collections::HashMap;
use std::hash::{Hash, Hasher};

use super::jump::Jump;
use crate::substructures::Substructures;

/// For every local subdomain, the first one that equals it.
pub fn representatives(problem: &Substructures, jump: &Jump) -> Vec<usize> {
    let mut found: HashMap<u64, Vec<usize>> = HashMap::new();
    let n = problem.local.len();
    let mut out = Vec::with_capacity(n);
    for j in 0..n {
        let candidates = found.entry(hash(problem, jump, j)).or_default();
        let equal = |&i: &usize| same(problem, jump, i, j);
        match candidates.iter().copied().find(equal) {
            Some(i) => out.push(i),
            None => {
                candidates.push(j);
                out.push(j);
            }
        }
    }
    out
}

/// Hash of what [`same`] compares. Values alone tell matrices apart well enough; patterns are compared, not hashed.
fn hash(problem: &Substructures, jump: &Jump, j: usize) -> u64 {
    let k = &problem.local[j].k;
    let mut state = DefaultHasher::new();
    (k.n(), k.nnz(), &jump.delta[j], &jump.primal[j]).hash(&mut state);
    let mix =
        |h: u64, v: &f64| (h.rotate_left(5) ^ v.to_bits()).wrapping_mul(0x517C_C1B7_2722_0A95);
    k.val.iter().fold(0, mix).hash(&mut state);
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
            let first = representatives(&problem, &jump);
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
