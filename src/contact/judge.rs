//! The rule of the active-set loop, row by row: which rows are on the wrong side.

use mpi::topology::SimpleCommunicator;

use super::tuning::Tuning;
use crate::feti::jump::operator::Jump;
use crate::feti::krylov::residual::Residual;
use crate::feti::operators::dual::Dual;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::substructures::{Problem, Subdomain};
use crate::Result;
use parallel::exchange::{max_all, total};
use petsc::Vec as PetscVec;

/// Sizes beside which forces and displacements of a problem count as small. The largest ones of a solution are not
/// used: they may be rounding themselves, where bodies touch without force or contact holds all that could move.
#[derive(Debug, Clone, Copy)]
pub struct JudgeSizes {
    /// The loads on one subdomain, Σ|f|, the largest of all. Multipliers below [`Tuning::rounding`] of it are what sums
    /// of loads leave.
    pub load: f64,
    /// These loads over the largest diagonal entry of K on Γ, the largest of all subdomains. A gap below
    /// [`Tuning::rounding`] of it changes forces by less than rounding of the loads.
    pub give: f64,
}

impl JudgeSizes {
    /// The sizes of `problem`. Collective.
    pub fn of(dual: &Dual, problem: &Problem) -> JudgeSizes {
        let locals = problem.local.iter().zip(&dual.stiffness.locals);
        let give = |(sub, local): (&Subdomain, &ScaledSubdomain)| match local.stiffest() {
            stiff if stiff > 0.0 => sub.load() / stiff,
            _ => 0.0,
        };
        let give = locals.map(give).fold(0.0, f64::max);
        let mut largest = [problem.largest_load(), give];
        max_all(dual.comm(), &mut largest);
        let [load, give] = largest;
        JudgeSizes { load, give }
    }
}

/// B y − C λ − c on the owned rows, including those that do not hold. Collective.
pub fn all_gaps(dual: &Dual, residual: &Residual, lambda: &PetscVec) -> Result<Vec<f64>> {
    let gaps = dual.multipliers()?;
    dual.stiffness.jump_of_all(&residual.work, &gaps)?;
    let mut gaps = gaps.to_vec()?;
    let c = &dual.stiffness.jump.gap;
    gaps.iter_mut().zip(c).for_each(|(gap, c)| *gap -= c);
    dual.stiffness
        .jump
        .less_compression(&lambda.array()?, &mut gaps);
    Ok(gaps)
}

/// The next set, and the measures behind it.
pub struct JudgedRows {
    /// Whether each owned row is to hold.
    pub active: Vec<bool>,
    /// Whether holding rows contradict each other on some rank.
    pub contradictory: bool,
    /// The violation of each owned row, in units in which multipliers and gaps compare; 0 if the row is on the right
    /// side.
    wrong: Vec<f64>,
    /// Largest remaining jump on rows that hold.
    pub jump_left: f64,
    lambda_max: f64,
    /// The largest displacement over all ranks.
    pub y_max: f64,
}

impl JudgedRows {
    /// Judges the owned rows by their gaps B u − c and multipliers. `y` is the largest displacement on this rank. A gap
    /// counts as violated only if it is above `open`, relative to the largest displacement, and above rounding. There
    /// is no such tolerance for multipliers: a row that pulls little may hold up a body that gives way much.
    /// Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        jump: &Jump,
        (gaps, lambda): (&[f64], &[f64]),
        (y, sizes): (f64, JudgeSizes),
        open: f64,
        tuning: &Tuning,
    ) -> JudgedRows {
        let rounding = tuning.rounding;
        let contact = jump.rows_between_bodies();
        // [largest remaining jump on rows that hold, largest |λ|, largest |y|, whether rows contradict each other]
        let mut largest = [0.0f64, 0.0, y, 0.0];
        for r in contact.clone().filter(|&r| jump.active[r]) {
            let slack = jump.held[r] - jump.gap[r];
            largest[0] = largest[0].max((gaps[r] - slack).abs());
            largest[1] = largest[1].max(lambda[r].abs());
            largest[3] = largest[3].max(f64::from(u8::from(slack != 0.0)));
        }
        max_all(comm, &mut largest);
        let [jump_left, lambda_max, y_max, contradictory] = largest;
        let JudgeSizes { load, give } = sizes;
        let lambda_max = lambda_max.max(rounding * load);
        let y_max = y_max.max(rounding * give);
        let mut rows = JudgedRows {
            active: jump.active.clone(),
            contradictory: contradictory > 0.0,
            wrong: vec![0.0; jump.n_owned],
            jump_left,
            lambda_max,
            y_max,
        };
        let open = (tuning.noise * jump_left)
            .max(open * y_max)
            .max(rounding * give);
        let pull = rounding * lambda_max.max(load);
        for r in contact.filter(|&r| jump.law[r].is_inequality()) {
            let pulls = jump.law[r].pull(lambda[r]);
            if jump.active[r] && pulls > pull {
                rows.active[r] = false;
                rows.wrong[r] = pulls / lambda_max;
            } else if !jump.active[r] && jump.law[r].violation(gaps[r], false) > open {
                rows.active[r] = true;
                rows.wrong[r] = gaps[r] / y_max;
            }
        }
        if rows.contradictory {
            rows.resolve(jump, lambda);
        }
        rows
    }

    /// Changes the set in blocks whose rows cannot hold together; these rows were held to the nearest right-hand sides
    /// that can be satisfied. Violated rows stay, and at least the row with the largest opening leaves.
    fn resolve(&mut self, jump: &Jump, lambda: &[f64]) {
        for block in &jump.blocks {
            let slack = |r: usize| jump.held[r] - jump.gap[r];
            let rows = || {
                block
                    .rows
                    .clone()
                    .filter(|&r| jump.active[r] && jump.law[r].is_inequality())
            };
            if rows().all(|r| slack(r) == 0.0) {
                continue;
            }
            for r in rows().filter(|&r| slack(r) > 0.0) {
                self.active[r] = true;
                self.wrong[r] = 0.0;
            }
            let open = || rows().filter(|&r| slack(r) < 0.0);
            if open().all(|r| self.active[r]) {
                let most = open().min_by(|&a, &b| {
                    let by_slack = slack(a).total_cmp(&slack(b));
                    by_slack.then(lambda[a].total_cmp(&lambda[b]))
                });
                if let Some(r) = most {
                    self.active[r] = false;
                    self.wrong[r] = -slack(r) / self.y_max.max(f64::MIN_POSITIVE);
                }
            }
        }
    }

    /// Number of rows on the wrong side over all ranks. Collective.
    pub fn wrong(&self, comm: &SimpleCommunicator) -> usize {
        let mine = self.wrong.iter().filter(|w| **w > 0.0).count();
        total(comm, mine as f64) as usize
    }

    /// λ + ρ (B u − c), with ρ such that both terms have the same scale.
    pub fn score(&self, lambda: f64, gap: f64) -> f64 {
        let scale = |x: f64, largest: f64| if largest > 0.0 { x / largest } else { 0.0 };
        scale(lambda, self.lambda_max) + scale(gap, self.y_max)
    }
}

#[cfg(test)]
#[path = "../../tests/inside/contact/judge.rs"]
mod tests;
