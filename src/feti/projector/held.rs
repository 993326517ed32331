//! Motions of bodies that no row opposes, and the sentence about them.

use super::balance::KernelLoad;
use super::columns::KernelColumns;
use super::motion::Motion;
use super::natural::NaturalCoarse;
use crate::substructures::Substructures;
use crate::{Error, Result};

impl NaturalCoarse {
    /// Returns an error if the load moves a body that no row holds: e is then not in the range of Gᵀ.
    pub fn check_held(&self, problem: &Substructures, load: &KernelLoad) -> Result<()> {
        for motion in self.unheld() {
            let (work, scale) = (motion.dot(&load.e), motion.size(&load.size));
            if work.abs() > 1e-10 * scale {
                let mut alpha = vec![0.0; self.r];
                motion.add(1.0, &mut alpha);
                let who = moving(problem, &self.columns, &alpha);
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
pub fn moving(problem: &Substructures, columns: &KernelColumns, motion: &[f64]) -> String {
    let largest = motion.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let moves = |b: &usize| {
        let of_body = &motion[columns.of(*b)];
        of_body.iter().any(|c| c.abs() > 1e-8 * largest)
    };
    let names: Vec<String> = (0..problem.n_bodies)
        .filter(moves)
        .map(|b| format!("\"{}\"", problem.body_names[b]))
        .collect();
    match names.len() {
        1 => format!("body {} is", names[0]),
        n if n > 4 => format!("bodies {} and {} more are", names[..3].join(", "), n - 3),
        _ => format!("bodies {} are", names.join(", ")),
    }
}
