//! The set-up of the linear method: from substructures to operators and a Krylov method.

use std::cell::{Cell, OnceCell};
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

use mpi::traits::Communicator;

use super::adaptive::{constrain::constrain, constraints};
use super::cost::{choice, variation};
use super::interface::sharing::DofSharing;
use super::interface::{entities, location};
use super::jump::deluxe;
use super::jump::operator::Jump;
use super::jump::weights::weights;
use super::krylov::shells;
use super::krylov::system::DualSystem;
use super::method::LinearMethod;
use super::operators::dual::Dual;
use super::operators::preconditioner::{table, PreconditionerInput};
use super::operators::stiffness::Stiffness;
use super::primal::coarse::PrimalProblem;
use super::primal::refinement::PrimalRefinement;
use super::primal::slack;
use super::primal::space::PrimalSpace;
use super::projector::natural::NaturalCoarse;
use super::set_up_summary::SetUpSummary;
use super::settings::{MethodSettings, Scaling};
use super::subdomain::factor::{factor, no_factor, Factored};
use super::subdomain::retained::RetainedFactors;
use super::subdomain::scaled::ScaledSubdomain;
use crate::feti::primal::refinement;
use crate::substructures::{Problem, Subdomain};
use crate::{Error, Result};
use cholesky::interior::Analysed;
use parallel::clock::{self, Phase};
use parallel::exchange::any;
use parallel::halo::Halo;
use parallel::team::Team;
use petsc::{Comm, Event, Ksp, NormType, Options, Session, Vec as PetscVec};

/// The iteration counts as divergent if the residual becomes this many times the first one.
const GROWTH: f64 = 1e12;

/// The result of a set-up: all of a [`LinearMethod`] that follows from the rows.
pub(super) struct SetUpResult {
    system: Rc<DualSystem>,
    ksp: Ksp,
    facts: SetUpSummary,
    varies: f64,
    analysed: Vec<Option<Arc<Analysed>>>,
}

/// Number of adaptive primal constraints of each body, and the seconds for finding them.
struct Added {
    constraints: Vec<usize>,
    seconds: f64,
}

impl LinearMethod {
    /// Factors, assembles the coarse problems and sets the Krylov method up. Collective.
    ///
    /// # Errors
    /// Bad substructures, a body that nothing holds, or PETSc's own errors; the same on all ranks.
    pub fn new(
        session: &Session,
        problem: Problem,
        settings: MethodSettings,
    ) -> Result<LinearMethod> {
        LinearMethod::keeping(session, problem, settings, None)
    }

    /// Sets a problem up with what is `kept` of another one, from which it differs only in rows, or in rows and the
    /// numbers of matrices: where the interface of a subdomain is the same, its factors or its analysis are kept.
    /// Collective.
    ///
    /// # Errors
    /// As [`LinearMethod::new`].
    pub(super) fn keeping(
        session: &Session,
        problem: Problem,
        settings: MethodSettings,
        kept: Option<&RetainedFactors>,
    ) -> Result<LinearMethod> {
        let made = SetUpResult::new(session, &problem, &settings, kept)?;
        Ok(LinearMethod {
            session: session.clone(),
            problem,
            settings,
            system: made.system,
            ksp: made.ksp,
            facts: made.facts,
            length: Cell::new(0.0),
            varies: made.varies,
            worth: OnceCell::new(),
            declined: Cell::new(0.0),
            analysed: made.analysed,
        })
    }

    /// Takes what a set-up for other rows has made in the place of what there is. The size of solutions, and the time
    /// that set-ups have taken, go on.
    pub(super) fn take(&mut self, made: SetUpResult) {
        let seconds = self.facts.setup_seconds;
        (self.system, self.ksp, self.facts) = (made.system, made.ksp, made.facts);
        (self.varies, self.analysed) = (made.varies, made.analysed);
        (self.worth, self.declined) = (OnceCell::new(), Cell::new(0.0));
        self.facts.setup_seconds += seconds;
    }
}

