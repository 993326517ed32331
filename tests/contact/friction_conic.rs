//! Random scenes with friction against conic programmes (`tests/contact/conic.rs`): Tresca's law, which one programme
//! solves, and Coulomb's, a fixed point of such programmes.
//!
//! Compared are the forces of all rows at the nodes, Bᵀ λ, which are unique where multipliers of rows that depend on
//! each other are not; the energy; and the states of nodes that are not on the border between two.

use super::conic::{Conic, Solved};
use crate::support::rng::Rng;
use crate::support::sample::sample;
use crate::support::session::with_session;
use fetifeti::problem::FrictionBound;
use fetifeti::settings::{ContactType, MethodSettings};
use fetifeti::solution::RowState;
use fetifeti::{FetiFeti, Problem, Settings, Solution};
use petsc::Session;
use scene::{Scene, Stepper};

/// Forces and energies agree to this, relative to the largest force and to the work of the loads. The programme has so
/// many digits where bodies differ in stiffness and rows depend on each other.
const ACCURACY: f64 = 2e-5;

/// Steps of the contact loop: states that wander so long wander on.
const STEPS: usize = 100;

/// What is farther than this from a border, in units of force and length, has a state.
const CLEAR: f64 = 1e-5;

/// Blocks that are held, pressed onto an obstacle or onto each other and pulled along, in the plane or in space; hard
/// or soft, at once, in a load cycle, or dragged by the obstacle.
fn held(id: u64) -> String {
    let mut rng = Rng::new(31_000 + id);
    let mut pick = |list: &[f64]| list[(rng.unit() * list.len() as f64) as usize % list.len()];
    let solid = pick(&[0.0, 0.0, 1.0]) > 0.0;
    let vector = |x: f64, y: f64, z: f64| match solid {
        true => format!("[{x}, {y}, {z}]"),
        false => format!("[{x}, {y}]"),
    };
    let n = pick(if solid { &[2.0, 3.0] } else { &[4.0, 6.0, 9.0] });
    let elements = vector(n, if solid { 2.0 } else { 3.0 }, 2.0);
    let mut law = match pick(&[0.0, 0.0, 0.0, 1.0, 2.0, 2.0]) as usize {
        0 => format!("tresca = {}\n", pick(&[0.01, 0.04, 0.1])),
        1 => format!("friction = {}\nfriction_limit = 0.03\n", pick(&[0.2, 0.6])),
        _ => format!("friction = {}\n", pick(&[0.05, 0.1, 0.3, 0.5, 0.8])),
    };
    if pick(&[0.0, 0.0, 1.0]) > 0.0 {
        law += &format!("stiffness = {}\n", pick(&[2.0, 20.0, 200.0]));
    }
    if pick(&[0.0, 0.0, 1.0]) > 0.0 {
        law += &format!("stick_stiffness = {}\n", pick(&[1.0, 10.0, 100.0]));
    }
    let load = vector(
        pick(&[-0.12, -0.05, 0.03, 0.1]),
        -0.1,
        pick(&[0.0, 0.06, -0.09]),
    );
    let held = format!(
        "{{ right = {{ x = 0, y = {}{} }} }}",
        pick(&[0.0, 0.004, 0.01]),
        if solid { ", z = 0" } else { "" }
    );
    let block = |name: &str, y: f64, young: f64, rest: String| {
        let (origin, size) = (vector(0.0, y, 0.0), vector(2.0, 1.0, 1.0));
        format!(
            "[[body]]\nname = \"{name}\"\norigin = {origin}\nsize = {size}\nelements = {elements}\nyoung = {young}\n\
             poisson = 0.3\n{rest}\n"
        )
    };
    let rest = format!("traction = {{ top = {load} }}\ndirichlet = {held}");
    let mut out = format!(
        "dimension = {}\nphysics = \"elasticity\"\n{}",
        if solid { 3 } else { 2 },
        block("upper", 0.0, pick(&[1.0, 10.0, 100.0]), rest)
    );
    let steps = pick(&[0.0, 1.0]) > 0.0;
    if pick(&[0.0, 1.0]) > 0.0 {
        out += &format!(
            "[[obstacle]]\nbody = \"upper\"\nside = \"bottom\"\nplane = {{ point = {}, normal = {} }}\n{law}",
            vector(0.0, 0.0, 0.0),
            vector(0.0, 1.0, 0.0)
        );
        if steps && pick(&[0.0, 1.0]) > 0.0 {
            let way = vector(pick(&[0.02, -0.05]), 0.0, pick(&[0.0, 0.03]));
            out += &format!("move = {way}\nramp = \"if(t<3, t/2, 4-t)\"\n");
        }
    } else {
        out += &block("lower", -1.0, 1.0, "dirichlet = [\"bottom\"]".into());
        out += &format!("[[contact]]\nbodies = [\"lower\", \"upper\"]\n{law}");
    }
    if steps {
        out += "[steps]\ntimes = [1, 2, 3, 4]\nload = \"if(t<2, 0.7, if(t<3, 1, if(t<4, 0.2, 0.9)))\"\n";
    }
    out
}

