//! The solver for equations on the rows that hold, from λ₀ to a certified solution.
//!
//! ```text
//!     Pᵀ F λ = Pᵀ d,   Gᵀ λ = e                                   [Lee (2.11), (3.8)]
//!     u = S̃⁺(g − Bᵀ λ) + R α
//! ```
//!
//! With coefficients that jump by 10⁶ and more, P M⁻¹ Pᵀ and P_2 lose many digits. CG may then meet rᵀ z < 0 long
//! before the accuracy of the operators is reached. The λ of that moment is good: a freshly evaluated residual and a
//! new Krylov space lead further.

use std::time::Instant;

use super::iterate::{iterate, IterateMonitor as LookAt, IterationControl, KrylovRun};
use super::loads::Loads;
use super::recovery::{displacements, LinearSolution};
use super::refinement::STEPS;
use super::residual::{Iterate, ROUNDING};
use super::target::{to_the_end, Target};
use super::together::Begun;
use super::verdict::{HostJudge, HostSolution, Judge, JudgeTiming, JudgedRun, Verdict};
use crate::feti::method::LinearMethod;
use crate::status::Status;
use crate::Result;
use parallel::exchange::highest;
use petsc::Stopped;

/// A run that breaks down has made progress if the residual became less than this part of its first value.
const PROGRESS: f64 = 0.5;

/// Largest number of new starts.
const STARTS: usize = 20;

/// Largest number of calls of the judge.
const ASKED: usize = 8;

/// A refinement of an error that is too large reduces it to this part of the bound, or at least by this factor.
const REDUCED: f64 = 0.1;

/// If such a step does not help, the next one reduces the residual by this factor more: with a large κ a residual may
/// fall a long way before the error does. No step reduces it by more than [`DEEPEST`].
const DEEPER: f64 = 1e-2;
const DEEPEST: f64 = 1e-6;

/// A first residual below this fraction of the displacements that it was formed from may be rounding: what is left of
/// the loads after large parts of S̃⁺ have cancelled. The judge looks before the iteration tries to reduce it.
const SUSPICIOUS: f64 = 1e-9;

impl LinearMethod {
    /// Solves the equations on the rows that hold until the tolerance is reached and `enough`, if given, is satisfied.
    /// Collective.
    ///
    /// # Errors
    /// A load that moves a body which nothing holds; PETSc's own errors, and those of `enough`.
    pub fn solve(&self, enough: Option<&Judge>) -> Result<LinearSolution> {
        let Some(enough) = enough else {
            let (at, judged, seconds) = self.run(None, None)?;
            return self.finished(at, judged, seconds, false);
        };
        let enough = |u: &[Vec<f64>], look: JudgeTiming| {
            let further = enough(u, look)?;
            Ok(further.map_or(Verdict::Enough, Verdict::Further))
        };
        let (at, judged, seconds) = self.run(None, Some(&enough))?;
        self.finished(at, judged, seconds, true)
    }

    /// [`LinearMethod::solve`] for a host that measures its own equations. The iteration may have been run together
    /// with others. Collective.
    ///
    /// # Errors
    /// As above.
    pub fn solve_for_host(&self, begun: Option<Begun>, enough: &HostJudge) -> Result<HostSolution> {
        let (at, judged, seconds) = self.run(begun, Some(enough))?;
        if let (true, Some(u)) = (judged.satisfied, &judged.seen) {
            self.remember_length(u);
            return Ok(HostSolution::Satisfied(judged.run));
        }
        let found = self.finished(at, judged, seconds, true)?;
        Ok(HostSolution::Certified(Box::new(found)))
    }

    /// The iteration, with the last λ and the seconds that it took. Collective.
    fn run(
        &self,
        begun: Option<Begun>,
        enough: Option<&HostJudge>,
    ) -> Result<(Iterate, JudgedRun, f64)> {
        let clock = Instant::now();
        let mut at = self.start()?; /*                                  λ₀ = Q G (Gᵀ Q G)⁻¹ e            */
        if let Some(begun) = &begun {
            at.lambda.copy_from(&begun.lambda)?;
        }
        let r = at.evaluate_projected(&self.dual())?; /*       r ← Pᵀ (B S̃⁺(g − Bᵀ λ₀) − c)     */
        let judged = match self.at_once(&mut at, r, enough)? {
            Some(judged) => JudgedRun {
                run: begun.map_or(judged.run, |begun| begun.run),
                ..judged
            },
            None => {
                let target = Target::new(self, begun.as_ref().map_or(r, |b| b.reference))?;
                let control = IterationControl::to(target.at_first(), at.residual.size);
                let control = control.observed().above_rounding();
                let run = match begun {
                    Some(begun) => begun.run,
                    None => self.reach(&mut at, control, None)?, /*   Pᵀ F P x = Pᵀ r, P_2, λ ← λ + P x         */
                };
                self.meet(&mut at, run, control, &target, enough)? /* y ← S̃⁺(g − Bᵀ λ) + R α             */
            }
        };
        Ok((at, judged, clock.elapsed().as_secs_f64()))
    }