impl SetUpResult {
    /// Factors, assembles the coarse problems and sets the Krylov method up; see [`LinearMethod::keeping`]. Collective.
    ///
    /// # Errors
    /// As [`LinearMethod::new`].
    pub(super) fn new(
        session: &Session,
        problem: &Problem,
        settings: &MethodSettings,
        kept: Option<&RetainedFactors>,
    ) -> Result<SetUpResult> {
        let clock = Instant::now();
        let comm = session.comm();
        let constraints = choice::constraints(settings);
        session.agree(entities::check(problem, constraints))?;
        session.agree(location::check(comm, problem))?;
        let scaling = settings.scaling.unwrap_or_else(|| choice::scaling(problem));
        let weights = weights(problem, scaling, settings.gamma);
        let sharing = session.agree(DofSharing::new(comm, problem, &weights, constraints))?;
        drop(weights);
        let many = settings.coupled;
        let mut jump = Jump::coupling(comm, problem, &sharing, many); /*      B, B_D                 */
        let mut team = Team::new(threads(session, settings))?;
        let kind = match settings.pc_type {
            Some(pc_type) => table::kind(pc_type),
            None => {
                let functions = settings.coarse_functions();
                choice::preconditioner(comm, problem, &sharing, &jump, functions).kind
            }
        };
        let (Factored { locals, analysed }, added) = subdomains(
            session,
            problem,
            &sharing,
            &mut jump,
            &team,
            (kind.needs_s, scaling, settings, kept),
        )?; /* S, T, Ψ */
        let varies = variation::varies(comm, problem);
        team.set_load(locals.iter().map(|l| l.gamma().n_delta.pow(2)).sum());
        let stiffness = stiffness(
            session,
            problem,
            &sharing,
            jump,
            locals,
            (team, varies, settings, kept),
        )?; /* S̃⁺, F */
        let preconditioner = (kind.set_up)(&PreconditionerInput {
            problem,
            sharing: &sharing,
            stiffness: &stiffness,
            settings,
        })?; /*                                                                 M⁻¹                    */
        let natural = phase(session, (Phase::NaturalSetup, "FetiFetiCoarse"), || {
            let projector = (settings.projector, varies);
            let prefix = format!("{}gtg_", settings.prefix);
            NaturalCoarse::new(
                problem,
                &stiffness,
                preconditioner.as_ref(),
                projector,
                &prefix,
            )
        })?; /*                                                                 G, P                   */
        let dual = Dual::new(stiffness, preconditioner, natural)?;
        let facts = SetUpSummary::new(comm, &dual, scaling);
        let system = Rc::new(DualSystem::new(session, dual, settings.recycle)?);
        let ksp = krylov(session, &system, settings)?;
        Ok(SetUpResult {
            system,
            ksp,
            facts: SetUpSummary {
                adaptive_constraints: added.constraints,
                adaptive_seconds: added.seconds,
                setup_seconds: clock.elapsed().as_secs_f64(),
                ..facts
            },
            varies,
            analysed,
        })
    }
}

/// Does a part of the set-up, with its clock running and as an event of -log_view.
fn phase<T>(
    session: &Session,
    (phase, name): (Phase, &str),
    work: impl FnOnce() -> Result<T>,
) -> Result<T> {
    let _event = Event::register(session, name)?.scope()?;
    clock::timed(phase, work)
}

/// Factors the subdomains of this rank and adds the adaptive primal constraints. Collective.
fn subdomains(
    session: &Session,
    problem: &Problem,
    sharing: &DofSharing,
    jump: &mut Jump,
    team: &Team,
    (needs_s, scaling, settings, kept): (bool, Scaling, &MethodSettings, Option<&RetainedFactors>),
) -> Result<(Factored, Added)> {
    let comm = session.comm();
    let kept = kept.map_or(Vec::new(), |kept| kept.still(jump));
    let factored = phase(session, (Phase::LocalSetup, "FetiFetiLocal"), || {
        factor(session, problem, jump, team, (settings, needs_s), &kept)
    });
    let Factored {
        mut locals,
        analysed,
    } = session.agree(factored)?;
    for (j, local) in locals.iter().enumerate() {
        jump.place(j, &local.gamma().interface);
    }
    if scaling == Scaling::Deluxe {
        deluxe::apply(comm, problem, sharing, jump, &locals);
    }
    let adapting = Instant::now();
    let adaptive = settings.adaptive;
    let added = constraints::find_adaptive_constraints(
        comm, problem, sharing, jump, &locals, team, adaptive,
    );
    if added.iter().any(|&n| n > 0) {
        let fails = |sub: &Subdomain, e| no_factor(problem, sub, e);
        let renewed = constrain(problem, jump, locals, team, fails);
        locals = session.agree(renewed)?;
    }
    let added = Added {
        constraints: added,
        seconds: adapting.elapsed().as_secs_f64(),
    };
    Ok((Factored { locals, analysed }, added))
}

