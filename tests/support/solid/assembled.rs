//! The tied problem as one sparse system, without multipliers.

use std::collections::BTreeMap;

use faer::prelude::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use fetifeti::Problem;

/// The solution by local dof of every subdomain; all rows must be ties u_a = u_b.
pub fn solve(problem: &Problem) -> Vec<Vec<f64>> {
    // Body dofs that are tied by rows are one unknown.
    let mut leader: BTreeMap<u64, u64> = BTreeMap::new();
    fn find(leader: &BTreeMap<u64, u64>, mut dof: u64) -> u64 {
        while let Some(&next) = leader.get(&dof) {
            dof = next;
        }
        dof
    }
    for row in &problem.rows {
        let (a, b) = (find(&leader, row.terms[0].0), find(&leader, row.terms[1].0));
        if a != b {
            leader.insert(a.max(b), a.min(b));
        }
    }
    let mut number: BTreeMap<u64, usize> = BTreeMap::new();
    let mut entries: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    let mut f = Vec::new();
    let mut places = Vec::new();
    for sub in &problem.local {
        let place: Vec<usize> = sub
            .dofs
            .iter()
            .map(|&dof| {
                let next = number.len();
                *number.entry(find(&leader, dof)).or_insert(next)
            })
            .collect();
        f.resize(number.len(), 0.0);
        for (i, &gi) in place.iter().enumerate() {
            f[gi] += sub.f[i];
            let (col, val) = sub.k.row(i);
            for (&j, &v) in col.iter().zip(val) {
                *entries.entry((gi, place[j as usize])).or_default() += v;
            }
        }
        places.push(place);
    }
    let n = f.len();
    let triplets: Vec<_> = entries
        .iter()
        .map(|(&(i, j), &v)| Triplet::new(i, j, v))
        .collect();
    let k = SparseColMat::try_new_from_triplets(n, n, &triplets).expect("a matrix");
    let factor = k.sp_cholesky(Side::Lower).expect("something holds it");
    let u = factor.solve(&Mat::from_fn(n, 1, |i, _| f[i]));
    places
        .iter()
        .map(|place| place.iter().map(|&g| u[(g, 0)]).collect())
        .collect()
}