    /// The run with its displacements, refined and certified. `asked`: the caller has been asked whether the residual
    /// should fall further. Collective.
    fn finished(
        &self,
        at: Iterate,
        judged: JudgedRun,
        seconds: f64,
        asked: bool,
    ) -> Result<LinearSolution> {
        let found = self.recovered(at, (judged.run, judged.seen), seconds)?; /* u_I ← K_II⁻¹ (f_I − K_IΓ u_Γ)  */
        let status = found.status.clone();
        let mut refined = self.refine(found)?; /*                       K du + Bᵀ dλ = f − K u − Bᵀ λ    */
        if asked {
            // If refinement did not find the missing digits, the caller decides whether they matter: a relative
            // tolerance of zero asks for all possible digits.
            refined.status = status;
        }
        if asked || !refined.status.broke_down() {
            return self.certify(refined);
        }
        // The operators have lost their digits; the displacements need not have. The certificate says whether they are
        // a solution all the same.
        let broken = std::mem::replace(&mut refined.status, Status::Rounding);
        let mut certified = self.certify(refined)?;
        if !certified.status.converged() {
            certified.status = broken;
        }
        Ok(certified)
    }

    /// Whether λ₀ is the solution already, as the judge sees it: a run without iterations, with the displacements of
    /// λ₀, rigid motions included. Otherwise `None`, and the residual is as it was. `r` is ‖Pᵀ r‖. Collective.
    fn at_once(
        &self,
        at: &mut Iterate,
        r: f64,
        enough: Option<&HostJudge>,
    ) -> Result<Option<JudgedRun>> {
        let Some(enough) = enough.filter(|_| r <= SUSPICIOUS * at.residual.size) else {
            return Ok(None);
        };
        at.place(&self.dual())?;
        let u = displacements(&self.dual(), &at.loads, &mut at.residual)?;
        let verdict = enough(&u, JudgeTiming::Before)?;
        if let Verdict::Further(_) = verdict {
            at.evaluate_projected(&self.dual())?;
            return Ok(None);
        }
        let run = KrylovRun {
            iterations: 0,
            status: Status::NothingToDo,
            residuals: vec![r],
            estimate: None,
            stopped: Stopped::No,
        };
        Ok(Some(JudgedRun {
            run,
            seen: Some(u),
            satisfied: verdict == Verdict::Satisfied,
        }))
    }

    /// Iterates from λ to `control.tolerance`; the residual holds Pᵀ r on entry. Looks at the spectrum, deflates large
    /// eigenvalues and starts anew where rounding has ended a run. `look` may end it early. On return the residual
    /// belongs to an earlier λ. Collective.
    pub(crate) fn reach(
        &self,
        at: &mut Iterate,
        control: IterationControl,
        mut look: Option<&mut LookAt>,
    ) -> Result<KrylovRun> {
        if self.is_blind()? {
            self.search(None)?;
        }
        let mut so_far: Option<KrylovRun> = None;
        let mut starts = 0;
        loop {
            let control = IterationControl {
                watch: self.watch(),
                ..control
            };
            let look = look.as_deref_mut();
            let run = iterate(self, &at.residual.r, &at.lambda, &control, look)?; /* λ ← λ + P x, Pᵀ F P x = Pᵀ r  */
            self.note(&run);
            let (stopped, seen) = (run.stopped, run.estimate);
            let converged = run.status.converged();
            let again = run.broke_down(PROGRESS) && starts < STARTS;
            let all = run.after(so_far.take());
            if stopped == Stopped::Eigenvalue {
                self.search(seen)?; /*                        P_2 = I − W (Wᵀ F W)⁺ Wᵀ F                 */
            } else if converged {
                return Ok(all);
            } else if again {
                starts += 1;
            } else if self.give_deflation_up() {
                // Rounding has made P_2 useless (elements a thousand times as long as high): the plain iteration begins
                // at λ₀.
                at.lambda.set(0.0)?;
                at.begin(&self.dual())?;
            } else {
                return Ok(all);
            }
            so_far = Some(all);
            at.evaluate_projected(&self.dual())?;
        }
    }

