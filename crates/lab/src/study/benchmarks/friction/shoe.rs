//! Code_Aster's test SSNV503 (V6.04.503): a shoe on a rigid plane, pressed by 300 N/mm² and pushed from the side, below
//! and above what friction holds.
//!
//! The shoe is 40 mm long and 20 mm high, μ = 0.3, and a spring of 4 N/mm holds it along the plane. Pushed by
//! 178.2 N/mm² it sticks; pushed by 181.8 N/mm² it slips until the spring bears what friction does not, which is 1 % of
//! μ N, at 9 mm. Code_Aster's plane is inclined, and 2 mm away at first; that is left out.

use super::super::report::{MeasuredValue, MeshSeries};
use super::super::runner::{Runner, SolvedScene};
use super::{resultant, tractions};
use base::Result;

const FRICTION: f64 = 0.3;

/// The force that presses, in N per mm of depth, and the stiffness of the spring in N/mm.
const NORMAL: f64 = 300.0 * 40.0;
const SPRING: f64 = 4.0;

/// The pressure from the side; the force of friction, and the way of the shoe in mm.
const PUSHES: [(f64, f64, f64); 2] = [(178.2, 3564.0, 0.0), (181.8, 3600.0, 9.0)];

/// The largest permitted errors of a force and of the way.
const FORCE: f64 = 1e-4;
const WAY: f64 = 0.01;

/// Both pushes, quadrilaterals of both orders.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    let meshes: &[usize] = if runner.quick { &[8] } else { &[8, 16, 32] };
    for (push, friction, way) in PUSHES {
        for order in [1, 2] {
            let mut list = Vec::new();
            for &n in meshes {
                let name = format!("ssnv503_{push}_order{order}_{n}");
                let run = runner.solve(&name, &scene(n, order, push))?;
                let values = measure(&run, friction, way);
                list.push(run.mesh(format!("{} × {n}", 2 * n), 1.0 / n as f64, values));
            }
            // The spring gives way with the shoe, which bends.
            out.push(MeshSeries {
                order: None,
                ..MeshSeries::new(format!("pushed by {push}, order {order}"), list)
            });
        }
    }
    Ok(out)
}

fn measure(run: &SolvedScene, friction: f64, way: f64) -> Vec<MeasuredValue> {
    let nodes = tractions(run.last());
    let [along, across, _] = resultant(&nodes);
    let mean = nodes.iter().map(|n| n.slip[0]).sum::<f64>() / nodes.len() as f64;
    vec![
        MeasuredValue::beside("friction", -along, friction).within(Some(FORCE)),
        MeasuredValue::beside("normal force", across, NORMAL).within(Some(FORCE)),
        MeasuredValue::error("(way − expected) / 9 mm", (mean - way) / 9.0).within(Some(WAY)),
    ]
}

fn scene(n: usize, order: usize, push: f64) -> String {
    format!(
        "title = \"A shoe on a rigid plane\"\nphysics = \"elasticity\"\norder = {order}\n\n\
         [[body]]\nname = \"shoe\"\nsize = [40, 20]\nelements = [{}, {n}]\nsubdomains = [2, 1]\n\
         young = 210e3\npoisson = 0\npressure = {{ top = 300, left = {push} }}\n\
         spring = {{ right = {} }}\n\n\
         [[obstacle]]\nbody = \"shoe\"\nside = \"bottom\"\n\
         plane = {{ point = [0, 0], normal = [0, 1] }}\nfriction = {FRICTION}\n",
        2 * n,
        SPRING / 20.0
    )
}
