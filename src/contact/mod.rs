//! The contact loop: inequality rows B_I u ≤ c with multipliers λ_I ≥ 0, [Lee (3.1)-(3.3)] (docs/theory.md, section 9).
//!
//! ```text
//!     min ½ uᵀ K u − fᵀ u    subject to    B_E u = c_E,  B_I u ≤ c_I
//! ```
//!
//! The loop calls the solver of equations and changes only Z^k, the set of rows that hold: subdomains are factored
//! once. There are three methods: a primal-dual active set (`active_set`); damped Newton steps on the augmented
//! Lagrangian (`lagrangian`), to which the first hands over if its sets wander; and SMALBE with MPRGP (`smalbe`). A
//! check before the loop finds out whether a solution exists (`feasible`).

mod active_set;
mod augmented;
mod balance;
mod cone;
mod damping;
mod dependent;
mod feasible;
mod judge;
mod lagrangian;
mod motion;
mod mprgp;
mod newton;
mod settings;
mod smalbe;
mod state;

pub use settings::{ContactSettings, ContactType};
pub use state::{Observer, Progress, State, Step};

use crate::feti::{LinearMethod, LinearSolution};
use crate::Result;
use active_set::Ended;

/// Solves the problem with its inequalities. Returns the solution and the steps of the loop. Collective.
///
/// # Errors
/// Contradictory rows, bodies that the load pushes away for ever, PETSc's own errors, and those of `observe`.
pub(crate) fn solve(
    method: &LinearMethod,
    settings: &ContactSettings,
    start: Option<&State>,
    observe: &mut Observer,
) -> Result<(LinearSolution, Vec<Step>)> {
    feasible::check(&method.problem, &method.dual())?;
    let begin = || {
        start
            .cloned()
            .unwrap_or_else(|| State::cold(&method.dual().stiffness.jump))
    };
    let (found, steps) = match settings.kind {
        ContactType::ActiveSet => match active_set::solve(method, settings, start, observe)? {
            Ended::Found(found, steps) => (found, steps),
            Ended::HandedOver {
                state,
                steps,
                seconds,
            } => lagrangian::solve(method, settings, state, steps, seconds, observe)?,
        },
        ContactType::AugmentedLagrangian => {
            lagrangian::solve(method, settings, begin(), Vec::new(), 0.0, observe)?
        }
        ContactType::Smalbe => smalbe::solve(method, settings, begin(), observe)?,
    };
    let refined = method.refine(found)?;
    Ok((method.certify(refined)?, steps))
}
