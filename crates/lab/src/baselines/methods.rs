//! Runs the methods of a plan on one scene, one job each, and makes the rows of tables from the results.

use std::path::PathBuf;

use serde::de::DeserializeOwned;

use super::judge::{CaseJudgement, Judgement};
use super::launch::{Failure, Finished, Launcher};
use super::plan::{BaselinePlan, PlannedRun};
use super::task::{step_file, BaselineTask, ContactOutcome, Job, Outcome, StepFile, StepOutcome};
use crate::assembled::layout::UnknownLayout;
use crate::assembled::load_steps::LoadSteps;
use crate::assembled::system::MatrixFormat;
use base::{Error, Result};
use report::json::{
    CompareContact, CompareInequalities, CompareRow, CompareStep, ComparedScene, MethodRun,
    PhaseSeconds,
};
use scene::{Numbering, Scene};

/// The methods of a plan on one scene.
pub struct Methods<'a> {
    launcher: &'a Launcher,
    plan: &'a BaselinePlan,
    /// The scene file.
    file: PathBuf,
    /// The layout of the unknowns.
    pub layout: UnknownLayout<'a>,
    /// Whether the scene has inequalities.
    contact: bool,
    /// Whether every method solves once more for another load.
    pub again: bool,
    /// The active set of our last contact loop, for methods that solve equations only. `None`: there is none yet.
    active: Option<Vec<usize>>,
}

/// The solutions that a method has left, by load step.
pub type Left = Vec<StepFile>;

/// The result of one run of a method.
pub struct Ran {
    /// The report of the method, or the reason why there is none.
    pub outcome: std::result::Result<Outcome, Failure>,
    /// Options of the second try, if there was one.
    pub rescue: Option<String>,
    /// Output of the ranks.
    pub printed: String,
    /// The solution, if there is one.
    pub solution: Option<Left>,
}

impl Ran {
    /// A run without a result, for this reason.
    fn not(message: String) -> Ran {
        let code = None;
        Ran {
            outcome: Err(Failure { code, message }),
            rescue: None,
            printed: String::new(),
            solution: None,
        }
    }
}

