//! How a solve ended.

use std::fmt;

use petsc::ConvergedReason;

/// The reason why a solve stopped. It is displayed as PETSc names its reasons, such as `CONVERGED_RTOL`.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// The Krylov method's own reason.
    Krylov(ConvergedReason),
    /// The residual was within the tolerance before the first iteration.
    NothingToDo,
    /// The tolerance asked for is below rounding: the solution is as good as rounding permits.
    Rounding,
    /// The iteration converged, but refinement did not reach the requested accuracy.
    Refinement,
    /// The iteration converged, but the displacements are far from equilibrium, or rows are far from holding.
    Certificate,
    /// Everything reached its tolerance, but the forces on a body do not balance.
    Balance,
    /// The residual of the host's equations stopped to fall above its tolerance: rounding.
    Stagnation,
    /// The contact loop reached its largest number of steps.
    ContactSteps,
}

impl Status {
    /// Whether everything reached its tolerance, or rounding where the tolerance is below it.
    pub fn converged(&self) -> bool {
        match self {
            Status::Krylov(reason) => reason.converged(),
            Status::NothingToDo | Status::Rounding => true,
            Status::Refinement
            | Status::Certificate
            | Status::Balance
            | Status::Stagnation
            | Status::ContactSteps => false,
        }
    }

    /// Whether the Krylov method met a direction that rounding has made indefinite, or broke down: its operators have
    /// no more digits.
    pub(crate) fn broke_down(&self) -> bool {
        matches!(self, Status::Krylov(reason) if reason.broke_down())
    }

    /// Whether the Krylov method reached its largest number of iterations.
    pub(crate) fn ran_out(&self) -> bool {
        matches!(self, Status::Krylov(reason) if reason.code == ConvergedReason::ITS)
    }

    /// The number of PETSc's `KSPConvergedReason` with the same meaning, or the nearest one: rounding counts as an
    /// absolute tolerance, operators that have lost their digits as a preconditioner that failed, a residual that
    /// rounding holds up as a breakdown, too many contact steps as too many iterations.
    pub fn number(&self) -> i32 {
        match self {
            Status::Krylov(reason) => reason.code,
            Status::NothingToDo => ConvergedReason::RTOL,
            Status::Rounding => ConvergedReason::ATOL,
            Status::Refinement | Status::Certificate | Status::Balance => {
                ConvergedReason::PC_FAILED
            }
            Status::Stagnation => ConvergedReason::BREAKDOWN,
            Status::ContactSteps => ConvergedReason::ITS,
        }
    }

    /// Advice to the user about this status, as a sentence without a full stop; `None` where the name says it all.
    pub fn remedy(&self) -> Option<&'static str> {
        match self {
            Status::Refinement => Some(
                "the iteration converged, but the operators carry too much rounding for the tolerance asked for: \
                 ask for less (-ksp_rtol), or look for elements or coefficients of very different size",
            ),
            Status::Certificate => Some(
                "the iteration converged, but the result is far from equilibrium or from continuity, so that it is no \
                 solution: look for elements or coefficients of very different size, and try \
                 -fetifeti_primal vertices,edges,faces or other bodies (-fetifeti_bodies)",
            ),
            Status::Balance => Some(
                "the loads, springs, contacts and reactions of a body do not add up to nothing, so that the result is \
                 no solution: ask for more digits (-fetifeti_ksp_rtol), and look for elements or coefficients of very \
                 different size",
            ),
            _ => None,
        }
    }

    /// The name, such as `CONVERGED_RTOL`.
    pub fn name(&self) -> &str {
        match self {
            Status::Krylov(reason) => &reason.name,
            Status::NothingToDo => "CONVERGED_NOTHING_TO_DO",
            Status::Rounding => "CONVERGED_ROUNDING",
            Status::Refinement => "DIVERGED_REFINEMENT",
            Status::Certificate => "DIVERGED_CERTIFICATE",
            Status::Balance => "DIVERGED_BALANCE",
            Status::Stagnation => "DIVERGED_STAGNATION",
            Status::ContactSteps => "DIVERGED_CONTACT_ITS",
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
#[path = "../tests/inside/status.rs"]
mod tests;
