//! Random elastic contact scenes from a seed: blocks in the plane and in space, curved bodies, rigid obstacles.

use super::assembled::{Assembled, Reference};
use super::qp::Outcome;
use super::rng::Rng;
use scene::Scene;
use std::fmt::Write;

/// A scene and its outcome.
pub struct Case {
    pub seed: u64,
    pub text: String,
    pub scene: Scene,
    pub problem: Assembled,
    pub fate: Fate,
}

pub enum Fate {
    Solvable(Box<Reference>),
    Unbounded,
    Infeasible,
}

/// The scene of a seed with its outcome; an error where the scene itself is refused.
pub fn case(seed: u64) -> Result<Case, String> {
    let text = text(seed);
    let scene = Scene::parse("random.toml", &text).map_err(|e| format!("{e}\n{text}"))?;
    let problem = Assembled::of_scene(&scene);
    let fate = match problem.outcome() {
        Outcome::Solved(solved) => Fate::Solvable(Box::new(problem.reference(solved))),
        Outcome::Unbounded(_) => Fate::Unbounded,
        Outcome::Infeasible(_) => Fate::Infeasible,
    };
    Ok(Case {
        seed,
        text,
        scene,
        problem,
        fate,
    })
}

fn number(rng: &mut Rng, low: f64, high: f64) -> f64 {
    (rng.uniform(low, high) * 1e3).round() / 1e3
}

/// The scene of a seed, in the format of scene files.
pub fn text(seed: u64) -> String {
    let rng = &mut Rng::new(seed);
    match rng.below(6) {
        0..=2 => blocks(rng, 2),
        3 => blocks(rng, 3),
        _ => round(rng),
    }
}

fn head(rng: &mut Rng, dim: usize) -> String {
    let mut out = format!("dimension = {dim}\nphysics = \"elasticity\"\n");
    if dim == 2 && rng.one_in(3) {
        out += "plane = \"stress\"\n";
    } else if rng.one_in(4) {
        out += "locking = \"bbar\"\n";
    } else if rng.one_in(4) {
        out += "element = \"p1\"\n";
    }
    out
}

fn list(values: impl IntoIterator<Item = f64>) -> String {
    let all: Vec<String> = values.into_iter().map(|v| v.to_string()).collect();
    format!("[{}]", all.join(", "))
}

/// A pile or row of blocks. The lowest block is held in some way; the others are pressed together or pulled, with
/// contact, ties and gaps between them, and sometimes an obstacle.
fn blocks(rng: &mut Rng, dim: usize) -> String {
    let mut out = head(rng, dim);
    let count = rng.between(2, if dim == 2 { 4 } else { 2 });
    let upwards = rng.one_in(2);
    let axis = usize::from(upwards);
    let jumps = rng.one_in(2);
    for b in 0..count {
        let mut origin = vec![0.0; dim];
        origin[axis] = b as f64;
        let subdomains: Vec<usize> = (0..dim).map(|_| rng.between(1, 2)).collect();
        // Faces must match: all blocks have the same number of elements across the row.
        let elements: Vec<usize> = subdomains
            .iter()
            .map(|s| if *s == 2 || dim == 2 { 4 } else { 2 })
            .map(|n| if dim == 3 { 2 } else { n })
            .collect();
        let counts = |v: &[usize]| list(v.iter().map(|&n| n as f64));
        writeln!(
            out,
            "[[body]]\nname = \"b{b}\"\norigin = {}\nsize = 1\nelements = {}\nsubdomains = {}",
            list(origin),
            counts(&elements),
            counts(&subdomains)
        )
        .expect("a text");
        let young = if jumps {
            10f64.powi(rng.between(0, 4) as i32)
        } else {
            1.0
        };
        writeln!(
            out,
            "young = {young}\npoisson = {}",
            rng.pick(&[0.0, 0.3, 0.45])
        )
        .expect("a text");
        let mut load: Vec<f64> = (0..dim).map(|_| number(rng, -0.05, 0.05)).collect();
        load[axis] = number(rng, -0.3, 0.05);
        if rng.one_in(3) {
            load.fill(0.0);
            load[axis] = -0.2;
        }
        writeln!(out, "load = {}", list(load)).expect("a text");
        let low = ["left", "bottom"][axis];
        let held = match (b, rng.below(5)) {
            (0, 0) => format!("{{ {low} = {{ {} = 0 }} }}", ["x", "y"][axis]),
            (0, _) => format!("{{ {low} = 0 }}"),
            (_, 0) => format!(
                "{{ {} = {{ {} = 0 }} }}",
                ["bottom", "left"][axis],
                ["y", "x"][axis]
            ),
            (_, 1) if dim == 3 => "{ left = { x = 0 }, back = { z = 0 } }".to_string(),
            _ => continue,
        };
        writeln!(out, "dirichlet = {held}").expect("a text");
    }
    for b in 1..count {
        let gap = number(rng, -0.05, 0.1);
        match rng.below(5) {
            0 => writeln!(
                out,
                "[[contact]]\nbodies = [\"b{}\", \"b{b}\"]\ngap = {gap}",
                b - 1
            ),
            1 => writeln!(
                out,
                "[[contact]]\nbodies = [\"b{b}\", \"b{}\"]\ngap = \"{gap}*sin(3*x + 2*y)\"",
                b - 1
            ),
            2 if dim == 2 => writeln!(
                out,
                "[[tie]]\nbodies = [\"b{}\", \"b{b}\"]\nrange = [0, 0.5]\n\
                 [[contact]]\nbodies = [\"b{}\", \"b{b}\"]\nrange = [0.5, 1]",
                b - 1,
                b - 1
            ),
            _ => Ok(()),
        }
        .expect("a text");
    }
    writeln!(
        out,
        "[interface]\ndefault = \"{}\"",
        if rng.one_in(5) { "tied" } else { "contact" }
    )
    .expect("a text");
    if rng.one_in(2) {
        obstacle(rng, &mut out, dim, count);
    }
    out
}

