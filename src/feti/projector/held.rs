//! Motions of bodies that no row opposes, and the sentence about them.

use super::balance::KernelLoad;
use super::columns::KernelColumns;
use super::kernel_motion::KernelMotion;
use super::natural::NaturalCoarse;
use crate::feti::operators::stiffness::Stiffness;
use crate::substructures::Problem;
use crate::{Error, Result};
use base::linalg::sorted::distinct;

impl NaturalCoarse {
    /// Returns an error if the load moves a body that no row holds: e is then not in the range of Gᵀ.
    /// Collective.
    pub fn check_held(
        &self,
        problem: &Problem,
        stiffness: &Stiffness,
        load: &KernelLoad,
    ) -> Result<()> {
        let comm = stiffness.comm();
        let along = load.along(comm, self.known(), self.unheld());
        for motion in self.unheld() {
            if along.driving(motion, 1e-10).is_some() {
                let who = moving(problem, &self.columns, motion);
                let way = self.way(problem, stiffness, motion);
                let weak = weakness(problem, &self.columns, motion);
                return Err(Error::input(format!(
                    "{who} held by nothing{way} (no Dirichlet side and no tie to a held body) \
                     and the load does not balance, expected a Dirichlet side or a tie{weak}"
                ))
                .at(problem.location(&moved(&self.columns, motion))));
            }
        }
        Ok(())
    }

    /// A driven motion in words, to follow what is said of its bodies: " where it slides along x". Empty where one is
    /// free altogether, or several do not move as one. Collective.
    pub fn way(&self, problem: &Problem, stiffness: &Stiffness, motion: &KernelMotion) -> String {
        let comm = stiffness.comm();
        let bodies: Vec<usize> = (moved(&self.columns, motion).into_iter())
            .map(|b| b as usize)
            .collect();
        // Other free motions of the same bodies belong to the name of this one.
        let mut free = self.free_motions(comm, problem, stiffness);
        free.retain(|f| f.bodies == bodies);
        if free.is_empty() {
            free = self.named(comm, problem, stiffness, std::slice::from_ref(motion));
        }
        match free.iter().find(|f| f.is_one()) {
            Some(free) if bodies.len() == 1 => format!(" where it {}", free.words),
            Some(free) => format!(" where they {}", free.words),
            None => String::new(),
        }
    }

    /// Combinations of kernel vectors on which all rows vanish, and whatever else holds bodies.
    pub fn unheld(&self) -> &[KernelMotion] {
        let of_rows = || self.gtg.as_ref().map_or(&[][..], |gtg| &gtg.gram.unheld);
        self.settled.as_deref().unwrap_or_else(of_rows)
    }

    /// Notes that these motions alone are free, because more holds bodies than the rows. It is forgotten where rows
    /// change.
    pub fn settle(&mut self, free: Vec<KernelMotion>) {
        self.settled = Some(free);
    }
}

/// The bodies that a combination of kernel vectors moves, as the beginning of a sentence: "body "a" is".
pub fn moving(problem: &Problem, columns: &KernelColumns, motion: &KernelMotion) -> String {
    let bodies = moved(columns, motion);
    let names: Vec<String> = (bodies.into_iter())
        .map(|b| format!("\"{}\"", problem.body_names[b as usize]))
        .collect();
    match names.len() {
        1 => format!("body {} is", names[0]),
        n if n > 4 => format!("bodies {} and {} more are", names[..3].join(", "), n - 3),
        _ => format!("bodies {} are", names.join(", ")),
    }
}

/// A remark on a body that a combination of kernel vectors moves, to be put behind a sentence; empty unless the cells
/// of the body leave motions without energy that are not rigid.
pub fn weakness(problem: &Problem, columns: &KernelColumns, motion: &KernelMotion) -> String {
    problem.weakness(&moved(columns, motion))
}

/// The bodies that a combination of kernel vectors moves.
pub fn moved(columns: &KernelColumns, motion: &KernelMotion) -> Vec<u32> {
    let largest = motion.largest();
    let moved = motion.0.iter().filter(|e| e.1.abs() > 1e-8 * largest);
    distinct(moved.map(|e| columns.body(e.0)))
}
