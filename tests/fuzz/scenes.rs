//! Random scenes from a seed, as text that a user could write: in the plane and in space, scalar and elastic, of boxes
//! and of meshes, with ties, contact, gaps, obstacles, jumps, springs, steps and options.

use std::fmt::Write;

use super::mesh::mesh;
use super::rng::Rng;

/// A number with three digits behind the point.
pub fn number(rng: &mut Rng, low: f64, high: f64) -> f64 {
    (rng.uniform(low, high) * 1e3).round() / 1e3
}

/// A scene, and the mesh beside it if it names one, `mesh.msh`.
pub struct Text {
    pub scene: String,
    pub mesh: Option<String>,
}

/// What all parts of a scene are made from.
struct Kind {
    dim: usize,
    elastic: bool,
    /// Whether loads press bodies together.
    pressed: bool,
    jumps: bool,
    steps: bool,
}

/// The scene of a seed.
pub fn text(seed: u64) -> Text {
    let rng = &mut Rng::new(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0x5ce7e);
    let kind = Kind {
        dim: if rng.one_in(3) { 3 } else { 2 },
        elastic: !rng.one_in(3),
        pressed: !rng.one_in(8),
        jumps: rng.one_in(3),
        steps: rng.one_in(6),
    };
    let mut out = format!("title = \"soak {seed}\"\ndimension = {}\n", kind.dim);
    if kind.elastic {
        out += "physics = \"elasticity\"\n";
        if kind.dim == 2 && rng.one_in(3) {
            out += "plane = \"stress\"\n";
        }
        if rng.one_in(6) {
            out += "locking = \"bbar\"\n";
        }
    }
    let form = rng.below(8);
    if form < 7 && rng.one_in(6) {
        out += "element = \"p1\"\n";
    }
    options(rng, &mut out);
    if kind.steps {
        let factor = *rng.pick(&["1", "\"t\"", "\"t^2\"", "\"min(2*t, 1)\""]);
        let _ = write!(
            out,
            "[steps]\ncount = {}\nload = {factor}\n",
            rng.between(1, 4)
        );
        if rng.one_in(3) {
            out += "gap = \"0.5 + 0.5*t\"\n";
        }
    }
    let mesh = match form {
        0..=3 => grid(rng, &kind, &mut out),
        4..=6 => stack(rng, &kind, &mut out),
        _ => Some(meshed(rng, &kind, &mut out)),
    };
    Text {
        scene: out,
        mesh: mesh.filter(|m| !m.is_empty()),
    }
}

fn options(rng: &mut Rng, out: &mut String) {
    *out += "[options]\n";
    let mut set = |rng: &mut Rng, odds: usize, name: &str, values: &[&str]| {
        if rng.one_in(odds) {
            let _ = writeln!(out, "fetifeti_{name} = \"{}\"", *rng.pick(values));
        }
    };
    let loops = ["active_set", "augmented_lagrangian", "smalbe"];
    set(rng, 2, "contact_type", &loops);
    set(
        rng,
        5,
        "scaling",
        &["multiplicity", "rho", "stiffness", "deluxe"],
    );
    set(
        rng,
        5,
        "pc_type",
        &["lumped", "dirichlet", "coarse_corrected"],
    );
    set(rng, 6, "operators", &["explicit", "implicit"]);
    set(rng, 8, "adaptive", &["10", "off"]);
    set(
        rng,
        8,
        "projector",
        &["identity", "diagonal", "preconditioner"],
    );
    set(
        rng,
        10,
        "primal",
        &["vertices", "vertices,edges", "vertices,edges,faces"],
    );
}

fn list(values: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", values.into_iter().collect::<Vec<_>>().join(", "))
}

/// The coefficients of a body or a grid.
fn material(rng: &mut Rng, kind: &Kind, grid: bool) -> String {
    let size = |rng: &mut Rng| 10f64.powi(rng.between(0, 5) as i32);
    let value = match rng.below(5) {
        _ if !kind.jumps => "1".to_string(),
        0 if grid => format!("{{ checkerboard = [1, {}], by = \"body\" }}", size(rng)),
        1 => format!(
            "{{ checkerboard = [{}, 1], by = \"subdomain\" }}",
            size(rng)
        ),
        2 => format!("\"{}*(1 + 0.5*sin(4*x)*cos(3*y))\"", size(rng)),
        _ => format!("{}", size(rng)),
    };
    if kind.elastic {
        let poisson = *rng.pick(&["0.3", "0.3", "0", "0.45", "0.49"]);
        format!("young = {value}\npoisson = {poisson}\n")
    } else {
        format!("rho = {value}\n")
    }
}

