//! The constants of the contact loop, ten times larger and smaller: steps, iterations, and answers.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::support::checks::near;
use crate::support::sample::sample;
use crate::support::session::with_session;
use fetifeti::settings::{ContactType, MethodSettings, Tuning};
use fetifeti::{FetiFeti, Settings};
use petsc::Session;
use scene::Scene;

const KINDS: [ContactType; 3] = [
    ContactType::ActiveSet,
    ContactType::AugmentedLagrangian,
    ContactType::Smalbe,
];

/// Scenes that take seconds, and the one without a solution.
const LEFT_OUT: [&str; 6] = [
    "speed_1024",
    "contact_grid_100",
    "bolted_flange",
    "hip_stem",
    "roller_bearing",
    "arch_falls",
];

/// A number that is multiplied, and rounded to at least one if it counts.
trait Scaled {
    fn scaled(self, factor: f64) -> Self;
}

impl Scaled for f64 {
    fn scaled(self, factor: f64) -> f64 {
        self * factor
    }
}

impl Scaled for usize {
    fn scaled(self, factor: f64) -> usize {
        ((self as f64 * factor).round() as usize).max(1)
    }
}

type Change = fn(&mut Tuning, f64);

/// The constants by name, and how each is multiplied.
macro_rules! constants {
    ($($name:ident)*) => {
        const CONSTANTS: &[(&str, Change)] = &[$((stringify!($name), |tuning, factor| {
            tuning.$name = tuning.$name.scaled(factor);
        })),*];
    };
}

constants! {
    doubt_after certified_wrong certified_rounding certified_reduction certified_rounds noise rounding open_in_trial
    misled_after misled_rows misled_reduction exact_reduction near closed patience against nearly_balanced balanced
    contradiction level placed_together placed_steps springs_weak springs_first springs_fall springs_rounds
    springs_steps springs_against line_evaluations line_same line_enough stiffness compact compact_samples stiffer
    stiffest few few_of_all reduction reduced_again attempts early close trial_patience flicker finer most_digits far
    softer anchored_rounding power_steps penalty gamma flat eta m_start m_shrink products smalbe_patience jumps stalled
    closing_steps
}

/// The examples with inequalities.
fn examples() -> Vec<(String, Scene)> {
    let mut paths: Vec<PathBuf> = Vec::new();
    for folder in ["../../examples/scenes", "../../examples/gallery"] {
        let entries = std::fs::read_dir(folder).expect("a folder");
        paths.extend(entries.map(|entry| entry.expect("an entry").path()));
    }
    paths.retain(|p| p.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    let name = |p: &PathBuf| {
        let stem = p.file_stem().expect("a name");
        stem.to_string_lossy().into_owned()
    };
    let taken = paths.iter().filter(|p| !LEFT_OUT.contains(&&*name(p)));
    let scenes = taken.map(|p| (name(p), Scene::load(p).expect("a scene")));
    let inequalities = |scene: &Scene| {
        let problem = scene.substructures(&|_| true).expect("substructures");
        problem.rows.iter().any(|row| row.law.is_inequality())
    };
    scenes.filter(|(_, scene)| inequalities(scene)).collect()
}

/// Steps and iterations of a method over the scenes, and the scenes that it does not solve, with their answers.
#[derive(Default)]
struct Course {
    steps: usize,
    iterations: usize,
    energies: BTreeMap<String, Option<f64>>,
}

impl Course {
    fn new(
        session: &Session,
        scenes: &[(String, Scene)],
        kind: ContactType,
        tuning: Tuning,
    ) -> Course {
        let mut out = Course::default();
        for (name, scene) in scenes {
            let problem = scene.substructures(&|_| true).expect("substructures");
            let mut settings = Settings::from(MethodSettings::default());
            settings.contact.kind = kind;
            settings.contact.tuning = tuning;
            let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
            let energy = match solver.solve() {
                Ok(solution) => {
                    out.steps += solution.steps.len();
                    out.iterations += solution.iterations;
                    solution.converged().then_some(solution.energy)
                }
                Err(_) => None,
            };
            out.energies.insert(name.clone(), energy);
        }
        out
    }

    /// The scenes that have no answer here and one there, and those with another answer.
    fn other_than(&self, usual: &Course) -> [Vec<&str>; 2] {
        let mut out = [Vec::new(), Vec::new()];
        for (name, energy) in &self.energies {
            match (energy, usual.energies[name]) {
                (None, Some(_)) => out[0].push(&**name),
                (Some(e), Some(known)) if !near(*e, known, 1e-6) => out[1].push(&**name),
                _ => {}
            }
        }
        out
    }
}

/// Every constant ten times larger and smaller: a table of steps and iterations.
///
/// # Panics
/// A constant that changes an answer: only the certificate may decide what is a solution.
fn vary(names: Vec<(&'static str, Change)>) {
    with_session(move |session| {
        let scenes = examples();
        let usual = KINDS.map(|kind| Course::new(session, &scenes, kind, Tuning::DEFAULT));
        let counts = |c: &Course| format!("{:5} {:6}", c.steps, c.iterations);
        println!("{:21} {}", "", usual.each_ref().map(counts).join(" | "));
        for (name, change) in names {
            for factor in [0.1, 10.0] {
                let mut tuning = Tuning::DEFAULT;
                change(&mut tuning, factor);
                let mut line = format!("{name:17} {factor:3}");
                for (kind, usual) in KINDS.into_iter().zip(&usual) {
                    let course = Course::new(session, &scenes, kind, tuning);
                    let [unsolved, others] = course.other_than(usual);
                    line += &format!(" {} |", counts(&course));
                    if !unsolved.is_empty() {
                        line += &format!(" unsolved {} |", unsolved.join(" "));
                    }
                    assert!(
                        others.is_empty(),
                        "{name} {factor} {}: {others:?}",
                        kind.name()
                    );
                }
                println!("{line}");
            }
        }
    });
}

/// One of forty constants: no answer depends on them.
#[test]
fn constants_decide_steps_and_no_answer() {
    vary(sample(40, CONSTANTS.iter().copied()).collect());
}

/// The table of all constants.
#[test]
#[ignore = "takes minutes"]
fn constants_ten_times_larger_and_smaller() {
    vary(CONSTANTS.to_vec());
}
