//! The main entry: from substructures to a solver that returns solutions and spectra.

mod changes;
mod early;
mod merging;

pub use merging::groups;

use std::cell::Ref;
use std::time::Instant;

use crate::contact::{self, Step};
use crate::feti::deflation::Cost;
use crate::feti::krylov::loads::Loads;
use crate::feti::krylov::together::Begun;
use crate::feti::krylov::verdict::{HostJudge, HostSolution, Judge};
use crate::feti::operators::dual::Dual;
use crate::feti::{Communication, LinearMethod, LinearSolution, SetUpSummary, Spectrum};
use crate::settings::Settings;
use crate::solution::Solution;
use crate::substructures::merged::Merged;
use crate::substructures::{idle, Problem, SolvedRow};
use crate::Result;
use parallel::exchange::any;
use petsc::{cite, Ksp, LogStage, Session};

const CITATION: &str = "@techreport{Lee2010,
  author = {Jungho Lee},
  title  = {Convergence analysis of a new domain decomposition method for a linearized contact problem},
  institution = {Oak Ridge National Laboratory},
  year   = {2010}
}
";

/// The FETI-FETI solver of one problem: the linear method, and the contact loop around it.
///
/// Two springs of stiffness 1 in a row, each a body. The first is fixed at its left end; a row ties its right end to
/// the second spring. A force of 1 pushes the right end of that one against a wall at a distance of 0.1:
///
/// ```
/// use fetifeti::problem::Csr;
/// use fetifeti::{FetiFeti, Problem, Row, Session, Settings, Subdomain};
///
/// fn main() -> fetifeti::Result<()> {
///     let session = Session::new(&[], "")?;
///     let fixed = Csr::from_triplets(1, &[(0, 0, 1.0)]);
///     let free = Csr::from_triplets(2, &[(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)]);
///     let problem = Problem::new(["fixed", "free"], 2)
///         .with_subdomains([
///             Subdomain::new(0, 0, fixed, vec![0.0], vec![0]),
///             Subdomain::new(1, 1, free, vec![0.0, 1.0], vec![1, 2]),
///         ])
///         .with_rows([
///             Row::equality([(0, 1.0), (1, -1.0)], 0.0),
///             Row::inequality([(2, 1.0)], 0.1).in_block(1),
///         ]);
///     let mut solver = FetiFeti::new(&session, problem, Settings::default())?;
///     let solution = solver.solve()?;
///     assert!(solution.converged());
///     // Both springs share the way of 0.1, which takes a force of 0.05; the wall carries the rest.
///     assert!((solution.u[0][0] - 0.05).abs() < 1e-12);
///     assert!((solution.rows()[1].multiplier - 0.95).abs() < 1e-12);
///
///     // A wall farther away, on the same set-up: the force moves the end by 2.
///     solver.set_loads(vec![vec![0.0], vec![0.0, 1.0]], &[0.0, 3.0]);
///     let solution = solver.solve()?;
///     assert!((solution.u[1][1] - 2.0).abs() < 1e-12);
///     assert!(!solution.rows()[1].holds());
///     Ok(())
/// }
/// ```
pub struct FetiFeti {
    pub(crate) method: LinearMethod,
    settings: Settings,
    setup_stage: LogStage,
    solve_stage: LogStage,
    /// Whether a body has motions that nothing sees.
    idle: bool,
    /// The bodies that are one for the method.
    merged: Option<Merged>,
}

impl FetiFeti {
    /// The linear method with its operators, for studies and checks of this workspace.
    #[doc(hidden)]
    pub fn method(&self) -> &LinearMethod {
        &self.method
    }

    /// Factors, assembles the coarse problems and sets the Krylov method up. Collective.
    ///
    /// # Errors
    /// Bad substructures, a body that nothing holds, or PETSc's own errors; the same on all ranks.
    pub fn new(
        session: &Session,
        problem: Problem,
        settings: impl Into<Settings>,
    ) -> Result<FetiFeti> {
        cite(session, CITATION)?;
        let stage = LogStage::register(session, "FETI-FETI setup")?;
        let staged = stage.scope()?;
        let settings = settings.into().with_options(session)?;
        let (problem, merged) = merging::merged(session, problem, &settings.method);
        let method = LinearMethod::new(session, problem, settings.method.clone())?;
        drop(staged);
        let idle = method.problem.local.iter().any(|s| !s.idle.is_empty());
        Ok(FetiFeti {
            merged,
            idle: any(session.comm(), idle),
            method,
            settings,
            setup_stage: stage,
            solve_stage: LogStage::register(session, "FETI-FETI solve")?,
        })
    }

