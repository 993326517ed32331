//! `FetiFeti`: from substructures to a solver that can be asked for solutions and spectra.

use std::cell::{Ref, RefCell};
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

use super::adaptive::constraints as adaptive;
use super::cost::choice;
use super::deflation;
use super::interface::entities;
use super::interface::sharing::Sharing;
use super::jump::deluxe;
use super::jump::operator::Jump;
use super::jump::weights::weights;
use super::krylov::correction;
use super::krylov::recover;
use super::krylov::recover::{Judge, Solution};
use super::lifting::correction::Lifting;
use super::operators::dual;
use super::operators::dual::{Dual, Shared};
use super::operators::preconditioner::Preconditioner;
use super::operators::stiffness::Stiffness;
use super::primal::coarse::PrimalProblem;
use super::primal::refine;
use super::primal::refine::Refinement;
use super::primal::space::PrimalSpace;
use super::projector::natural::NaturalCoarse;
use super::settings::{PcType, Scaling, Settings};
use super::subdomain::factor::{factor, no_factor};
use super::subdomain::problem::LocalProblem;
use super::subdomain::scaled::Local;
use crate::contact;
use crate::parallel::clock;
use crate::parallel::clock::Phase;
use crate::parallel::halo::Halo;
use crate::parallel::team::Team;
use crate::petsc::{cite, Comm, Ksp, NormType, Session, Stage, Vec as PetscVec};
use crate::substructures::{Subdomain, Substructures};
use crate::{Error, Result};
use mpi::traits::Communicator;

const CITATION: &str = "@techreport{Lee2010,
  author = {Jungho Lee},
  title  = {Convergence analysis of a new domain decomposition method for a linearized contact problem},
  institution = {Oak Ridge National Laboratory},
  year   = {2010}
}
";

/// Iterations before the first look at the spectrum. A search costs about twenty; most steps of a contact loop take no more, and the matrices of the
/// deflation would have to be renewed in each of them.
const WATCHED_FROM: usize = 5;
const WATCHED_FROM_IN_STEPS: usize = 20;

/// The residual may become this many times the first one before the iteration counts as divergent.
const GROWTH: f64 = 1e12;

/// KKT residuals may be this many times the tolerance of the iteration, which measures another norm.
const CREDIBLE: f64 = 1e4;

/// Facts about the problem as the solver sees it.
#[derive(Debug, Clone, Default)]
pub struct Facts {
    /// Rows of B_loc.
    pub multipliers_local: usize,
    /// Rows of B_gl.
    pub multipliers_global: usize,
    /// Rows of B_gl that hold.
    pub multipliers_active: usize,
    /// Rows of B_gl that are inequalities.
    pub inequalities: usize,
    /// Bodies with a kernel.
    pub floating_bodies: usize,
    /// Dimension of all kernels, r.
    pub kernel_dimension: usize,
    /// Primal dofs of all bodies.
    pub primal: usize,
    /// Adaptive primal constraints in each body; empty where no edge or face is tested.
    pub adaptive_constraints: Vec<usize>,
    /// Seconds of set-up that finding them and making them primal took.
    pub adaptive_seconds: f64,
    /// Different subdomains on this rank: each is factored once.
    pub kinds: usize,
    /// How many of them have S and T as sparse solves.
    pub implicit_kinds: usize,
    /// Subdomains of this rank with S in single precision.
    pub in_single: usize,
    /// Bytes of the subdomains' sparse factors on this rank.
    pub factor_bytes: usize,
    /// Bytes of the subdomains' dense operators on this rank.
    pub dense_bytes: usize,
    /// Seconds of set-up.
    pub setup_seconds: f64,
}

/// The FETI-FETI solver of one problem.
pub struct FetiFeti {
    session: Session,
    problem: Substructures,
    settings: Settings,
    dual: Shared,
    ksp: Ksp,
    facts: Facts,
    solve_stage: Stage,
}

