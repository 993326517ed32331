//! Half a cylinder and a block of one material in plane strain, pressed together and then pushed to and fro along each
//! other.

use std::f64::consts::{FRAC_PI_2, PI};

use super::super::meshes::{standing_circle, ElementSize, TwoBodyMesh, RATIO};
use super::super::report::MeshSeries;
use super::super::runner::Runner;
use super::mindlin::{Mindlin, Stage, StageLimits, FACTOR, STAGES, STEPS};
use super::{tractions, NodeTraction};
use crate::delaunay::{graded_arc, graded_line};
use base::Result;
use mesh::MeshFile;

const RADIUS: f64 = 8.0;
const YOUNG: f64 = 200.0;
const POISSON: f64 = 0.3;
const FRICTION: f64 = 0.3;

/// Half the width of the contact for which the approach is chosen.
const HALF_WIDTH: f64 = 0.4;

/// How far the upper body is pushed, over the approach; with it Q is about 0.75 μP at the turn.
const PUSH: f64 = 1.7 * FRICTION;

/// Triangles of both orders on meshes that do not match.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let theory = Mindlin {
        modulus: YOUNG / (2.0 * (1.0 - POISSON * POISSON)),
        radius: RADIUS,
        friction: FRICTION,
        spheres: false,
    };
    let edges: [&[f64]; 2] = if runner.quick {
        [&[0.25, 0.125], &[0.5, 0.25]]
    } else {
        [&[0.125, 0.0625, 0.03125], &[0.25, 0.125, 0.0625]]
    };
    let mut series: Vec<MeshSeries> = Vec::new();
    for (order, edges) in [1, 2].into_iter().zip(edges) {
        let mut stages: [Vec<_>; 3] = Default::default();
        for (k, &edge) in edges.iter().enumerate() {
            let name = format!("mindlin_cylinder_order{order}_{}", k + 1);
            let file = format!("{name}.msh");
            let run =
                runner.solve_mesh(&name, &scene(&file, &theory), &mesh(&file, edge, order))?;
            let steps: Vec<Vec<NodeTraction>> = run.steps.iter().map(tractions).collect();
            let finest = k + 1 == edges.len();
            for ((step, _), list) in STAGES.into_iter().zip(&mut stages) {
                let stage = Stage {
                    steps: &steps,
                    step,
                    limits: finest.then_some(StageLimits {
                        curve: if runner.quick { 0.08 } else { 0.05 },
                        extremes: (2.0 * edge).max(0.03),
                    }),
                };
                let (values, curve) = stage.beside(&theory, |_| true);
                let label = format!("h = a/{}", 1.0 / edge);
                list.push(run.with_curve(label, edge, values, curve));
            }
        }
        for ((_, name), list) in STAGES.into_iter().zip(stages) {
            series.push(MeshSeries::new(format!("{name}, order {order}"), list));
        }
    }
    Ok(series)
}

/// Half a disc on a block; the origin is their point of contact.
fn mesh(name: &str, edge: f64, order: usize) -> MeshFile {
    let r = RADIUS;
    let size = |edge: f64| {
        let size = ElementSize {
            unit: HALF_WIDTH,
            edge,
            most: r * edge.min(0.5),
        };
        move |[x, y]: [f64; 2]| size.at(x.hypot(y))
    };
    let fine = size(edge / RATIO);
    let centre = [0.0, r];
    let mut disc = graded_arc(centre, r, [-PI, -FRAC_PI_2], &fine);
    disc.extend(&graded_arc(centre, r, [-FRAC_PI_2, 0.0], &fine)[1..]);
    disc.extend(&graded_line([r, r], [-r, r], &fine)[1..]);
    let curve = standing_circle(r);
    let coarse = size(edge);
    let corners = [[-r, -r], [r, -r], [r, 0.0], [0.0; 2], [-r, 0.0], [-r, -r]];
    let mut block = vec![corners[0]];
    for ends in corners.windows(2) {
        block.extend(&graded_line(ends[0], ends[1], &coarse)[1..]);
    }
    let mut pair = TwoBodyMesh::new(order);
    pair.add(&disc, &fine, &curve, 1);
    pair.add(&block, &coarse, &|_| None, 2);
    pair.finish(name, |[x, y, _], body| match body {
        1 if y > r * (1.0 - 1e-9) => 7,
        2 if y < -r * (1.0 - 1e-9) => 8,
        _ if x.hypot(y) < 4.0 * HALF_WIDTH => 2 + body,
        _ => 0,
    })
}

/// The bodies overlap from the first load step on, so that they press; then the flat side of the upper one, which stays
/// level, goes to and fro. The block carries the multipliers: its normal is the one along which the bodies approach.
fn scene(mesh: &str, theory: &Mindlin) -> String {
    let force = PI * theory.modulus * HALF_WIDTH.powi(2) / (4.0 * theory.radius);
    // How far both flat sides approach, of cylinders that Hertz's pressure presses together.
    let compliance = (1.0 - POISSON * POISSON) / (PI * YOUNG);
    let approach = 2.0 * force * compliance * (2.0 * (4.0 * RADIUS / HALF_WIDTH).ln() - 1.0);
    let body = |name: &str, held: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nyoung = {YOUNG}\npoisson = {POISSON}\n\
             dirichlet = {{ {held} }}\n\n"
        )
    };
    format!(
        "title = \"A cylinder under normal and tangential load\"\nphysics = \"elasticity\"\n\n\
         [mesh]\nfile = \"{mesh}\"\n\n{}{}\
         [[contact]]\nsurfaces = [\"upper_contact\", \"lower_contact\"]\nmultipliers = \"lower_contact\"\n\
         gap = {}\nfriction = {FRICTION}\n\n[steps]\ncount = {STEPS}\ndirichlet = \"{FACTOR}\"\n",
        body("upper", &format!("load = {{ x = {}, y = 0 }}", PUSH * approach)),
        body("lower", "foot = 0"),
        -approach
    )
}
