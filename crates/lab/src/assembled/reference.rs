//! The reference solution: a direct solution that shares nothing with the method but the matrices of the subdomains.
//!
//! MUMPS factors the assembled matrix; with inequalities, an active-set loop surrounds it. Every solution is refined,
//! by default with residuals in twice the working precision. It runs on any number of ranks.

use super::course::{ActiveSetEnd, OuterSolve, OuterStart, Tolerances};
use super::layout::UnknownLayout;
use super::load_steps::LoadSteps;
use super::near::{Near, NearKernel};
use super::problem::AssembledProblem;
use super::reduced::Reduced;
use super::refine::{over, Refiner};
use super::strain::{energy_norm, values};
use super::system::{Copies, MatrixFormat};
use super::unknowns::Unknowns;
use crate::assembled::outer;
use base::{Error, Result};
use fetifeti::inside::idle;
use fetifeti::Subdomain;
use parallel::contiguous_share;
use parallel::exchange::{max_all, sum_all};
use petsc::{Comm, Ksp, Session, Vec as PetscVec};
use scene::Scene;

/// Residual that a solution in working precision must reach. A refined solution is judged by its certificate instead.
const TARGET: f64 = 1e-8;

/// Solves with one factor in working precision; all but the first refine.
const SOLVES: usize = 3;

/// The supports added by the layout may bear this part of the load.
const BALANCED: f64 = 1e-8;

/// The precision in which residuals are summed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResidualPrecision {
    /// Working precision: the accuracy of MUMPS with iterative refinement.
    Working,
    /// Twice the working precision: for the reference solution that errors are measured against.
    Twice,
}

/// The direct solution of a scene at its last load step, with friction from the steps before it.
pub struct Reference<'a> {
    session: Session,
    layout: &'a UnknownLayout<'a>,
    /// The assembled problem.
    pub problem: AssembledProblem,
    /// Its solution, or that of the first load step without one.
    pub found: ActiveSetEnd,
    /// The load steps, and the solutions of those before the last one.
    pub steps: LoadSteps,
    /// The solutions of the steps before.
    pub before: Vec<ActiveSetEnd>,
}