impl<'a> Methods<'a> {
    /// The methods of `plan` on `scene`, which is in `file`.
    pub fn new(
        launcher: &'a Launcher,
        plan: &'a BaselinePlan,
        scene: &'a Scene,
        file: PathBuf,
    ) -> Methods<'a> {
        Methods {
            launcher,
            plan,
            file,
            layout: UnknownLayout::new(scene),
            contact: scene.has_contact(),
            again: false,
            active: None,
        }
    }

    /// Runs number `k` of the plan. If the method breaks down, it is tried once more with the options of the second
    /// try; where `rescued` says that it has needed them before, they are used at once.
    ///
    /// # Errors
    /// [`base::ErrorKind::Environment`] where a job cannot be started at all.
    pub fn run(&mut self, k: usize, rescued: bool) -> Result<Ran> {
        let run = &self.plan.runs[k];
        if let (Some(_), Some(trouble)) = (run.baseline, &self.layout.trouble) {
            return Ok(Ran::not(format!("not for this scene: {trouble}")));
        }
        if let Some(missing) = &run.missing {
            return Ok(Ran::not(missing.clone()));
        }
        if run.ranks > self.plan.max_ranks {
            return Ok(Ran::not(format!(
                "needs {} ranks, one for each of its parts; {} are allowed (-compare_max_ranks)",
                run.ranks, self.plan.max_ranks
            )));
        }
        let equations = run
            .baseline
            .is_some_and(|b| b.format == MatrixFormat::Unassembled);
        if equations && self.layout.scene().has_laws() {
            let message = "not for this scene: it solves the equations of our active set, which have no forces of \
                           friction and no springs of soft contact";
            return Ok(Ran::not(message.to_string()));
        }
        if equations && self.contact && self.active.is_none() {
            let message = "solves the equations of our active set, and there is none";
            return Ok(Ran::not(message.to_string()));
        }
        let rescuer = run.baseline.filter(|b| b.has_rescue());
        let (mut outcome, mut printed) = self.job(k, rescued)?;
        let mut rescue = rescued.then_some(()).and(rescuer);
        if !rescued && rescuer.is_some() && worth_a_second_try(&outcome) {
            let (second, more) = self.job(k, true)?;
            (outcome, rescue) = (second, rescuer);
            printed += &more;
        }
        let mut solution = None;
        if let Ok(outcome) = &outcome {
            let contact = outcome.contact.as_ref();
            let rows = contact.map(|c| c.active.clone()).unwrap_or_default();
            if contact.is_some_and(|c| c.steps.is_some()) && run.baseline.is_none() {
                self.active = Some(rows.clone());
            }
            let file = self.solution(k);
            solution = Some(match &outcome.load_steps[..] {
                [] => vec![(file, rows)],
                steps => {
                    let each = steps.iter().enumerate();
                    let left = |(step, at): (usize, &StepOutcome)| {
                        (step_file(&file, step), at.contact.active.clone())
                    };
                    each.map(left).collect()
                }
            });
        }
        Ok(Ran {
            outcome,
            rescue: rescue.map(|b| b.rescue_options()),
            printed,
            solution,
        })
    }

    fn solution(&self, k: usize) -> PathBuf {
        self.launcher.workspace.file(&format!("{k}.u"))
    }

    fn job(
        &self,
        k: usize,
        rescue: bool,
    ) -> Result<(std::result::Result<Outcome, Failure>, String)> {
        let run = &self.plan.runs[k];
        let active = self.active.as_deref().unwrap_or_default();
        let task = run.task(&self.solution(k), rescue, active);
        let finished = self.start(&format!("{k}-{rescue}"), task, self.again, run.ranks)?;
        Ok((finished.record, finished.printed))
    }

    fn start<T: DeserializeOwned>(
        &self,
        name: &str,
        task: BaselineTask,
        again: bool,
        ranks: usize,
    ) -> Result<Finished<T>> {
        let job = Job {
            scene: self.file.clone(),
            rtol: self.plan.rtol,
            inner: self.plan.inner,
            again,
            task,
        };
        self.launcher.run(name, ("baseline", &job), ranks)
    }

    /// The judge's verdict on solutions; an empty one where there is no direct solution.
    ///
    /// # Errors
    /// As [`Methods::run`].
    pub fn judge(&self, solutions: Vec<Left>) -> Result<CaseJudgement> {
        if self.layout.trouble.is_some() {
            return Ok(CaseJudgement {
                rows: self.layout.forms.len(),
                ..CaseJudgement::default()
            });
        }
        let judge = BaselineTask::Judge { solutions };
        let finished = self.start("judge", judge, false, self.plan.cores)?;
        Ok(finished.record.unwrap_or_else(|failure| {
            eprintln!(
                "Warning: no direct solution, so no errors: {}",
                failure.message
            );
            CaseJudgement::default()
        }))
    }
}

/// Whether a method broke down, as opposed to a time limit or the limits of rounding.
fn worth_a_second_try(outcome: &std::result::Result<Outcome, Failure>) -> bool {
    match outcome {
        Ok(outcome) => !outcome.reason.starts_with("CONVERGED"),
        Err(failure) => failure.code.is_some(),
    }
}

/// PETSc's arguments for the jobs. Arguments that ask for a text about the whole program are left to the parent.
pub fn forwarded(petsc: &[String]) -> Vec<String> {
    const PARENTS: [&str; 4] = ["-help", "-h", "-options_left", "-version"];
    let mut forwarded = Vec::new();
    let mut drop_value = false;
    for arg in petsc {
        let is_option = arg.starts_with('-') && arg.parse::<f64>().is_err();
        if is_option {
            drop_value = PARENTS.contains(&arg.as_str());
        }
        if !drop_value {
            forwarded.push(arg.clone());
        }
    }
    forwarded
}

/// The run in a table before it has a result.
pub fn blank(run: &PlannedRun) -> MethodRun {
    MethodRun {
        method: run.name().to_string(),
        layout: run.layout.to_string(),
        options: run.options[0].clone(),
        given: run.given.clone(),
        subdomains: run.parts,
        ranks: run.ranks,
        threads: run.threads,
        ..MethodRun::default()
    }
}

