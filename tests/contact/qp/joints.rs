//! Materials, loads and supports of bodies, and what joins them: contact, ties, gaps, obstacles, load steps.

use super::scenes::{ends, list, number, round, Block, Kind};
use crate::support::rng::Rng;
use std::fmt::Write;

/// The load steps of a scene.
pub fn steps(rng: &mut Rng, kind: &Kind, out: &mut String) {
    let factor = *rng.pick(&["\"t\"", "\"t\"", "1", "\"t^2\"", "\"min(2*t, 1)\""]);
    let _ = write!(
        out,
        "[steps]\ncount = {}\nload = {factor}\n",
        rng.between(2, 3)
    );
    if rng.one_in(3) {
        *out += "dirichlet = \"t\"\n";
    }
    if kind.update {
        *out += "update = true\n";
    } else if rng.one_in(3) {
        *out += "gap = \"0.5 + 0.5*t\"\n";
    }
}

/// The coefficients of a body or a grid.
pub fn material(rng: &mut Rng, kind: &Kind, grid: bool) -> String {
    let size = |rng: &mut Rng| 10f64.powi(rng.between(0, 4) as i32);
    let value = match rng.below(5) {
        _ if !kind.jumps => "1".to_string(),
        0 if grid => format!("{{ checkerboard = [1, {}], by = \"body\" }}", size(rng)),
        1 if !grid => format!(
            "{{ checkerboard = [{}, 1], by = \"subdomain\" }}",
            size(rng)
        ),
        2 => format!("\"{}*(1 + 0.5*sin(4*x)*cos(3*y))\"", size(rng)),
        _ => format!("{}", size(rng)),
    };
    if kind.elastic {
        let poisson = *rng.pick(&["0.3", "0.3", "0", "0.45"]);
        format!("young = {value}\npoisson = {poisson}\n")
    } else {
        format!("rho = {value}\n")
    }
}

/// A load against the axis, now and then with a part across it.
fn load(rng: &mut Rng, kind: &Kind) -> String {
    let size = if kind.elastic { 0.3 } else { 2.0 };
    let down = if kind.pressed {
        -number(rng, 0.1 * size, size)
    } else {
        number(rng, -0.5 * size, 0.5 * size)
    };
    let swing = round(down.abs() * rng.uniform(0.0, 0.8));
    let down = match rng.below(4) {
        0 => format!("\"{down} + {swing}*cos(5*x + 2*y)\""),
        1 => format!("\"{down}*(1 + 0.3*x)\""),
        _ => format!("{down}"),
    };
    if !kind.elastic {
        return format!("load = {down}\n");
    }
    let mut all = vec!["0".to_string(); kind.dim];
    if rng.one_in(30) {
        all.fill_with(|| format!("{}", number(rng, -0.02, 0.02)));
    }
    all[kind.axis] = down;
    format!("load = {}\n", list(all))
}

/// The sides at which a body is held.
fn support(rng: &mut Rng, kind: &Kind, lowest: bool) -> String {
    let [low, high] = ends(kind, kind.axis);
    let across = usize::from(kind.axis == 0);
    let [one, other] = ends(kind, across);
    let (along, aside) = (["x", "y", "z"][kind.axis], ["x", "y", "z"][across]);
    let given = format!("{}", number(rng, -0.05, 0.05));
    let value = match (kind.elastic, rng.below(9)) {
        (false, 0) => given,
        (false, 1) => "\"0.1*sin(3*x)\"".into(),
        (true, 0) => {
            let push = (0..kind.dim).map(|d| if d == kind.axis { given.as_str() } else { "0" });
            list(push)
        }
        (true, 1) => format!("{{ {along} = 0 }}"),
        (true, 2) => format!("{{ {aside} = 0 }}"),
        _ => "0".into(),
    };
    // A body that nothing else holds across the axis is guided there, or left alone.
    let guide = match kind.elastic {
        true => format!("{{ {one} = {{ {aside} = 0 }} }}"),
        false => format!("{{ {other} = 0 }}"),
    };
    match rng.below(12) {
        0..=5 if lowest && kind.floor => format!("dirichlet = {guide}\n"),
        _ if lowest && kind.floor => String::new(),
        0..=9 if lowest => format!("dirichlet = {{ {low} = {value} }}\n"),
        10 if lowest => format!("dirichlet = {{ {low} = 0, {one} = 0 }}\n"),
        0 if !lowest => format!("dirichlet = {{ {high} = {value} }}\n"),
        1..=4 if !lowest => format!("dirichlet = {guide}\n"),
        _ => String::new(),
    }
}

