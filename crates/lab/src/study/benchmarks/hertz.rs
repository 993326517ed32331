//! Hertz's problems on unstructured meshes that do not match: a cylinder and a ball on a block, and the roller of the
//! first of NAFEMS' contact benchmarks.

use super::meshes::{Ball, Roller};
use super::report::{MeasuredValue, MeshResult, MeshSeries, ReferencePressure};
use super::runner::{Runner, SolvedScene};
use crate::study::hertz::{measure, Elastic, HertzContact, HertzPair, NodalPressure};
use base::{Error, Result};

/// Young's modulus of steel and aluminium in N/mm², and Poisson's ratio of both.
pub const YOUNG: [f64; 2] = [210e3, 70e3];
const POISSON: f64 = 0.3;

/// The load of the roller, in N per mm of thickness.
pub const ROLLER_LOAD: f64 = 35e3;

/// The largest permitted errors of force, half-width and peak on the finest mesh.
struct HertzLimits {
    force: f64,
    curve: f64,
    fit: f64,
}

/// A cylinder of radius 10 mm on a block of 40 × 20 mm, a/R = 0.05.
pub fn cylinder(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let roller = Roller {
        radius: 10.0,
        block: [20.0, 20.0],
        whole: false,
        load: 10.0,
        a: 0.5,
    };
    let pair = pair(10.0, false);
    let force = std::f64::consts::PI * pair.modulus * 0.25 / (4.0 * 10.0);
    let limits = HertzLimits {
        force: 1e-6,
        curve: 0.03,
        fit: 0.01,
    };
    plane(runner, "hertz_cylinder", &roller, &pair, force, &limits)
}

/// The roller of radius 50 mm under 35 kN per mm of thickness, on a block of 200 × 200 mm.
pub fn roller(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let pair = pair(50.0, false);
    let limits = HertzLimits {
        force: 1e-6,
        curve: 0.05,
        fit: 0.02,
    };
    plane(
        runner,
        "roller",
        &nafems(&pair),
        &pair,
        ROLLER_LOAD,
        &limits,
    )
}

/// The bodies of NAFEMS' benchmark.
pub fn nafems(pair: &HertzPair) -> Roller {
    Roller {
        radius: 50.0,
        block: [100.0, 200.0],
        whole: true,
        load: 8.0,
        a: pair.under(ROLLER_LOAD).a,
    }
}

/// Steel of this radius on aluminium.
pub fn pair(radius: f64, spheres: bool) -> HertzPair {
    let body = |young, radius| Elastic {
        young,
        poisson: POISSON,
        radius,
    };
    HertzPair::new(
        [body(YOUNG[0], radius), body(YOUNG[1], f64::INFINITY)],
        spheres,
    )
}

/// Edges in the contact, relative to the half-width, by order.
fn edges(quick: bool) -> [&'static [f64]; 2] {
    if quick {
        [&[0.25, 0.125, 0.0625], &[0.5, 0.25, 0.125]]
    } else {
        [&[0.125, 0.0625, 0.03125], &[0.25, 0.125, 0.0625]]
    }
}

fn plane(
    runner: &mut Runner,
    name: &str,
    roller: &Roller,
    pair: &HertzPair,
    force: f64,
    limits: &HertzLimits,
) -> Result<Vec<MeshSeries>> {
    let mut out = Vec::new();
    let [first, second] = edges(runner.quick);
    let mut kinds = vec![(1, first, "lower"), (2, second, "lower")];
    if !roller.whole {
        kinds.push((1, first, "upper"));
    }
    for (order, edges, multipliers) in kinds {
        let finer = if multipliers == "upper" { "_finer" } else { "" };
        let mut list = Vec::new();
        for (k, &edge) in edges.iter().enumerate() {
            let stem = format!("{name}_order{order}{finer}_{}", k + 1);
            let file = format!("{stem}.msh");
            let mesh = roller.mesh(&file, edge, order);
            // The vertical force of a pressure on a curve is the pressure times the width of the curve.
            let pressure = 0.5 * force / roller.load;
            let title = if roller.whole {
                "Roller on a block"
            } else {
                "Cylinder on a block"
            };
            let text = scene_of(title, 2, &file, pressure, YOUNG, multipliers);
            let run = runner.solve_mesh(&stem, &text, &mesh)?;
            let finest = (k + 1 == edges.len()).then_some(limits);
            list.push(record(
                &run,
                edge,
                [force, 2.0],
                pair,
                finest,
                |[x, _, _]| x,
            )?);
        }
        let carried = match multipliers {
            "upper" => ", multipliers on the finer side",
            _ => "",
        };
        out.push(MeshSeries::new(
            format!("triangles of order {order}{carried}"),
            list,
        ));
    }
    Ok(out)
}

