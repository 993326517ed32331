//! Rows without dofs of their own, solved for some of their dofs: z = T y + L λ satisfies B z = λ for any y.

use super::pattern::compressed;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;

/// Sets of rows that meet are solved densely up to this number of rows.
const MEETING: usize = 300;

/// Among coefficients of at least this part of the largest one, that of the softest dof is the pivot: values of soft
/// dofs that follow from others carry little energy.
const LARGE: f64 = 0.25;

/// The general solution.
pub struct GeneralSolution {
    /// On (dofs, free dofs).
    pub t: Csr,
    /// On (dofs, rows).
    pub l: Csr,
}

/// Solves independent rows `b` on dofs with these weights. `None` if too many rows meet.
pub fn solve(b: &Csr, weights: &[f64]) -> Option<GeneralSolution> {
    let n = weights.len();
    let mut l: Vec<Vec<(u32, f64)>> = vec![Vec::new(); n];
    // Of each dof that is solved for: the others in its equation.
    let mut follows: Vec<Option<Vec<(u32, f64)>>> = vec![None; n];
    for rows in meeting(b, n) {
        if rows.len() > MEETING {
            return None;
        }
        let mut dofs: Vec<u32> = rows.iter().flat_map(|&r| b.row(r).0).copied().collect();
        dofs.sort_unstable();
        dofs.dedup();
        let weights: Vec<f64> = dofs.iter().map(|&j| weights[j as usize]).collect();
        let mut a = Dense::zeros(rows.len(), dofs.len() + rows.len());
        for (i, &r) in rows.iter().enumerate() {
            let (col, val) = b.row(r);
            for (j, v) in col.iter().zip(val) {
                let at = dofs.binary_search(j).expect("it was collected");
                a.set(i, at, *v);
            }
            a.set(i, dofs.len() + i, 1.0);
        }
        let pivots = eliminate(&mut a, &weights);
        for (i, &p) in pivots.iter().enumerate() {
            let others = (0..dofs.len()).filter(|q| !pivots.contains(q));
            let terms = others.map(|q| (dofs[q], -a.get(i, q)));
            follows[dofs[p] as usize] = Some(terms.filter(|t| t.1 != 0.0).collect());
            let right = (0..rows.len()).map(|k| (rows[k] as u32, a.get(i, dofs.len() + k)));
            l[dofs[p] as usize] = right.filter(|t| t.1 != 0.0).collect();
        }
    }
    let mut free = vec![u32::MAX; n];
    let mut next = 0;
    for (j, free) in free.iter_mut().enumerate() {
        if follows[j].is_none() {
            *free = next;
            next += 1;
        }
    }
    let t: Vec<Vec<(u32, f64)>> = (0..n)
        .map(|j| match &follows[j] {
            None => vec![(free[j], 1.0)],
            Some(terms) => terms.iter().map(|t| (free[t.0 as usize], t.1)).collect(),
        })
        .collect();
    Some(GeneralSolution {
        t: compressed(&t),
        l: compressed(&l),
    })
}

/// Sets of rows that have dofs in common, directly or through others.
fn meeting(b: &Csr, n_dofs: usize) -> Vec<Vec<usize>> {
    let mut users: Vec<Vec<usize>> = vec![Vec::new(); n_dofs];
    for r in 0..b.n() {
        b.row(r).0.iter().for_each(|&j| users[j as usize].push(r));
    }
    let mut seen = vec![false; b.n()];
    let mut out = Vec::new();
    for start in 0..b.n() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let mut set = vec![start];
        let mut head = 0;
        while head < set.len() {
            for &j in b.row(set[head]).0 {
                for r in std::mem::take(&mut users[j as usize]) {
                    if !std::mem::replace(&mut seen[r], true) {
                        set.push(r);
                    }
                }
            }
            head += 1;
        }
        set.sort_unstable();
        out.push(set);
    }
    out
}

/// Solves the rows of `a` = [B | I] for one dof each, with pivots among the first columns, which have these weights.
/// Returns the dof of each row.
fn eliminate(a: &mut Dense, weights: &[f64]) -> Vec<usize> {
    let mut pivots = vec![usize::MAX; a.rows];
    for _ in 0..a.rows {
        let open = || {
            let rows = (0..a.rows).filter(|&i| pivots[i] == usize::MAX);
            rows.flat_map(|i| (0..weights.len()).map(move |j| (i, j)))
        };
        let size = |&(i, j): &(usize, usize)| a.get(i, j).abs();
        let largest = open().map(|p| size(&p)).fold(0.0, f64::max);
        let by_weight = |p: &(usize, usize), q: &(usize, usize)| {
            let by_size = || size(q).total_cmp(&size(p));
            weights[p.1].total_cmp(&weights[q.1]).then_with(by_size)
        };
        let chosen = open()
            .filter(|p| size(p) >= LARGE * largest)
            .min_by(by_weight);
        let (i, j) = chosen.expect("a row is open");
        pivots[i] = j;
        let pivot = a.get(i, j);
        for k in 0..a.cols {
            a.set(i, k, a.get(i, k) / pivot);
        }
        for other in (0..a.rows).filter(|&r| r != i) {
            let factor = a.get(other, j);
            if factor != 0.0 {
                for k in 0..a.cols {
                    a.set(other, k, a.get(other, k) - factor * a.get(i, k));
                }
                a.set(other, j, 0.0);
            }
        }
    }
    pivots
}
