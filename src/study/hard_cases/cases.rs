//! The cases, in the format of scene files.

/// One case.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Its name, a word.
    pub name: &'static str,
    /// The difficulty of the case.
    pub title: &'static str,
    /// The scene.
    pub text: String,
}

/// A scene of equal bodies.
struct Grid<'a> {
    /// The keys of the scene before the grid.
    head: &'a str,
    bodies: &'a [usize],
    subdomains: usize,
    /// Elements across a subdomain.
    elements: usize,
    /// The other keys of the grid, and the rest of the scene.
    rest: &'a str,
}

const SCALAR: &str = "";
const ELASTIC: &str = "physics = \"elasticity\"\n";
const BBAR: &str = "physics = \"elasticity\"\nlocking = \"bbar\"\n";
const SOLID: &str = "dimension = 3\nphysics = \"elasticity\"\n";

impl Grid<'_> {
    fn text(&self) -> String {
        let list: Vec<String> = self.bodies.iter().map(usize::to_string).collect();
        format!(
            "{}[grid]\nbodies = [{}]\nsubdomains = {}\nelements_per_subdomain = {}\n{}",
            self.head,
            list.join(", "),
            self.subdomains,
            self.elements,
            self.rest
        )
    }
}

/// All cases; with `quick` on smaller meshes.
pub fn cases(quick: bool) -> Vec<Case> {
    let mut out = coefficients();
    out.extend(shapes(quick));
    out.extend(contacts());
    out
}

fn case(name: &'static str, title: &'static str, grid: Grid) -> Case {
    Case {
        name,
        title,
        text: grid.text(),
    }
}

/// Cases with large jumps of stiffness, and near-incompressible ones.
fn coefficients() -> Vec<Case> {
    // A load without symmetry: symmetry would make the problem easy.
    const PULL: &str = "dirichlet = [\"left\"]\nload = [\"1 + x*y\", \"sin(3*x) - y\"]\n";
    const PULL3: &str =
        "dirichlet = [\"left\"]\nload = [\"1 + x*y\", \"sin(3*x) - y\", \"z - 0.3*x\"]\n";
    let mut out = Vec::new();
    let plane = |name, title, head, young: &str| {
        let rest = format!("young = {young}\n{PULL}");
        case(
            name,
            title,
            Grid {
                head,
                bodies: &[3, 2],
                subdomains: 4,
                elements: 4,
                rest: &rest,
            },
        )
    };
    out.push(plane(
        "jump-bodies",
        "E = 1 and 1e6 by body",
        ELASTIC,
        "{ checkerboard = [1, 1e6], by = \"body\" }",
    ));
    out.push(plane(
        "jump-bodies-soft",
        "E = 1 and 1e-6 by body",
        ELASTIC,
        "{ checkerboard = [1, 1e-6], by = \"body\" }",
    ));
    out.push(plane(
        "jump-inside",
        "E = 1 and 1e6 by subdomain",
        ELASTIC,
        "{ checkerboard = [1, 1e6], by = \"subdomain\" }",
    ));
    out.push(plane(
        "jump-inside-soft",
        "E = 1 and 1e-6 by subdomain",
        ELASTIC,
        "{ checkerboard = [1, 1e-6], by = \"subdomain\" }",
    ));
    out.push(plane(
        "jump-elements",
        "E = 1e6 in every third element of every third row",
        ELASTIC,
        "\"if(mod(floor(48*x), 3) == 1 && mod(floor(32*y), 3) == 1, 1e6, 1)\"",
    ));
    let rest = format!("young = {{ checkerboard = [1, 1e6], by = \"body\" }}\n{PULL3}");
    out.push(case(
        "jump-bodies-3d",
        "E = 1 and 1e6 by body, solid",
        Grid {
            head: SOLID,
            bodies: &[2, 2, 2],
            subdomains: 2,
            elements: 2,
            rest: &rest,
        },
    ));
    let rest = format!("young = {{ checkerboard = [1, 1e6], by = \"subdomain\" }}\n{PULL3}");
    out.push(case(
        "jump-inside-3d",
        "E = 1 and 1e6 by subdomain, solid",
        Grid {
            head: SOLID,
            bodies: &[2, 2, 1],
            subdomains: 2,
            elements: 2,
            rest: &rest,
        },
    ));
    let rest = format!("poisson = 0.4999\n{PULL}");
    for (name, title, head) in [
        ("incompressible", "ν = 0.4999, full integration", ELASTIC),
        (
            "incompressible-bbar",
            "ν = 0.4999, locking = \"bbar\"",
            BBAR,
        ),
    ] {
        out.push(case(
            name,
            title,
            Grid {
                head,
                bodies: &[2, 2],
                subdomains: 4,
                elements: 4,
                rest: &rest,
            },
        ));
    }
    out
}