    /// Solves for the loads of the substructures: by the contact loop if some rows are inequalities, by one linear
    /// solve otherwise. Collective.
    ///
    /// An iteration that stops early is not an error: look at [`Solution::status`].
    ///
    /// # Errors
    /// A body that nothing holds or that is pushed away for ever, gaps that contradict each other; PETSc's own errors.
    pub fn solve(&mut self) -> Result<Solution> {
        self.solve_from(None, &mut |_, _| Ok(()))
    }

    /// Solves without inequalities, for callers that measure the solution themselves. Whenever the tolerance is
    /// reached, `enough` returns the factor by which the residual should fall further, and the iteration goes on;
    /// `None` ends it. Collective.
    ///
    /// # Errors
    /// As [`FetiFeti::solve`], and those of `enough`.
    pub fn solve_until(&mut self, enough: &Judge) -> Result<Solution> {
        let _staged = self.solve_stage.scope()?;
        self.check_idle()?;
        self.certified(self.method.solve(Some(enough))?, Vec::new())
    }

    /// [`FetiFeti::solve_until`] for a host: its monitors look at the solver, its bodies have no idle motions.
    pub(crate) fn judged(&self, begun: Option<Begun>, enough: &HostJudge) -> Result<HostSolution> {
        let _staged = self.solve_stage.scope()?;
        self.method.solve_for_host(begun, enough)
    }

    /// The present loads, condensed to the interfaces, to be given to [`FetiFeti::together`]. Collective.
    pub(crate) fn condensed(&self) -> Loads {
        Loads::new(self.problem(), &self.dual())
    }

    /// The iterations for several loads at once, to be finished by [`FetiFeti::judged`] one by one; see
    /// [`LinearMethod::together`]. Collective.
    ///
    /// # Errors
    /// As [`FetiFeti::solve`].
    pub(crate) fn together(&self, loads: Vec<Loads>) -> Result<Vec<Option<Begun>>> {
        let _staged = self.solve_stage.scope()?;
        self.method.together(loads)
    }

    /// Solves as [`FetiFeti::solve`], from a given state of the contact loop and with a call after each of its steps.
    /// Without inequalities the state is not used. Collective.
    ///
    /// # Errors
    /// As [`FetiFeti::solve`], and those of `observe`.
    pub fn solve_from(
        &mut self,
        start: Option<&contact::State>,
        observe: &mut contact::Observer,
    ) -> Result<Solution> {
        self.observed(start, observe)
    }

    /// [`FetiFeti::solve_from`] for a host whose monitors look at the solver during the solve.
    pub(crate) fn observed(
        &self,
        start: Option<&contact::State>,
        observe: &mut contact::Observer,
    ) -> Result<Solution> {
        let _staged = self.solve_stage.scope()?;
        self.check_idle()?;
        if self.facts().inequalities == 0 {
            let found = self.method.solve(None)?;
            return self.certified(self.method.at_rest(found), Vec::new());
        }
        let (found, steps) = contact::solve(&self.method, &self.settings.contact, start, observe)?;
        self.certified(self.method.at_rest(found), steps)
    }

    /// The solution, with a bound of its error if that was asked for. Collective.
    fn certified(&self, found: LinearSolution, steps: Vec<Step>) -> Result<Solution> {
        let certified = if self.settings.method.certify {
            Some(self.method.certified(&found)?)
        } else {
            None
        };
        let mut solution = self.solution(found, steps)?;
        solution.certified = certified;
        Ok(solution)
    }

    /// Returns an error if the load drives a motion that nothing sees. Collective.
    fn check_idle(&self) -> Result<()> {
        if self.idle {
            idle::check(self.session().comm(), &self.problem().local)
        } else {
            Ok(())
        }
    }

