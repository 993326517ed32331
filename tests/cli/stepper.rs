//! Load steps by `Stepper` alone: the answers of the program, and those of a run that was interrupted.

use std::rc::Rc;

use super::checkpoint::solve;
use super::renewal::{blocks, UPDATE};
use crate::support::checks::number;
use crate::support::mpi::Scratch;
use crate::support::session::with_session;

use scene::sliding::Sliding;
use scene::{distribution, Scene, StepSolution, Stepper, StepperState};

/// What the program reports of a step: energy, number of contacts, largest sliding.
type Told = (f64, usize, f64);

fn told(step: &StepSolution) -> Told {
    assert!(step.solution.converged());
    let holds = step.solution.rows().iter().filter(|r| r.is_inequality());
    let slides = step.slides.as_ref().expect("elastic contact").values();
    let slid = slides.copied().fold(Sliding::default(), Sliding::max);
    (
        step.energy,
        holds.filter(|r| r.holds()).count(),
        slid.largest,
    )
}

#[test]
fn steps_are_those_of_the_program() {
    let options = "[options]\nfetifeti_ksp_rtol = 1e-10\n";
    for steps in [UPDATE, &UPDATE.replace("update = true\n", "")] {
        let text = blocks(1.1, 3.15, 6, false, &format!("{steps}{options}"));
        let scratch = Scratch::new("stepper");
        let report = solve(1, &scratch.file("s.toml", &text), 0, &[]);
        let load_steps = report["contact"]["load_steps"].as_array();
        let told_by_program = load_steps.expect("load steps").iter().map(|s| {
            let active = s["active"].as_u64().expect("a count") as usize;
            (number(&s["energy"]), active, number(&s["largest_sliding"]))
        });
        let by_program: Vec<Told> = told_by_program.collect();
        assert_eq!(by_program.len(), 5);
        with_session(move |session| {
            let scene = Rc::new(Scene::parse("s.toml", &text).expect("a scene"));
            let all = || -> base::Result<()> {
                let mut found = Vec::new();
                for step in Stepper::new(session, scene.clone())? {
                    let step = step?;
                    assert_eq!(step.step, found.len());
                    assert_eq!(step.time, Some((step.step + 1) as f64 / 5.0));
                    assert_eq!(step.renewal.is_some(), scene.is_renewed() && step.step > 0);
                    found.push(told(&step));
                }
                assert_eq!(found, by_program);
                let mut stepper = Stepper::new(session, scene.clone())?;
                assert_eq!(stepper.checkpoint()?, None);
                for step in stepper.by_ref().take(2) {
                    step?;
                }
                let state = stepper.checkpoint()?.expect("two steps have ended");
                let text = serde_json::to_string(&state).expect("names and numbers");
                let read: StepperState = serde_json::from_str(&text).expect("a state");
                assert_eq!(read, state);
                let mut resumed = Stepper::new(session, scene.clone())?.resume(Some(&read))?;
                assert_eq!(resumed.next_step(), Some(2));
                for (step, before) in resumed.by_ref().zip(&by_program[2..]) {
                    let now = told(&step?);
                    // The block moves so far that rounding of its rigid motion is a part of 10⁻⁶.
                    assert!((now.0 - before.0).abs() <= 1e-5 * before.0.abs());
                    assert_eq!(now.1, before.1);
                }
                assert_eq!(resumed.next_step(), None);
                assert!(resumed.next().is_none());
                assert_eq!(resumed.checkpoint()?, None);
                Ok(())
            };
            distribution::with_options(session, &scene.options, all).expect("all steps");
        });
    }
}

#[test]
fn a_state_of_another_scene_is_refused() {
    with_session(|session| {
        let parse = |n: usize, steps: &str| {
            Rc::new(Scene::parse("s.toml", &blocks(1.1, 3.15, n, false, steps)).expect("a scene"))
        };
        let (scene, other) = (parse(6, UPDATE), parse(4, UPDATE));
        let mut stepper = Stepper::new(session, scene.clone()).expect("a stepper");
        stepper.next().expect("a step").expect("a solution");
        let state = stepper.checkpoint().expect("collective");
        let refused = |scene: &Rc<Scene>, state: Option<StepperState>, what: &str| {
            let stepper = Stepper::new(session, scene.clone()).expect("a stepper");
            let error = stepper.resume(state.as_ref()).err().expect("refused");
            assert!(
                error.is_input() && error.to_string().contains(what),
                "{error}"
            );
        };
        refused(&other, state.clone(), "the checkpoint is for");
        refused(&parse(6, ""), state.clone(), "stands in load step 1");
        let mut damaged = state.expect("a state");
        damaged.contact.local[0] += 1;
        refused(&scene, Some(damaged), "contradicts itself");
    });
}