/// A straight, inclined or round obstacle beside one of the bodies.
fn obstacle(rng: &mut Rng, out: &mut String, dim: usize, count: usize) {
    let side = *rng.pick(&["left", "right", "bottom", "top"]);
    let (d, upper) = match side {
        "left" => (0, false),
        "right" => (0, true),
        "bottom" => (1, false),
        _ => (1, true),
    };
    let b = rng.below(count);
    // Blocks lie along x or y from the origin on: the obstacle is in front of the whole row.
    let far = count as f64;
    let distance = number(rng, -0.02, 0.2);
    let mut normal = vec![0.0; dim];
    normal[d] = if upper { -1.0 } else { 1.0 };
    let mut point = vec![0.5; dim];
    point[d] = if upper { far + distance } else { -distance };
    let what = match rng.below(3) {
        0 => format!(
            "plane = {{ point = {}, normal = {} }}",
            list(point),
            list(normal)
        ),
        1 => {
            normal[1 - d] = 0.1;
            format!(
                "plane = {{ point = {}, normal = {} }}",
                list(point),
                list(normal)
            )
        }
        _ => {
            point[d] += if upper { 3.0 } else { -3.0 };
            let kind = if dim == 2 { "cylinder" } else { "sphere" };
            format!("{kind} = {{ centre = {}, radius = 3 }}", list(point))
        }
    };
    writeln!(
        out,
        "[[obstacle]]\nbody = \"b{b}\"\nside = \"{side}\"\n{what}"
    )
    .expect("a text");
}

/// Half discs on planes or on each other, a sector of an annulus around a cylinder.
fn round(rng: &mut Rng) -> String {
    let mut out = head(rng, 2);
    let grading = *rng.pick(&[1.0, 1.5]);
    let push = number(rng, -0.1, -0.01);
    let free = rng.one_in(3);
    let hold = if free {
        ""
    } else {
        "dirichlet = { top = { x = 0 } }\n"
    };
    let disc = |name: &str, y: f64, pole: &str, rest: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nshape = {{ half_disc = {{ radius = 1, centre = [0, {y}], \
             grading = {grading}, pole = \"{pole}\" }} }}\nelements = [8, 4]\nsubdomains = 2\n{rest}"
        )
    };
    let gap = number(rng, -0.01, 0.02);
    match rng.below(3) {
        0 => {
            out += &disc(
                "disc",
                1.0,
                "bottom",
                &format!("{hold}traction = {{ top = [0, {push}] }}\n"),
            );
            out += "[[obstacle]]\nbody = \"disc\"\nside = \"bottom\"\nplane = { point = [0, 0], normal = [0, 1] }\n";
            writeln!(out, "gap = {gap}").expect("a text");
        }
        1 => {
            out += &disc("lower", -1.0, "top", "dirichlet = { bottom = 0 }\n");
            out += &disc(
                "upper",
                1.0,
                "bottom",
                &format!("{hold}traction = {{ top = [0, {push}] }}\n"),
            );
            writeln!(
                out,
                "[[contact]]\nbodies = [\"upper\", \"lower\"]\nsides = [\"bottom\", \"top\"]\ngap = {gap}"
            )
            .expect("a text");
        }
        _ => {
            let radius = number(rng, 0.9, 1.02);
            writeln!(
                out,
                "[[body]]\nname = \"ring\"\n\
                 shape = {{ annulus = {{ inner = 1, outer = 1.5, from = 0, to = 90 }} }}\nelements = [4, 8]\n\
                 subdomains = [1, 2]\npressure = {{ right = {} }}\n\
                 dirichlet = {{ bottom = {{ y = 0 }}, top = {{ x = 0 }} }}\n\
                 [[obstacle]]\nbody = \"ring\"\nside = \"left\"\ncylinder = {{ centre = [0, 0], radius = {radius} }}",
                number(rng, 0.05, 0.3)
            )
            .expect("a text");
        }
    }
    out
}
