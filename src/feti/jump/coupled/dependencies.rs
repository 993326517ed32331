//! Rows of a coupled block that follow from others, and multipliers without forces.
//!
//! ```text
//!     Bᵀ N = 0,      Π = I − N (Nᵀ N)⁻¹ Nᵀ      the orthogonal projection onto range B
//! ```
//!
//! B_Dᵀ is that of the other rows times Π: as for dense blocks B B_Dᵀ = Π, and B_D y has no part in N. Most sets of
//! rows are independent by their pattern, and then nothing has to be computed.

use super::pattern::{JumpMatrices, FAINT};
use super::rank::{self, DependentRow};
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use base::linalg::sorted::distinct;

/// Entries of N below this are rounding; the largest of each column is at least one.
const NOTHING: f64 = 1e-11;

/// N, column by column. Each belongs to a row that follows from others.
#[derive(Debug)]
pub struct Dependencies {
    columns: Vec<Vec<(u32, f64)>>,
    /// Nᵀ N.
    gram: Semidefinite,
}

impl Dependencies {
    /// The dependencies among the rows in `on`, and the rows that are left out of a set of independent ones; `None` if
    /// the rows are independent.
    pub fn new(b: &JumpMatrices, on: &[bool]) -> Option<(Dependencies, Vec<u32>)> {
        let held = peeled(b, on);
        if !held.contains(&true) {
            return None;
        }
        let left = rank::dependent(b, &held);
        if left.is_empty() {
            return None;
        }
        let column = |d: &DependentRow| {
            let entries = d.combination.iter().map(|&(r, v)| (r, -v));
            let mut out: Vec<(u32, f64)> = entries.filter(|e| e.1.abs() > NOTHING).collect();
            out.push((d.row, 1.0));
            out
        };
        let columns: Vec<_> = left.iter().map(column).collect();
        let left = left.iter().map(|d| d.row).collect();
        let p = columns.len();
        let mut gram = Dense::zeros(p, p);
        let mut full = vec![0.0; on.len()];
        for (i, column) in columns.iter().enumerate() {
            column.iter().for_each(|&(r, v)| full[r as usize] = v);
            for (j, other) in columns.iter().enumerate() {
                gram.set(j, i, other.iter().map(|&(r, v)| v * full[r as usize]).sum());
            }
            column.iter().for_each(|&(r, _)| full[r as usize] = 0.0);
        }
        let gram = Semidefinite::new(&gram);
        Some((Dependencies { columns, gram }, left))
    }

    /// λ ← Π λ. Of right-hand sides it is the nearest one that the rows can satisfy together.
    pub fn project(&self, lambda: &mut [f64]) {
        let of = |c: &Vec<(u32, f64)>| c.iter().map(|&(r, v)| v * lambda[r as usize]).sum();
        let mut along: Vec<f64> = self.columns.iter().map(of).collect();
        self.gram.solve(&mut along);
        for (column, a) in self.columns.iter().zip(along) {
            column
                .iter()
                .for_each(|&(r, v)| lambda[r as usize] -= a * v);
        }
    }

    /// The rows of each dependency by itself.
    pub fn parts(&self) -> impl Iterator<Item = Vec<usize>> + '_ {
        let rows = |c: &Vec<(u32, f64)>| distinct(c.iter().map(|e| e.0 as usize));
        self.columns.iter().map(rows)
    }

    /// The rows that are not zero in N.
    pub fn support(&self) -> Vec<usize> {
        let rows = self.columns.iter().flatten();
        distinct(rows.map(|e| e.0 as usize))
    }
}

/// `on` without rows that have a dof that no other row in `on` has, again and again until there are none: all that may
/// depend on each other by the pattern of B.
fn peeled(b: &JumpMatrices, on: &[bool]) -> Vec<bool> {
    let JumpMatrices { rows, columns } = b;
    let mut held = on.to_vec();
    let users = |j| b.users(j).filter(|&r| on[r]).count();
    let mut users: Vec<usize> = (0..columns.n()).map(users).collect();
    let mut queue: Vec<usize> = (0..users.len()).filter(|&j| users[j] == 1).collect();
    while let Some(j) = queue.pop() {
        let Some(r) = b.users(j).find(|&r| held[r]) else {
            continue;
        };
        let largest = rows.row(r).1.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        if rows.get(r, j).abs() <= FAINT * largest {
            continue;
        }
        held[r] = false;
        let (dofs, values) = rows.row(r);
        for (&k, _) in dofs.iter().zip(values).filter(|e| *e.1 != 0.0) {
            let k = k as usize;
            users[k] -= 1;
            if users[k] == 1 {
                queue.push(k);
            }
        }
    }
    held
}
