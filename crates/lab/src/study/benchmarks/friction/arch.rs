//! A semicircular arch of voussoirs under its own weight, on both sides of its least thickness and of the least
//! coefficient of friction.
//!
//! Milankovitch (1907) found 0.1075 of the radius of the centre line for the least thickness of an arch with joints
//! everywhere; with n voussoirs of straight sides it is a little less ([`Arch::least_thickness`]). Voussoirs are much
//! stiffer than their weight, and forces at the ends of a joint are forces at nodes there: elements change nothing in
//! the limit.

use super::super::report::{MeasuredValue, MeshResult, MeshSeries};
use super::super::runner::Runner;
use super::arch_statics::Arch;
use super::tractions;
use base::Result;

/// A coefficient of friction with which nothing slides.
const ROUGH: f64 = 0.6;

/// The thickness of an arch that slides before its joints open too far.
const THICK: f64 = 0.15;

/// Young's modulus over the weight of a voussoir per volume, and the radius.
const YOUNG: f64 = 1e6;

/// Thickness and friction above and below their limits.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    let counts: &[usize] = if runner.quick {
        &[16]
    } else {
        &[8, 16, 17, 32]
    };
    for factor in [1.01, 1.001, 0.999, 0.99] {
        let mut list = Vec::new();
        for (n, parts) in counts.iter().flat_map(|&n| [(n, 1), (n, 2)]) {
            let arch = Arch {
                thickness: 1.0,
                voussoirs: n,
                parts,
            };
            let least = arch.least_thickness(ROUGH);
            let thickness = factor * least;
            let arch = Arch { thickness, ..arch };
            let mut result = voussoirs(runner, arch, ROUGH, factor)?;
            // Couplet's problem with joints everywhere: few voussoirs are off by what they cannot do.
            result.values.push(MeasuredValue::beside(
                "least thickness, statics / Milankovitch",
                least,
                0.1075,
            ));
            list.push(result);
        }
        out.push(MeshSeries::new(format!("thickness {factor} × least"), list));
    }
    for factor in [1.2, 0.8] {
        let mut list = Vec::new();
        for (n, parts) in counts.iter().flat_map(|&n| [(n, 1), (n, 2)]) {
            let arch = Arch {
                thickness: THICK,
                voussoirs: n,
                parts,
            };
            let friction = factor * arch.least_friction();
            list.push(voussoirs(runner, arch, friction, factor)?);
        }
        out.push(MeshSeries::new(format!("friction {factor} × least"), list));
    }
    Ok(out)
}

/// An arch that stands carries its weight at the springings; one that does not is refused, in a sentence that names
/// voussoirs, or ends with a status that says that the loop has found no solution.
fn voussoirs(runner: &mut Runner, arch: Arch, friction: f64, factor: f64) -> Result<MeshResult> {
    let kind = if friction == ROUGH { "thick" } else { "rough" };
    let (n, parts) = (arch.voussoirs, arch.parts);
    let name = format!("arch_{kind}_{factor}_{n}_{parts}");
    let mesh = format!("{n} of 2·{parts} × {parts} elements");
    let text = scene(arch, friction);
    if factor < 1.0 {
        let refused = runner.refused(&name, &text)?;
        let said = refused.said.as_deref();
        let named = said.is_some_and(|s| s.contains("bodies \"v0\""));
        let values = vec![
            MeasuredValue::error("wrong answer", f64::from(u8::from(said.is_none())))
                .within(Some(0.0)),
            MeasuredValue::error("fallen, not named", f64::from(u8::from(!named))),
        ];
        return Ok(refused.mesh(mesh, 1.0 / n as f64, values));
    }
    let run = runner.solve(&name, &text)?;
    let nodes = tractions(run.last());
    // The upward force of both springings, which are the obstacles.
    let springings = nodes.iter().filter(|n| n.point[1].abs() < 1e-9);
    let carried: f64 = springings.map(|n| n.force()[1]).sum();
    let beyond = nodes.iter().map(|n| {
        let shear = n.shear[0].hypot(n.shear[1]);
        (shear - friction * n.pressure) * n.area
    });
    let values = vec![
        MeasuredValue::error("wrong answer", 0.0).within(Some(0.0)),
        MeasuredValue::error("springings / weight", carried / arch.weight() - 1.0)
            .within(Some(1e-6)),
        MeasuredValue::error(
            "|T| beyond μ N / weight",
            beyond.fold(0.0, f64::max) / arch.weight(),
        )
        .within(Some(1e-6)),
    ];
    Ok(run.mesh(mesh, 1.0 / n as f64, values))
}

fn scene(arch: Arch, friction: f64) -> String {
    let [inner, outer] = arch.radii();
    let n = arch.voussoirs;
    let mut text = "title = \"An arch of voussoirs\"\nphysics = \"elasticity\"\n".to_string();
    for k in 0..n {
        let [from, to] = [k, k + 1].map(|k| 180.0 * k as f64 / n as f64);
        text += &format!(
            "\n[[body]]\nname = \"v{k}\"\n\
             shape = {{ annulus = {{ inner = {inner:?}, outer = {outer:?}, from = {from:?}, to = {to:?} }} }}\n\
             elements = [{}, {}]\nyoung = {YOUNG}\npoisson = 0.2\n\
             load = {{ x = 0, y = -1, quadrature = \"gauss\" }}\n",
            2 * arch.parts,
            arch.parts
        );
    }
    text += &format!("\n[[contact]]\nbodies = \"all\"\nfriction = {friction:?}\n");
    for (body, side) in [(0, "bottom"), (n - 1, "top")] {
        text += &format!(
            "\n[[obstacle]]\nbody = \"v{body}\"\nside = \"{side}\"\n\
             plane = {{ point = [0, 0], normal = [0, 1] }}\nfriction = {friction:?}\n"
        );
    }
    text
}
