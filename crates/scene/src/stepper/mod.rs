//! Load steps: one solution after the other, each from the end of the step before.
//!
//! ```text
//! Scene ──> Stepper ──┬─ begin:    contacts where the last step has left the bodies, loads and gaps of the step
//!             ▲       ├─ solve_by: Solution, energy with given values, sliding ──> StepSolution
//!             │       └─ what the next step starts from: multipliers, set, displacements
//!        StepperState <── checkpoint
//! ```
//!
//! | file | task |
//! |---|---|
//! | [`renewed`] | contacts that are renewed at each load step |
//! | [`state`] | the state from which a stepper resumes, and where it is made |
//! | [`slid`] | how far sides with friction have slid |
//! | [`layout`] | removes the ranks from the state of a contact loop, and distributes it again |

mod layout;
mod renewed;
mod slid;
mod state;

use std::collections::BTreeMap;
use std::mem::replace;
use std::rc::Rc;

use super::checked::Scene;
use super::displaced::Displaced;
use super::loads::Stepping;
use super::sliding::{self, Sliding};
use super::{distribution, fits};
use base::Result;
use fetifeti::problem::RowSource;
use fetifeti::settings::MethodSettings;
use fetifeti::solution::State;
use fetifeti::{FetiFeti, Solution};
use layout::RowLayout;
use parallel::exchange::total;
use petsc::Session;
use renewed::Renewed;

pub use layout::GlobalState;
pub use renewed::RenewalCost;
pub use state::{Checkpointer, StepperState};

/// Number of directions that a load step passes on to the next one.
const DIRECTIONS: usize = 30;

/// Solves the load steps of a scene in order, each from the end of the one before; a scene without `[steps]` has one.
///
/// It is an iterator over the solutions. It ends after the last step, after one that did not converge, and after an
/// error. All ranks take the same steps: whatever it does is collective.
///
/// Two blocks of height 1, one on the other, are pressed together by 0.1 in two steps, of which the second renews the
/// contact:
///
/// ```
/// use fetifeti::Session;
/// use fetifeti_scene::{Scene, Stepper};
/// use std::rc::Rc;
///
/// const SCENE: &str = r#"
///     physics = "elasticity"
///     [[body]]
///     name = "low"
///     size = 1
///     elements = 2
///     young = 100
///     poisson = 0
///     dirichlet = ["bottom"]
///     [[body]]
///     name = "high"
///     origin = [0, 1]
///     size = 1
///     elements = 2
///     young = 100
///     poisson = 0
///     dirichlet = { top = { x = 0, y = -0.1 } }
///     [[contact]]
///     bodies = ["low", "high"]
///     [steps]
///     times = [0.5, 1]
///     dirichlet = "t"
///     update = true
/// "#;
///
/// fn main() -> fetifeti::Result<()> {
///     let session = Session::new(&[], "")?;
///     let scene = Rc::new(Scene::parse("blocks.toml", SCENE)?);
///     let mut energies = Vec::new();
///     for step in Stepper::new(&session, scene.clone())? {
///         let step = step?;
///         assert!(step.solution.converged());
///         assert!(step.solution.rows().iter().any(|row| row.holds()));
///         energies.push(step.energy);
///     }
///     // ½ · 50 · way²: both together have half the stiffness of one, which is 100.
///     for (energy, way) in energies.iter().zip([0.05, 0.1]) {
///         assert!((energy - 25.0 * way * way).abs() < 1e-6);
///     }
///
///     // Interrupted after the first step, and resumed.
///     let mut stepper = Stepper::new(&session, scene.clone())?;
///     stepper.next().transpose()?;
///     let state = stepper.checkpoint()?;
///     let mut resumed = Stepper::new(&session, scene.clone())?.resume(state.as_ref())?;
///     let last = resumed.next().transpose()?.expect("the second step");
///     assert_eq!(last.step, 1);
///     assert!((last.energy - energies[1]).abs() < 1e-6);
///     assert!(resumed.next().is_none());
///     Ok(())
/// }
/// ```
pub struct Stepper {
    contacts: Renewed,
    solver: FetiFeti,
    /// The loads of the steps; the solver has those of a single one.
    loads: Option<Stepping>,
    /// This rank's subdomains, increasing.
    mine: Vec<usize>,
    /// The present load step, and where its contact loop starts.
    step: usize,
    state: Option<State>,
    phase: Phase,
}

/// The place of a stepper between two solutions.
enum Phase {
    /// The solver has the rows and loads of an earlier step.
    Before,
    /// The solver has the rows and loads of the step; the cost of its renewal, if there was one.
    Ready(Option<RenewalCost>),
    /// There is no further step.
    Over,
}

