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
mod anchored;
mod anchors;
mod augmented;
mod certified_signs;
mod coercivity;
mod compliant_rows;
mod farkas;
mod feasible;
mod force_balance;
mod judge;
mod lagrangian;
mod least_distance;
mod line_minimum;
mod line_search;
mod mean_compliance;
mod mprgp;
mod newton_termination;
mod pull_monitor;
mod ratio_test;
mod semismooth_newton;
mod settings;
mod smalbe;
mod state;
mod unilateral_springs;

pub use settings::{ContactSettings, ContactType};
pub use state::{ActiveSetProgress, Observer, State, Step};

use crate::feti::krylov::loads::Loads;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;
use active_set::Ended;

/// Solves the problem with its inequalities. Returns the solution and the steps of the loop. After an error the rows of
/// the method hold that held before. Collective.
///
/// # Errors
/// Contradictory rows, bodies that the load pushes away for ever, PETSc's own errors, and those of `observe`.
pub(crate) fn solve(
    method: &LinearMethod,
    settings: &ContactSettings,
    start: Option<&State>,
    observe: &mut Observer,
) -> Result<(LinearSolution, Vec<Step>)> {
    method.with_rows_kept(|| judged(method, settings, start, observe))
}

/// Runs of the loop until all rows are on the right side. Collective.
fn judged(
    method: &LinearMethod,
    settings: &ContactSettings,
    start: Option<&State>,
    observe: &mut Observer,
) -> Result<(LinearSolution, Vec<Step>)> {
    feasible::check(&method.problem, &method.dual())?;
    let before = start.map_or(0, |s| s.steps);
    let begin = start.cloned();
    let (mut found, mut steps) = outer(method, settings, settings.kind, begin, observe)?;
    let mut accuracy = 1.0;
    for _ in 0..certified_signs::ROUNDS {
        let certified = method.certify(method.refine(found)?)?;
        // A certificate that rows on the wrong side have spoilt is for the loop to mend.
        if !certified.status.converged() && certified.status != Status::Certificate {
            return Ok((certified, steps));
        }
        let Some(mut state) = certified_signs::wrong_signs(method, &certified)? else {
            return Ok((certified, steps));
        };
        accuracy *= certified_signs::FURTHER;
        state.accuracy = accuracy;
        state.steps = before + steps.len();
        let kind = ContactType::ActiveSet;
        let (next, more) = outer(method, settings, kind, Some(state), observe)?;
        let (iterations, seconds) = (certified.iterations, certified.solve_seconds);
        steps.extend(more);
        found = LinearSolution {
            iterations: iterations + next.iterations,
            solve_seconds: seconds + next.solve_seconds,
            ..next
        };
    }
    let mut last = method.certify(method.refine(found)?)?;
    if last.status.converged() && certified_signs::wrong_signs(method, &last)?.is_some() {
        last.status = Status::Certificate;
    }
    Ok((last, steps))
}

/// One run of the loop, without the certificate. Collective.
fn outer(
    method: &LinearMethod,
    settings: &ContactSettings,
    kind: ContactType,
    start: Option<State>,
    observe: &mut Observer,
) -> Result<(LinearSolution, Vec<Step>)> {
    let cold = || State::cold(&method.dual().stiffness.jump);
    match kind {
        ContactType::ActiveSet => {
            match active_set::solve(method, settings, start.as_ref(), observe)? {
                Ended::Found(found, steps) => {
                    if !found.status.converged() {
                        ask(method, &found.lambda)?;
                    }
                    Ok((found, steps))
                }
                Ended::HandedOver {
                    state,
                    steps,
                    seconds,
                } => lagrangian::solve(method, settings, state, steps, seconds, observe),
            }
        }
        ContactType::AugmentedLagrangian => {
            let state = start.unwrap_or_else(cold);
            lagrangian::solve(method, settings, state, Vec::new(), 0.0, observe)
        }
        ContactType::Smalbe => {
            let state = start.unwrap_or_else(cold);
            ask(method, &state.lambda)?;
            smalbe::solve(method, settings, state, observe)
        }
    }
}

/// Returns an error that names bodies which the load pushes away for ever. Few rigid motions are asked about before the
/// loop, many only here, from the λ where the loop is: where it has failed or does not end, and before SMALBE, which
/// would go on for ever. Collective.
fn ask(method: &LinearMethod, lambda: &[f64]) -> Result<()> {
    let dual = method.dual();
    let load = Loads::new(&method.problem, &dual).kernel;
    farkas::check_many(&method.problem, &dual, &load, lambda)
}
