//! B R with all rows of B_gl: those of candidates, too.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::natural::NaturalCoarse;
use super::rows::{RowEntry, Rows};
use crate::feti::operators::stiffness::Stiffness;
use crate::parallel::exchange::{exchange, max_all};
use crate::parallel::owners::Owners;
use crate::substructures::Substructures;

/// Entries of R below this part of their column's largest are rounding, and entries of G below this part of their row.
const STILL: f64 = 1e-12;

impl NaturalCoarse {
    /// Assembles [`all`](Self::all), with the names of columns. Collective.
    pub(super) fn all_rows(&self, problem: &Substructures, stiffness: &Stiffness) -> Rows {
        let (comm, jump) = (stiffness.comm(), &stiffness.jump);
        let owners = Owners::new(comm, jump.first);
        let mut outgoing: Vec<Vec<RowEntry>> = vec![Vec::new(); comm.size() as usize];
        let largest = self.largest(comm, problem);
        for (j, kernel) in self.kernels.iter().enumerate() {
            let columns = jump.columns.of(j);
            for &(e, full) in columns.contact {
                let (ghost, at) = (columns.row[e as usize], columns.at[e as usize]);
                let row = jump.ghosts[ghost as usize];
                let to = owners.of(row);
                for c in 0..kernel.cols {
                    let col = self.columns.of(problem.local[j].body).start + c;
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
        Rows::without_rounding(jump.n_owned, &entries.collect::<Vec<_>>(), &largest, STILL)
    }

    /// The largest entry of each column of R. Collective.
    fn largest(&self, comm: &SimpleCommunicator, problem: &Substructures) -> Vec<f64> {
        let mut largest = vec![0.0_f64; self.r];
        for (kernel, sub) in self.kernels.iter().zip(&problem.local) {
            let first = self.columns.of(sub.body).start;
            for c in 0..kernel.cols {
                let size = kernel.col(c).iter().fold(0.0f64, |a, v| a.max(v.abs()));
                largest[first + c] = largest[first + c].max(size);
            }
        }
        max_all(comm, &mut largest);
        largest
    }
}
