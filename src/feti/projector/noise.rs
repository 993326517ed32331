//! Motions of single bodies that nothing holds but rounding of the input.
//!
//! Normals that follow from coordinates of twelve digits resist the free turn of a pin by 1e-12 of what they resist a
//! push. Divided by that, what is left of the load would turn the pin by many thousand radians. A row whose direction
//! is known to an angle ε, with coefficients b, may do the work ε |b| |v| on a motion v by rounding alone. The motion
//! counts as free if the rows together do no more:
//!
//! ```text
//!     Σ (B v)²  ≤  Σ (ε |b| |v|)²
//! ```
//!
//! Motions of several bodies need no such measure. Their columns of G are large and cancel, and the pivot that is left
//! shows it to the root of rounding (`gram`).

use std::borrow::Cow;

use mpi::topology::SimpleCommunicator;

use super::by_column::ByColumn;
use super::gram::Gram;
use super::motion::Motion;
use super::natural::NaturalCoarse;
use super::rows::Rows;
use super::shape::Shape;
use crate::feti::jump::operator::Jump;
use crate::feti::primal::kernel::fixing_rows;
use crate::linalg::dense::Dense;
use crate::linalg::sorted::distinct;
use crate::parallel::exchange::any;
use crate::substructures::Substructures;

/// Eigenvalues of a small matrix are known to this part of the largest one.
const EIGENVALUES: f64 = 1e-14;

impl NaturalCoarse {
    /// All rows of B R, of which only the chosen ones may hold, without what they do by rounding alone. Collective.
    pub fn rows_without_noise(&self, comm: &SimpleCommunicator, chosen: &[bool]) -> Cow<'_, Rows> {
        match self.noise.is_empty() {
            true => Cow::Borrowed(&self.all),
            false => Cow::Owned(self.without_noise(self.all.clone(), &self.gram(comm, chosen))),
        }
    }

    /// G without what its rows do by rounding alone on the motions that count as free: they do nothing on these then,
    /// and multipliers need not balance it.
    pub(super) fn without_noise(&self, g: Rows, gram: &Gram) -> Rows {
        if self.noise.is_empty() {
            return g;
        }
        let motions: Vec<Motion> = gram.unheld.iter().map(|m| self.plain(m)).collect();
        g.across(&ByColumn::new(self.known(), motions.iter()))
    }

    /// A motion without coefficients that are no more than rounding of the input: a turn, and not a turn with a slide of
    /// 1e-12. Columns that are not known here keep theirs.
    fn plain(&self, motion: &Motion) -> Motion {
        let largest = motion.largest();
        let counts = |&&(c, v): &&(u32, f64)| {
            let here = self.known().here(c);
            here.is_none_or(|c| v.abs() > self.noise[c as usize].sqrt() * largest)
        };
        Motion(motion.0.iter().filter(counts).copied().collect())
    }
}

/// Σ ε² |b|² over the candidate rows of a column's body, for each column that is known here; empty where all directions
/// are exact. Collective.
pub(super) fn rounding_of_rows(
    comm: &SimpleCommunicator,
    problem: &Substructures,
    jump: &Jump,
    (all, shape): (&Rows, &Shape),
) -> Vec<f64> {
    if !any(comm, problem.rows.iter().any(|row| row.rounding > 0.0)) {
        return Vec::new();
    }
    let mut out = vec![0.0; shape.known.n()];
    for i in jump.rows_between_bodies().filter(|&i| jump.is_candidate(i)) {
        let row = &problem.rows[jump.given(i)];
        let largest = row.terms.iter().fold(0.0f64, |a, t| a.max(t.1.abs()));
        let columns = all.entries(i).0.iter();
        for body in distinct(columns.map(|&c| shape.pattern.bodies()[c as usize])) {
            let of_body = out[shape.pattern.columns(body as usize)].iter_mut();
            of_body.for_each(|n| *n += (row.rounding * largest).powi(2));
        }
    }
    shape.known.sum(comm, &mut out);
    out
}

/// The columns of a body that are best left out, increasing: as many as it has motions on which its rows do no more
/// than `noise`. `block` is GᵀG of the body.
pub(super) fn weak_columns(block: &Dense, noise: f64) -> Vec<usize> {
    if noise == 0.0 || block.rows == 0 {
        return Vec::new();
    }
    let a = faer::Mat::from_fn(block.rows, block.rows, |i, j| block.get(i, j));
    let eigen = a.self_adjoint_eigen(faer::Side::Lower);
    let eigen = eigen.expect("eigenvalues of a small symmetric finite matrix converge");
    let values = eigen.S().column_vector();
    // They increase, and are known to rounding of the largest one.
    let limit = noise.max(EIGENVALUES * values[block.rows - 1]);
    let weak = (0..block.rows).filter(|&k| values[k] <= limit).count();
    let motions = Dense::from_fn(block.rows, weak, |i, k| eigen.U()[(i, k)]);
    let mut columns = fixing_rows(&motions);
    columns.sort_unstable();
    columns
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/projector/noise.rs"]
mod tests;
