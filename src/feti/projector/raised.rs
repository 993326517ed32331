//! GᵀG after some rows more hold, without another factorisation.
//!
//! Let A = GᵀG leave motions free, and let each row cᵢ that is put back take one motion nᵢ: with C = (c₁ …) and N =
//! (n₁ …), A N = 0, W = CᵀN is regular. Then A + C Cᵀ is inverted by the factor of A,
//!
//! ```text
//!     w = W⁻ᵀ Nᵀ b,    x = A⁺(b − C w) + N W⁻¹ (w − Cᵀ A⁺(b − C w)),
//! ```
//!
//! because Nᵀ(A + C Cᵀ)x = WᵀCᵀx must be Nᵀb. The other motions, less what N takes of them, stay free.

use std::rc::Rc;

use faer::prelude::Solve;
use mpi::traits::Communicator;

use super::gram::{Factor, Gram, Motion};
use crate::cholesky::team::{Place, Team};
use crate::linalg::dense::Dense;
use crate::parallel::clock::{self, Phase};
use crate::parallel::exchange::sum_all;

/// Largest number of rows that are put back without another factorisation.
pub const MOST: usize = 64;

/// Largest number of free motions among which the rows look for theirs.
const FREE: usize = 1000;

/// Smallest pivot of W, each entry relative to the largest work that the row could do on the motion: a factor of all
/// rows knows better what nearly hangs together.
const PIVOT: f64 = 1e-4;

/// A row of G: columns and values.
pub type Row = (Vec<u32>, Vec<f64>);

/// (A + C Cᵀ)⁺.
pub struct Raised {
    base: Rc<Gram>,
    /// C and N.
    rows: Vec<Motion>,
    motions: Vec<Motion>,
    /// The same, by where this rank has the entries in vectors that no rank has whole.
    shared: [Vec<Shared>; 2],
    /// W⁻¹; its rows belong to motions, its columns to rows of G.
    inverse: Dense,
}

/// The entries that this rank has of a row or of a motion.
struct Shared {
    own: Vec<(u32, f64)>,
    top: Vec<(u32, f64)>,
}

impl Shared {
    fn new(team: &Team, motion: &Motion) -> Shared {
        let (rank, first) = (team.comm().rank() as u32, team.first_own());
        let mut shared = Shared {
            own: Vec::new(),
            top: Vec::new(),
        };
        for &(c, v) in &motion.0 {
            match team.place(c) {
                Place::Subtree { rank: r, number } if r == rank => {
                    shared.own.push((number - first, v))
                }
                Place::Subtree { .. } => (),
                Place::Top(at) => shared.top.push((at, v)),
            }
        }
        shared
    }

    fn dot(&self, own: &[f64], top: Option<&[f64]>) -> f64 {
        let of = |e: &[(u32, f64)], x: &[f64]| -> f64 {
            e.iter().map(|&(i, v)| v * x[i as usize]).sum()
        };
        of(&self.own, own) + top.map_or(0.0, |top| of(&self.top, top))
    }

    fn add(&self, alpha: f64, own: &mut [f64], top: Option<&mut [f64]>) {
        let to = |e: &[(u32, f64)], x: &mut [f64]| {
            e.iter().for_each(|&(i, v)| x[i as usize] += alpha * v)
        };
        to(&self.own, own);
        if let Some(top) = top {
            to(&self.top, top);
        }
    }
}