/// A load, mostly downwards.
fn load(rng: &mut Rng, kind: &Kind) -> String {
    let down = if kind.pressed {
        -number(rng, 0.1, 2.0)
    } else {
        number(rng, -1.0, 1.0)
    };
    let swing = number(rng, 0.0, 2.0);
    let down = match rng.below(4) {
        0 => format!("\"{down} + {swing}*cos(5*x + 2*y)\""),
        1 => format!("\"{down}*(1 + x)\""),
        _ => format!("{down}"),
    };
    if !kind.elastic {
        return format!("load = {down}\n");
    }
    let aside = if rng.one_in(3) {
        format!("{}", number(rng, -0.3, 0.3))
    } else {
        "0".into()
    };
    let mut all = vec![aside; kind.dim - 1];
    all.push(down);
    format!("load = {}\n", list(all))
}

/// The lowest side in the direction of the load, and the one above.
fn ends(kind: &Kind) -> [&'static str; 2] {
    match kind.dim {
        2 => ["bottom", "top"],
        _ => ["back", "front"],
    }
}

fn dirichlet(rng: &mut Rng, kind: &Kind, lowest: bool) -> String {
    let [low, high] = ends(kind);
    let value = |rng: &mut Rng| match (kind.elastic, rng.below(4)) {
        (false, 0) => format!("{}", number(rng, -0.1, 0.1)),
        (false, 1) => "\"0.1*sin(3*x)\"".into(),
        (true, 0) => {
            let push = format!("{}", number(rng, -0.1, 0.1));
            list((0..kind.dim).map(|d| {
                if d + 1 == kind.dim {
                    push.clone()
                } else {
                    "0".into()
                }
            }))
        }
        (true, 1) => format!("{{ {} = 0 }}", ["x", "y", "z"][kind.dim - 1]),
        _ => "0".into(),
    };
    match rng.below(8) {
        0 => "dirichlet = \"all\"\n".into(),
        1 => "dirichlet = [\"left\", \"right\"]\n".into(),
        2 if !lowest => format!("dirichlet = {{ {high} = {} }}\n", value(rng)),
        3 => format!("dirichlet = {{ left = 0, {low} = {} }}\n", value(rng)),
        _ if lowest => format!("dirichlet = {{ {low} = {} }}\n", value(rng)),
        _ => String::new(),
    }
}

fn gap(rng: &mut Rng) -> String {
    let size = number(rng, 0.0, 0.1);
    match rng.below(6) {
        0 => format!("gap = {size}\n"),
        1 => format!("gap = -{size}\n"),
        2 => format!("gap = \"{size}*abs(sin(3*x + 2*y))\"\n"),
        3 => format!("gap = [[0.2, {size}], [0.6, -{}], [0.9, 0]]\n", 0.1 * size),
        _ => String::new(),
    }
}

/// Where on a face.
fn part(rng: &mut Rng) -> String {
    match rng.below(8) {
        0 => "range = [0, 0.5]\n".into(),
        1 => "range = [0.3, 1]\n".into(),
        _ => String::new(),
    }
}

fn obstacle(rng: &mut Rng, kind: &Kind, body: &str, low: f64) -> String {
    let [side, _] = ends(kind);
    let at = low - number(rng, 0.0, 0.2);
    if !kind.elastic {
        let bound = -number(rng, 0.0, 0.3);
        let wave = number(rng, 0.0, 0.05);
        let side = *rng.pick(&["left", "right", side, "all"]);
        return format!(
            "[[obstacle]]\nbody = \"{body}\"\nside = \"{side}\"\nbelow = \"{bound} + {wave}*sin(4*x)\"\n"
        );
    }
    let axis = |v: &str| {
        list((0..kind.dim).map(|d| {
            if d + 1 == kind.dim {
                v.into()
            } else {
                "0".to_string()
            }
        }))
    };
    let shape = if rng.one_in(3) {
        let centre = format!("{}", at - 5.0);
        let round = if kind.dim == 2 { "cylinder" } else { "sphere" };
        format!("{round} = {{ centre = {}, radius = 5 }}", axis(&centre))
    } else {
        format!(
            "plane = {{ point = {}, normal = {} }}",
            axis(&format!("{at}")),
            axis("1")
        )
    };
    format!("[[obstacle]]\nbody = \"{body}\"\nside = \"{side}\"\n{shape}\n")
}

/// Elements and subdomains of a box in each direction.
fn cuts(rng: &mut Rng, dim: usize) -> (String, String) {
    let most = if dim == 2 { 3 } else { 2 };
    let subdomains: Vec<usize> = (0..dim).map(|_| rng.between(1, most)).collect();
    let each = if dim == 2 { 4 } else { 2 };
    let elements = subdomains
        .iter()
        .map(|s| (s * rng.between(1, each)).to_string());
    (
        list(elements),
        list(subdomains.iter().map(usize::to_string)),
    )
}