    /// The solution, with the rows in the order in which the problem has them. Collective.
    fn solution(&self, mut found: LinearSolution, steps: Vec<Step>) -> Result<Solution> {
        if self.idle {
            let comm = self.session().comm();
            idle::remove_idle(comm, &self.problem().local, &mut found.u);
        }
        let dual = self.dual();
        let jump = &dual.stiffness.jump;
        let multipliers = jump.in_given_order(&found.lambda);
        let mut gaps = found.gaps.clone();
        let rows = gaps.iter_mut().zip(&found.lambda).zip(&jump.compliance);
        rows.for_each(|((gap, l), c)| *gap += c * l);
        let gaps = jump.in_given_order(&gaps);
        let holds = jump.in_given_order(&found.active);
        let values = multipliers.into_iter().zip(gaps).zip(holds);
        let rows = self.method.problem.rows.iter().zip(values);
        let rows = rows
            .map(|(row, ((multiplier, gap), holds))| SolvedRow::new(row, multiplier, gap, holds));
        let mut rows: Vec<SolvedRow> = rows.collect();
        drop(dual);
        if let Some(merged) = &self.merged {
            let clock = Instant::now();
            let forces = self.method.interface_forces(&found.lambda)?;
            rows = merged.rows(self.session().comm(), &forces, rows);
            found.recover_seconds += clock.elapsed().as_secs_f64();
        }
        Ok(Solution::new(found, rows, steps))
    }

    /// Displacements of each local subdomain for the present iterate, for a monitor of [`FetiFeti::ksp`] during a solve
    /// without inequalities; `None` if no iteration is running. The cost is about that of an iteration. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn current(&self) -> Result<Option<Vec<Vec<f64>>>> {
        self.method.current()
    }

    /// Finds the eigenvectors above τ with all candidate rows and deflates them from now on, whatever the spectrum of
    /// the iterations. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn deflate(&mut self) -> Result<()> {
        self.method.deflate()
    }

    /// Result and cost of the deflation; `None` if there was no search.
    pub fn deflated(&self) -> Option<Cost> {
        self.method.deflated()
    }

    /// (The largest eigenvalue that iterations have seen and `auto` would have deflated with fewer bodies, the
    /// eigenvalue from which deflation is worth its cost); `None` if there was none.
    pub fn deflation_declined(&self) -> Option<(f64, f64)> {
        self.method.deflation_declined()
    }

    /// Exact extreme eigenvalues of the preconditioned operator; `None` without multipliers. If a bound is asked for
    /// and nothing has been deflated yet, deflation comes first. Collective.
    ///
    /// # Errors
    /// PETSc's and SLEPc's own.
    pub fn spectrum(&mut self) -> Result<Option<Spectrum>> {
        self.method.spectrum()
    }

    /// [`spectrum`](Self::spectrum) without deflation. Collective.
    ///
    /// # Errors
    /// PETSc's and SLEPc's own.
    pub fn plain_spectrum(&self) -> Result<Option<Spectrum>> {
        self.method.plain_spectrum()
    }

    /// The identities of the theory, each with its relative defect, which must be of the size of rounding. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn check(&self) -> Result<Vec<(&'static str, f64)>> {
        self.method.check()
    }

    /// Messages and reductions per iteration, over all iterations of the Krylov method so far; `None` if there were
    /// none. Collective.
    pub fn communication(&self) -> Option<Communication> {
        self.method.communication()
    }

    /// Facts about the problem.
    pub fn facts(&self) -> &SetUpSummary {
        &self.method.facts
    }

    /// The settings in force, with options applied.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The session.
    pub fn session(&self) -> &Session {
        &self.method.session
    }

    /// The Krylov solver of the dual problem.
    pub fn ksp(&self) -> &Ksp {
        &self.method.ksp
    }

    /// F, M⁻¹ and P for the rows that hold, for studies and checks of this workspace.
    #[doc(hidden)]
    pub fn dual(&self) -> Ref<'_, Dual> {
        self.method.dual()
    }
}
