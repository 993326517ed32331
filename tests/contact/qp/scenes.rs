//! Random contact scenes by number, as text that a user could write: piles and rows of boxes, grids, brick walls,
//! plates with blocks between them, round bodies; in the plane and in space, scalar and elastic.

use super::joints;
use crate::support::rng::Rng;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Choices that all parts of a scene share.
pub struct Kind {
    pub dim: usize,
    pub elastic: bool,
    /// Whether loads press bodies together.
    pub pressed: bool,
    /// Whether stiffnesses differ between bodies.
    pub jumps: bool,
    /// Whether load steps renew the contacts.
    pub update: bool,
    /// Whether the lowest bodies lie on an obstacle, and nothing else holds them against the load.
    pub floor: bool,
    /// The direction in which bodies follow each other, and against which the load acts.
    pub axis: usize,
}

/// A body: a box with a name, and whether it is the lowest.
pub struct Block {
    pub name: String,
    pub origin: Vec<f64>,
    pub size: Vec<f64>,
    pub elements: Vec<usize>,
    pub subdomains: Vec<usize>,
    pub lowest: bool,
}

/// A number with three digits behind the point.
pub fn number(rng: &mut Rng, low: f64, high: f64) -> f64 {
    round(rng.uniform(low, high))
}

/// A coordinate with three digits behind the point.
pub fn round(x: f64) -> f64 {
    (x * 1e3).round() / 1e3
}

pub fn list<T: ToString>(values: impl IntoIterator<Item = T>) -> String {
    let all: Vec<String> = values.into_iter().map(|v| v.to_string()).collect();
    format!("[{}]", all.join(", "))
}

/// The sides at the low and the high end of a direction.
pub fn ends(kind: &Kind, axis: usize) -> [&'static str; 2] {
    match (axis, kind.dim) {
        (0, _) => ["left", "right"],
        (1, _) => ["bottom", "top"],
        _ => ["back", "front"],
    }
}

/// The scene of a number.
pub fn text(id: u64) -> String {
    let rng = &mut Rng::new(id.wrapping_mul(0x9e6c_63d0_876a_46ad) ^ 0xc0_47ac7);
    let dim = if rng.one_in(4) { 3 } else { 2 };
    let elastic = !rng.one_in(4);
    let steps = rng.one_in(4);
    let mut kind = Kind {
        dim,
        elastic,
        pressed: !rng.one_in(12),
        jumps: rng.one_in(2),
        floor: rng.one_in(5),
        update: steps && elastic && rng.one_in(2),
        axis: if rng.one_in(3) { 0 } else { dim - 1 },
    };
    let form = rng.below(if dim == 2 && elastic { 12 } else { 10 });
    if form >= 6 {
        kind.axis = dim - 1;
    }
    // Curved sides touch in a point to begin with, and renewal is for those that slide.
    kind.update &= form < 10 || rng.one_in(2);
    let mut out = format!("title = \"contact {id}\"\ndimension = {dim}\n");
    if elastic {
        out += "physics = \"elasticity\"\n";
        if dim == 2 && rng.one_in(3) {
            out += "plane = \"stress\"\n";
        } else if rng.one_in(6) {
            out += "locking = \"bbar\"\n";
        } else if rng.one_in(6) {
            out += "element = \"p1\"\n";
        }
    } else if rng.one_in(5) {
        out += "element = \"p1\"\n";
    }
    if steps {
        joints::steps(rng, &kind, &mut out);
    }
    match form {
        0..=3 => pile(rng, &kind, &mut out),
        4..=5 => grid(rng, &kind, &mut out),
        6..=7 => wall(rng, &kind, &mut out),
        8..=9 => table(rng, &kind, &mut out),
        _ => discs(rng, &kind, &mut out),
    }
    out
}

/// Elements and subdomains in one direction.
fn cut(rng: &mut Rng, most_subdomains: usize, most_each: usize) -> (usize, usize) {
    let subdomains = rng.between(1, most_subdomains);
    (subdomains * rng.between(1, most_each), subdomains)
}

