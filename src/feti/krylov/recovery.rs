//! Recovery of the displacements from the multipliers.
//!
//! ```text
//!     u_Γ = S̃⁺(g − Bᵀ λ) + R α               u_I by back substitution
//! ```

use std::time::Instant;

use super::certificate::{Certificate, Kkt};
use super::iterate::KrylovRun;
use super::leftover::Leftover;
use super::loads::Loads;
use super::residual::{Iterate, Residual};
use crate::feti::method::LinearMethod;
use crate::feti::operators::dual::Dual;
use crate::feti::spectrum::Spectrum;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::feti::subdomain::which::Operator;
use crate::status::Status;
use crate::Result;
use cholesky::lanes::LANES;

/// The solution of the linear method; vectors are this rank's part.
#[derive(Debug, Clone)]
pub struct LinearSolution {
    /// Displacements of each local subdomain, by local dof; copies inside a body agree.
    pub u: Vec<Vec<f64>>,
    /// Multipliers of the rows that this rank owns.
    pub lambda: Vec<f64>,
    /// B u − c on these rows, including those that do not hold.
    pub gaps: Vec<f64>,
    /// Whether each of these rows holds. Rows that follow from others that hold are included.
    pub active: Vec<bool>,
    /// Krylov iterations.
    pub iterations: usize,
    /// The reason why the iterations stopped, or the verdict of the certificate on their result.
    pub status: Status,
    /// ‖r_n‖₂ for n = 0, 1, …
    pub residuals: Vec<f64>,
    /// The Krylov method's own estimate of the spectrum.
    pub estimate: Option<Spectrum>,
    /// Optimality.
    pub kkt: Kkt,
    /// ½ uᵀ K u − fᵀ u + λᵀ (B u − c).
    pub energy: f64,
    /// The residual of the equations, and the sizes of their terms.
    pub left: Leftover,
    /// Seconds of condensing and iterating.
    pub solve_seconds: f64,
    /// Seconds of the recovery.
    pub recover_seconds: f64,
}

impl LinearMethod {
    /// The solution of `at` after this run. The displacements of `at` must belong to its λ and include the rigid
    /// motions. Collective.
    pub(crate) fn recover(
        &self,
        at: Iterate,
        run: KrylovRun,
        solve_seconds: f64,
    ) -> Result<LinearSolution> {
        self.recovered(at, (run, None), solve_seconds)
    }

    /// [`recover`](Self::recover) with the displacements, if they are known already. Collective.
    pub(super) fn recovered(
        &self,
        mut at: Iterate,
        (run, seen): (KrylovRun, Option<Vec<Vec<f64>>>),
        solve_seconds: f64,
    ) -> Result<LinearSolution> {
        let clock = Instant::now();
        let dual = self.dual();
        let u = match seen {
            Some(u) => u,
            None => displacements(&dual, &at.loads, &mut at.residual)?,
        };
        let recover_seconds = clock.elapsed().as_secs_f64();
        let certificate =
            Certificate::new(&self.problem, &dual, &u, &at.lambda, self.length.get())?;
        Ok(LinearSolution {
            u,
            lambda: at.lambda.to_vec()?,
            gaps: certificate.gaps,
            active: dual.stiffness.jump.implied(),
            iterations: run.iterations,
            status: run.status,
            residuals: run.residuals,
            estimate: run.estimate,
            kkt: certificate.kkt,
            energy: certificate.energy,
            left: certificate.left,
            solve_seconds,
            recover_seconds,
        })
    }

    /// g − S u_Γ of each local subdomain, by local dof: the forces of rows and of neighbours that its displacements ask
    /// for, with u_Γ = S̃⁺(g − Bᵀ λ) as it is before the remaining jumps are averaged. So the copies of a dof inside a
    /// body are in equilibrium to rounding, however far the iteration went. Zero inside. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub(crate) fn interface_forces(&self, lambda: &[f64]) -> Result<Vec<Vec<f64>>> {
        let dual = self.dual();
        let stiffness = &dual.stiffness;
        let loads = Loads::new(&self.problem, &dual);
        let (loaded, _) = loads.with_multipliers(&self.problem, &dual, lambda)?;
        let mut work = stiffness.work();
        let all = work.iter_mut().zip(loaded);
        all.for_each(|(w, g)| w.v = g);
        stiffness.s_plus(&mut work)?;
        let (problem, locals, loads) = (&self.problem, &stiffness.locals, &loads.g);
        let forces = stiffness.team.map(work.len(), |j| {
            let local = &locals[j];
            let mut s_u = vec![0.0; work[j].y.len()];
            local.apply_one(Operator::S, &work[j].y, &mut s_u);
            let mut out = vec![0.0; problem.local[j].f.len()];
            let on_gamma = local.gamma().interface.iter().zip(&loads[j]).zip(&s_u);
            on_gamma.for_each(|((&i, g), s_u)| out[i as usize] = g - s_u);
            out
        });
        Ok(forces)
    }

    /// Displacements of each local subdomain for the present iterate, for a monitor of the Krylov method. `None` if no
    /// iteration is running that monitors may look into. The cost is about that of an iteration. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn current(&self) -> Result<Option<Vec<Vec<f64>>>> {
        let system = &self.system;
        let Some(start) = system.start() else {
            return Ok(None);
        };
        let dual = self.dual();
        let loads = Loads::new(&self.problem, &dual);
        let mut at = Iterate::new(&dual, loads)?;
        self.ksp.current_solution(&at.lambda)?;
        dual.p(&at.lambda)?;
        system.p2(&at.lambda)?;
        at.lambda.axpy(1.0, &start)?;
        at.place(&dual)?;
        displacements(&dual, &at.loads, &mut at.residual).map(Some)
    }
}

/// u of every local subdomain from the y of `residual`, which must include the rigid motions; y is changed.
pub(super) fn displacements(
    dual: &Dual,
    loads: &Loads,
    residual: &mut Residual,
) -> Result<Vec<Vec<f64>>> {
    let stiffness = &dual.stiffness;
    // The remaining jumps inside a body are averaged: u ← u − B_D,locᵀ B_loc u.
    let work = &mut residual.work;
    let jump = &residual.r;
    stiffness.jump_of(work, jump)?;
    jump.array_mut()?[stiffness.jump.n_owned_local..].fill(0.0);
    let mut ghost = stiffness.scaled_ghosts();
    stiffness.fetch_scaled(jump, &mut ghost)?;
    let columns = &stiffness.jump.columns;
    stiffness.team.for_each(work, |j, w| {
        columns.of(j).bd_transpose(&ghost, &mut w.v);
        for (y, v) in w.y.iter_mut().zip(&w.v) {
            *y -= v;
        }
    });
    let work = &*work;
    let batches = stiffness.batches(LANES);
    Ok(stiffness.by_batch(&batches, |locals, members| {
        let part = |&j: &usize| (&loads.interiors[j][..], &work[j].y[..]);
        let parts: Vec<_> = members.iter().map(part).collect();
        ScaledSubdomain::recover_many(locals, &parts)
    }))
}