/// S̃⁺: the subdomains and the primal problem of their bodies. Collective.
fn stiffness(
    session: &Session,
    problem: &Problem,
    sharing: &DofSharing,
    jump: Jump,
    locals: Vec<ScaledSubdomain>,
    (team, varies, settings, kept): (Team, f64, &MethodSettings, Option<&RetainedFactors>),
) -> Result<Stiffness> {
    let comm = session.comm();
    let mut space = PrimalSpace::new(comm, problem, sharing, &jump.averages, &locals);
    slack::check(session, problem, &space, &locals)?;
    let primal = phase(session, (Phase::PrimalSetup, "FetiFetiPrimal"), || {
        let prefix = format!("{}coarse_", settings.prefix);
        let known = kept.map_or(&[][..], RetainedFactors::coarse);
        let patterns = (known, settings.keeps_analyses);
        PrimalProblem::new(session, &mut space, &team, &prefix, patterns)
    })?;
    let layout = PetscVec::mpi(session, jump.n_owned)?;
    let dual_halo = Halo::new(session, &layout, &jump.ghosts)?;
    let mut stiffness = Stiffness::new(session, jump, locals, space, primal, dual_halo, team)?;
    if varies > refinement::PLAIN {
        stiffness.refine(PrimalRefinement::new(problem, &stiffness.locals));
    }
    if any(session.comm(), !problem.friction.is_empty()) || stiffness.jump.is_soft {
        stiffness.know_nodes(problem)?;
    }
    Ok(stiffness)
}

/// Threads of this rank. Collective.
fn threads(session: &Session, settings: &MethodSettings) -> usize {
    settings.threads.unwrap_or_else(|| {
        let neighbours = session.comm().split_shared(session.rank() as i32);
        usual_threads(neighbours.size() as usize)
    })
}

/// The cores of this machine divided by the ranks on it, but no more than this rank is bound to.
fn usual_threads(ranks: usize) -> usize {
    let bound = std::thread::available_parallelism().map_or(1, |n| n.get());
    let online = std::fs::read_to_string("/sys/devices/system/cpu/online");
    let cores = online.ok().and_then(|text| count(&text)).unwrap_or(bound);
    (cores / ranks).clamp(1, bound)
}

/// The number of cores in a list such as 0-3,8.
fn count(list: &str) -> Option<usize> {
    let ranges = list.trim().split(',').map(|range| {
        let (low, high) = range.split_once('-').unwrap_or((range, range));
        let (low, high): (usize, usize) = (low.parse().ok()?, high.parse().ok()?);
        (high + 1).checked_sub(low)
    });
    ranges.sum()
}

/// CG on Pᵀ F P with P M⁻¹ Pᵀ, stopped by ‖r_n‖₂ / ‖r_0‖₂ as in \[Lee\].
fn krylov(session: &Session, system: &Rc<DualSystem>, settings: &MethodSettings) -> Result<Ksp> {
    let a = shells::operator(system)?;
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_operators(&a, &a)?;
    // PETSc itself adds `ksp_` to this prefix. The PC gets another prefix: `pc_type` chooses among the M⁻¹ of this
    // crate, not among PETSc's PCs.
    ksp.set_options_prefix(&settings.prefix)?;
    ksp.set_type("cg")?;
    ksp.set_norm_type(NormType::Unpreconditioned)?;
    // ‖r‖₂ may grow by √κ and more before it falls. An iteration without convergence ends at the largest number of
    // iterations.
    ksp.set_tolerances(Some(settings.rtol), None, Some(GROWTH), None)?;
    ksp.set_compute_singular_values(true)?;
    let pc = ksp.pc()?;
    pc.set_shell("fetifeti", shells::preconditioner_shell(system))?;
    pc.set_options_prefix(&format!("{}ksp_", settings.prefix))?;
    // Since PETSc 3.23 negative numbers are names of other values, or an error without the option's name.
    let asked = Options::new(session, &settings.prefix).get_i64("ksp_max_it")?;
    if let Some(max_it) = asked.filter(|&n| n < 0) {
        return Err(Error::input(format!(
            "option -{}ksp_max_it is {max_it}, expected a number of iterations, at least 0",
            settings.prefix
        )));
    }
    ksp.set_from_options()?;
    let (rtol, ..) = ksp.tolerances()?;
    if !(0.0..1.0).contains(&rtol) {
        return Err(Error::input(format!(
            "option -{}ksp_rtol is {rtol}, expected a number from 0 to below 1",
            settings.prefix
        )));
    }
    ksp.check_norm_type()
        .map_err(|e| unfit_norm(e, &settings.prefix))?;
    ksp.setup()?;
    Ok(ksp)
}

/// Explains the remedy if PETSc cannot test convergence in the norm that is set.
fn unfit_norm(error: Error, prefix: &str) -> Error {
    match error.trace().first() {
        Some(message) => Error::input(format!(
            "option -{prefix}ksp_type: {message} (set -{prefix}ksp_norm_type to one that it supports, such as \
             preconditioned)"
        )),
        None => error,
    }
}

#[cfg(test)]
#[path = "../../tests/inside/feti/setup.rs"]
mod tests;