    /// Iterates further, after `run` with this `control`, until the displacements have the accuracy of the user's
    /// tolerance and `enough` asks for no more. On return the displacements are those of λ, rigid motions included.
    /// Collective.
    fn meet(
        &self,
        at: &mut Iterate,
        mut run: KrylovRun,
        control: IterationControl,
        target: &Target,
        enough: Option<&HostJudge>,
    ) -> Result<JudgedRun> {
        let IterationControl {
            mut tolerance,
            mut size,
            ..
        } = control;
        let (mut asked, mut idle, mut stalled) = (0, false, false);
        // The displacements take the place of the residual.
        let kept = enough.map(|_| at.residual.r.duplicate()).transpose()?;
        loop {
            at.place(&self.dual())?; /*              y ← S̃⁺(g − Bᵀ λ) + R α                     */
            // The interface may not move at all in the solution. Rounding then has the size of S̃⁺ applied to the loads
            // at the start.
            size = size.max(at.residual.size);
            let wanted = target.of_displacements(at.residual.length(&self.dual()), size);
            if stalled || !run.status.converged() {
                break;
            }
            self.dual().p_transpose(&at.residual.r)?; /* r ← Pᵀ r                            */
            let r = at.residual.r.norm2()?;
            let judged = to_the_end(tolerance, wanted) || r <= wanted;
            if judged {
                let (Some(enough), Some(kept)) = (enough.filter(|_| asked < ASKED), &kept) else {
                    break;
                };
                kept.copy_from(&at.residual.r)?;
                let u = displacements(&self.dual(), &at.loads, &mut at.residual)?;
                let verdict = enough(&u, JudgeTiming::After)?;
                let Verdict::Further(factor) = verdict else {
                    return Ok(JudgedRun {
                        run,
                        seen: Some(u),
                        satisfied: verdict == Verdict::Satisfied,
                    });
                };
                asked += 1;
                // Directions of earlier loads may reach the new tolerance without an iteration: that is progress.
                idle = false;
                // The last iteration may have ended far below its tolerance.
                at.residual.r.copy_from(kept)?;
                tolerance = factor * tolerance.min(wanted).min(r);
            } else {
                tolerance = wanted;
            }
            // The remaining iterations are few, and no look at the spectrum may end them.
            let control = IterationControl::to(tolerance, size)
                .observed()
                .above_rounding();
            let more = iterate(self, &at.residual.r, &at.lambda, &control, None)?;
            if more.iterations == 0 {
                // The target was reached already, by earlier directions perhaps, which `enough` has not seen. The next
                // pass is the last one, unless `enough` asks for more.
                if std::mem::replace(&mut idle, true) && !judged {
                    break;
                }
                continue;
            }
            idle = false;
            stalled = !more.status.converged();
            run.add(more);
        }
        Ok(JudgedRun {
            run,
            seen: None,
            satisfied: false,
        })
    }

    /// The certificate has the last word. Displacements far from equilibrium or from the solution, or rows far from
    /// holding, are not a solution, whatever the status of the iteration. They are refined first, and so is an error
    /// that is too large in the energy norm: where given values deform stiff bodies this norm hardly sees the soft
    /// ones. Collective.
    pub(crate) fn certify(&self, mut solution: LinearSolution) -> Result<LinearSolution> {
        let mut part = REDUCED;
        for step in 0.. {
            if !solution.status.converged() {
                break;
            }
            let asked = self.relative_tolerance(&solution)?;
            let bound = solution.left.bound(asked);
            let estimate = self.energy_error(&solution, bound)?;
            let mut error = estimate.most;
            let beyond = solution.kkt.beyond(asked);
            if (error > bound || beyond > 1.0) && step < STEPS {
                let reduction = (part / beyond.max(error / bound)).clamp(DEEPEST, REDUCED);
                let refined = self.refined(&solution, reduction)?;
                if let Some(better) = refined.better {
                    solution = better;
                    continue;
                }
                // Where rounding keeps a step from helping, the correction itself is a closer estimate than the upper
                // bound, which is too large by the condition number.
                if let Some(correction) = refined.correction {
                    error = error.min(estimate.least.max(correction));
                    if (error > bound || beyond > 1.0) && reduction > DEEPEST {
                        part *= DEEPER;
                        continue;
                    }
                }
            }
            solution.kkt.error = Some(solution.left.relative(error));
            if !(error <= bound && solution.kkt.is_credible(asked)) {
                solution.status = Status::Certificate;
            }
            break;
        }
        if solution.status.converged() {
            self.remember_length(&solution.u);
        }
        Ok(solution)
    }

    /// Notes the largest displacement of a solution as one of the problem's scale. Collective.
    fn remember_length(&self, u: &[Vec<f64>]) {
        let mine = u.iter().flatten();
        let mine = mine.fold(self.length.get(), |a, u| a.max(u.abs()));
        self.length.set(highest(self.session.comm(), mine));
    }

    /// The smallest residual that matters beside the scale of the problem: that of displacements in earlier loads, and
    /// of right-hand sides of the rows. Collective.
    pub(crate) fn least_residual(&self) -> f64 {
        let dual = self.dual();
        let jump = &dual.stiffness.jump;
        let rows = (0..jump.n_owned).filter(|&r| jump.is_candidate(r));
        let mine = rows.fold(self.length.get(), |a, r| a.max(jump.gap[r].abs()));
        ROUNDING * highest(dual.comm(), mine) * (jump.n_global as f64).sqrt()
    }

    /// λ₀ = Q G (Gᵀ Q G)⁻¹ e for the loads of the problem. Collective.
    fn start(&self) -> Result<Iterate> {
        let dual = self.dual();
        let loads = Loads::new(&self.problem, &dual);
        let natural = &dual.natural;
        natural.check_held(&self.problem, &dual.stiffness, &loads.kernel)?;
        let at = Iterate::new(&dual, loads)?;
        at.begin(&dual)?;
        Ok(at)
    }
}
