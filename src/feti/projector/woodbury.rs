//! GᵀG after some rows more hold, without another factorisation: the Woodbury formula.
//!
//! Let A = GᵀG leave motions free, and let each row cᵢ that is put back take one motion nᵢ: with C = (c₁ …) and N =
//! (n₁ …), A N = 0, W = CᵀN is regular. Then A + C Cᵀ is inverted by the factor of A,
//!
//! ```text
//!     w = W⁻ᵀ Nᵀ b,    x = A⁺(b − C w) + N W⁻¹ (w − Cᵀ A⁺(b − C w)),
//! ```
//!
//! because Nᵀ(A + C Cᵀ)x = WᵀCᵀx must be Nᵀb. The other motions, less what N takes of them, stay free.

use std::cell::Cell;
use std::rc::Rc;

use faer::prelude::Solve;

use super::column_map::ColumnMap;
use super::gram::{Gram, GramFactor};
use super::kernel_motion::KernelMotion;
use base::linalg::dense::Dense;
use cholesky::team::FactorTeam;
use parallel::clock::{self, Phase};
use parallel::exchange::sum_all;

/// Largest number of rows that are put back without another factorisation.
pub const MOST: usize = 64;

/// Largest number of free motions among which the rows look for theirs.
const FREE: usize = 1000;

/// Smallest pivot of W, each entry relative to the largest work that the row could do on the motion: a factor of all
/// rows knows better what nearly hangs together.
const PIVOT: f64 = 1e-4;

/// A row of G: names of columns, and values.
pub type SparseRow = (Vec<u32>, Vec<f64>);

/// (A + C Cᵀ)⁺.
pub struct WoodburyFactor {
    base: Rc<Gram>,
    /// C and N.
    rows: Vec<KernelMotion>,
    motions: Vec<KernelMotion>,
    /// The entries of C and N, placed where this rank has them in vectors that no rank has whole.
    shared: [Vec<GhostedEntries>; 2],
    /// W⁻¹; its rows belong to motions, its columns to rows of G.
    inverse: Dense,
    /// The smallest pivot of W.
    pivot: f64,
}

/// The entries of a row or of a motion at this rank's columns and at its ghosts, with their places in shares.
struct GhostedEntries {
    own: Vec<(u32, f64)>,
    ghosts: Vec<(u32, f64)>,
}

impl GhostedEntries {
    fn new(team: &FactorTeam, known: &ColumnMap, motion: &KernelMotion) -> GhostedEntries {
        let here = motion.0.iter();
        let here = here.filter_map(|&(c, v)| Some((team.here(known.here(c)?)?, v)));
        let is_own = |e: &(u32, f64)| (e.0 as usize) < team.sizes().0;
        let (own, ghosts) = here.partition(is_own);
        GhostedEntries { own, ghosts }
    }

    /// This rank's part of the product with a vector that is the sum of what the ranks have.
    fn dot(&self, x: &[f64]) -> f64 {
        self.dot_own(x) + dot(&self.ghosts, x)
    }

    /// This rank's part of the product with a vector that is the same at a column and at its ghosts.
    fn dot_own(&self, x: &[f64]) -> f64 {
        dot(&self.own, x)
    }

    fn add_own(&self, alpha: f64, x: &mut [f64]) {
        add(&self.own, alpha, x);
    }

    fn add(&self, alpha: f64, x: &mut [f64]) {
        add(&self.own, alpha, x);
        add(&self.ghosts, alpha, x);
    }
}

fn dot(entries: &[(u32, f64)], x: &[f64]) -> f64 {
    entries.iter().map(|&(i, v)| v * x[i as usize]).sum()
}

fn add(entries: &[(u32, f64)], alpha: f64, x: &mut [f64]) {
    let entries = entries.iter();
    entries.for_each(|&(i, v)| x[i as usize] += alpha * v);
}