/// A ball of radius 10 mm on a block, a/R = 0.06.
pub fn sphere(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let ball = Ball {
        radius: 10.0,
        extent: 7.0,
        a: 0.6,
    };
    let pair = pair(10.0, true);
    let force = 4.0 * pair.modulus * ball.a.powi(3) / (3.0 * 10.0);
    // Tetrahedra of first order are stiff: four of them along the radius leave some percent.
    let limits = [0.05, 0.03].map(|fit| HertzLimits {
        force: 1e-6,
        curve: 0.15,
        fit,
    });
    let edges: [&[f64]; 2] = if runner.quick {
        [&[0.5, 0.35], &[1.0]]
    } else {
        [&[0.5, 0.35, 0.25], &[1.0, 0.7, 0.5]]
    };
    let mut out = Vec::new();
    for (order, edges) in [1, 2].into_iter().zip(edges) {
        let mut list = Vec::new();
        for (k, &edge) in edges.iter().enumerate() {
            let stem = format!("hertz_sphere_order{order}_{}", k + 1);
            let file = format!("{stem}.msh");
            let mesh = ball.mesh(&file, edge, order);
            let pressure = 0.25 * force / Ball::loaded(&mesh);
            let text = scene_of("Ball on a block", 3, &file, pressure, YOUNG, "lower");
            let run = runner.solve_mesh(&stem, &text, &mesh)?;
            let finest = (k + 1 == edges.len() && !runner.quick).then_some(&limits[order - 1]);
            let place = |[x, y, _]: [f64; 3]| x.hypot(y);
            list.push(record(&run, edge, [force, 4.0], &pair, finest, place)?);
        }
        out.push(MeshSeries::new(
            format!("tetrahedra of order {order}"),
            list,
        ));
    }
    Ok(out)
}

/// The scene of one body pressed onto another one; nothing holds the upper one vertically but the contact, and the body
/// `multipliers` carries the multipliers.
pub fn scene_of(
    title: &str,
    dim: usize,
    mesh: &str,
    pressure: f64,
    young: [f64; 2],
    multipliers: &str,
) -> String {
    let other = match multipliers {
        "lower" => "upper",
        _ => "lower",
    };
    let up = ["y", "z"][dim - 2];
    let held = |body: &str| match dim {
        2 => format!("{body}_axis = {{ x = 0 }}"),
        _ => format!("{body}_x = {{ x = 0 }}, {body}_y = {{ y = 0 }}"),
    };
    format!(
        "title = \"{title}\"\ndimension = {dim}\nphysics = \"elasticity\"\n\n[mesh]\nfile = \"{mesh}\"\n\n\
         [[body]]\nname = \"upper\"\nyoung = {}\npoisson = {POISSON}\ndirichlet = {{ {} }}\n\
         pressure = {{ load = {pressure:?} }}\n\n\
         [[body]]\nname = \"lower\"\nyoung = {}\npoisson = {POISSON}\n\
         dirichlet = {{ {}, foot = {{ {up} = 0 }} }}\n\n\
         [[contact]]\nsurfaces = [\"{multipliers}_contact\", \"{other}_contact\"]\n",
        young[0],
        held("upper"),
        young[1],
        held("lower"),
    )
}

/// Half-width, peak and force beside Hertz's for the given force; the model has one `share`-th of the bodies.
fn record(
    run: &SolvedScene,
    edge: f64,
    [force, share]: [f64; 2],
    pair: &HertzPair,
    finest: Option<&HertzLimits>,
    place: impl Fn([f64; 3]) -> f64,
) -> Result<MeshResult> {
    let pressures = pressures(run, place);
    let measured = measure(&run.last().rows, &pressures).ok_or_else(|| {
        Error::not_converged(format!(
            "{}: too few nodes touch for a half-width",
            run.file
        ))
    })?;
    let theory = pair.under(force);
    let up = run.scene.dim() - 1;
    let vertical = run
        .last()
        .rows
        .iter()
        .map(|r| r.multiplier * r.normal()[up].abs());
    let limit = |of: fn(&HertzLimits) -> f64| finest.map(of);
    let (off, curve) = beside(&pressures, &theory);
    let values = vec![
        MeasuredValue::error("rms of p", off).within(limit(|l| l.curve)),
        MeasuredValue::beside("a", measured.fit.a, theory.a).within(limit(|l| l.fit)),
        MeasuredValue::beside("p0", measured.fit.p0, theory.p0).within(limit(|l| l.fit)),
        MeasuredValue::beside("force", share * vertical.sum::<f64>(), force)
            .within(limit(|l| l.force)),
    ];
    Ok(run.with_curve(format!("h = a/{:.3}", 1.0 / edge), edge, values, curve))
}

/// The pressures of the rows.
pub fn pressures(run: &SolvedScene, place: impl Fn([f64; 3]) -> f64) -> Vec<NodalPressure> {
    let pressure = |row: &fetifeti::solution::SolvedRow| {
        Some(NodalPressure {
            x: place(row.label.point),
            value: row.pressure()?,
            weight: row.label.area,
            active: row.holds(),
        })
    };
    run.last().rows.iter().filter_map(pressure).collect()
}

/// The root mean square of p − theory, relative to the theory's, and the pressures near the contact.
fn beside(pressures: &[NodalPressure], theory: &HertzContact) -> (f64, Vec<ReferencePressure>) {
    let mut squares = [0.0; 2];
    let mut curve = Vec::new();
    for p in pressures {
        let reference = theory.pressure(p.x);
        squares[0] += p.weight * (p.value - reference).powi(2);
        squares[1] += p.weight * reference.powi(2);
        if p.x.abs() < 1.6 * theory.a {
            curve.push(ReferencePressure {
                x: p.x / theory.a,
                p: p.value / theory.p0,
                reference: reference / theory.p0,
            });
        }
    }
    ((squares[0] / squares[1]).sqrt(), curve)
}