/// Cases with flat elements, many subdomains, or fine subdomains.
fn shapes(quick: bool) -> Vec<Case> {
    let mut out = Vec::new();
    let flat = "size = [1, 0.001]\ndirichlet = [\"left\"]\nload = \"1 + x\"\n";
    out.push(case(
        "flat",
        "elements 1000 times as long as high, scalar",
        Grid {
            head: SCALAR,
            bodies: &[2, 2],
            subdomains: 4,
            elements: 4,
            rest: flat,
        },
    ));
    let flat = "size = [1, 0.001]\ndirichlet = [\"left\"]\nload = [\"1 + x\", \"1e-6*(2 - x)\"]\n";
    out.push(case(
        "flat-elastic",
        "elements 1000 times as long as high, elastic: a thin sheet that bends",
        Grid {
            head: ELASTIC,
            bodies: &[2, 2],
            subdomains: 4,
            elements: 4,
            rest: flat,
        },
    ));
    let held = "dirichlet = [\"left\", \"bottom\"]\nload = \"1 + x*y\"\n";
    let (many, fine) = if quick { (16, 32) } else { (32, 128) };
    out.push(case(
        "many-subdomains",
        if quick {
            "H_b/H_s = 16"
        } else {
            "H_b/H_s = 32"
        },
        Grid {
            head: SCALAR,
            bodies: &[2, 2],
            subdomains: many,
            elements: 2,
            rest: held,
        },
    ));
    out.push(case(
        "fine-subdomains",
        if quick { "H_s/h = 32" } else { "H_s/h = 128" },
        Grid {
            head: SCALAR,
            bodies: &[2, 2],
            subdomains: 2,
            elements: fine,
            rest: held,
        },
    ));
    let pull = "dirichlet = [\"left\"]\nload = [\"1 + x*y\", \"sin(3*x) - y\"]\n";
    let (many, fine) = if quick { (8, 16) } else { (16, 64) };
    out.push(case(
        "many-subdomains-elastic",
        if quick {
            "H_b/H_s = 8, elastic"
        } else {
            "H_b/H_s = 16, elastic"
        },
        Grid {
            head: ELASTIC,
            bodies: &[2, 2],
            subdomains: many,
            elements: 2,
            rest: pull,
        },
    ));
    out.push(case(
        "fine-subdomains-elastic",
        if quick {
            "H_s/h = 16, elastic"
        } else {
            "H_s/h = 64, elastic"
        },
        Grid {
            head: ELASTIC,
            bodies: &[2, 2],
            subdomains: 2,
            elements: fine,
            rest: pull,
        },
    ));
    out
}

/// Two blocks, one on the other: the keys of the scene, of the lower and the upper block, and of the interface.
fn blocks(head: &str, lower: &str, upper: &str, rest: &str) -> String {
    let body = |name: &str, y: f64, keys: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [0, {y}]\n\
             size = [1, 1]\nsubdomains = [2, 2]\nelements = [16, 16]\n{keys}"
        )
    };
    format!(
        "{head}{}{}{rest}",
        body("lower", 0.0, lower),
        body("upper", 1.0, upper)
    )
}