/// A grid of equal bodies.
fn grid(rng: &mut Rng, kind: &Kind, out: &mut String) -> Option<String> {
    let most = if kind.dim == 2 { 4 } else { 2 };
    let bodies: Vec<usize> = (0..kind.dim).map(|_| rng.between(1, most)).collect();
    let default = *rng.pick(&["tied", "contact", "contact", "free"]);
    let _ = write!(out, "[interface]\ndefault = \"{default}\"\n[grid]\n");
    let _ = writeln!(
        out,
        "bodies = {}",
        list(bodies.iter().map(usize::to_string))
    );
    let _ = writeln!(out, "size = {}", list(bodies.iter().map(usize::to_string)));
    let (elements, subdomains) = cuts(rng, kind.dim);
    let _ = writeln!(out, "elements = {elements}\nsubdomains = {subdomains}");
    *out += &material(rng, kind, true);
    *out += &load(rng, kind);
    *out += &dirichlet(rng, kind, true);
    let name = |at: &[usize]| {
        let places: Vec<String> = at.iter().map(usize::to_string).collect();
        format!("b{}", places.join("_"))
    };
    // Pairs of neighbours.
    for _ in 0..rng.below(4) {
        let d = rng.below(kind.dim);
        if bodies[d] < 2 {
            continue;
        }
        let mut at: Vec<usize> = bodies.iter().map(|n| rng.below(*n)).collect();
        at[d] = rng.below(bodies[d] - 1);
        let first = name(&at);
        at[d] += 1;
        let mut pair = [first, name(&at)];
        if rng.one_in(6) {
            pair.reverse();
        }
        let [a, b] = pair;
        let (joint, gap) = if rng.one_in(3) {
            ("tie", String::new())
        } else {
            ("contact", gap(rng))
        };
        let _ = write!(
            out,
            "[[{joint}]]\nbodies = [\"{a}\", \"{b}\"]\n{}{gap}",
            part(rng)
        );
    }
    if rng.one_in(4) {
        *out += &obstacle(rng, kind, &name(&vec![0; kind.dim]), 0.0);
    }
    None
}

/// Bodies on each other, each with elements of its own.
fn stack(rng: &mut Rng, kind: &Kind, out: &mut String) -> Option<String> {
    *out += "[interface]\ndefault = \"free\"\n";
    let n = rng.between(2, 4);
    let same = rng.one_in(3);
    let (mut level, mut cut) = (0.0, cuts(rng, kind.dim));
    let mut first = 0.0;
    for k in 0..n {
        if !same {
            cut = cuts(rng, kind.dim);
        }
        let mut size = vec![1.0; kind.dim];
        let mut origin = vec![0.0; kind.dim];
        size[kind.dim - 1] = number(rng, 0.5, 1.5);
        if !same {
            size[0] = number(rng, 0.5, 1.5);
            origin[0] = number(rng, -0.2, 0.2);
        }
        origin[kind.dim - 1] = level;
        let numbers = |v: &[f64]| list(v.iter().map(f64::to_string));
        let _ = write!(
            out,
            "[[body]]\nname = \"s{k}\"\norigin = {}\nsize = {}\nelements = {}\nsubdomains = {}\n",
            numbers(&origin),
            numbers(&size),
            cut.0,
            cut.1
        );
        *out += &material(rng, kind, false);
        *out += &load(rng, kind);
        *out += &dirichlet(rng, kind, k == 0);
        if rng.one_in(8) {
            let _ = writeln!(out, "spring = {{ left = {} }}", number(rng, 0.1, 10.0));
        }
        level += size[kind.dim - 1];
        level = (level * 1e3).round() / 1e3;
        if k == 0 {
            first = origin[kind.dim - 1];
        }
    }
    for k in 1..n {
        let (a, b) = (k - 1, k);
        let carrier = if rng.one_in(3) {
            format!("multipliers = \"s{b}\"\n")
        } else {
            String::new()
        };
        let _ = match rng.below(5) {
            0 => write!(out, "[[tie]]\nbodies = [\"s{a}\", \"s{b}\"]\n{carrier}"),
            _ => write!(
                out,
                "[[contact]]\nbodies = [\"s{a}\", \"s{b}\"]\n{carrier}{}",
                gap(rng)
            ),
        };
    }
    if rng.one_in(4) {
        *out += &obstacle(rng, kind, "s0", first);
    }
    None
}

/// Two bodies of a mesh, one on the other, with nodes that are moved about.
fn meshed(rng: &mut Rng, kind: &Kind, out: &mut String) -> String {
    let [low, high] = ends(kind);
    *out += "[interface]\ndefault = \"free\"\n[mesh]\nfile = \"mesh.msh\"\n";
    for (k, name) in ["lower", "upper"].into_iter().enumerate() {
        let _ = write!(
            out,
            "[[body]]\nname = \"{name}\"\nsubdomains = {}\n",
            rng.between(1, 4)
        );
        *out += &material(rng, kind, true).replace("by = \"subdomain\"", "by = \"body\"");
        *out += &load(rng, kind);
        if k == 0 {
            let _ = writeln!(out, "dirichlet = {{ {name}_{low} = 0 }}");
        }
    }
    let joint = if rng.one_in(4) { "tie" } else { "contact" };
    let _ = write!(
        out,
        "[[{joint}]]\nsurfaces = [\"lower_{high}\", \"upper_{low}\"]\n{}",
        if joint == "tie" {
            String::new()
        } else {
            gap(rng)
        }
    );
    mesh(rng, kind.dim, [low, high])
}