impl FetiFeti {
    /// Factors, assembles the coarse problems and sets the Krylov method up. Collective.
    ///
    /// # Errors
    /// Bad substructures, a body that nothing holds, or PETSc's own errors; the same on all ranks.
    pub fn new(session: &Session, problem: Substructures, settings: Settings) -> Result<FetiFeti> {
        let clock = Instant::now();
        cite(session, CITATION)?;
        let stage = Stage::register(session, "FETI-FETI setup")?;
        let _staged = stage.scope()?;
        let settings = settings.with_options(session)?;
        let comm = session.comm();
        let prefix = settings.prefix.clone();

        session.agree(entities::check(&problem, settings.primal))?;
        let weights = weights(&problem, &settings);
        let sharing = session.agree(Sharing::new(comm, &problem, &weights, settings.primal))?;
        drop(weights);
        let mut jump = Jump::new(comm, &problem, &sharing);
        let mut team = Team::new(threads(session, &settings))?;
        let kind = settings.pc_type.unwrap_or_else(|| {
            choice::preconditioner(comm, &problem, &sharing, &jump, settings.coarse_functions())
        });
        let factored = clock::timed(Phase::LocalSetup, || {
            factor(session, &problem, &jump, &team, &settings, kind)
        });
        let mut locals = session.agree(factored)?;
        for (j, local) in locals.iter().enumerate() {
            jump.place(j, &local.interface);
        }
        if settings.scaling == Scaling::Deluxe {
            deluxe::apply(comm, &problem, &sharing, &mut jump, &locals);
        }
        let adapting = Instant::now();
        let adaptive = settings.adaptive;
        let added = adaptive::find(
            comm, &problem, &sharing, &mut jump, &locals, &team, adaptive,
        );
        if added.iter().any(|&n| n > 0) {
            let fails = |sub: &Subdomain, e| no_factor(&problem, sub, e);
            let renewed = adaptive::constrain(&problem, &jump, locals, &team, fails);
            locals = session.agree(renewed)?;
        }
        let adapting = adapting.elapsed().as_secs_f64();
        let mut space = PrimalSpace::new(comm, &problem, &sharing, &jump.averages, &locals);
        let primal = clock::timed(Phase::PrimalSetup, || {
            PrimalProblem::new(session, &mut space, &team, &format!("{prefix}coarse_"))
        })?;
        let layout = PetscVec::mpi(session, jump.n_owned)?;
        let dual_halo = Halo::new(session, &layout, &jump.ghosts)?;
        team.set_load(locals.iter().map(|l| l.n_delta.pow(2)).sum());
        let mut stiffness = Stiffness::new(jump, locals, space, primal, dual_halo, team);
        let varies = deflation::varies(comm, &problem);
        if varies > refine::PLAIN {
            stiffness.refine(Refinement::new(&problem, &stiffness.locals));
        }

        let lifting = match kind {
            PcType::CoarseCorrected => clock::timed(Phase::LiftingSetup, || {
                Lifting::new(
                    session,
                    &problem,
                    &sharing,
                    &stiffness,
                    settings.coarse_functions(),
                )
            })?,
            _ => None,
        };
        let preconditioner = Preconditioner::new(
            comm,
            kind,
            &problem,
            &stiffness,
            lifting,
            settings.precision,
        );
        let natural = clock::timed(Phase::NaturalSetup, || {
            NaturalCoarse::new(
                session,
                &problem,
                &stiffness,
                &preconditioner,
                (settings.projector, varies),
                &format!("{prefix}gtg_"),
            )
        })?;
        let mut facts = facts(&stiffness, &natural, comm);
        facts.in_single = preconditioner.in_single();
        let mut dual = Dual::new(session, stiffness, preconditioner, natural)?;
        dual.watched_from = match facts.inequalities {
            0 => WATCHED_FROM,
            _ => WATCHED_FROM_IN_STEPS,
        };
        dual.recycle(settings.recycle);
        let dual = Rc::new(RefCell::new(dual));
        let ksp = krylov(session, &dual, &settings)?;
        dual.borrow()
            .set_watch(deflation::watch(settings.adaptive, varies));
        facts.adaptive_constraints = added;
        facts.adaptive_seconds = adapting;
        facts.setup_seconds = clock.elapsed().as_secs_f64();
        Ok(FetiFeti {
            session: session.clone(),
            problem,
            settings,
            dual,
            ksp,
            facts,
            solve_stage: Stage::register(session, "FETI-FETI solve")?,
        })
    }

    /// Solves for the loads of the substructures: by the contact loop where rows are inequalities, at once where none is.
    /// Collective.
    ///
    /// An iteration that stops early is no error here: look at [`Solution::converged`].
    ///
    /// # Errors
    /// A body that nothing holds or that is pushed away for ever, gaps that contradict each other; PETSc's own errors.
    pub fn solve(&self) -> Result<Solution> {
        self.solve_from(None, &mut |_, _| Ok(()))
    }

