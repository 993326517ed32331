//! The contact loop: inequality rows B_I u ≤ c with multipliers λ_I ≥ 0, [Lee (3.1)-(3.3)] (docs/theory.md, section 9).
//!
//! ```text
//!     min ½ uᵀ K u − fᵀ u    subject to    B_E u = c_E,  B_I u ≤ c_I
//! ```
//!
//! The loop calls the solver of equations and changes only Z^k, the set of rows that hold: subdomains are factored
//! once. There are two methods: a primal-dual active set (`active_set`) and SMALBE with MPRGP (`smalbe`). The first
//! hands over to the second if its sets cycle. A check before the loop finds out whether a solution exists
//! (`feasible`).

mod active_set;
mod augmented;
mod balance;
mod cone;
mod feasible;
mod judge;
mod motion;
mod mprgp;
mod settings;
mod smalbe;
mod state;

pub use settings::{ContactSettings, ContactType};
pub use state::{Caution, Observer, State, Step};

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
    let ended = match settings.kind {
        ContactType::ActiveSet => active_set::solve(method, settings, start, observe)?,
        ContactType::Smalbe => {
            let cold = || State::cold(&method.dual().stiffness.jump);
            Ended::HandedOver {
                state: start.cloned().unwrap_or_else(cold),
                steps: Vec::new(),
                seconds: 0.0,
            }
        }
    };
    let (found, steps) = match ended {
        Ended::Found(found, steps) => (found, steps),
        Ended::HandedOver {
            state,
            steps,
            seconds,
        } => smalbe::solve(method, settings, state, steps, seconds, observe)?,
    };
    let refined = method.refine(found)?;
    Ok((method.certify(refined)?, steps))
}
