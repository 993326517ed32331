//! The roller of the first of NAFEMS' contact benchmarks with friction: Code_Aster's test SSNP154 (V6.03.154).

use super::super::hertz::{nafems, pair, scene_of, ROLLER_LOAD, YOUNG};
use super::super::report::{MeasuredValue, MeshSeries, ReferencePressure};
use super::super::runner::{Runner, SolvedScene};
use super::{resultant, tractions};
use crate::study::hertz::HertzContact;
use base::Result;
use fetifeti::problem::BodyNode;

/// The coefficients of friction, and the way of the point B of Code_Aster's models, in mm.
const WAYS: [(f64, f64); 2] = [(0.0, -1.306904), (0.1, -1.30264)];

/// The largest permitted difference from Code_Aster's, which has large rotations.
const LIMIT: f64 = 0.03;

/// The pressure at B with friction, and how far ours may be off: theirs is extrapolated from stresses.
const PRESSURE: (f64, f64) = (3542.69, 0.05);

/// Triangles of both orders.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let pair = pair(50.0, false);
    let roller = nafems(&pair);
    let theory = pair.under(ROLLER_LOAD);
    let edges: [&[f64]; 2] = if runner.quick {
        [&[0.25, 0.125], &[0.5, 0.25]]
    } else {
        [&[0.125, 0.0625, 0.03125], &[0.25, 0.125, 0.0625]]
    };
    let mut out = Vec::new();
    for (friction, way) in WAYS {
        for (order, edges) in [1, 2].into_iter().zip(edges) {
            let mut list = Vec::new();
            for (k, &edge) in edges.iter().enumerate() {
                let name = format!("roller_friction{friction}_order{order}_{}", k + 1);
                let file = format!("{name}.msh");
                let mesh = roller.mesh(&file, edge, order);
                let pressure = 0.5 * ROLLER_LOAD / roller.load;
                let title = "Roller on a block with friction";
                let text = scene_of(title, 2, &file, pressure, YOUNG, "lower")
                    .replace("foot = { y = 0 }", "foot = 0");
                // A coefficient of 0 would be a law of friction, too.
                let law = if friction > 0.0 {
                    format!("friction = {friction}\n")
                } else {
                    String::new()
                };
                let text = text + &law;
                let run = runner.solve_mesh(&name, &text, &mesh)?;
                let (values, curve) = measure(&run, friction, way, &theory);
                list.push(run.with_curve(format!("h = a/{}", 1.0 / edge), edge, values, curve));
            }
            // The difference that is left is that of small displacements.
            out.push(MeshSeries {
                order: None,
                ..MeshSeries::new(format!("μ = {friction}, order {order}"), list)
            });
        }
    }
    Ok(out)
}

fn measure(
    run: &SolvedScene,
    friction: f64,
    way: f64,
    theory: &HertzContact,
) -> (Vec<MeasuredValue>, Vec<ReferencePressure>) {
    let step = run.last();
    let middle = step.rows.iter().find(|r| r.label.point[0].abs() < 1e-9);
    let lower: Option<BodyNode> = middle.and_then(|r| r.label.members[0]);
    let found = lower.map_or(f64::NAN, |node| step.displaced.at(node)[1]);
    let mut values = vec![MeasuredValue::beside("u_y of B", found, way).within(Some(LIMIT))];
    if friction == 0.0 {
        return (values, Vec::new());
    }
    let nodes = tractions(step);
    let bound = friction * theory.p0;
    let beyond = nodes
        .iter()
        .map(|n| n.shear[0].hypot(n.shear[1]) - friction * n.pressure.max(0.0));
    let largest = nodes.iter().map(|n| n.shear[0].abs()).fold(0.0, f64::max);
    let [_, normal, _] = resultant(&nodes);
    let pressure = middle.and_then(|r| r.pressure()).unwrap_or(f64::NAN);
    values.extend([
        MeasuredValue::beside("p of B", pressure, PRESSURE.0).within(Some(PRESSURE.1)),
        MeasuredValue::error("largest τ / μ p0", largest / bound),
        MeasuredValue::error("|τ| beyond μ p / μ p0", beyond.fold(0.0, f64::max) / bound)
            .within(Some(1e-6)),
        MeasuredValue::error("force / load", 2.0 * normal.abs() / ROLLER_LOAD - 1.0)
            .within(Some(1e-6)),
    ]);
    let drawn = nodes.iter().filter(|n| n.point[0] < 1.6 * theory.a);
    let curve = drawn.map(|n| ReferencePressure {
        x: n.point[0] / theory.a,
        p: n.shear[0].abs() / bound,
        reference: theory.pressure(n.point[0]) / theory.p0,
    });
    (values, curve.collect())
}