/// A wall of `friction_walls` with Tresca's law, or soft and with elastic slip.
fn wall(id: u64) -> String {
    let mut rng = Rng::new(47_000 + id);
    let text = super::friction_walls::scene(id);
    let law = match rng.below(3) {
        0 => Some(format!("tresca = {}", rng.pick(&[0.005, 0.02, 0.05]))),
        1 => Some("friction = 0.3\nstiffness = 30\nstick_stiffness = 10".to_string()),
        _ => None,
    };
    let line = |line: &str| match &law {
        Some(law) if line.starts_with("friction") => format!("{law}\n"),
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// Results, and what they were compared with.
#[derive(Default)]
struct Tally {
    /// Load steps with Tresca's law and with Coulomb's that agree.
    right: [usize; 2],
    /// Steps of Coulomb's law whose fixed point is another, or does not come to rest: there the solver has the forces
    /// of the programme with the bounds that it ends with.
    other: usize,
    /// Scenes that the programme does not solve to its tolerance.
    undecided: usize,
    /// Scenes that are refused, with a programme that has no solution.
    without: usize,
    failed: Vec<String>,
    /// Nodes that are open, stick and slip in both; with a state in the programme, but another in the solver.
    states: [usize; 3],
    wrong: usize,
    force: f64,
    energy: f64,
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0f64, |a, v| a.max(v.abs()))
}

/// The multipliers of all rows, in the order of the problem.
fn multipliers(solution: &Solution) -> Vec<f64> {
    let rows = solution.rows().iter().chain(solution.tangential_rows());
    rows.map(|row| row.multiplier).collect()
}

/// A load step: the programme's loads and gaps, and what came out.
struct Step<'a> {
    conic: &'a Conic<'a>,
    problem: &'a Problem,
    loads: Vec<f64>,
    gaps: Vec<f64>,
    solution: &'a Solution,
}

impl Step<'_> {
    /// How far forces and energy are from those of a programme, relative to their sizes.
    fn distance(&self, other: &Solved) -> [f64; 2] {
        let found = self.conic.reactions(&multipliers(self.solution));
        let wanted = self.conic.reactions(&other.lambda);
        let apart: Vec<f64> = found.iter().zip(&wanted).map(|(a, b)| a - b).collect();
        let force = self.conic.force(&self.loads, &self.gaps);
        let work: f64 = self
            .loads
            .iter()
            .zip(&other.u)
            .map(|(f, u)| (f * u).abs())
            .sum();
        let energy = (self.solution.energy - other.energy).abs();
        [
            largest(&apart) / force.max(largest(&wanted)),
            energy / work.max(other.energy.abs()),
        ]
    }

    /// Counts the states of nodes that have one in the programme.
    fn count(&self, other: &Solved, tally: &mut Tally) {
        let found = self.solution.tangential_rows();
        let n_normal = self.solution.rows().len();
        let (force, length) = (self.conic.force(&self.loads, &self.gaps), largest(&other.u));
        let bounds = self.conic.bounds(&other.lambda);
        for (node, g) in self.problem.friction.iter().zip(bounds) {
            let size = |v: &[f64]| {
                let parts = node.tangential.iter().map(|&t| v[t] * v[t]);
                parts.sum::<f64>().sqrt()
            };
            let apart = -other.excess[node.normal] > CLEAR * length;
            let state = if apart && g < CLEAR * force {
                0
            } else if g - size(&other.lambda) > CLEAR * force {
                1
            } else if size(&other.excess) > CLEAR * length && g > CLEAR * force {
                2
            } else {
                continue;
            };
            let own = match found[node.tangential[0] - n_normal].state {
                RowState::Sticks => 1,
                RowState::Slips => 2,
                _ => 0,
            };
            match state == own {
                true => tally.states[state] += 1,
                false => tally.wrong += 1,
            }
        }
    }
}

