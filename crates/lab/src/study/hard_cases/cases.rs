//! The cases, in the format of scene files.

use super::decks::{decks, KnownDisplacement};
use super::trackers::{trackers, KnownForce};

/// One case.
#[derive(Debug, Clone, PartialEq)]
pub struct HardCase {
    /// Its name, a word.
    pub name: &'static str,
    /// The difficulty of the case.
    pub title: String,
    /// The scene, or a deck, which begins with an asterisk.
    pub text: String,
    /// A force that is known beforehand.
    pub force: Option<KnownForce>,
    /// A displacement that is known beforehand.
    pub point: Option<KnownDisplacement>,
}

/// The keys of a scene before its bodies.
const SCALAR: &str = "";
const ELASTIC: &str = "physics = \"elasticity\"\n";
const BBAR: &str = "physics = \"elasticity\"\nlocking = \"bbar\"\n";
const SOLID: &str = "dimension = 3\nphysics = \"elasticity\"\n";

/// A load without symmetry: symmetry would make the problem easy.
const PULL: &str = "dirichlet = [\"left\"]\nload = [\"1 + x*y\", \"sin(3*x) - y\"]\n";
const PULL3: &str =
    "dirichlet = [\"left\"]\nload = [\"1 + x*y\", \"sin(3*x) - y\", \"z - 0.3*x\"]\n";

/// A scene of equal bodies: its keys, the bodies, subdomains and elements of a subdomain in each direction, the other
/// keys of the grid, and the rest of the scene.
fn grid(head: &str, bodies: &[usize], [subdomains, elements]: [usize; 2], rest: &str) -> String {
    format!(
        "{head}[grid]\nbodies = {bodies:?}\nsubdomains = {subdomains}\nelements_per_subdomain = {elements}\n{rest}"
    )
}

/// Two blocks, one on the other, the lower one fixed: the keys of the scene, of the upper block, and of the interface.
fn blocks(head: &str, upper: &str, rest: &str) -> String {
    let body = |name: &str, y: f64, keys: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [0, {y}]\nsize = [1, 1]\nsubdomains = [2, 2]\n\
             elements = [16, 16]\n{keys}"
        )
    };
    let lower = body("lower", 0.0, "dirichlet = [\"bottom\"]\n");
    format!("{head}{lower}{}{rest}", body("upper", 1.0, upper))
}

/// All cases; with `quick` on smaller meshes.
pub fn cases(quick: bool) -> Vec<HardCase> {
    let mut out = Vec::new();
    let mut add = |name, title: &str, text| {
        out.push(HardCase {
            point: None,
            name,
            title: title.to_string(),
            text,
            force: None,
        });
    };
    coefficients(&mut add);
    shapes(quick, &mut add);
    contacts(&mut add);
    walls(&mut add);
    out.extend(trackers());
    out.extend(decks());
    out
}