/// The solution of a load step; vectors are this rank's part.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct StepSolution {
    /// The load step, from 0.
    pub step: usize,
    /// Its time t; `None` in a scene without `[steps]`.
    pub time: Option<f64>,
    /// Displacements, multipliers, rows and their states, and why the solve ended.
    pub solution: Solution,
    /// Its potential energy over all ranks, with that of given values, which [`Solution::energy`] leaves out.
    pub energy: f64,
    /// In elasticity with contact, how far the sides that touch have slid, on rank 0: since the start, or since the
    /// step before where steps renew contacts.
    pub slides: Option<BTreeMap<RowSource, Sliding>>,
    /// The cost of renewed contacts; `None` where they stay, and in the first step.
    pub renewal: Option<RenewalCost>,
}

impl Stepper {
    /// Assembles the scene, whose options must be in the database ([`distribution::load`]), and sets a solver up.
    /// Collective.
    ///
    /// # Errors
    /// As [`distribution::substructures`] and [`FetiFeti::new`].
    pub fn new(session: &Session, scene: impl Into<Rc<Scene>>) -> Result<Stepper> {
        let scene = scene.into();
        session.agree(fits::solved(session, &scene, &scene.title))?;
        let problem = distribution::substructures(session, &scene)?;
        let solver = FetiFeti::new(session, problem, Stepper::settings(&scene))?;
        Stepper::with_solver(scene, solver)
    }

    /// The settings of [`Stepper::new`]: with load steps, search directions of one step serve the next.
    pub fn settings(scene: &Scene) -> MethodSettings {
        MethodSettings::default().recycle(if scene.steps.is_some() { DIRECTIONS } else { 0 })
    }

    /// Takes a solver that was made from the substructures of the scene. Collective.
    ///
    /// # Errors
    /// As [`Scene::subdomain_mesh`].
    pub fn with_solver(scene: impl Into<Rc<Scene>>, solver: FetiFeti) -> Result<Stepper> {
        let scene = scene.into();
        let local = || solver.problem().local.iter().map(|s| s.index);
        let mut mine: Vec<usize> = local().collect();
        mine.sort_unstable();
        let many = (scene.n_steps() > 1).then(|| Stepping::new(&scene, local()));
        Ok(Stepper {
            loads: solver.session().agree(many.transpose())?,
            contacts: Renewed::new(scene),
            solver,
            mine,
            step: 0,
            state: None,
            phase: Phase::Before,
        })
    }

    /// Takes a stepper that has solved nothing yet to the load step of a state of this scene. The state may be of other
    /// ranks and other settings. That of rank 0 counts, on all of them; with `None` there the stepper is as it was.
    /// Collective.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a state that contradicts itself or is of another scene; those
    /// of [`Scene::renew`].
    pub fn resume(mut self, state: Option<&StepperState>) -> Result<Stepper> {
        let session = self.solver.session().clone();
        let n = self.contacts.scene().n_steps();
        let state = state.filter(|_| session.rank() == 0);
        session.agree(state.map_or(Ok(()), |state| state.check(n)))?;
        let place = state.map(|state| (state.load_step, state.left.clone()));
        let everywhere = (session.rank() == 0).then(|| vec![place; session.size()]);
        let Some((step, left)) = layout::from_first(&session, everywhere) else {
            return Ok(self);
        };
        if step > 0 {
            let owns = |s| self.mine.binary_search(&s).is_ok();
            let left = Displaced::of_nodes(&left);
            self.contacts.resume(&owns, &mut self.solver, step, left)?;
        }
        let rows = RowLayout::new(self.solver.method());
        self.state = Some(rows.scatter(&session, state.map(|state| &state.contact))?);
        self.step = step;
        self.phase = Phase::Before;
        Ok(self)
    }

    /// The number of the load step that is solved next, from 0; `None` if there is none.
    pub fn next_step(&self) -> Option<usize> {
        (!matches!(self.phase, Phase::Over)).then_some(self.step)
    }

    /// Makes the next load step ready: renews contacts if the scene wants that, and hands rows, loads and gaps to the
    /// solver. What is ready stays so; after the last step it does nothing. Collective.
    ///
    /// # Errors
    /// Given values that contradict an inequality, a body that nothing holds any more, a load that is not finite.
    pub fn begin(&mut self) -> Result<()> {
        self.phase = match replace(&mut self.phase, Phase::Over) {
            Phase::Before => Phase::Ready(self.make_ready()?),
            ready_or_over => ready_or_over,
        };
        Ok(())
    }

    fn make_ready(&mut self) -> Result<Option<RenewalCost>> {
        let owns = |s| self.mine.binary_search(&s).is_ok();
        let renewed = self.contacts.renew(&owns, &mut self.solver, self.step)?;
        let cost = renewed.map(|(start, cost)| {
            self.state = start;
            cost
        });
        if let Some(loads) = &mut self.loads {
            let loads = self
                .solver
                .session()
                .agree(loads.loads(self.contacts.scene(), self.step))?;
            let mut gaps = self.contacts.scene().gaps(&owns, self.step)?;
            slid::add(&self.solver, self.state.as_ref(), &mut gaps);
            self.solver.set_loads(loads, &gaps);
        }
        Ok(cost)
    }

