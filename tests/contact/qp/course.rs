//! A scene by both: the solver's course over the load steps, and the quadratic programme of every step.

use super::verdict::{self, Agreed};
use crate::support::assembled::Assembled;
use crate::support::qp::Outcome;
use base::Result;
use fetifeti::problem::BodyNode;
use fetifeti::settings::{ContactSettings, ContactType, MethodSettings};
use fetifeti::solution::{SolvedRow, State};
use fetifeti::{FetiFeti, Problem, Row, Settings, Solution};
use petsc::Session;
use scene::{Displaced, Scene, Stepping};
use std::any::Any;
use std::collections::HashMap;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::time::{Duration, Instant};

/// The difference of two formulas for the energy of the programme's solution, relative to its scale, above which the
/// solution has too few digits to judge another: bodies that slide far on sides that are hardly inclined.
const ENERGY: f64 = 5e-9;

/// What a scene has come to.
#[derive(Debug, Clone)]
pub enum Fate {
    /// Every load step has the solution of the quadratic programme.
    Right(Agreed),
    /// The programme proves that a load step has no solution by this, and the solver refuses it.
    NoSolution(Proof),
    /// Refused when it was read, or when contacts were renewed.
    Refused(String),
    /// The programme comes to no certified answer.
    Undecided(String),
    /// The solver did not converge, and says so.
    NotConverged(String),
    /// The solver is wrong: another answer, an answer where there is none, a refusal of what has a solution, a panic.
    Wrong(String),
}

/// Why a load step has no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proof {
    /// A motion of bodies that nothing stops and the load drives.
    Unbounded,
    /// Weights with which the rows contradict each other.
    Infeasible,
}

/// Seconds of both, over all load steps.
#[derive(Debug, Clone, Copy, Default)]
pub struct Times {
    pub programme: Duration,
    pub solver: Duration,
}

fn all(_: usize) -> bool {
    true
}

/// The solver, the contacts that it has, and its last solution.
struct Run<'s> {
    session: &'s Session,
    scene: &'s Scene,
    kind: ContactType,
    present: Scene,
    solver: Option<FetiFeti>,
    last: Option<Solution>,
}

/// What a scene has come to by one method.
pub fn fate(session: &Session, text: &str, kind: ContactType, times: &mut Times) -> Fate {
    let scene = match Scene::parse("contact.toml", text) {
        Ok(scene) => scene,
        Err(e) => return Fate::Refused(e.to_string()),
    };
    let whole = match scene.substructures(&all) {
        Ok(whole) => whole,
        Err(e) => return Fate::Refused(e.to_string()),
    };
    let mut run = Run {
        session,
        present: scene.clone(),
        scene: &scene,
        kind,
        solver: None,
        last: None,
    };
    let mut agreed = Agreed::default();
    for step in 0..scene.n_steps() {
        match run.step(&whole, step, times) {
            Ok(of_step) => agreed.include(of_step),
            Err(fate) => return fate.at_step(step),
        }
    }
    Fate::Right(agreed)
}

impl Fate {
    fn at_step(self, step: usize) -> Fate {
        let at = |why: String| format!("load step {}: {why}", step + 1);
        match self {
            Fate::Refused(why) => Fate::Refused(at(why)),
            Fate::Undecided(why) => Fate::Undecided(at(why)),
            Fate::NotConverged(why) => Fate::NotConverged(at(why)),
            Fate::Wrong(why) => Fate::Wrong(at(why)),
            other => other,
        }
    }
}

/// The text of a panic.
fn said(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().cloned();
    let text = text.or_else(|| panic.downcast_ref::<&str>().map(ToString::to_string));
    text.unwrap_or_default()
}