/// Solves all load steps of a scene both ways, each with the history of its own.
fn compare(session: &Session, kind: ContactType, (name, text): (&str, &str), tally: &mut Tally) {
    let parsed = Scene::parse("conic.toml", text).expect("a good scene");
    let problem = parsed.substructures(&|_| true).expect("a good scene");
    let conic = Conic::new(&problem);
    let tresca = { problem.friction.iter() }.all(|n| matches!(n.bound, FrictionBound::Tresca(_)));
    let mut settings = Settings::from(MethodSettings::default().rtol(1e-10));
    (settings.contact.kind, settings.contact.max_it) = (kind, STEPS);
    let solver = FetiFeti::new(session, problem.clone(), settings);
    let scene = Scene::parse("conic.toml", text).expect("a good scene");
    let solved = solver.and_then(|solver| Stepper::with_solver(scene, solver));
    let mut stepper = solved.unwrap_or_else(|e| panic!("{name}: {e}\n{text}"));
    let mut slid = vec![0.0; problem.rows.len()];
    for step in 0..parsed.n_steps() {
        let subdomains = 0..problem.n_subdomains;
        let loads: Vec<Vec<f64>> = { subdomains }
            .map(|s| parsed.loads(s, step).expect("loads"))
            .collect();
        let loads = conic.gathered(&loads, true);
        let gaps = parsed.gaps(&|_| true, step).expect("gaps");
        let gaps: Vec<f64> = gaps.iter().zip(&slid).map(|(c, a)| c + a).collect();
        let programme = || match tresca {
            true => conic.tresca(&loads, &gaps, &conic.bounds(&slid)).ok(),
            false => conic.coulomb(&loads, &gaps),
        };
        let solution = match stepper.next().expect("a step") {
            Ok(step) => step.solution,
            Err(e) if e.to_string().contains("pushed away") => {
                assert!(programme().is_none(), "{name}: {e}\n{text}");
                tally.without += 1;
                return;
            }
            Err(e) => panic!("{name}: {e}\n{text}"),
        };
        if !solution.converged() {
            tally.failed.push(format!("{name}: {}", solution.status));
            return;
        }
        let judged = Step {
            conic: &conic,
            problem: &problem,
            loads: loads.clone(),
            gaps: gaps.clone(),
            solution: &solution,
        };
        let agrees = |other: &Solved| judged.distance(other).iter().all(|d| *d < ACCURACY);
        let found = match programme() {
            Some(other) if agrees(&other) => {
                judged.count(&other, tally);
                tally.right[usize::from(!tresca)] += 1;
                other
            }
            other => {
                let far = other.map(|o| judged.distance(&o));
                let wrong = tresca && far.is_some();
                assert!(!wrong, "{name}, step {step}: {far:?}\n{text}");
                let bounds = conic.bounds(&multipliers(&solution));
                let Ok(other) = conic.tresca(&loads, &gaps, &bounds) else {
                    tally.undecided += 1;
                    return;
                };
                let now = judged.distance(&other);
                assert!(agrees(&other), "{name}, step {step}: {now:?}\n{text}");
                println!("{name}, step {step}: the fixed point is not that of the solver, {far:?}");
                tally.other += 1;
                other
            }
        };
        let [force, energy] = judged.distance(&found);
        tally.force = tally.force.max(force);
        tally.energy = tally.energy.max(energy);
        // Where the sides stand: what a node has slipped, and not what its friction gives way.
        let jumps = conic.jumps(&found.u);
        let rows = problem.rows.iter().zip(&found.lambda).zip(jumps);
        let stands = rows.map(|((row, l), jump)| jump - row.compliance * l);
        slid = stands.collect();
        let normal = problem.rows.len() - solution.tangential_rows().len();
        slid[..normal].fill(0.0);
    }
}