/// Cases with large jumps of stiffness, and near-incompressible ones.
fn coefficients(add: &mut dyn FnMut(&'static str, &str, String)) {
    let by =
        |least: &str, part: &str| format!("{{ checkerboard = [1, {least}], by = \"{part}\" }}");
    let elements = "\"if(mod(floor(48*x), 3) == 1 && mod(floor(32*y), 3) == 1, 1e6, 1)\"";
    for (name, title, young) in [
        ("jump-bodies", "E = 1 and 1e6 by body", by("1e6", "body")),
        (
            "jump-bodies-soft",
            "E = 1 and 1e-6 by body",
            by("1e-6", "body"),
        ),
        (
            "jump-inside",
            "E = 1 and 1e6 by subdomain",
            by("1e6", "subdomain"),
        ),
        (
            "jump-inside-soft",
            "E = 1 and 1e-6 by subdomain",
            by("1e-6", "subdomain"),
        ),
        (
            "jump-elements",
            "E = 1e6 in every third element of every third row",
            elements.into(),
        ),
    ] {
        let rest = format!("young = {young}\n{PULL}");
        add(name, title, grid(ELASTIC, &[3, 2], [4, 4], &rest));
    }
    for (name, title, bodies, part) in [
        (
            "jump-bodies-3d",
            "E = 1 and 1e6 by body, solid",
            [2, 2, 2],
            "body",
        ),
        (
            "jump-inside-3d",
            "E = 1 and 1e6 by subdomain, solid",
            [2, 2, 1],
            "subdomain",
        ),
    ] {
        let rest = format!("young = {}\n{PULL3}", by("1e6", part));
        add(name, title, grid(SOLID, &bodies, [2, 2], &rest));
    }
    for (name, title, head) in [
        ("incompressible", "ν = 0.4999, full integration", ELASTIC),
        (
            "incompressible-bbar",
            "ν = 0.4999, locking = \"bbar\"",
            BBAR,
        ),
    ] {
        let rest = format!("poisson = 0.4999\n{PULL}");
        add(name, title, grid(head, &[2, 2], [4, 4], &rest));
    }
}

/// Cases with flat elements, many subdomains, or fine subdomains.
fn shapes(quick: bool, add: &mut dyn FnMut(&'static str, &str, String)) {
    let flat = |load: &str| format!("size = [1, 0.001]\ndirichlet = [\"left\"]\nload = {load}\n");
    add(
        "flat",
        "elements 1000 times as long as high, scalar",
        grid(SCALAR, &[2, 2], [4, 4], &flat("\"1 + x\"")),
    );
    add(
        "flat-elastic",
        "elements 1000 times as long as high, elastic: a thin sheet that bends",
        grid(
            ELASTIC,
            &[2, 2],
            [4, 4],
            &flat("[\"1 + x\", \"1e-6*(2 - x)\"]"),
        ),
    );
    let (many, fine) = if quick { (16, 32) } else { (32, 128) };
    let held = "dirichlet = [\"left\", \"bottom\"]\nload = \"1 + x*y\"\n";
    let scalar = |parts| grid(SCALAR, &[2, 2], parts, held);
    add(
        "many-subdomains",
        &format!("H_b/H_s = {many}"),
        scalar([many, 2]),
    );
    add(
        "fine-subdomains",
        &format!("H_s/h = {fine}"),
        scalar([2, fine]),
    );
    let (many, fine) = if quick { (8, 16) } else { (16, 64) };
    let elastic = |parts| grid(ELASTIC, &[2, 2], parts, PULL);
    let title = format!("H_b/H_s = {many}, elastic");
    add("many-subdomains-elastic", &title, elastic([many, 2]));
    let title = format!("H_s/h = {fine}, elastic");
    add("fine-subdomains-elastic", &title, elastic([2, fine]));
}

/// Cases in which contacts are too few, too loose, too deep, or absent.
fn contacts(add: &mut dyn FnMut(&'static str, &str, String)) {
    const CONTACT: &str = "[[contact]]\nbodies = [\"lower\", \"upper\"]\n";
    let slides = |keys: &str, load: &str| {
        let walls = "dirichlet = { left = { x = 0 }, right = { x = 0 } }";
        format!("{keys}{walls}\nload = [0, {load}]\n")
    };
    let sprung = |load: &str| format!("load = {load}\nspring = {{ left = 1e-8, right = 1e-8 }}\n");
    let moved = |top: &str, more: &str| format!("dirichlet = {{ top = {top} }}\n{more}");
    let at = |point: &str| format!("{CONTACT}points = [{point}]\n");
    let deep = format!("{CONTACT}gap = \"-0.1*(1 + x)\"\n");
    let pressed = slides("", "\"-1 - x\"");
    add(
        "one-node",
        "a floating block on one node",
        blocks(ELASTIC, &pressed, &at("0.5")),
    );
    // Scalar inequalities are u_first − u_second ≤ gap: the upper body stays above the lower one.
    add(
        "one-node-scalar",
        "a floating body on one node, scalar",
        blocks(SCALAR, "load = \"-1 - x\"\n", &at("0.5")),
    );
    add(
        "one-corner",
        "a floating block on its corner",
        blocks(ELASTIC, &pressed, &at("0")),
    );
    add(
        "springs-pressed",
        "a block held by springs of 1e-8 and pressed onto another",
        blocks(ELASTIC, &sprung("[0, \"-1 + 0.5*x\"]"), CONTACT),
    );
    add(
        "springs-lifted",
        "a block held by springs of 1e-8 only, lifted off",
        blocks(ELASTIC, &sprung("[\"1e-9*y\", \"1e-8*(1 + x)\"]"), CONTACT),
    );
    let sprung = "spring = { bottom = 1e-8 }\nload = [\"1e-9*x\", \"1e-8*(y - x)\"]\n";
    add(
        "springs-tied",
        "bodies tied to each other, held by springs of 1e-8 only",
        grid(ELASTIC, &[2, 2], [2, 4], sprung),
    );
    let sprung = "load = \"1e-8*(1 + x)\"\nspring = { top = 1e-8 }\n";
    add(
        "springs-scalar",
        "a body held by springs of 1e-8 only, scalar",
        blocks(SCALAR, sprung, CONTACT),
    );
    add(
        "interpenetrating",
        "blocks that begin up to 0.2 inside each other",
        blocks(ELASTIC, &moved("[0, -0.05]", ""), &deep),
    );
    add(
        "interpenetrating-floating",
        "the same with a floating block",
        blocks(ELASTIC, &slides("", "-0.1"), &deep),
    );
    add(
        "no-contact",
        "a held block that is lifted off everywhere",
        blocks(
            ELASTIC,
            &moved("[0, 0.05]", "load = [0, \"0.1*x\"]\n"),
            CONTACT,
        ),
    );
    add(
        "no-contact-scalar",
        "a held body that is lifted off everywhere, scalar",
        blocks(SCALAR, &moved("0.1", "load = 1\n"), CONTACT),
    );
    add(
        "stiff-on-soft",
        "a block 1e6 times as stiff pressed into another",
        blocks(ELASTIC, &slides("young = 1e6\n", "\"-1 - x\""), CONTACT),
    );
    add(
        "soft-on-stiff",
        "a block 1e-6 times as stiff pressed onto another",
        blocks(
            ELASTIC,
            &slides("young = 1e-6\n", "\"-1e-7*(1 + x)\""),
            CONTACT,
        ),
    );
    let place = |name: &str, origin: &str, size: &str, elements: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = {origin}\nsize = {size}\nelements = {elements}\n\
             subdomains = 2\n"
        )
    };
    let plate = place("plate", "[0, 0, 0]", "[2, 1, 2]", "[6, 4, 6]");
    let block = place("block", "[0.3, 1, 0.4]", "1", "[4, 4, 4]");
    add(
        "soft-on-rigid",
        "a floating solid on a plate 1e12 times as stiff, of another mesh",
        format!(
            "{SOLID}{plate}young = 1e12\ndirichlet = [\"bottom\"]\n{block}young = 1\n\
             dirichlet = {{ left = {{ x = 0 }}, back = {{ z = 0 }} }}\n\
             traction = {{ top = [0, \"-0.01*(1 + 0.2*(x - 0.5))\", 0] }}\n[[contact]]\n\
             bodies = [\"plate\", \"block\"]\nmultipliers = \"block\"\n"
        ),
    );
    add(
        "flies-away",
        "a floating block that the load pulls away: no solution",
        blocks(ELASTIC, &slides("", "\"1 + x\""), CONTACT),
    );
}

/// Walls of bodies in contact whose coefficients jump from body to body: the sets of an active-set method wander there.
fn walls(add: &mut dyn FnMut(&'static str, &str, String)) {
    let scalar = "dirichlet = { bottom = 0, right = 0 }\n\
                  load = \"5*(0.3 + cos(1.3*x + 1)*sin(2.2*y + 1.7*bi))\"\n";
    for (name, title, jump) in [
        ("wall", "4 x 4 bodies in contact, two thirds with gaps", "1"),
        ("wall-jumps-1e4", "the same, ρ = 1 and 1e4 by body", "1e4"),
        ("wall-jumps-1e6", "the same, ρ = 1 and 1e6 by body", "1e6"),
    ] {
        let rho = format!("rho = {{ checkerboard = [1, {jump}], by = \"body\" }}\n{scalar}");
        add(name, title, wall(SCALAR, &rho, 1.0));
    }
    let framed = "young = { checkerboard = [1, 1e6], by = \"body\" }\n\
                  dirichlet = [\"left\", \"right\", \"bottom\", \"top\"]\n\
                  load = [\"sin(2.2*y + 1.7*bi)\", \"cos(1.3*x + bj)\"]\n";
    add(
        "wall-elastic",
        "4 x 4 blocks in a frame, E = 1 and 1e6 by body, gaps of 0.01 to 0.03",
        wall(ELASTIC, framed, 0.1),
    );
}

/// A wall of 4 x 4 bodies: the keys of the scene and of the grid. Gaps are `scale` times 0.09 to 0.3.
fn wall(head: &str, keys: &str, scale: f64) -> String {
    const BODIES: usize = 4;
    let rest = format!("size = [4, 4]\n{keys}[interface]\ndefault = \"contact\"\n");
    let mut out = grid(head, &[BODIES, BODIES], [2, 4], &rest);
    for i in 0..BODIES {
        for j in 0..BODIES {
            for (above, to) in [[i + 1, j], [i, j + 1]].into_iter().enumerate() {
                // Any rule would do that gives unequal gaps to most interfaces, and none to some.
                let n = (7 * i + 11 * j + 5 * above + i * j * above) % 23;
                if to.iter().all(|k| *k < BODIES) && n % 5 != 0 {
                    let gap = scale * (0.08 + 0.01 * n as f64);
                    let [k, l] = to;
                    out += &format!(
                        "[[contact]]\nbodies = [\"b{i}_{j}\", \"b{k}_{l}\"]\ngap = {gap:.4}\n"
                    );
                }
            }
        }
    }
    out
}