impl Run<'_> {
    /// Solves a load step by both, and compares.
    fn step(
        &mut self,
        whole: &Problem,
        step: usize,
        times: &mut Times,
    ) -> std::result::Result<Agreed, Fate> {
        let refused = |e: base::Error| Fate::Refused(e.to_string());
        if let (true, Some(solver), Some(last)) =
            (self.scene.is_renewed(), &self.solver, &self.last)
        {
            let local = &solver.problem().local;
            let at = Displaced::gather(self.session, self.scene, local, &last.u, step - 1);
            self.present.renew(&at, step).map_err(refused)?;
        }
        let problem = self.problem(whole, step).map_err(refused)?;
        let clock = Instant::now();
        let assembled = Assembled::new(&problem);
        let outcome = catch_unwind(AssertUnwindSafe(|| assembled.outcome()));
        times.programme += clock.elapsed();
        let clock = Instant::now();
        let solved = catch_unwind(AssertUnwindSafe(|| self.solve(&problem, step)));
        times.solver += clock.elapsed();
        let solved = solved.map_err(|panic| Fate::Wrong(format!("a panic: {}", said(&*panic))))?;
        let outcome = outcome.map_err(|panic| {
            let answer = match &solved {
                Ok(solution) => format!("{}, energy {}", solution.status, solution.energy),
                Err(e) => e.to_string(),
            };
            Fate::Undecided(format!("{}; the solver: {answer}", said(&*panic)))
        })?;
        let reference = match outcome {
            Outcome::Solved(solved) => assembled.reference(solved),
            Outcome::Unbounded(_) => return Err(without(Proof::Unbounded, solved)),
            Outcome::Infeasible(_) => return Err(without(Proof::Infeasible, solved)),
        };
        let known = verdict::known(&assembled, &reference);
        if known > ENERGY {
            let why = format!("the programme knows its energy to {known:.1e} only");
            return Err(Fate::Undecided(why));
        }
        let solution = solved.map_err(|e| match e.is_not_converged() {
            true => Fate::NotConverged(e.to_string()),
            false => Fate::Wrong(format!("a solution was missed: {e}")),
        })?;
        if !solution.converged() {
            return Err(Fate::NotConverged(solution.status.to_string()));
        }
        let u = problem.local.iter().zip(&solution.u);
        let copies = u.flat_map(|(s, u)| s.dofs.iter().copied().zip(u.iter().copied()));
        let u = assembled.gather(copies, 1e-8).map_err(Fate::Wrong)?;
        let agreed = verdict::judge(&assembled, &reference, &u, &solution);
        self.last = Some(solution);
        agreed.map_err(Fate::Wrong)
    }

    /// The problem of a load step with the present contacts.
    fn problem(&self, whole: &Problem, step: usize) -> Result<Problem> {
        let mut problem = whole.clone();
        let mut loads = Stepping::new(self.scene, 0..self.scene.n_subdomains())?;
        let loads = loads.loads(self.scene, step)?;
        for (sub, f) in problem.local.iter_mut().zip(loads) {
            sub.f = f;
        }
        problem.rows = self.present.solver_rows(&all);
        for (row, gap) in problem.rows.iter_mut().zip(self.present.gaps(&all, step)?) {
            row.gap = gap;
        }
        Ok(problem)
    }

    /// The solver's solution of a load step: set up once, with new rows where contacts are renewed, from the end of the
    /// last step.
    fn solve(&mut self, problem: &Problem, step: usize) -> Result<Solution> {
        let mut start = None;
        if let (Some(solver), Some(last)) = (&mut self.solver, &self.last) {
            if self.scene.is_renewed() {
                solver.set_rows(self.present.solver_rows(&all), Vec::new())?;
                start = warm(solver, &problem.rows, last);
            } else {
                start = Some(last.warm_start());
            }
        } else {
            let mut settings = Settings::from(MethodSettings::default().rtol(1e-11));
            settings.contact = ContactSettings::default().kind(self.kind);
            let whole = self.scene.substructures(&all)?;
            self.solver = Some(FetiFeti::new(self.session, whole, settings)?);
        }
        let solver = self.solver.as_mut().expect("it has been set up");
        if self.scene.n_steps() > 1 {
            let loads = problem.local.iter().map(|s| s.f.clone()).collect();
            solver.set_loads(loads, &self.present.gaps(&all, step)?);
        }
        solver.solve_from(start.as_ref(), &mut |_, _| Ok(()))
    }
}

/// Where the loop starts after rows were renewed: with the forces of the last step at the nodes that had one.
fn warm(solver: &FetiFeti, rows: &[Row], last: &Solution) -> Option<State> {
    type Place = ([Option<BodyNode>; 2], bool);
    let place = |r: &SolvedRow| -> Place { (r.label.members, r.is_inequality()) };
    let known: HashMap<Place, (f64, bool)> = last
        .rows()
        .iter()
        .map(|r| (place(r), (r.multiplier, r.holds())))
        .collect();
    let found = rows.iter().map(|row| {
        let inequality = row.law.is_inequality();
        known.get(&(row.label.members, inequality)).copied()
    });
    let found: Vec<Option<(f64, bool)>> = found.collect();
    found.iter().any(Option::is_some).then(|| {
        let start: Vec<_> = found.iter().map(|s| s.unwrap_or((0.0, true))).collect();
        solver.start(last.inside_bodies(), &start)
    })
}

/// The fate of a load step without a solution.
fn without(proof: Proof, solved: Result<Solution>) -> Fate {
    match solved {
        Err(e) if e.is_input() => Fate::NoSolution(proof),
        Err(e) => Fate::NotConverged(format!("{proof:?}, but: {e}")),
        Ok(s) if s.converged() => Fate::Wrong(format!("{proof:?}, but the solver has a solution")),
        Ok(s) => Fate::NotConverged(format!("{proof:?}, but: {}", s.status)),
    }
}