/// Scenes of a kind by a strategy of the contact loop.
fn all_by(
    method: ContactType,
    kind: &'static str,
    text: fn(u64) -> String,
    ids: impl Iterator<Item = u64>,
) -> Tally {
    let ids: Vec<u64> = ids.collect();
    with_session(move |session| {
        let mut tally = Tally::default();
        for id in ids {
            let name = format!("{kind} {id}");
            compare(session, method, (&name, &text(id)), &mut tally);
        }
        println!(
            "{kind}: load steps that agree: Tresca {}, Coulomb {} (forces within {:.1e}, energy {:.1e}), another \
             solution {}; open, stick, slip: {:?}, wrong {}; undecided {}, without a \
             solution {}, not solved: {:?}",
            tally.right[0],
            tally.right[1],
            tally.force,
            tally.energy,
            tally.other,
            tally.states,
            tally.wrong,
            tally.undecided,
            tally.without,
            tally.failed
        );
        tally
    })
}

fn all(kind: &'static str, text: fn(u64) -> String, ids: impl Iterator<Item = u64>) -> Tally {
    all_by(ContactType::ActiveSet, kind, text, ids)
}

/// Forty of four hundred scenes of blocks.
#[test]
fn held_blocks_have_the_solution_of_the_conic_programme() {
    let tally = all("blocks", held, sample(10, 0..400));
    assert!(tally.failed.is_empty() && (tally.without, tally.undecided) == (0, 0));
    assert!(tally.right.iter().all(|n| *n > 10), "{:?}", tally.right);
    assert!(tally.states.iter().all(|n| *n > 10), "{:?}", tally.states);
    assert_eq!((tally.wrong, tally.other), (0, 0));
    assert!(tally.force < 1e-6 && tally.energy < 1e-6);
}

/// Twenty of them, and four walls, by SMALBE.
#[test]
fn smalbe_has_the_solution_of_the_conic_programme() {
    let tally = all_by(ContactType::Smalbe, "blocks", held, sample(20, 0..400));
    assert!(tally.failed.is_empty() && (tally.without, tally.undecided) == (0, 0));
    assert!(tally.right.iter().all(|n| *n > 5), "{:?}", tally.right);
    assert!(tally.states.iter().all(|n| *n > 10), "{:?}", tally.states);
    assert_eq!((tally.wrong, tally.other), (0, 0));
    assert!(tally.force < 1e-6 && tally.energy < 1e-6);
    let tally = all_by(ContactType::Smalbe, "walls", wall, sample(50, 0..200));
    assert!(tally.right[0] + tally.right[1] > tally.other / 4);
}

/// Eight of two hundred walls, whose rows depend on each other, and where states may wander: that is said.
#[test]
fn walls_have_the_solution_of_the_conic_programme() {
    let ids: Vec<u64> = sample(25, 0..200).collect();
    let n = ids.len();
    let tally = all("walls", wall, ids.into_iter());
    assert!(tally.right[0] + tally.right[1] > tally.other / 4);
    assert!(tally.undecided <= 1 + n / 20, "{}", tally.undecided);
    assert!(tally.failed.len() <= 3 + n / 3, "{:?}", tally.failed);
}

/// All blocks and walls: `cargo test --test contact -- --ignored --nocapture conic`.
#[test]
#[ignore = "the samples run"]
fn all_scenes_beside_the_conic_programme() {
    let tally = all("blocks", held, 0..400);
    assert!(tally.failed.is_empty() && (tally.wrong, tally.other) == (0, 0));
    let tally = all("walls", wall, 0..200);
    assert!(tally.failed.len() < 70, "{:?}", tally.failed);
    let tally = all_by(ContactType::Smalbe, "blocks", held, 0..400);
    assert!(tally.failed.is_empty() && (tally.wrong, tally.other) == (0, 0));
    let tally = all_by(ContactType::Smalbe, "walls", wall, 0..200);
    assert!(tally.failed.len() < 70, "{:?}", tally.failed);
}
