//! The algorithm: the equations on the rows that hold, from λ₀ to a certified solution.
//!
//! ```text
//!     Pᵀ F λ = Pᵀ d,   Gᵀ λ = e                                   [Lee (2.11), (3.8)]
//!     u = S̃⁺(g − Bᵀ λ) + R α
//! ```
//!
//! With coefficients that jump by 10⁶ and more, P M⁻¹ Pᵀ and P_2 lose so many digits that CG may meet rᵀ z < 0 long before
//! rounding ends the iteration as a whole. The λ that it has reached is good: a residual evaluated afresh and a new Krylov
//! space lead further.

use std::time::Instant;

use super::iterate::{iterate, IterationControl, Run};
use super::loads::Loads;
use super::recovery::{displacements, LinearSolution};
use super::residual::Iterate;
use super::target::{to_the_end, Target};
use crate::feti::method::LinearMethod;
use crate::status::Status;
use crate::Result;

/// A run that breaks down has got somewhere if the residual became less than this part of what it began with.
const PROGRESS: f64 = 0.5;

/// New starts at most.
const STARTS: usize = 20;

/// The judge is asked this many times at most.
const ASKED: usize = 8;

/// Looks at displacements that satisfy the tolerance; the factor by which the residual should fall further, or `None`.
pub type Judge<'a> = dyn Fn(&[Vec<f64>]) -> Result<Option<f64>> + 'a;

impl LinearMethod {
    /// Solves with the rows that hold, as equations, until the tolerance is reached and `enough`, if there is one, is
    /// satisfied. Collective.
    ///
    /// # Errors
    /// A load that moves a body which nothing holds; PETSc's own, and what `enough` returns.
    pub fn solve(&self, enough: Option<&Judge>) -> Result<LinearSolution> {
        let clock = Instant::now();
        let session = self.session();
        let mut at = self.start()?; /*                        λ₀ = Q G (Gᵀ Q G)⁻¹ e                      */
        let r0 = at.evaluate_projected(session, &self.dual())?; /*   r ← Pᵀ (B S̃⁺(g − Bᵀ λ₀) − c)       */
        let target = Target::new(self, r0)?;
        let mut tolerance = target.at_first();
        let mut size = at.residual.size;
        let mut run = self.reach(
            &mut at,
            IterationControl {
                observed: true,
                ..IterationControl::to(tolerance, size)
            },
        )?;

        // Until the displacements that come out have the accuracy that was asked for.
        let (mut asked, mut idle, mut stalled) = (0, false, false);
        loop {
            at.place(session, &self.dual())?; /*              y ← S̃⁺(g − Bᵀ λ) + R α                     */
            // An interface may come to rest altogether: what S̃⁺ made of the loads at first is the size of rounding.
            size = size.max(at.residual.size);
            let wanted = target.of_displacements(at.residual.length(session), size);
            if stalled || !run.status.converged() {
                break;
            }
            if to_the_end(tolerance, wanted) {
                let Some(enough) = enough.filter(|_| asked < ASKED) else {
                    break;
                };
                let u = displacements(&self.dual(), &at.loads, &mut at.residual)?;
                let Some(factor) = enough(&u)? else { break };
                asked += 1;
                // The last iteration may have gone far below its tolerance.
                tolerance = factor * tolerance.min(at.evaluate_projected(session, &self.dual())?);
            } else {
                tolerance = wanted;
            }
            // What follows is short, and no look at the spectrum may end it.
            self.dual().p_transpose(&at.residual.r)?;
            let control = IterationControl {
                observed: true,
                ..IterationControl::to(tolerance, size)
            };
            let more = iterate(self, &at.residual.r, &at.lambda, &control)?;
            if more.iterations == 0 {
                // It was there already: the next look is the last one, unless somebody asks for more.
                if std::mem::replace(&mut idle, true) {
                    break;
                }
                continue;
            }
            idle = false;
            stalled = !more.status.converged();
            run.add(more);
        }

        let seconds = clock.elapsed().as_secs_f64();
        let found = self.recover(at, run, seconds)?; /*       u_I ← K_II⁻¹ (f_I − K_IΓ u_Γ)              */
        let status = found.status.clone();
        let mut refined = self.refine(found)?; /*             K du + Bᵀ dλ = f − K u − Bᵀ λ              */
        if enough.is_some() {
            // Digits that refinement was after and did not find are for `enough` to miss: a relative tolerance of zero
            // asks for all there are.
            refined.status = status;
        }
        self.certify(refined) /*                              the certificate has the last word          */
    }

    /// Iterates from λ, with Pᵀ r in its residual, to `control.tolerance`: looks at the spectrum, deflates what is far out,
    /// starts anew where rounding has ended a run. On return the residual belongs to an earlier λ. Collective.
    pub(crate) fn reach(&self, at: &mut Iterate, control: IterationControl) -> Result<Run> {
        let session = self.session();
        if self.is_blind()? {
            self.search(None)?;
        }
        let mut so_far: Option<Run> = None;
        let mut starts = 0;
        loop {
            let control = IterationControl {
                watch: self.watch(),
                ..control
            };
            let run = iterate(self, &at.residual.r, &at.lambda, &control)?; /* λ ← λ + P x, Pᵀ F P x = Pᵀ r  */
            let (broken_off, seen) = (run.broken_off, run.estimate);
            let converged = run.status.converged();
            let again = run.broke_down(PROGRESS) && starts < STARTS;
            let all = match so_far.take() {
                Some(before) => before.followed_by(run),
                None => run,
            };
            if broken_off {
                self.search(seen)?; /*                        P_2 = I − W (Wᵀ F W)⁺ Wᵀ F                 */
            } else if converged {
                return Ok(all);
            } else if again {
                starts += 1;
            } else if self.give_deflation_up() {
                // Where rounding has made P_2 useless (elements a thousand times as long as high), the plain iteration
                // begins at λ₀.
                at.lambda.set(0.0)?;
                at.balance(session, &self.dual())?;
            } else {
                return Ok(all);
            }
            so_far = Some(all);
            at.evaluate_projected(session, &self.dual())?;
        }
    }

    /// The certificate has the last word: whatever the iteration says, displacements that are far from equilibrium, or rows
    /// that are far from holding, are no solution.
    pub(crate) fn certify(&self, mut solution: LinearSolution) -> Result<LinearSolution> {
        let rtol = self.ksp().tolerances()?.0;
        if solution.status.converged() && !solution.kkt.is_credible(rtol) {
            solution.status = Status::Certificate;
        }
        Ok(solution)
    }

    /// λ₀ = Q G (Gᵀ Q G)⁻¹ e for the loads of the problem. Collective.
    fn start(&self) -> Result<Iterate> {
        let (session, dual) = (self.session(), self.dual());
        let loads = Loads::new(session, self.problem(), &dual);
        dual.natural
            .check_held(self.problem(), &dual.stiffness, &loads.kernel)?;
        let at = Iterate::new(&dual, loads)?;
        at.balance(session, &dual)?;
        Ok(at)
    }
}
