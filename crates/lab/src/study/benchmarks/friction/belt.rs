//! A belt on a drum: Euler's and Eytelwein's T₂/T₁ = e^{μθ}.
//!
//! One end of the belt is held and the other is pulled, so that all of it slips towards the latter. A belt of the
//! thickness h on a drum of radius R pulls along its middle, while friction acts at R. With the pressure p per length,
//!
//! ```text
//!     T = p R,   (R + h/2) dT = μ p R dθ R,   T₂/T₁ = exp(μ θ / (1 + h/(2R)))
//! ```
//!
//! in a belt whose bending moment is the same everywhere, as it is where the drum has the same curvature everywhere.

use std::f64::consts::PI;

use super::super::report::{MeasuredValue, MeshResult, MeshSeries, ReferencePressure};
use super::super::runner::{Runner, SolvedScene};
use super::{resultant, tractions};
use base::Result;
use fetifeti::solution::RowState;

const FRICTION: f64 = 0.3;

/// Half of a drum of radius 1, belts of two thicknesses, elements of both orders.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    let meshes: &[usize] = if runner.quick {
        &[40, 80]
    } else {
        &[40, 80, 160]
    };
    for thickness in [0.04, 0.02] {
        for order in [1, 2] {
            let mut list = Vec::new();
            for (k, &n) in meshes.iter().enumerate() {
                let name = format!("belt_{thickness}_order{order}_{n}");
                let run = runner.solve(&name, &scene(n, order, thickness))?;
                let finest = k + 1 == meshes.len();
                list.push(measure(&run, n, order, thickness, finest));
            }
            let name = format!("h = {thickness} R, order {order}");
            out.push(MeshSeries::new(name, list));
        }
    }
    Ok(out)
}

fn measure(run: &SolvedScene, n: usize, order: usize, thickness: f64, finest: bool) -> MeshResult {
    let nodes = tractions(run.last());
    // The held end takes what the drum and the pull leave.
    let pulled = thickness;
    let held = resultant(&nodes)[1] - pulled;
    let exponent = FRICTION / (1.0 + 0.5 * thickness);
    let ratio = (exponent * PI).exp();
    let stuck = nodes.iter().filter(|n| n.state == RowState::Sticks).count();
    let edge = 1.0 / (n * order) as f64;
    let values = vec![
        MeasuredValue::beside("T2/T1", pulled / held, ratio).within(finest.then_some(0.01)),
        MeasuredValue::beside("T2/T1 of a thin belt", pulled / held, (FRICTION * PI).exp()),
        MeasuredValue::error("nodes that stick", stuck as f64).within(Some(0.0)),
    ];
    let curve = nodes.iter().map(|node| {
        let angle = node.point[1].atan2(node.point[0]);
        let shear = node.shear[0].hypot(node.shear[1]);
        ReferencePressure {
            x: angle.to_degrees(),
            p: shear / (FRICTION * held),
            reference: (exponent * angle).exp(),
        }
    });
    run.with_curve(format!("{n} elements"), edge, values, curve.collect())
}

/// The belt has a unit traction on the end at 180°.
fn scene(n: usize, order: usize, thickness: f64) -> String {
    format!(
        "title = \"A belt on a drum\"\nphysics = \"elasticity\"\nplane = \"stress\"\norder = {order}\n\n\
         [[body]]\nname = \"belt\"\n\
         shape = {{ annulus = {{ inner = 1, outer = {}, from = 0, to = 180 }} }}\n\
         elements = [2, {n}]\nsubdomains = [1, {}]\nyoung = 1e6\npoisson = 0\n\
         dirichlet = {{ bottom = {{ y = 0 }} }}\ntraction = {{ top = [0, -1] }}\n\n\
         # The side of first order is a polygon whose corners lie on the drum.\n\
         [[obstacle]]\nbody = \"belt\"\nside = \"left\"\n\
         cylinder = {{ centre = [0, 0], radius = 1 }}\nfriction = {FRICTION}\n",
        1.0 + thickness,
        n / 20
    )
}