/// Elements and subdomains in each direction. Fine sides have many nodes that may touch.
fn cuts(rng: &mut Rng, kind: &Kind, fine: bool) -> (Vec<usize>, Vec<usize>) {
    let most = if kind.dim == 2 { 3 } else { 2 };
    let cuts = (0..kind.dim).map(|d| match (kind.dim, fine && d != kind.axis) {
        (2, true) => cut(rng, most, 12),
        (2, false) => cut(rng, most, 3),
        (_, true) => cut(rng, most, 4),
        _ => cut(rng, most, 1),
    });
    cuts.unzip()
}

/// Bodies that follow each other along the axis, with meshes that match or do not.
fn pile(rng: &mut Rng, kind: &Kind, out: &mut String) {
    *out += "[interface]\ndefault = \"free\"\n";
    let count = match (kind.dim, rng.one_in(3)) {
        (2, true) => rng.between(5, 12),
        (2, false) => rng.between(2, 5),
        (_, true) => rng.between(3, 6),
        _ => rng.between(2, 3),
    };
    let same = rng.one_in(3);
    let fine = count <= 6;
    let mut cut = cuts(rng, kind, fine);
    let (mut level, mut blocks) = (number(rng, -1.0, 1.0), Vec::new());
    for k in 0..count {
        let (mut origin, mut size) = (vec![0.0; kind.dim], vec![1.0; kind.dim]);
        for d in (0..kind.dim).filter(|_| !same) {
            size[d] = number(rng, 0.7, 1.5);
            origin[d] = number(rng, -0.2, 0.2);
        }
        if !same {
            cut = cuts(rng, kind, fine);
        }
        origin[kind.axis] = round(level);
        blocks.push(Block {
            name: format!("p{k}"),
            elements: cut.0.clone(),
            subdomains: cut.1.clone(),
            lowest: k == 0,
            origin,
            size: size.clone(),
        });
        // Sides that do not touch are named.
        level += size[kind.axis];
        if k % 5 == 4 && rng.one_in(2) {
            level += number(rng, 0.0, 0.05);
        }
    }
    blocks
        .iter()
        .for_each(|b| joints::body(rng, kind, b, "", out));
    for pair in blocks.windows(2) {
        let [a, b] = pair else { unreachable!() };
        let apart = round(a.origin[kind.axis] + a.size[kind.axis]) != b.origin[kind.axis];
        joints::joint(rng, kind, [&a.name, &b.name], (apart, same), out);
    }
    if rng.one_in(8) {
        let k = rng.between(1, count - 1);
        joints::squeeze(rng, kind, [&blocks[k - 1], &blocks[k]], out);
    }
    joints::obstacles(rng, kind, &blocks, out);
}

/// A grid of equal bodies, whose nodes match, with cross points.
fn grid(rng: &mut Rng, kind: &Kind, out: &mut String) {
    let counts: Vec<usize> = match kind.dim {
        2 => rng
            .pick(&[vec![2, 2], vec![3, 2], vec![2, 4], vec![4, 3], vec![12, 1]])
            .clone(),
        _ => rng
            .pick(&[vec![2, 1, 2], vec![2, 2, 2], vec![1, 1, 4]])
            .clone(),
    };
    let default = *rng.pick(&["contact", "contact", "contact", "contact", "tied"]);
    let many = counts.iter().product::<usize>() > 4;
    let (elements, subdomains) = cuts(rng, kind, !many);
    let _ = write!(
        out,
        "[interface]\ndefault = \"{default}\"\n[grid]\nbodies = {}\nsize = {}\n",
        list(&counts),
        list(&counts)
    );
    let block = Block {
        name: "b".into(),
        origin: vec![0.0; kind.dim],
        size: counts.iter().map(|&n| n as f64).collect(),
        elements,
        subdomains,
        lowest: true,
    };
    joints::properties(rng, kind, &block, true, out);
    let name = |at: &[usize]| {
        let places: Vec<String> = at.iter().map(usize::to_string).collect();
        format!("b{}", places.join("_"))
    };
    let mut named = BTreeSet::new();
    for _ in 0..rng.below(5) {
        let d = rng.below(kind.dim);
        if counts[d] < 2 {
            continue;
        }
        let mut at: Vec<usize> = counts.iter().map(|n| rng.below(*n)).collect();
        at[d] = rng.below(counts[d] - 1);
        let first = name(&at);
        at[d] += 1;
        if named.insert([first.clone(), name(&at)]) {
            joints::joint(rng, kind, [&first, &name(&at)], (false, true), out);
        }
    }
    let lowest = Block {
        name: name(&vec![0; kind.dim]),
        size: vec![1.0; kind.dim],
        ..block
    };
    joints::obstacles(rng, kind, &[lowest], out);
}

