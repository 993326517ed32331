//! Work of rows on the motions of a body that may be rounding of the input (`noise`).

use mpi::topology::SimpleCommunicator;

use super::gram_pattern::GramPattern;
use super::rows::KernelRows;
use crate::feti::jump::operator::Jump;
use crate::substructures::Problem;
use base::linalg::sorted::distinct;
use parallel::exchange::any;

/// Σ ε² |b|² over the candidate rows of a column's body, for each column that is known here; empty where all directions
/// are exact. Collective.
pub(super) fn rounding_of_rows(
    comm: &SimpleCommunicator,
    problem: &Problem,
    jump: &Jump,
    (all, shape): (&KernelRows, &GramPattern),
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
