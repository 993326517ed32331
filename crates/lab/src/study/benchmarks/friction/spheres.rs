//! Two equal half balls, pressed together and then pushed to and fro along each other.
//!
//! Mindlin's solution takes all shear stress and all slip to be along Q. With ν = 0 shear in one direction moves the
//! surface of a half-space in this direction alone, and the solution is exact for half-spaces; with ν = 0.3 the slip
//! turns by some degrees.

use super::super::report::MeshSeries;
use super::super::runner::Runner;
use super::mindlin::{Mindlin, Stage, StageLimits, FACTOR, STAGES, STEPS};
use super::{tractions, NodeTraction};
use base::Result;

const RADIUS: f64 = 8.0;
const YOUNG: f64 = 200.0;
const FRICTION: f64 = 0.3;

/// The radius of the contact.
const CONTACT: f64 = 0.8;

/// How far the upper body is pushed, over the approach; with it Q is about 0.75 μP at the turn.
const PUSH: f64 = 1.7 * FRICTION;

/// How far out the boxes reach, and up to where their elements are equal, over the radius: flanks are cut off.
const TRIM: f64 = 0.5;
const FOCUS: f64 = 0.11;

/// Bricks of first order; nodes match. Faces of second order are joined by mortar rows in space.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let theory = Mindlin {
        modulus: 0.5 * YOUNG,
        radius: 0.5 * RADIUS,
        friction: FRICTION,
        spheres: true,
    };
    let meshes: &[usize] = if runner.quick {
        &[12, 16]
    } else {
        &[16, 24, 32]
    };
    let mut stages: [Vec<_>; 3] = Default::default();
    for (k, &n) in meshes.iter().enumerate() {
        let name = format!("mindlin_sphere_{n}");
        let run = runner.solve(&name, &scene(n, &theory))?;
        let steps: Vec<Vec<NodeTraction>> = run.steps.iter().map(tractions).collect();
        let finest = k + 1 == meshes.len() && !runner.quick;
        for ((step, _), list) in STAGES.into_iter().zip(&mut stages) {
            let stage = Stage {
                steps: &steps,
                step,
                limits: finest.then_some(StageLimits {
                    curve: 0.1,
                    extremes: 0.1,
                }),
            };
            let (values, curve) = stage.beside(&theory, |n| n.point[2].abs() < 1e-9);
            let label = format!("{n} × {} × {n}", n / 2);
            list.push(run.with_curve(label, 1.0 / n as f64, values, curve));
        }
    }
    let named = STAGES.into_iter().zip(stages);
    Ok(named
        .map(|((_, name), list)| MeshSeries::new(format!("{name}, order 1"), list))
        .collect())
}

/// As for cylinders: y is the normal.
fn scene(n: usize, theory: &Mindlin) -> String {
    let approach = CONTACT * CONTACT / theory.radius;
    let ball = |name: &str, side: f64, pole: &str, held: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\n\
             shape = {{ half_ball = {{ radius = {RADIUS}, centre = [0, {}, 0], pole = \"{pole}\", \
             focus = {FOCUS}, trim = {TRIM} }} }}\n\
             elements = [{n}, {}, {n}]\nsubdomains = [2, 1, 2]\nyoung = {YOUNG}\npoisson = 0\n\
             dirichlet = {{ {held} }}\n\n",
            side * RADIUS,
            n / 2
        )
    };
    let pushed = format!("top = [{}, 0, 0]", PUSH * approach);
    format!(
        "title = \"Two balls under normal and tangential load\"\ndimension = 3\nphysics = \"elasticity\"\n\n\
         {}{}[[contact]]\nbodies = [\"upper\", \"lower\"]\nsides = [\"bottom\", \"top\"]\n\
         gap = {}\nfriction = {FRICTION}\n\n[steps]\ncount = {STEPS}\ndirichlet = \"{FACTOR}\"\n",
        ball("upper", 1.0, "bottom", &pushed),
        ball("lower", -1.0, "top", "bottom = 0"),
        -approach
    )
}