impl Gram {
    /// This GᵀG with a few rows more. `None` if that takes another factorisation: the rows are many, or there is one
    /// that does not take a motion of its own.
    pub fn raised(self: &Rc<Gram>, rows: &[SparseRow]) -> Option<Gram> {
        let GramFactor::Sparse { factor, .. } = &self.factor else {
            return None;
        };
        if rows.len() > MOST || self.unheld.len() > FREE {
            return None;
        }
        let taken = WoodburyPivot::new(rows, &self.unheld)?;
        let rows = rows.iter().map(|(columns, values)| {
            KernelMotion(
                columns
                    .iter()
                    .copied()
                    .zip(values.iter().copied())
                    .collect(),
            )
        });
        let rows: Vec<KernelMotion> = rows.collect();
        let motions: Vec<KernelMotion> = taken
            .of_rows
            .iter()
            .map(|&m| self.unheld[m].clone())
            .collect();
        let team = factor.team();
        let known = &*self.known;
        let shares = |all: &[KernelMotion]| {
            all.iter()
                .map(|m| GhostedEntries::new(team, known, m))
                .collect()
        };
        let shared = [shares(&rows), shares(&motions)];
        // A motion of its own column alone: that column is the one that is left out for it.
        let stay = |m: &usize| !taken.of_rows.contains(m);
        let left: Vec<usize> = (0..self.unheld.len()).filter(stay).collect();
        Some(Gram {
            dropped: left.iter().map(|&m| self.dropped[m]).collect(),
            unheld: taken.left,
            known: self.known.clone(),
            smallest: Cell::new(0.0),
            factor: GramFactor::Raised(Box::new(WoodburyFactor {
                base: self.clone(),
                rows,
                motions,
                shared,
                inverse: taken.inverse,
                pivot: taken.pivot,
            })),
        })
    }
}

/// Which motions the rows take, and what is left of the others.
struct WoodburyPivot {
    of_rows: Vec<usize>,
    inverse: Dense,
    pivot: f64,
    left: Vec<KernelMotion>,
}

impl WoodburyPivot {
    fn new(rows: &[SparseRow], free: &[KernelMotion]) -> Option<WoodburyPivot> {
        let (k, n) = (rows.len(), free.len());
        let work = Dense::from_fn(k, n, |i, m| free[m].work(&rows[i].0, &rows[i].1));
        let size = |row: &SparseRow| row.1.iter().fold(0.0f64, |s, v| s + v.abs());
        let mut rest = Dense::from_fn(k, n, |i, m| {
            work.get(i, m) / (size(&rows[i]) * free[m].largest())
        });
        let mut of_rows = vec![usize::MAX; k];
        let mut taken = vec![false; n];
        let mut smallest = 1.0f64;
        for _ in 0..k {
            let open = (0..k).filter(|&i| of_rows[i] == usize::MAX);
            let pairs = open.flat_map(|i| (0..n).map(move |m| (i, m)));
            let pairs = pairs.filter(|&(_, m)| !taken[m]);
            let (i, m) = pairs
                .max_by(|&(i, m), &(j, l)| rest.get(i, m).abs().total_cmp(&rest.get(j, l).abs()))?;
            let pivot = rest.get(i, m);
            if pivot.is_nan() || pivot.abs() <= PIVOT {
                return None;
            }
            smallest = smallest.min(pivot.abs());
            (of_rows[i], taken[m]) = (m, true);
            for l in (0..n).filter(|&l| !taken[l]) {
                let factor = rest.get(i, l) / pivot;
                if factor != 0.0 {
                    (0..k).for_each(|j| rest.set(j, l, rest.get(j, l) - factor * rest.get(j, m)));
                }
            }
        }
        let w = faer::Mat::from_fn(k, k, |i, m| work.get(i, of_rows[m]));
        let inverse = w.partial_piv_lu().solve(faer::Mat::<f64>::identity(k, k));
        let inverse = Dense::from_fn(k, k, |m, i| inverse[(m, i)]);
        let mut left = Vec::new();
        for l in (0..n).filter(|&l| !taken[l]) {
            let mut motion = free[l].clone();
            for m in 0..k {
                let part: f64 = (0..k).map(|i| inverse.get(m, i) * work.get(i, l)).sum();
                if part != 0.0 {
                    motion = motion.plus(-part, &free[of_rows[m]]);
                }
            }
            left.push(motion);
        }
        Some(WoodburyPivot {
            of_rows,
            inverse,
            pivot: smallest,
            left,
        })
    }
}