impl<'a> Reference<'a> {
    /// Solves `scene`, whose layout is given. Where a set is `given`, only its equations are solved. `found` says
    /// whether there is a solution. Collective.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) where the inequalities have no frames; those of the scene, and
    /// PETSc's.
    pub fn new(
        session: &Session,
        scene: &Scene,
        layout: &'a UnknownLayout<'a>,
        precision: ResidualPrecision,
        given: Option<&[bool]>,
    ) -> Result<Reference<'a>> {
        if let Some(trouble) = &layout.trouble {
            return Err(Error::input(format!("not for this scene: {trouble}")));
        }
        if layout.unsupported > 0 {
            return Err(Error::input(
                "not for this scene: nothing holds a body whose nodes are all in inequalities",
            ));
        }
        let unknowns = Unknowns::all(layout);
        let format = MatrixFormat::Assembled;
        let mut problem = AssembledProblem::new(session, scene, &unknowns, format)?;
        let assembled = (&problem.system, &problem.rows);
        let steps = LoadSteps::new(session, scene, assembled, format)?;
        let refiner;
        let solve = match precision {
            ResidualPrecision::Working => OuterSolve::Repeated(SOLVES),
            ResidualPrecision::Twice => {
                refiner = Refiner::new(session, &problem.system, &problem.trace)?;
                OuterSolve::Refined(&refiner)
            }
        };
        let kernel = NearKernel::new(scene, &unknowns, &problem.system.b, Near::None)?;
        let mut reduced = Reduced::new(session, &problem.system, &problem.rows, kernel)?;
        let ksp = mumps(session)?;
        let tolerances = Tolerances {
            rtol: TARGET,
            inner: 0.0,
            lag: 0.0,
        };
        let mut solver = || Ok(ksp.clone());
        // Without inequalities there is one set only, the empty one.
        let given = given.or((problem.rows.len() == 0).then_some(&[]));
        let system = &problem.system;
        let mut before = steps.follow(&mut problem.rows, |step, rows, start| {
            // Residuals in twice the precision are those of the assembled system.
            system.b.copy_from(&step.b)?;
            reduced.set_load(&step.b, step.reference);
            let start = given.map_or(start, OuterStart::Given);
            let solver = &mut solver;
            outer::solve(session, rows, &reduced, solver, tolerances, solve, start)
        })?;
        let found = before.pop().expect("there is a load step");
        let mut out = Reference {
            session: session.clone(),
            layout,
            problem,
            found,
            steps,
            before,
        };
        if layout.loose() > 0 && out.found.converged && out.pushed(scene)? > BALANCED {
            out.found.converged = false;
            out.found.reason = "DIVERGED_LOAD_NOT_BALANCED".into();
        }
        Ok(out)
    }

    /// As [`Reference::new`] with residuals in twice the working precision; it is an error if no solution is found.
    /// Collective.
    ///
    /// # Errors
    /// As [`Reference::new`]; [`ErrorKind::NotConverged`](base::ErrorKind::NotConverged) where no solution satisfies
    /// the conditions, such as where nothing holds a body.
    pub fn certified(
        session: &Session,
        scene: &Scene,
        layout: &'a UnknownLayout<'a>,
    ) -> Result<Reference<'a>> {
        let out = Reference::new(session, scene, layout, ResidualPrecision::Twice, None)?;
        let found = &out.found;
        if !found.converged {
            let c = found.certificate;
            return Err(Error::not_converged(format!(
                "the direct solution ends with {}, a correction of {:.1e}, a violation of {:.1e} and a pull of {:.1e}",
                found.reason, c.correction, c.feasibility, c.pull
            )));
        }
        Ok(out)
    }

    /// The solution on these subdomains by local dof. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn values(&self, subdomains: &[Subdomain]) -> Result<Vec<Vec<f64>>> {
        values(&self.session, self.layout, &self.found.u, subdomains, true)
    }

    /// √(wᵀ K w), whatever rigid motions w has. Collective.
    ///
    /// # Errors
    /// Those of the scene, and PETSc's.
    pub fn energy_norm(&self, w: &PetscVec) -> Result<f64> {
        energy_norm(&self.session, self.layout, &self.problem.system, w)
    }

    /// The distance of the u of these subdomains from the solution: in the energy norm, and by the largest
    /// displacement, each relative to the solution. The subdomains of all ranks together are those of the scene. In the
    /// energy norm the mean of the copies of an unknown counts. Collective.
    ///
    /// # Errors
    /// Those of the scene, and PETSc's.
    pub fn distance(
        &self,
        subdomains: &[Subdomain],
        u: &[Vec<f64>],
        copies: Copies,
    ) -> Result<[f64; 2]> {
        let mut values = self.values(subdomains)?;
        idle::remove_idle(self.session.comm(), subdomains, &mut values);
        let most = |list: &[Vec<f64>]| list.iter().flatten().fold(0.0f64, |a, v| a.max(v.abs()));
        let size = most(&values);
        for (values, u) in values.iter_mut().zip(u) {
            values.iter_mut().zip(u).for_each(|(v, u)| *v = u - *v);
        }
        let mut largest = [most(&values), size];
        max_all(self.session.comm(), &mut largest);
        let energy = self.size(subdomains, &values, copies)?;
        Ok([energy, over(largest[0], largest[1])])
    }

    /// The energy norm of d, relative to that of the solution. Collective.
    ///
    /// # Errors
    /// Those of the scene, and PETSc's.
    pub fn size(&self, subdomains: &[Subdomain], d: &[Vec<f64>], copies: Copies) -> Result<f64> {
        let (system, unknowns) = (&self.problem.system, Unknowns::all(self.layout));
        let (mean, _) = system.mean(&self.session, subdomains, d, &unknowns, copies)?;
        Ok(over(
            self.energy_norm(&mean)?,
            self.energy_norm(&self.found.u)?,
        ))
    }

    /// The largest force on a support added by the layout, relative to the load. Collective.
    fn pushed(&self, scene: &Scene) -> Result<f64> {
        let share = contiguous_share(
            scene.n_subdomains(),
            self.session.size(),
            self.session.rank(),
        );
        let mine: Result<Vec<Subdomain>> = share.map(|s| scene.subdomain(s)).collect();
        let mine = self.session.agree(mine)?;
        let u = self.values(&mine)?;
        let supports = self.layout.supports();
        let mut forces = vec![0.0; supports.len()];
        for (s, u) in mine.iter().zip(&u) {
            for (i, &dof) in s.dofs.iter().enumerate() {
                // A dependent unknown hands its force on to those that it follows.
                for (at, coefficient) in self.layout.terms(self.layout.index(dof)).0 {
                    let Ok(k) = supports.binary_search(&at) else {
                        continue;
                    };
                    let (cols, vals) = s.k.row(i);
                    let ku: f64 = cols.iter().zip(vals).map(|(&j, v)| v * u[j as usize]).sum();
                    forces[k] += coefficient * (s.f[i] - ku);
                }
            }
        }
        sum_all(self.session.comm(), &mut forces);
        let largest = forces.iter().fold(0.0f64, |a, f| a.max(f.abs()));
        Ok(over(largest, self.problem.system.reference))
    }
}

/// MUMPS, without options of the user.
pub(super) fn mumps(session: &Session) -> Result<Ksp> {
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_type("preonly")?;
    let pc = ksp.pc()?;
    pc.set_type("cholesky")?;
    pc.set_solver_type("mumps")?;
    Ok(ksp)
}

#[cfg(test)]
#[path = "../../tests/assembled/reference.rs"]
mod tests;