/// Elements, coefficients, loads and supports of a body or a grid.
pub fn properties(rng: &mut Rng, kind: &Kind, block: &Block, grid: bool, out: &mut String) {
    let _ = write!(
        out,
        "elements = {}\nsubdomains = {}\n",
        list(&block.elements),
        list(&block.subdomains)
    );
    *out += &material(rng, kind, grid);
    if !rng.one_in(8) || block.lowest {
        *out += &load(rng, kind);
    }
    *out += &support(rng, kind, block.lowest);
    if !grid && rng.one_in(12) {
        let [low, _] = ends(kind, kind.axis);
        let _ = writeln!(out, "spring = {{ {low} = {} }}", number(rng, 0.01, 1.0));
    }
}

/// A box.
pub fn body(rng: &mut Rng, kind: &Kind, block: &Block, rest: &str, out: &mut String) {
    let _ = write!(
        out,
        "[[body]]\nname = \"{}\"\norigin = {}\nsize = {}\n{rest}",
        block.name,
        list(&block.origin),
        list(&block.size)
    );
    properties(rng, kind, block, false, out);
}

fn gap(rng: &mut Rng, kind: &Kind) -> String {
    let size = number(rng, 0.0, 0.1);
    match rng.below(8) {
        0 => format!("gap = {size}\n"),
        1 => format!("gap = -{}\n", round(0.3 * size)),
        2 => format!("gap = \"{size}*abs(sin(3*x + 2*y))\"\n"),
        3 if kind.dim == 2 && !kind.update => {
            format!(
                "gap = [[0.2, {size}], [0.6, -{}], [0.9, 0]]\n",
                round(0.1 * size)
            )
        }
        4 => format!("gap = \"{}*sin(4*x + y)\"\n", round(0.5 * size)),
        _ => String::new(),
    }
}

/// A contact or a tie of two neighbours, the lower one first, on the common side or a part of it. `apart`: the sides do
/// not touch; `matching`: their nodes coincide.
pub fn joint(
    rng: &mut Rng,
    kind: &Kind,
    [a, b]: [&str; 2],
    (apart, matching): (bool, bool),
    out: &mut String,
) {
    let turned = rng.one_in(if kind.elastic { 2 } else { 40 });
    let pair = if turned { [b, a] } else { [a, b] };
    let bodies = format!("bodies = [\"{}\", \"{}\"]\n", pair[0], pair[1]);
    let [low, high] = ends(kind, kind.axis);
    let sides = match (apart, turned) {
        (false, _) => String::new(),
        (true, false) => format!("sides = [\"{high}\", \"{low}\"]\n"),
        (true, true) => format!("sides = [\"{low}\", \"{high}\"]\n"),
    };
    let carrier = match rng.below(4) {
        0 if !matching => format!("multipliers = \"{b}\"\n"),
        _ => String::new(),
    };
    let parts = kind.dim == 2 && !apart && !kind.update;
    let _ = match rng.below(12) {
        0 if !apart => write!(out, "[[tie]]\n{bodies}{carrier}"),
        1 if parts && matching => write!(
            out,
            "[[tie]]\n{bodies}range = [0, 0.4]\n[[contact]]\n{bodies}range = [0.4, 1]\n{}",
            gap(rng, kind)
        ),
        2 if parts => write!(
            out,
            "[[contact]]\n{bodies}range = [0, 0.7]\n{carrier}{}",
            gap(rng, kind)
        ),
        3 if parts && matching => write!(
            out,
            "[[contact]]\n{bodies}range = [0, 0.4]\n{}[[contact]]\n{bodies}range = [0.4, 1]\n{}",
            gap(rng, kind),
            gap(rng, kind)
        ),
        _ => write!(
            out,
            "[[contact]]\n{bodies}{sides}{carrier}{}",
            gap(rng, kind)
        ),
    };
}

