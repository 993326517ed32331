//! B R with all rows of B_gl: those of candidates, too.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::columns::KernelColumns;
use super::natural::NaturalCoarse;
use super::rows::{KernelRows, RowEntry};
use crate::feti::jump::operator::Jump;
use crate::feti::operators::stiffness::Stiffness;
use crate::substructures::Problem;
use base::linalg::dense::Dense;
use parallel::exchange::{exchange, max_all};
use parallel::owners::Owners;

/// Entries of R below this part of their column's largest are rounding, and entries of G below this part of their row.
/// R carries the rounding of the local elimination, 1e-14 times the condition number of a subdomain: with 1e-12 a body
/// that only a flat side holds, and that is free along it, seemed to be held by an entry of 1.2e-12.
const STILL: f64 = 1e-11;

impl NaturalCoarse {
    /// Assembles [`all`](Self::all), with the names of columns. Collective.
    pub(super) fn all_rows(&self, problem: &Problem, stiffness: &Stiffness) -> KernelRows {
        let kernels = (&self.columns, &self.kernels[..]);
        rows_of_bodies(stiffness.comm(), problem, &stiffness.jump, kernels)
    }
}

/// B R with the names of columns. `kernels` has R of each local subdomain where `jump` has the places of its entries.
/// Collective.
pub(super) fn rows_of_bodies(
    comm: &SimpleCommunicator,
    problem: &Problem,
    jump: &Jump,
    (columns, kernels): (&KernelColumns, &[Dense]),
) -> KernelRows {
    let owners = Owners::new(comm, jump.first);
    let mut outgoing: Vec<Vec<RowEntry>> = vec![Vec::new(); comm.size() as usize];
    let largest = largest(comm, problem, columns, kernels);
    for (j, kernel) in kernels.iter().enumerate() {
        let entries = jump.columns.of(j);
        for &(e, full) in entries.contact {
            let (ghost, at) = (entries.row[e as usize], entries.at[e as usize]);
            let row = jump.ghosts[ghost as usize];
            let to = owners.of(row);
            for c in 0..kernel.cols {
                let col = columns.of(problem.local[j].body).start + c;
                let value = kernel.get(at as usize, c);
                // A body that cannot move along a row's normal moves there by rounding, and the row would seem to
                // hold it.
                if value.abs() > STILL * largest[col] {
                    outgoing[to].push(RowEntry {
                        row,
                        col: col as u32,
                        value: full * value,
                    });
                }
            }
        }
    }
    let entries = exchange(comm, outgoing);
    let first = jump.first as u32;
    let entries = entries.iter().map(|e| (e.row - first, e.col, e.value));
    KernelRows::without_rounding(jump.n_owned, &entries.collect::<Vec<_>>(), &largest, STILL)
}

/// The largest entry of each column of R. Collective.
fn largest(
    comm: &SimpleCommunicator,
    problem: &Problem,
    columns: &KernelColumns,
    kernels: &[Dense],
) -> Vec<f64> {
    let mut largest = vec![0.0_f64; columns.n()];
    for (kernel, sub) in kernels.iter().zip(&problem.local) {
        let first = columns.of(sub.body).start;
        for c in 0..kernel.cols {
            let size = kernel.col(c).iter().fold(0.0f64, |a, v| a.max(v.abs()));
            largest[first + c] = largest[first + c].max(size);
        }
    }
    max_all(comm, &mut largest);
    largest
}
