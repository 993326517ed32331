//! The end of a search on the augmented Lagrangian: whether it is the solution, and the solution.

use super::semismooth_newton::SemismoothNewton;
use super::state::Step;
use crate::feti::krylov::iterate::KrylovRun;
use crate::feti::LinearSolution;
use crate::status::Status;
use crate::Result;
use parallel::exchange::highest;

impl SemismoothNewton<'_> {
    /// Whether the springs give way by no more than the tolerance, and their forces are those of the displacements to
    /// the digits that this asks for. Collective.
    pub fn is_solution(&self, rtol: f64) -> Result<bool> {
        let comm = self.method.session.comm();
        // Anchors bear a part of the load.
        let (Some(point), None) = (&self.point, &self.anchors) else {
            return Ok(false);
        };
        let pull = self.penalty().pull(point);
        let pairs = || (0..pull.len()).filter(|&i| self.law[i].is_inequality());
        let apart = pairs().map(|i| (self.law[i].project(pull[i]) - point.force[i]).abs());
        let force = pairs().map(|i| point.force[i].abs());
        let (apart, force) = (apart.fold(0.0, f64::max), force.fold(0.0, f64::max));
        if highest(comm, apart) > rtol.sqrt() * highest(comm, force) {
            return Ok(false);
        }
        let dual = self.method.dual();
        let jump = &dual.stiffness.jump;
        let open = self.point.iter().flat_map(|p| p.gap.iter().enumerate());
        let open = open.filter(|(i, _)| self.law[*i].is_inequality());
        let open = open.fold(0.0f64, |a, (i, gap)| {
            if jump.active[i] {
                a.max(gap.abs())
            } else {
                a.max(*gap)
            }
        });
        Ok(highest(comm, open) <= rtol * self.length)
    }

    /// The solution at the last Newton step. Collective.
    pub fn finish(
        mut self,
        steps: &[Step],
        seconds: f64,
        status: Status,
    ) -> Result<LinearSolution> {
        self.evaluate_point()?;
        self.rigid();
        // P_2 belonged to F + C: what follows is done with F.
        let active = self.method.dual().stiffness.jump.active.clone();
        self.method.set_active(&active)?;
        let last = self.last.map(|run| (run.residuals, run.estimate));
        let iterations = steps.iter().map(|s| s.iterations).sum();
        let run = KrylovRun::of_loop(iterations, status, last.unwrap_or_default());
        let mut at = self.at;
        at.loads.jumps = None;
        self.method.recover(at, run, seconds)
    }
}