    /// Solves the next load step by `solve`, for callers that observe the contact loop
    /// ([`FetiFeti::solve_from`]) or solve in a way of their own. It gets the solver, the scene with the contacts of
    /// the step, and the start of the contact loop. `None` after the last step. Collective.
    ///
    /// # Errors
    /// As [`Stepper::begin`], and those of `solve`.
    pub fn solve_by(
        &mut self,
        solve: impl FnOnce(&mut FetiFeti, &Scene, Option<&State>) -> Result<Solution>,
    ) -> Result<Option<StepSolution>> {
        self.begin()?;
        let Phase::Ready(renewal) = replace(&mut self.phase, Phase::Over) else {
            return Ok(None);
        };
        let (step, scene) = (self.step, self.contacts.scene());
        let solution = solve(&mut self.solver, scene, self.state.as_ref());
        let solution = solution.map_err(|e| self.contacts.at_step(step, e))?;
        let session = self.solver.session().clone();
        let local = self.solver.problem().local.iter().map(|s| s.index);
        let given = scene.given_energy(local, step);
        let given = total(session.comm(), session.agree(given)?);
        let out = StepSolution {
            step,
            time: scene.steps.as_ref().map(|s| s.times[step]),
            energy: solution.energy + given,
            slides: self.end(&session, &solution),
            renewal,
            solution,
        };
        if out.solution.converged() && step + 1 < self.contacts.scene().n_steps() {
            let mut next = out.solution.warm_start();
            let owns = |s| self.mine.binary_search(&s).is_ok();
            let solved = (&self.solver, &out.solution);
            let before = (step, self.state.as_ref());
            // Renewed contacts ask where their own sides stand.
            if !self.contacts.scene().is_renewed() {
                next.slid = slid::after(self.contacts.scene(), &owns, solved, before)?;
            }
            self.state = Some(next);
            self.step = step + 1;
            self.phase = Phase::Before;
        }
        Ok(Some(out))
    }

    /// Notes where the step has left the bodies, and returns how far their sides have slid. Collective.
    fn end(
        &mut self,
        session: &Session,
        solution: &Solution,
    ) -> Option<BTreeMap<RowSource, Sliding>> {
        let (step, rows) = (self.step, solution.rows());
        let scene = self.contacts.scene();
        let (local, u) = (&self.solver.problem().local, &solution.u);
        let slides = scene.form.is_elastic() && self.solver.facts().inequalities > 0;
        let moved = if scene.is_renewed() {
            let all = Displaced::gather(session, scene, local, u, step);
            self.contacts.end(all, solution)
        } else if slides {
            Displaced::near(session, scene, local, u, step, &sliding::bodies_of(rows))
        } else {
            return None;
        };
        slides.then(|| sliding::slid(session, self.contacts.scene(), rows, &moved, step))
    }

    /// Where this stepper stands: at the start of the next load step, on rank 0. `None` on the others, before anything
    /// is known, and after the last step. The next step is made ready. Collective.
    ///
    /// # Errors
    /// As [`Stepper::begin`].
    pub fn checkpoint(&mut self) -> Result<Option<StepperState>> {
        self.begin()?;
        let start = self.state.as_ref().filter(|_| self.next_step().is_some());
        Ok(start.and_then(|start| self.checkpointer().checkpoint(start)))
    }

    /// Makes checkpoints inside the load step that is ready, for an observer of its contact loop. Collective.
    pub fn checkpointer(&self) -> Checkpointer {
        Checkpointer {
            session: self.solver.session().clone(),
            rows: RowLayout::new(self.solver.method()),
            load_step: self.step,
            left: self.contacts.start().clone(),
        }
    }

    /// The scene with the contacts of the load step that was made ready last.
    pub fn scene(&self) -> &Scene {
        self.contacts.scene()
    }

    /// The solver.
    pub fn solver(&self) -> &FetiFeti {
        &self.solver
    }

    /// The solver, for another stepper.
    pub fn into_solver(self) -> FetiFeti {
        self.solver
    }

    /// The solver, for what changes it without changing its rows and loads.
    pub fn solver_mut(&mut self) -> &mut FetiFeti {
        &mut self.solver
    }
}

impl Iterator for Stepper {
    type Item = Result<StepSolution>;

    fn next(&mut self) -> Option<Result<StepSolution>> {
        let solved = self.solve_by(|solver, _, start| solver.solve_from(start, &mut |_, _| Ok(())));
        solved.transpose()
    }
}