/// Courses of bricks, every other one moved by half a brick.
fn wall(rng: &mut Rng, kind: &Kind, out: &mut String) {
    let up = kind.dim - 1;
    let (courses, columns) = match kind.dim {
        2 => (rng.between(2, 4), rng.between(2, 3)),
        _ => (rng.between(2, 3), 2),
    };
    let matching = rng.one_in(2);
    *out += if matching {
        "[interface]\ndefault = \"contact\"\n"
    } else {
        "[interface]\ndefault = \"free\"\n"
    };
    let each = rng.between(1, if kind.dim == 2 { 4 } else { 2 });
    let mut blocks: Vec<Block> = Vec::new();
    for j in 0..courses {
        for i in 0..columns {
            let mut origin = vec![0.0; kind.dim];
            let mut size = vec![1.0; kind.dim];
            size[0] = 2.0;
            origin[0] = 2.0 * i as f64 + (j % 2) as f64;
            origin[up] = j as f64;
            let mut elements = vec![each; kind.dim];
            elements[0] = 2 * each;
            let mut subdomains = vec![1; kind.dim];
            if !matching {
                elements = (0..kind.dim).map(|_| rng.between(1, each + 1)).collect();
                elements[0] *= 2;
            }
            subdomains[0] = rng.between(1, 2);
            blocks.push(Block {
                name: format!("w{j}_{i}"),
                lowest: j == 0,
                origin,
                size,
                elements,
                subdomains,
            });
        }
    }
    blocks
        .iter()
        .for_each(|b| joints::body(rng, kind, b, "", out));
    for (k, a) in blocks.iter().enumerate() {
        for b in &blocks[k + 1..] {
            let above = b.origin[up] == a.origin[up] + 1.0;
            let beside = b.origin[up] == a.origin[up] && b.origin[0] == a.origin[0] + 2.0;
            let overlap = (b.origin[0] - a.origin[0]).abs() < 2.0;
            if (above && overlap || beside) && (!matching || rng.one_in(8)) {
                joints::joint(rng, kind, [&a.name, &b.name], (false, false), out);
            }
        }
    }
    joints::obstacles(rng, kind, &blocks[..1], out);
}