    /// The same without inequalities, for those who measure the solution themselves: whenever the tolerance is reached, `enough` is asked for the factor
    /// by which the residual should fall further, and the iteration goes on from where it is until it says `None`. Collective.
    ///
    /// # Errors
    /// As [`FetiFeti::solve`], and what `enough` returns.
    pub fn solve_until(&self, enough: &Judge) -> Result<Solution> {
        let _staged = self.solve_stage.scope()?;
        let found = recover::solve(self, Some(enough))?;
        let (converged, reason) = (found.converged, found.reason.clone());
        let (session, problem) = (&self.session, &self.problem);
        let refined = correction::refine(session, problem, &self.dual, &self.ksp, found)?;
        // Digits that refinement was after and did not find are for `enough` to miss: a relative tolerance of zero asks for all there are.
        self.believe(Solution {
            converged,
            reason,
            ..refined
        })
    }

    /// The same from a given state of the contact loop, with a call after each of its steps. Without inequalities the
    /// state is not used. Collective.
    ///
    /// # Errors
    /// As [`FetiFeti::solve`], and what `observe` returns.
    pub fn solve_from(
        &self,
        start: Option<&contact::State>,
        observe: &mut contact::Observer,
    ) -> Result<Solution> {
        let _staged = self.solve_stage.scope()?;
        let solution = if self.facts.inequalities > 0 {
            contact::solve(self, start, observe)?
        } else {
            recover::solve(self, None)?
        };
        let (session, problem) = (&self.session, &self.problem);
        let solution = correction::refine(session, problem, &self.dual, &self.ksp, solution)?;
        self.believe(solution)
    }

    /// Displacements of each local subdomain for the iterate that has been reached, to be asked for by a monitor of [`FetiFeti::ksp`] during a
    /// solve without inequalities; `None` where no iteration is running. Costs about as much as an iteration. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn current(&self) -> Result<Option<Vec<Vec<f64>>>> {
        recover::current(&self.session, &self.problem, &self.dual(), &self.ksp)
    }

    /// The certificate has the last word: whatever the iteration says, displacements that are far from equilibrium, or rows that are far
    /// from holding, are no solution.
    fn believe(&self, mut solution: Solution) -> Result<Solution> {
        let rtol = self.ksp.tolerances()?.0;
        let bound = (CREDIBLE * rtol).clamp(1e-3, 0.5);
        let kkt = &solution.kkt;
        let closed = (CREDIBLE * rtol).clamp(1e-6, 0.1);
        // Written so that NaN is not believed either.
        let credible = kkt.stationarity <= bound && kkt.feasibility <= closed;
        if solution.converged && !credible {
            solution.converged = false;
            solution.reason = "DIVERGED_CERTIFICATE".into();
        }
        Ok(solution)
    }

    /// Replaces the loads (one vector per local subdomain) and the right-hand sides c of the rows (in the order in which this rank
    /// provides them). Nothing is factored again.
    ///
    /// # Panics
    /// If a length differs from what is there.
    pub fn set_loads(&mut self, loads: Vec<Vec<f64>>, gaps: &[f64]) {
        assert_eq!(loads.len(), self.problem.local.len());
        assert_eq!(gaps.len(), self.problem.rows.len());
        for (sub, f) in self.problem.local.iter_mut().zip(loads) {
            assert_eq!(f.len(), sub.f.len());
            sub.f = f;
        }
        for (row, &gap) in self.problem.rows.iter_mut().zip(gaps) {
            row.gap = gap;
        }
        self.dual.borrow_mut().stiffness.jump.set_gaps(gaps);
    }

    /// The identities that the theory promises, each with its relative defect, which must be about rounding. Collective.
    pub fn check(&self) -> Result<Vec<(&'static str, f64)>> {
        super::operators::check::identities(&self.session, &self.problem, &self.dual())
    }

    /// Facts about the problem.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// The settings in force, with options applied.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The problem.
    pub fn problem(&self) -> &Substructures {
        &self.problem
    }

    /// The operators.
    pub fn dual(&self) -> Ref<'_, Dual> {
        self.dual.borrow()
    }

    /// The operators, for those that change Z^k.
    pub(crate) fn shared(&self) -> &Shared {
        &self.dual
    }

    /// The session.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The Krylov solver of the dual problem.
    pub fn ksp(&self) -> &Ksp {
        &self.ksp
    }
}

/// Threads of this rank. Collective.
fn threads(session: &Session, settings: &Settings) -> usize {
    let wanted = settings.threads.unwrap_or_else(|| {
        let neighbours = session.comm().split_shared(session.rank() as i32);
        usual_threads(neighbours.size() as usize)
    });
    wanted.min(settings.local.most_threads().unwrap_or(wanted))
}

