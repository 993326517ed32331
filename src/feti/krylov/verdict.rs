//! Verdicts of callers on the displacements that the iteration has reached, and their consequences.
//!
//! A host that measures the residual of its own equations needs no other measure: the certificate would cost as much as
//! an iteration or two, and the velocities of a Stokes problem are solved for some hundred times, in four iterations
//! each.

use super::iterate::KrylovRun;
use super::recovery::LinearSolution;
use crate::Result;

/// When the judge looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JudgeTiming {
    /// Before the first iteration, because there may be nothing left to iterate on.
    Before,
    /// After an iteration to the tolerance.
    After,
}

/// Judges displacements. Returns the factor by which the residual should fall further, or `None`. Before the first
/// iteration the factor is not used: anything but `None` lets the iteration begin.
pub type Judge<'a> = dyn Fn(&[Vec<f64>], JudgeTiming) -> Result<Option<f64>> + 'a;

/// A host's verdict on displacements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// They satisfy the host's own equations, whose residual it has measured. Nothing else is measured.
    Satisfied,
    /// No further iteration is wanted. The certificate has the last word.
    Enough,
    /// The residual should fall further by this factor; before the first iteration: this may begin.
    Further(f64),
}

/// Gives verdicts on displacements.
pub type HostJudge<'a> = dyn Fn(&[Vec<f64>], JudgeTiming) -> Result<Verdict> + 'a;

/// A run, and the displacements of its result if the host has seen them.
pub(super) struct JudgedRun {
    /// The run.
    pub run: KrylovRun,
    /// The displacements.
    pub seen: Option<Vec<Vec<f64>>>,
    /// Whether they satisfy the host's equations.
    pub satisfied: bool,
}

/// The result of a solve for a host.
pub enum HostSolution {
    /// The displacements that the host has seen last satisfy its equations.
    Satisfied(KrylovRun),
    /// The solution with its certificate.
    Certified(Box<LinearSolution>),
}
