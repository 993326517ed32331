//! Z_cᵀ S Z_c of a subdomain whose Z_c has hundreds of columns, without most of its zeros.
//!
//! The coarse function of a vertex outside the subdomain lives on one face or one edge of the subdomain. Columns with
//! the same nonzero rows form a *group*. Rows that belong to the same groups are placed side by side, and S is
//! multiplied with groups only:
//!
//! ```text
//!     Y_g = Σ_r S[:, r] Z[r, g],      A[g, :] = Σ_r Z[r, g]ᵀ Y[r, :],      r over the runs of rows of group g
//! ```

use std::collections::BTreeMap;
use std::ops::Range;

use super::coarse_functions::Recipe;
use super::interpolation::Functions;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use base::linalg::dense::{multiply, Dense};

/// An order of Γ and of the columns in which Z_c is a matrix of few blocks.
struct BlockPermutation {
    /// Position in Γ of each row.
    rows: Vec<u32>,
    /// For each column, its column in the recipe.
    columns: Vec<u32>,
    /// Columns, and runs of rows, of every group.
    members: Vec<(Range<usize>, Vec<Range<usize>>)>,
}

impl BlockPermutation {
    fn new(recipe: &Recipe) -> BlockPermutation {
        let support = recipe.support();
        let mut by_rows: BTreeMap<&[u64], Vec<u32>> = BTreeMap::new();
        for (rows, c) in support.iter().zip(0..) {
            // Zero columns belong to no group.
            if rows.iter().any(|w| *w != 0) {
                by_rows.entry(rows).or_default().push(c);
            }
        }
        // Rows are sorted by the groups that have them, with one bit for each group. The last bit stands for all groups
        // beyond.
        let has = |rows: &[u64], i: usize| rows[i / 64] >> (i % 64) & 1 == 1;
        let mut owners: Vec<(u128, u32)> = (0..recipe.rows as u32).map(|i| (0, i)).collect();
        for (set, g) in by_rows.keys().zip(0u32..) {
            for owner in owners.iter_mut().filter(|o| has(set, o.1 as usize)) {
                owner.0 |= 1 << g.min(127);
            }
        }
        owners.sort_unstable();
        let rows: Vec<u32> = owners.iter().map(|o| o.1).collect();
        let mut columns = Vec::new();
        let members = by_rows.iter().map(|(set, list)| {
            let start = columns.len();
            columns.extend_from_slice(list);
            (
                start..columns.len(),
                runs(rows.iter().map(|&i| has(set, i as usize))),
            )
        });
        let members = members.collect();
        BlockPermutation {
            rows,
            columns,
            members,
        }
    }
}

/// The runs of `true`.
fn runs(inside: impl Iterator<Item = bool>) -> Vec<Range<usize>> {
    let mut out: Vec<Range<usize>> = Vec::new();
    for (i, _) in inside.enumerate().filter(|i| i.1) {
        match out.last_mut().filter(|last| last.end == i) {
            Some(last) => last.end += 1,
            None => out.push(i..i + 1),
        }
    }
    out
}

/// Z_cᵀ S Z_c in the columns of the recipe; only the lower triangle is valid. `local` has a dense S.
pub(crate) fn block(local: &ScaledSubdomain, recipe: &Recipe, functions: &[Functions]) -> Dense {
    let groups = BlockPermutation::new(recipe);
    let s = local.s_in_order(&groups.rows);
    let whole = recipe.build(functions);
    let (n, cols) = (groups.rows.len(), groups.columns.len());
    let mut z = Dense::zeros(n, cols);
    for (c, &from) in groups.columns.iter().enumerate() {
        let column = whole.col(from as usize);
        let target = z.col_mut(c).iter_mut();
        target
            .zip(&groups.rows)
            .for_each(|(z, &i)| *z = column[i as usize]);
    }
    let mut y = Dense::zeros(n, cols);
    for (g, runs) in &groups.members {
        for (k, rows) in runs.iter().enumerate() {
            let part = z.view().submatrix(rows.start, g.start, rows.len(), g.len());
            let left = s.view().subcols(rows.start, rows.len());
            let target = y.view_mut().subcols_mut(g.start, g.len());
            multiply(target, k > 0, 1.0, left, part);
        }
    }
    let mut a = Dense::zeros(cols, cols);
    for (g, runs) in &groups.members {
        // Only columns from those of the group on: the rest follows by symmetry.
        let rest = cols - g.start;
        for (k, rows) in runs.iter().enumerate() {
            let part = z.view().submatrix(rows.start, g.start, rows.len(), g.len());
            let right = y.view().submatrix(rows.start, g.start, rows.len(), rest);
            let target = a.view_mut().submatrix_mut(g.start, g.start, g.len(), rest);
            multiply(target, k > 0, 1.0, part.transpose(), right);
        }
    }
    let mut out = Dense::zeros(recipe.columns.len(), recipe.columns.len());
    for (p, &i) in groups.columns.iter().enumerate() {
        for (q, &j) in groups.columns.iter().enumerate().skip(p) {
            let (low, high) = (i.min(j) as usize, i.max(j) as usize);
            out.set(high, low, a.get(p, q));
        }
    }
    out
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/lifting/block.rs"]
mod tests;