/// Cases in which contacts are too few, too loose, too deep, or absent.
fn contacts() -> Vec<Case> {
    const SLIDES: &str = "dirichlet = { left = { x = 0 }, right = { x = 0 } }\n";
    const FIXED: &str = "dirichlet = [\"bottom\"]\n";
    const CONTACT: &str = "[[contact]]\nbodies = [\"lower\", \"upper\"]\n";
    let mut out = Vec::new();
    let mut add = |name, title, text| out.push(Case { name, title, text });
    let upper = format!("{SLIDES}load = [0, \"-1 - x\"]\n");
    let one = format!("{CONTACT}points = [0.5]\n");
    add(
        "one-node",
        "a floating block on one node",
        blocks(ELASTIC, FIXED, &upper, &one),
    );
    // Scalar inequalities are u_first − u_second ≤ gap: the upper body stays above the lower one.
    add(
        "one-node-scalar",
        "a floating body on one node, scalar",
        blocks(SCALAR, FIXED, "load = \"-1 - x\"\n", &one),
    );
    let corner = format!("{CONTACT}points = [0]\n");
    add(
        "one-corner",
        "a floating block on its corner",
        blocks(ELASTIC, FIXED, &upper, &corner),
    );
    let upper = "load = [0, \"-1 + 0.5*x\"]\nspring = { left = 1e-8, right = 1e-8 }\n";
    add(
        "springs-pressed",
        "a block held by springs of 1e-8 and pressed onto another",
        blocks(ELASTIC, FIXED, upper, CONTACT),
    );
    let upper = "load = [\"1e-9*y\", \"1e-8*(1 + x)\"]\nspring = { left = 1e-8, right = 1e-8 }\n";
    add(
        "springs-lifted",
        "a block held by springs of 1e-8 only, lifted off",
        blocks(ELASTIC, FIXED, upper, CONTACT),
    );
    add(
        "springs-tied",
        "bodies tied to each other, held by springs of 1e-8 only",
        Grid {
            head: ELASTIC,
            bodies: &[2, 2],
            subdomains: 2,
            elements: 4,
            rest: "spring = { bottom = 1e-8 }\nload = [\"1e-9*x\", \"1e-8*(y - x)\"]\n",
        }
        .text(),
    );
    add(
        "springs-scalar",
        "a body held by springs of 1e-8 only, scalar",
        blocks(
            SCALAR,
            FIXED,
            "load = \"1e-8*(1 + x)\"\nspring = { top = 1e-8 }\n",
            CONTACT,
        ),
    );
    let deep = format!("{CONTACT}gap = \"-0.1*(1 + x)\"\n");
    let upper = "dirichlet = { top = [0, -0.05] }\n";
    add(
        "interpenetrating",
        "blocks that begin up to 0.2 inside each other",
        blocks(ELASTIC, FIXED, upper, &deep),
    );
    let upper = format!("{SLIDES}load = [0, -0.1]\n");
    add(
        "interpenetrating-floating",
        "the same with a floating block",
        blocks(ELASTIC, FIXED, &upper, &deep),
    );
    let upper = "dirichlet = { top = [0, 0.05] }\nload = [0, \"0.1*x\"]\n";
    add(
        "no-contact",
        "a held block that is lifted off everywhere",
        blocks(ELASTIC, FIXED, upper, CONTACT),
    );
    add(
        "no-contact-scalar",
        "a held body that is lifted off everywhere, scalar",
        blocks(
            SCALAR,
            FIXED,
            "dirichlet = { top = 0.1 }\nload = 1\n",
            CONTACT,
        ),
    );
    let upper = format!("young = 1e6\n{SLIDES}load = [0, \"-1 - x\"]\n");
    add(
        "stiff-on-soft",
        "a block 1e6 times as stiff pressed into another",
        blocks(ELASTIC, FIXED, &upper, CONTACT),
    );
    let upper = format!("young = 1e-6\n{SLIDES}load = [0, \"-1e-7*(1 + x)\"]\n");
    add(
        "soft-on-stiff",
        "a block 1e-6 times as stiff pressed onto another",
        blocks(ELASTIC, FIXED, &upper, CONTACT),
    );
    let upper = format!("{SLIDES}load = [0, \"1 + x\"]\n");
    add(
        "flies-away",
        "a floating block that the load pulls away: no solution",
        blocks(ELASTIC, FIXED, &upper, CONTACT),
    );
    out
}
