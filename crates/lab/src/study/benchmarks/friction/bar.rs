//! A bar that is pressed onto its bed by a uniform pressure p and pulled at one end.
//!
//! A thin bar of the height h slips over the length ℓ = F/(μ p) from the end that is pulled by F per thickness, and
//! this end moves by F²/(2 E h μ p). In two dimensions there is a transition to where the bar sticks, whose length is
//! in proportion to h: ℓ = F/(μ p) − c h. As long as the end that is not pulled is far away, c does not depend on the
//! load, and dℓ/dF = 1/(μ p) is exact.

use super::super::report::{MeasuredValue, MeshResult, MeshSeries, ReferencePressure};
use super::super::runner::{Runner, SolvedScene};
use super::{resultant, tractions, NodeTraction};
use base::Result;
use fetifeti::solution::RowState;

const FRICTION: f64 = 0.3;
const PRESSURE: f64 = 1.0;
const YOUNG: f64 = 1e4;

/// The slip lengths F/(μ p) of a thin bar in the load steps; the bar is 1 long.
const LENGTHS: [f64; 3] = [0.3, 0.5, 0.7];

/// Bars of two heights, elements of both orders.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    let meshes: &[usize] = if runner.quick {
        &[40, 80]
    } else {
        &[40, 80, 160]
    };
    for height in [0.05, 0.025] {
        for order in [1, 2] {
            let mut list = Vec::new();
            for &n in meshes {
                let name = format!("bar_{height}_order{order}_{n}");
                let run = runner.solve(&name, &scene(n, order, height))?;
                list.push(measure(&run, n, order, height));
            }
            // The error that is left is that of the bar's height.
            out.push(MeshSeries {
                order: None,
                ..MeshSeries::new(format!("h = {height}, order {order}"), list)
            });
        }
    }
    Ok(out)
}

/// The length over which the bar slips: the areas of the nodes that do.
fn slip_length(nodes: &[NodeTraction]) -> f64 {
    let slipping = nodes.iter().filter(|n| n.state == RowState::Slips);
    slipping.map(|n| n.area).sum()
}

fn measure(run: &SolvedScene, n: usize, order: usize, height: f64) -> MeshResult {
    let steps: Vec<Vec<NodeTraction>> = run.steps.iter().map(tractions).collect();
    let lengths: Vec<f64> = steps.iter().map(|nodes| slip_length(nodes)).collect();
    // What the pull at the end is in equilibrium with, over μ p.
    let thin = |nodes: &Vec<NodeTraction>| -resultant(nodes)[0] / (FRICTION * PRESSURE);
    let thin: Vec<f64> = steps.iter().map(thin).collect();
    let last = LENGTHS.len() - 1;
    let edge = 1.0 / (n * order) as f64;
    let slope = (lengths[last] - lengths[0]) / (thin[last] - thin[0]);
    let correction = height / thin[last];
    let values = vec![
        // Both ends of the difference are known to a node.
        MeasuredValue::beside("μ p dℓ/dF", slope, 1.0)
            .within(Some(2.0 * edge / (thin[last] - thin[0]))),
        MeasuredValue::beside("μ p ℓ/F", lengths[last] / thin[last], 1.0)
            .within(Some(correction + edge)),
        MeasuredValue::beside("F", thin[last], LENGTHS[last]).within(Some(correction)),
    ];
    let curve = steps[last].iter().map(|node| ReferencePressure {
        x: node.point[0],
        p: -node.shear[0] / (FRICTION * PRESSURE),
        reference: f64::from(u8::from(1.0 - node.point[0] < thin[last])),
    });
    run.with_curve(format!("{n} elements"), edge, values, curve.collect())
}

/// The pressure is there from the first load step on; the end is drawn as far as a thin bar gives way to μ p ℓ.
fn scene(n: usize, order: usize, height: f64) -> String {
    let across = ((n as f64 * height).round() as usize).max(2);
    let way = LENGTHS.map(|l| l * l * FRICTION * PRESSURE / (2.0 * YOUNG * height));
    format!(
        "title = \"A bar pulled over its bed\"\nphysics = \"elasticity\"\nplane = \"stress\"\norder = {order}\n\n\
         [[body]]\nname = \"bar\"\nsize = [1, {height}]\nelements = [{n}, {across}]\nsubdomains = [{}, 1]\n\
         young = {YOUNG}\npoisson = 0\npressure = {{ top = {PRESSURE} }}\n\
         dirichlet = {{ right = {{ x = 1 }} }}\n\n\
         [[obstacle]]\nbody = \"bar\"\nside = \"bottom\"\n\
         plane = {{ point = [0, 0], normal = [0, 1] }}\nfriction = {FRICTION}\n\n\
         [steps]\ncount = 3\ndirichlet = \"if(t < 0.5, {}, if(t < 0.9, {}, {}))\"\n",
        n / 20,
        way[0],
        way[1],
        way[2],
    )
}
