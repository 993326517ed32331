//! Motions of bodies that no row opposes, and the sentence about them.

use mpi::topology::SimpleCommunicator;

use super::balance::KernelLoad;
use super::columns::KernelColumns;
use super::motion::Motion;
use super::natural::NaturalCoarse;
use crate::linalg::sorted::distinct;
use crate::substructures::Substructures;
use crate::{Error, Result};

impl NaturalCoarse {
    /// Returns an error if the load moves a body that no row holds: e is then not in the range of Gᵀ.
    /// Collective.
    pub fn check_held(
        &self,
        comm: &SimpleCommunicator,
        problem: &Substructures,
        load: &KernelLoad,
    ) -> Result<()> {
        let along = load.along(comm, self.known(), self.unheld());
        for motion in self.unheld() {
            let [work, scale] = along.work(motion);
            if work.abs() > 1e-10 * scale {
                let who = moving(problem, &self.columns, motion);
                return Err(Error::input(format!(
                    "{who} held by nothing (no Dirichlet side and no tie to a held body) \
                     and the load does not balance, expected a Dirichlet side or a tie"
                )));
            }
        }
        Ok(())
    }

    /// Combinations of kernel vectors on which all rows vanish.
    pub fn unheld(&self) -> &[Motion] {
        self.gtg.as_ref().map_or(&[], |gtg| &gtg.gram.unheld)
    }
}

/// The bodies that a combination of kernel vectors moves, as the beginning of a sentence: "body "a" is".
pub fn moving(problem: &Substructures, columns: &KernelColumns, motion: &Motion) -> String {
    let largest = motion.largest();
    let moved = motion.0.iter().filter(|e| e.1.abs() > 1e-8 * largest);
    let bodies = distinct(moved.map(|e| columns.body(e.0)));
    let names: Vec<String> = (bodies.into_iter())
        .map(|b| format!("\"{}\"", problem.body_names[b as usize]))
        .collect();
    match names.len() {
        1 => format!("body {} is", names[0]),
        n if n > 4 => format!("bodies {} and {} more are", names[..3].join(", "), n - 3),
        _ => format!("bodies {} are", names.join(", ")),
    }
}