impl Gram {
    /// This GᵀG with a few rows more. `None` if that takes another factorisation: the rows are many, or there is one
    /// that does not take a motion of its own.
    pub fn raised(self: &Rc<Gram>, rows: &[Row]) -> Option<Gram> {
        let Factor::Sparse { factor, .. } = &self.factor else {
            return None;
        };
        if rows.len() > MOST || self.unheld.len() > FREE {
            return None;
        }
        let taken = Taken::new(rows, &self.unheld)?;
        let rows = rows.iter().map(|(columns, values)| {
            Motion(
                columns
                    .iter()
                    .copied()
                    .zip(values.iter().copied())
                    .collect(),
            )
        });
        let rows: Vec<Motion> = rows.collect();
        let motions: Vec<Motion> = taken
            .of_rows
            .iter()
            .map(|&m| self.unheld[m].clone())
            .collect();
        let team = factor.team();
        let shares = |all: &[Motion]| all.iter().map(|m| Shared::new(team, m)).collect();
        let shared = [shares(&rows), shares(&motions)];
        // A motion of its own column alone: that column is the one that is left out for it.
        let stay = |m: &usize| !taken.of_rows.contains(m);
        let left: Vec<usize> = (0..self.unheld.len()).filter(stay).collect();
        Some(Gram {
            dropped: left.iter().map(|&m| self.dropped[m]).collect(),
            unheld: taken.left,
            factor: Factor::Raised(Box::new(Raised {
                base: self.clone(),
                rows,
                motions,
                shared,
                inverse: taken.inverse,
            })),
        })
    }
}

/// Which motions the rows take, and what is left of the others.
struct Taken {
    of_rows: Vec<usize>,
    inverse: Dense,
    left: Vec<Motion>,
}

impl Taken {
    fn new(rows: &[Row], free: &[Motion]) -> Option<Taken> {
        let (k, n) = (rows.len(), free.len());
        let work = Dense::from_fn(k, n, |i, m| free[m].work(&rows[i].0, &rows[i].1));
        let size = |row: &Row| row.1.iter().fold(0.0f64, |s, v| s + v.abs());
        let mut rest = Dense::from_fn(k, n, |i, m| {
            work.get(i, m) / (size(&rows[i]) * free[m].largest())
        });
        let mut of_rows = vec![usize::MAX; k];
        let mut taken = vec![false; n];
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
        Some(Taken {
            of_rows,
            inverse,
            left,
        })
    }
}

impl Gram {
    /// The motions that rows have taken after the factorisation.
    pub fn taken(&self) -> &[Motion] {
        match &self.factor {
            Factor::Raised(raised) => &raised.motions,
            _ => &[],
        }
    }
}

impl Raised {
    /// The factor of A.
    pub fn base(&self) -> &Gram {
        &self.base
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

    /// x ← (A + C Cᵀ)⁺ x. Collective.
    pub fn solve(&self, x: &mut [f64]) {
        let dots =
            |all: &[Motion], x: &[f64]| -> Vec<f64> { all.iter().map(|m| m.dot(x)).collect() };
        let w = self.forces(&dots(&self.motions, x));
        self.rows.iter().zip(&w).for_each(|(c, w)| c.add(-w, x));
        self.base.solve(x);
        let z = self.amounts(&w, &dots(&self.rows, x));
        self.motions.iter().zip(&z).for_each(|(n, z)| n.add(*z, x));
    }

    /// The same for a vector that no rank has whole ([`Gram::solve_shares`]). Collective.
    pub fn solve_shares(&self, own: &mut [f64], top: &mut [f64]) {
        let [rows, motions] = &self.shared;
        let Factor::Sparse { factor, .. } = &self.base.factor else {
            unreachable!("it was made from such a factor")
        };
        let team = factor.team();
        // One rank counts for the rows of the top where all have the same.
        let first = team.comm().rank() == 0;
        let summed = |mut values: Vec<f64>| {
            clock::timed(Phase::Reduction, || sum_all(team.comm(), &mut values));
            values
        };
        let nb = motions.iter().map(|n| n.dot(own, Some(top))).collect();
        let w = self.forces(&summed(nb));
        for (c, w) in rows.iter().zip(&w) {
            c.add(-w, own, first.then_some(&mut *top));
        }
        self.base.solve_shares(own, top);
        let cx = rows
            .iter()
            .map(|c| c.dot(own, first.then_some(top)))
            .collect();
        let z = self.amounts(&w, &summed(cx));
        for (n, z) in motions.iter().zip(&z) {
            n.add(*z, own, Some(top));
        }
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/projector/raised.rs"]
mod tests;