/// The row of a table for a run and its result.
pub fn row(run: &PlannedRun, ran: Ran) -> CompareRow {
    let mut row = CompareRow {
        run: blank(run),
        ..CompareRow::default()
    };
    if ran.rescue.is_some() {
        row.run.options = run.options[1].clone();
    }
    row.run.rescue = ran.rescue;
    match ran.outcome {
        Err(failure) => row.run.message = Some(failure.message),
        Ok(o) => {
            row.seconds = seconds(&o);
            row.memory_mb = Some(o.memory / 1e6);
            row.memory_at_start_mb = Some(o.memory_at_start / 1e6);
            row.run.options += &o.rtol.map_or(String::new(), |rtol| run.tolerance(rtol));
            row.run = MethodRun {
                kappa: o.kappa,
                iterations: o.iterations,
                residual: o.residual,
                contact: o.contact.as_ref().map(contact),
                load_steps: o.load_steps.iter().map(load_step).collect(),
                rtol: o.rtol,
                converged: o.message.is_none(),
                converged_reason: o.reason,
                message: o.message,
                ..row.run
            };
        }
    }
    row
}

fn contact(of: &ContactOutcome) -> CompareContact {
    CompareContact {
        outer: of.steps,
        active: of.active.len(),
        ..CompareContact::default()
    }
}

fn load_step(of: &StepOutcome) -> CompareStep {
    CompareStep {
        iterations: of.iterations,
        residual: Some(of.residual),
        setup: Some(of.setup),
        solve: Some(of.solve),
        contact: contact(&of.contact),
        ..CompareStep::default()
    }
}

/// The seconds of a run.
pub fn seconds(o: &Outcome) -> PhaseSeconds<f64> {
    PhaseSeconds {
        assemble: Some(o.assemble),
        setup: Some(o.setup),
        solve: Some(o.solve),
        total: Some(o.setup + o.solve),
    }
}

/// Enters the judge's findings into the rows of these numbers, whose methods have left a solution.
pub fn sentence<R>(
    rows: &mut [R],
    run_of: fn(&mut R) -> &mut MethodRun,
    numbers: Vec<usize>,
    verdict: &CaseJudgement,
) {
    let judged = numbers.into_iter().zip(&verdict.solutions).enumerate();
    for (i, (k, judgement)) in judged {
        let run = run_of(&mut rows[k]);
        run.error = judgement.error;
        run.residual = judgement.residual;
        run.from_ours = judgement.from_ours;
        if let Some(contact) = &mut run.contact {
            enter(contact, judgement);
        }
        let steps = verdict.load_steps.get(i).into_iter().flatten();
        for (step, judgement) in run.load_steps.iter_mut().zip(steps) {
            step.error = judgement.error;
            step.residual = judgement.residual;
            step.from_ours = judgement.from_ours;
            enter(&mut step.contact, judgement);
        }
    }
}

fn enter(contact: &mut CompareContact, judgement: &Judgement) {
    contact.differ = judgement.differ;
    contact.feasibility = judgement.feasibility;
    contact.min_multiplier = judgement.min_multiplier;
    contact.law = judgement.law;
    contact.forces = judgement.forces;
}

/// Facts about the scene, without its direct solution.
pub fn facts(scene: &Scene, plan: &BaselinePlan) -> ComparedScene {
    ComparedScene {
        scene: scene.title.clone(),
        bodies: scene.n_bodies(),
        subdomains: scene.n_subdomains(),
        dofs: Numbering::new(scene).len() as usize,
        rtol: plan.rtol,
        ..ComparedScene::default()
    }
}

/// Enters the judge's findings about the direct solution.
pub fn judged(facts: &mut ComparedScene, scene: &Scene, verdict: &CaseJudgement) {
    let reference = verdict.reference;
    facts.reference_residual = reference.and_then(|r| r.residual);
    facts.contact = scene.has_contact().then(|| CompareInequalities {
        rows: verdict.rows,
        active: reference.map(|_| verdict.active),
        outer: verdict.steps,
        feasibility: reference.and_then(|r| r.feasibility),
        min_multiplier: reference.and_then(|r| r.min_multiplier),
        law: reference.and_then(|r| r.law),
        load_steps: scene.n_steps(),
        solved: LoadSteps::number(scene),
    });
}

/// The error of a comparison in which ours stopped early, if it did. Where rounding keeps the assembled residual above
/// its target, the table says so; the method itself has converged.
pub fn stopped<'a>(mut runs: impl Iterator<Item = (&'a MethodRun, String)>) -> Result<()> {
    let early = |run: &MethodRun| run.is_ours() && !run.converged_reason.starts_with("CONVERGED");
    match runs.find(|(run, _)| early(run)) {
        None => Ok(()),
        Some((run, scene)) => Err(Error::not_converged(format!(
            "fetifeti on {scene}: {}",
            run.message.as_deref().unwrap_or(&run.converged_reason)
        ))),
    }
}