/// The cores of this machine divided among the ranks on it, no more than this rank is bound to.
fn usual_threads(ranks: usize) -> usize {
    let bound = std::thread::available_parallelism().map_or(1, |n| n.get());
    let online = std::fs::read_to_string("/sys/devices/system/cpu/online");
    let cores = online.ok().and_then(|text| count(&text)).unwrap_or(bound);
    (cores / ranks).clamp(1, bound)
}

/// How many numbers a list such as 0-3,8 names.
fn count(list: &str) -> Option<usize> {
    let ranges = list.trim().split(',').map(|range| {
        let (low, high) = range.split_once('-').unwrap_or((range, range));
        let (low, high): (usize, usize) = (low.parse().ok()?, high.parse().ok()?);
        (high + 1).checked_sub(low)
    });
    ranges.sum()
}

fn facts(
    stiffness: &Stiffness,
    natural: &NaturalCoarse,
    comm: &mpi::topology::SimpleCommunicator,
) -> Facts {
    let jump = &stiffness.jump;
    let contact = jump.active[jump.n_owned_local..].iter();
    let active = contact.filter(|a| **a).count();
    let inequalities = jump.inequality.iter().filter(|i| **i).count();
    let mut counts = [active as f64, inequalities as f64];
    crate::parallel::exchange::sum_all(comm, &mut counts);
    let mut kinds: Vec<&Arc<LocalProblem>> = stiffness.locals.iter().map(Local::kind).collect();
    kinds.sort_by_key(|l| Arc::as_ptr(l));
    kinds.dedup_by(|a, b| Arc::ptr_eq(a, b));
    let bytes = kinds.iter().map(|l| l.bytes());
    let (factor_bytes, dense_bytes) = bytes.fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    Facts {
        multipliers_local: jump.n_local,
        multipliers_global: jump.n_global - jump.n_local,
        multipliers_active: counts[0] as usize,
        inequalities: counts[1] as usize,
        floating_bodies: stiffness.space.defect.iter().filter(|d| **d > 0).count(),
        kernel_dimension: natural.r,
        primal: stiffness.space.n_global,
        factor_bytes,
        dense_bytes,
        kinds: kinds.len(),
        in_single: 0,
        implicit_kinds: kinds.iter().filter(|k| k.is_implicit()).count(),
        adaptive_constraints: Vec::new(),
        adaptive_seconds: 0.0,
        setup_seconds: 0.0,
    }
}

/// CG on Pᵀ F P with P M⁻¹ Pᵀ, stopped by ‖r_n‖₂ / ‖r_0‖₂ as in the paper.
fn krylov(session: &Session, dual: &Shared, settings: &Settings) -> Result<Ksp> {
    let a = dual::operator(session, dual)?;
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_operators(&a, &a)?;
    // PETSc itself adds `ksp_` to this prefix. The PC gets another one: `pc_type` chooses among our M⁻¹, not among PETSc's PCs.
    ksp.set_options_prefix(&settings.prefix)?;
    ksp.set_type("cg")?;
    ksp.set_norm_type(NormType::Unpreconditioned)?;
    // ‖r‖₂ may grow by √κ and more before it falls; what does not converge ends at the largest number of iterations.
    ksp.set_tolerances(Some(settings.rtol), None, Some(GROWTH), None)?;
    ksp.set_compute_singular_values(true)?;
    let pc = ksp.pc()?;
    pc.set_shell("fetifeti", dual::preconditioner_shell(dual))?;
    pc.set_options_prefix(&format!("{}ksp_", settings.prefix))?;
    ksp.set_from_options()?;
    let rtol = ksp.tolerances()?.0;
    if !(0.0..1.0).contains(&rtol) {
        return Err(Error::input(format!(
            "option -{}ksp_rtol is {rtol}, expected a number from 0 to below 1",
            settings.prefix
        )));
    }
    ksp.setup().map_err(|e| unfit_norm(e, &settings.prefix))?;
    Ok(ksp)
}

/// Says what to do where a Krylov method cannot judge convergence by the norm that is set.
fn unfit_norm(error: Error, prefix: &str) -> Error {
    match error {
        Error::Petsc { trace, .. } if trace.first().is_some_and(|t| t.contains("norm type")) => {
            Error::input(format!(
                "option -{prefix}ksp_type: {} (set -{prefix}ksp_norm_type to one that it supports, such as preconditioned)",
                trace[0]
            ))
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::{count, usual_threads};

    #[test]
    fn ranks_share_the_cores_of_a_machine() {
        assert_eq!(count("0-3,8\n"), Some(5));
        assert_eq!(count("0"), Some(1));
        assert_eq!(count("none"), None);
        assert!(usual_threads(1) >= 1);
        assert_eq!(usual_threads(1 << 20), 1);
    }
}