impl Gram {
    /// The motions that rows have taken after the factorisation.
    pub fn taken(&self) -> &[KernelMotion] {
        match &self.factor {
            GramFactor::Raised(raised) => &raised.motions,
            _ => &[],
        }
    }
}

impl WoodburyFactor {
    /// About the smallest eigenvalue: a row does the square of its part of the work on its motion.
    pub fn smallest_eigenvalue(&self) -> f64 {
        self.pivot.powi(2).min(self.base.smallest_eigenvalue())
    }

    /// w = W⁻ᵀ Nᵀ b from Nᵀ b.
    fn forces(&self, nb: &[f64]) -> Vec<f64> {
        let mut w = vec![0.0; nb.len()];
        self.inverse.add_mul_transpose(nb, &mut w);
        w
    }

    /// W⁻¹ (w − Cᵀ x).
    fn amounts(&self, w: &[f64], cx: &[f64]) -> Vec<f64> {
        let rest: Vec<f64> = w.iter().zip(cx).map(|(w, c)| w - c).collect();
        let mut z = vec![0.0; w.len()];
        self.inverse.add_mul(&rest, &mut z);
        z
    }

    /// x ← (A + C Cᵀ)⁺ x for a vector of columns. Collective.
    pub fn solve(&self, x: &mut [f64]) {
        let (known, comm) = (&*self.base.known, self.team().comm());
        let dots = |all: &[KernelMotion], x: &[f64]| -> Vec<f64> {
            if !known.is_part() {
                return all.iter().map(|m| m.dot(x)).collect();
            }
            let (names, [x]) = known.at(comm, all, [x]);
            let at = |c: u32| x[names.binary_search(&c).expect("a column of the motions")];
            let terms = |m: &KernelMotion| m.0.iter().map(|&(c, v)| v * at(c)).sum();
            all.iter().map(terms).collect()
        };
        let w = self.forces(&dots(&self.motions, x));
        let rows = self.rows.iter().zip(&w);
        rows.for_each(|(c, w)| known.add(-w, c, x));
        self.base.solve(x);
        let z = self.amounts(&w, &dots(&self.rows, x));
        let motions = self.motions.iter().zip(&z);
        motions.for_each(|(n, z)| known.add(*z, n, x));
    }

    fn team(&self) -> &FactorTeam {
        let GramFactor::Sparse { factor, .. } = &self.base.factor else {
            unreachable!("it was made from such a factor")
        };
        factor.team()
    }

    /// x ← (A + C Cᵀ)⁺ x for a vector of columns that no rank has whole ([`Gram::solve_shares`]). Collective.
    pub fn solve_shares(&self, x: &mut [f64]) {
        let [rows, motions] = &self.shared;
        let comm = self.team().comm();
        let summed = |values: &mut Vec<f64>| {
            clock::timed(Phase::Reduction, || sum_all(comm, values));
        };
        let mut nb: Vec<f64> = motions.iter().map(|n| n.dot(x)).collect();
        summed(&mut nb);
        let w = self.forces(&nb);
        rows.iter().zip(&w).for_each(|(c, w)| c.add_own(-w, x));
        self.base.solve_shares(x);
        let mut cx: Vec<f64> = rows.iter().map(|c| c.dot_own(x)).collect();
        summed(&mut cx);
        let z = self.amounts(&w, &cx);
        motions.iter().zip(&z).for_each(|(n, z)| n.add(*z, x));
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/projector/woodbury.rs"]
mod tests;