/// A plate, blocks that stand on it, and perhaps a plate on the blocks.
fn table(rng: &mut Rng, kind: &Kind, out: &mut String) {
    let up = kind.dim - 1;
    *out += "[interface]\ndefault = \"free\"\n";
    let legs = rng.between(2, if kind.dim == 2 { 6 } else { 3 });
    let wide = 1.5 * legs as f64;
    let plate = |rng: &mut Rng, name: &str, level: f64, lowest: bool| {
        let (mut origin, mut size) = (vec![0.0; kind.dim], vec![1.0; kind.dim]);
        (origin[up], size[up], size[0]) = (level, 0.5, wide);
        let subdomains = rng.between(1, 3);
        let mut elements = vec![rng.between(1, 3); kind.dim];
        elements[0] = subdomains * rng.between(legs, 3 * legs) / (kind.dim - 1);
        elements[0] = elements[0].div_ceil(subdomains) * subdomains;
        let mut all = vec![1; kind.dim];
        all[0] = subdomains;
        Block {
            name: name.into(),
            subdomains: all,
            lowest,
            origin,
            size,
            elements,
        }
    };
    let mut blocks = vec![plate(rng, "plate", 0.0, true)];
    for k in 0..legs {
        let (mut origin, mut size) = (vec![0.0; kind.dim], vec![1.0; kind.dim]);
        origin[0] = round(1.5 * k as f64 + number(rng, 0.1, 0.3));
        (origin[up], size[0]) = (0.5, number(rng, 0.6, 1.1));
        let (elements, subdomains) = cuts(rng, kind, kind.dim == 2);
        blocks.push(Block {
            name: format!("leg{k}"),
            lowest: false,
            origin,
            size,
            elements,
            subdomains,
        });
    }
    let covered = !rng.one_in(3);
    if covered {
        blocks.push(plate(rng, "cover", 1.5, false));
    }
    blocks
        .iter()
        .for_each(|b| joints::body(rng, kind, b, "", out));
    for k in 0..legs {
        let leg = format!("leg{k}");
        joints::joint(rng, kind, ["plate", &leg], (false, false), out);
        if covered {
            joints::joint(rng, kind, [&leg, "cover"], (false, false), out);
        }
    }
    joints::obstacles(rng, kind, &blocks[..1], out);
}

/// Half discs on each other, on a rigid plane, or on a block.
fn discs(rng: &mut Rng, kind: &Kind, out: &mut String) {
    *out += "[interface]\ndefault = \"free\"\n";
    let mut disc = |rng: &mut Rng, name: &str, y: f64, pole: &str, rest: &str| {
        let (along, deep) = (2 * rng.between(3, 10), rng.between(3, 6));
        let _ = write!(
            out,
            "[[body]]\nname = \"{name}\"\nshape = {{ half_disc = {{ radius = 1, centre = [0, {y}], grading = {}, \
             pole = \"{pole}\" }} }}\nelements = [{along}, {deep}]\nsubdomains = [{}, 1]\n{}{rest}",
            rng.pick(&[1.0, 1.5]),
            rng.between(1, 2),
            joints::material(rng, kind, false)
        );
    };
    let push = number(rng, -0.1, -0.01);
    let hold = *rng.pick(&["dirichlet = { top = { x = 0 } }\n", ""]);
    let pressed = format!("{hold}traction = {{ top = [0, {push}] }}\n");
    let count = rng.between(1, 3);
    let gap = number(rng, -0.01, 0.02);
    if count == 1 {
        disc(rng, "d0", 1.0, "bottom", &pressed);
        let _ = write!(
            out,
            "[[obstacle]]\nbody = \"d0\"\nside = \"bottom\"\n\
             plane = {{ point = [0, 0], normal = [0, 1] }}\ngap = {gap}\n"
        );
        return;
    }
    disc(rng, "d0", -1.0, "top", "dirichlet = { bottom = 0 }\n");
    disc(rng, "d1", 1.0, "bottom", &pressed);
    let _ = write!(
        out,
        "[[contact]]\nbodies = [\"d1\", \"d0\"]\nsides = [\"bottom\", \"top\"]\ngap = {gap}\n"
    );
    if count == 3 {
        let block = Block {
            name: "d2".into(),
            origin: vec![-0.5, 1.0],
            size: vec![1.0, 0.5],
            elements: vec![rng.between(2, 12), 2],
            subdomains: vec![1, 1],
            lowest: false,
        };
        joints::body(rng, kind, &block, "", out);
        let _ = write!(
            out,
            "[[contact]]\nbodies = [\"d1\", \"d2\"]\nsides = [\"top\", \"bottom\"]\n"
        );
    }
}
