//! A block on an incline, which stands if and only if the tangent of its angle is at most the coefficient of friction.

use super::super::report::{MeasuredValue, MeshResult, MeshSeries};
use super::super::runner::Runner;
use super::{resultant, tractions};
use base::Result;

/// The coefficient of friction.
const FRICTION: f64 = 0.3;

/// tan α / μ on both sides of 1.
const SLOPES: [f64; 6] = [0.9, 0.99, 0.9999, 1.0001, 1.01, 1.1];

/// The largest permitted error of a force, relative to the weight, and of |τ| beside μ p at a node.
const LIMIT: f64 = 1e-8;

/// Blocks of 2 × 1 in elements of both orders.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    let meshes: &[usize] = if runner.quick { &[4] } else { &[4, 8, 16] };
    for order in [1, 2] {
        for slope in SLOPES {
            let mut list = Vec::new();
            for &n in meshes {
                list.push(block(runner, n, order, slope)?);
            }
            let name = format!("tan α = {slope} μ, order {order}");
            out.push(MeshSeries::new(name, list));
        }
    }
    Ok(out)
}

fn block(runner: &mut Runner, n: usize, order: usize, slope: f64) -> Result<MeshResult> {
    let name = format!("incline_{slope}_order{order}_{n}");
    let text = scene(n, order, slope * FRICTION);
    let mesh = format!("{} × {n}", 2 * n);
    if slope > 1.0 {
        // It must be refused, by the name of the body that slides.
        let refused = runner.refused(&name, &text)?;
        let names = |s: &String| s.contains("body \"block\"") && s.contains("slides along x");
        let wrong = f64::from(!refused.said.as_ref().is_some_and(names));
        let value = MeasuredValue::error("not refused as sliding", wrong).within(Some(0.0));
        return Ok(refused.mesh(mesh, 1.0 / n as f64, vec![value]));
    }
    let run = runner.solve(&name, &text)?;
    let nodes = tractions(run.last());
    let weight = 2.0;
    let [along, across, _] = resultant(&nodes);
    let beyond = nodes
        .iter()
        .map(|t| t.shear[0].abs() - FRICTION * t.pressure);
    let beyond = beyond.fold(0.0, f64::max);
    let values = vec![
        MeasuredValue::error(
            "friction / weight along the slope",
            along / (-slope * FRICTION * weight) - 1.0,
        )
        .within(Some(LIMIT)),
        MeasuredValue::error("normal force / weight", across / weight - 1.0).within(Some(LIMIT)),
        MeasuredValue::error("|τ| beyond μ p", beyond).within(Some(LIMIT)),
    ];
    Ok(run.mesh(mesh, 1.0 / n as f64, values))
}

/// The block in the axes of the incline, under a weight of 1 per volume across it and its part along the slope.
fn scene(n: usize, order: usize, tangent: f64) -> String {
    format!(
        "title = \"A block on an incline\"\nphysics = \"elasticity\"\norder = {order}\n\n\
         [[body]]\nname = \"block\"\nsize = [2, 1]\nelements = [{}, {n}]\nsubdomains = [2, 1]\n\
         young = 1000\npoisson = 0.3\nload = [{tangent}, -1]\n\n\
         [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\n\
         plane = {{ point = [0, 0], normal = [0, 1] }}\nfriction = {FRICTION}\n",
        2 * n
    )
}