/// Rigid obstacles below the lowest bodies, and now and then some more beside the ends of a body.
pub fn obstacles(rng: &mut Rng, kind: &Kind, blocks: &[Block], out: &mut String) {
    for block in blocks.iter().filter(|b| b.lowest && kind.floor) {
        obstacle(rng, kind, block, false, out);
    }
    if rng.one_in(3) {
        let block = rng.pick(blocks);
        let upper = !block.lowest || rng.one_in(2);
        obstacle(rng, kind, block, upper, out);
    }
}

/// An obstacle beside the lower or the upper end of a body; of a scalar below or above its sides.
fn obstacle(rng: &mut Rng, kind: &Kind, block: &Block, upper: bool, out: &mut String) {
    let [low, high] = ends(kind, kind.axis);
    let side = if upper { high } else { low };
    let head = format!("[[obstacle]]\nbody = \"{}\"\n", block.name);
    if !kind.elastic {
        let side = if rng.one_in(4) { "all" } else { side };
        let bound = number(rng, 0.06, 0.4);
        let wave = number(rng, 0.0, 0.05);
        let (key, sign) = if upper && rng.one_in(3) {
            ("above", "")
        } else {
            ("below", "-")
        };
        let _ = write!(
            out,
            "{head}side = \"{side}\"\n{key} = \"{sign}{bound} + {wave}*sin(4*x)\"\n"
        );
        return;
    }
    let outwards = if upper { 1.0 } else { -1.0 };
    let end = block.origin[kind.axis] + if upper { block.size[kind.axis] } else { 0.0 };
    let distance = number(rng, if kind.floor { -0.01 } else { 0.06 }, 0.1);
    let middle = |d: usize| round(block.origin[d] + 0.5 * block.size[d]);
    let mut point: Vec<f64> = (0..kind.dim).map(middle).collect();
    let mut normal = vec![0.0; kind.dim];
    point[kind.axis] = round(end + outwards * distance);
    normal[kind.axis] = -outwards;
    let plane = |point: &[f64], normal: &[f64]| {
        format!(
            "plane = {{ point = {}, normal = {} }}",
            list(point),
            list(normal)
        )
    };
    let shape = match rng.below(5) {
        0 => {
            point[kind.axis] = round(point[kind.axis] + 4.0 * outwards);
            let curved = if kind.dim == 2 { "cylinder" } else { "sphere" };
            format!("{curved} = {{ centre = {}, radius = 4 }}", list(&point))
        }
        1 if !kind.floor => {
            normal[usize::from(kind.axis == 0)] = 0.1;
            plane(&point, &normal)
        }
        _ => plane(&point, &normal),
    };
    let _ = write!(out, "{head}side = \"{side}\"\n{shape}\n");
}

/// Bounds from both sides that leave little room, or none: of a scalar on the two sides of a contact, in elasticity a
/// side between two planes.
pub fn squeeze(rng: &mut Rng, kind: &Kind, [lower, upper]: [&Block; 2], out: &mut String) {
    let [low, high] = ends(kind, kind.axis);
    let room = *rng.pick(&[-0.02, 0.0, 0.03, 0.1]);
    if !kind.elastic {
        let floor = number(rng, -0.1, 0.1);
        let _ = write!(
            out,
            "[[obstacle]]\nbody = \"{}\"\nside = \"{high}\"\nbelow = {floor}\n\
             [[obstacle]]\nbody = \"{}\"\nside = \"{low}\"\nabove = {}\n",
            lower.name,
            upper.name,
            round(floor + room)
        );
        return;
    }
    let end = upper.origin[kind.axis] + upper.size[kind.axis];
    let down = number(rng, 0.0, 0.1);
    for (place, normal) in [(end - down, 1.0), (end - down + room, -1.0)] {
        let (mut at, mut n) = (vec![0.0; kind.dim], vec![0.0; kind.dim]);
        (at[kind.axis], n[kind.axis]) = (round(place), normal);
        let _ = write!(
            out,
            "[[obstacle]]\nbody = \"{}\"\nside = \"{high}\"\nplane = {{ point = {}, normal = {} }}\n",
            upper.name,
            list(&at),
            list(&n)
        );
    }
}
