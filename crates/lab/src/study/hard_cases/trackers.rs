//! Cases that others report in the trackers of their programs, each named by program and number, with sides whose nodes
//! do not match.

use super::cases::HardCase;

/// A force between bodies that is known beforehand, from equilibrium or from a closed form: Σ λ n over all rows, the
/// force of the first body of the joint on the second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownForce {
    /// The direction, an axis.
    pub axis: usize,
    /// Its value.
    pub value: f64,
    /// The largest deviation that is right.
    pub within: f64,
}

/// A body: its name, the keys that place it, and its other keys.
fn body(name: &str, place: &str, keys: &str) -> String {
    format!("[[body]]\nname = \"{name}\"\n{place}{keys}")
}

/// Lower left corner, size, elements and subdomains.
fn tracker_scene(origin: &str, size: &str, elements: &str, subdomains: &str) -> String {
    format!("origin = {origin}\nsize = {size}\nelements = {elements}\nsubdomains = {subdomains}\n")
}

/// All of them.
pub fn trackers() -> Vec<HardCase> {
    vec![
        plank(),
        facets(),
        touching(),
        at_rest(),
        incompressible(),
        press_fit(),
        tied(),
        crossing(),
    ]
}

/// Sizes, meshes and E of the thread's plank and block (its pull request 14241), with the block at its foremost, and
/// turned so that some of its nodes touch: each of them slides to and fro between two faces of the plank there.
fn plank() -> HardCase {
    let elastic = "young = 1e9\npoisson = 0.3\n";
    let plank = body(
        "plank",
        &tracker_scene("[-0.3, -10]", "[0.6, 20]", "[2, 67]", "[2, 1]"),
        &format!("{elastic}dirichlet = {{ left = {{ x = 0 }}, bottom = {{ y = 0 }} }}\n"),
    );
    let block = body(
        "block",
        &tracker_scene("[0.31, 9.2]", "[0.6, 0.8]", "[4, 4]", "[2, 2]"),
        &format!("{elastic}dirichlet = {{ right = [\"-0.011 + 0.02*(y - 9.6)\", 0] }}\n"),
    );
    HardCase {
        point: None,
        name: "moose-10950-plank",
        title: "a block turned into a long plank, at a gap, nodes between two faces (moose#10950)"
            .into(),
        text: format!(
            "physics = \"elasticity\"\n{plank}{block}[[contact]]\nbodies = [\"block\", \"plank\"]\n\
             sides = [\"left\", \"right\"]\n"
        ),
        force: None,
    }
}

/// The zone of contact ends among faces with different normals, and every second node of the round side stands before
/// a corner of the other one.
fn facets() -> HardCase {
    let bowl = body(
        "bowl",
        &tracker_scene("[0, 0]", "[4, 1]", "[8, 4]", "[2, 2]"),
        "shape = { y = \"y*(0.6 + 0.1*(x - 2)^2)\" }\ndirichlet = [\"bottom\"]\n",
    );
    let round = body(
        "round",
        &tracker_scene("[0, 1]", "[4, 1]", "[16, 4]", "[4, 2]"),
        "shape = { y = \"y - (2 - y)*(0.4 - 0.16*(x - 2)^2)\" }\ndirichlet = { left = { x = 0 } }\n\
         traction = { top = [0, \"-0.01*(1 + 0.2*(x - 2))\"] }\n",
    );
    HardCase {
        point: None,
        name: "moose-10950-facets",
        title: "a round block in a bowl of flat faces, nodes before corners (moose#10950)".into(),
        text: format!(
            "physics = \"elasticity\"\n{bowl}{round}[[contact]]\nbodies = [\"round\", \"bowl\"]\n\
             sides = [\"bottom\", \"top\"]\n"
        ),
        // The load of the round block.
        force: Some(KnownForce {
            axis: 1,
            value: -0.04,
            within: 1e-8,
        }),
    }
}

/// Two solids on each other, 4 x 4 and 6 x 6 faces; the keys of the lower and of the upper one.
fn solids(lower: &str, upper: &str) -> String {
    let lower = body(
        "lower",
        &tracker_scene("[0, 0, 0]", "1", "[4, 4, 4]", "[2, 2, 2]"),
        lower,
    );
    let upper = body(
        "upper",
        &tracker_scene("[0, 1, 0]", "1", "[6, 3, 6]", "[2, 1, 2]"),
        upper,
    );
    format!(
        "dimension = 3\nphysics = \"elasticity\"\n{lower}{upper}[[contact]]\n\
         bodies = [\"lower\", \"upper\"]\n"
    )
}

/// No force at all.
const NONE: Option<KnownForce> = Some(KnownForce {
    axis: 1,
    value: 0.0,
    within: 1e-10,
});

/// Both move as one rigid body: all rows are zero, gap and multiplier.
fn touching() -> HardCase {
    let motion = "[\"0.01 - 0.02*y + 0.03*z\", \"0.02*x - 0.01*z - 0.04\", \"0.01*y - 0.03*x\"]";
    let given = |side: &str| format!("dirichlet = {{ {side} = {motion} }}\n");
    HardCase {
        point: None,
        name: "4c-1585-moved",
        title: "solids that touch without a force, moved and turned as one (4C#1585)".into(),
        text: solids(&given("bottom"), &given("top")),
        force: NONE,
    }
}

/// No load, and nothing but the contact holds the upper one.
fn at_rest() -> HardCase {
    HardCase {
        point: None,
        name: "4c-1585-at-rest",
        title: "a solid that lies on another one without any load (4C#1585)".into(),
        text: solids(
            "dirichlet = [\"bottom\"]\n",
            "dirichlet = { left = { x = 0 }, back = { z = 0 } }\n",
        ),
        force: NONE,
    }
}

/// A round punch, a hundred times as stiff, pressed into rubber in a mould.
fn incompressible() -> HardCase {
    let rubber = body(
        "rubber",
        &tracker_scene("[0, 0]", "[2, 1]", "[16, 8]", "[4, 2]"),
        "young = 1\npoisson = 0.49999\ndirichlet = { bottom = 0, left = { x = 0 }, right = { x = 0 } }\n",
    );
    let punch = body(
        "punch",
        &tracker_scene("[0.5, 1]", "[1, 0.5]", "[12, 6]", "[2, 2]"),
        "shape = { y = \"y + 0.6*(x - 1)^2*(1.5 - y)\" }\nyoung = 100\npoisson = 0.3\n\
         dirichlet = { top = { x = 0 } }\ntraction = { top = [0, -0.1] }\n",
    );
    HardCase {
        point: None,
        name: "kratos-11713-rubber",
        title: "a round punch pressed into rubber, ν = 0.49999 (Kratos#11713)".into(),
        text: format!(
            "physics = \"elasticity\"\nlocking = \"bbar\"\n{rubber}{punch}[[contact]]\n\
             bodies = [\"rubber\", \"punch\"]\nsides = [\"top\", \"bottom\"]\n"
        ),
        // The load of the punch.
        force: Some(KnownForce {
            axis: 1,
            value: 0.1,
            within: 1e-7,
        }),
    }
}

/// Diameters and interference of the thread: 20, 40 and 60 mm, 5 µm of diameter. Its closed form has 5.74 MPa, and a
/// force of 1371 N with a friction of 0.1, which are E = 196 GPa and a length of 19 mm.
fn press_fit() -> HardCase {
    let [inner, joint, outer, overlap, young, length] = [10.0f64, 20.0, 30.0, 2.5e-3, 196e3, 19.0];
    let ring = |name: &str, from: f64, to: f64, mesh: [&str; 2]| {
        let place = tracker_scene(
            &format!("[{from}, 0]"),
            &format!("[{}, {length}]", to - from),
            mesh[0],
            mesh[1],
        );
        let keys =
            format!("young = {young}\npoisson = 0.3\ndirichlet = {{ bottom = {{ y = 0 }} }}\n");
        body(name, &place, &keys)
    };
    let shaft = ring("shaft", inner, joint, ["[6, 7]", "[2, 1]"]);
    let hub = ring("hub", joint, outer, ["[6, 10]", "[2, 2]"]);
    // Lamé, ends free: p = E δ/R / ((R² + a²)/(R² − a²) + (b² + R²)/(b² − R²)).
    let [a2, r2, b2] = [inner, joint, outer].map(|r| r * r);
    let pressure = young * overlap / joint / ((r2 + a2) / (r2 - a2) + (b2 + r2) / (b2 - r2));
    let force = pressure * 2.0 * std::f64::consts::PI * joint * length;
    HardCase {
        point: None,
        name: "calculix-98-press-fit",
        title: "a hub on a hollow shaft, with the force of the closed form (CalculiX#98)".into(),
        text: format!(
            "physics = \"elasticity\"\nplane = \"axisymmetric\"\norder = 2\n{shaft}{hub}[[contact]]\n\
             bodies = [\"shaft\", \"hub\"]\ngap = {}\n",
            -overlap
        ),
        force: Some(KnownForce {
            axis: 0,
            value: force,
            within: 1e-3 * force,
        }),
    }
}

/// Sizes, E, ν and loads of the thread: two blocks tied on each other, and a beam beside them that has no part in it.
fn tied() -> HardCase {
    let elastic = "young = 2e11\npoisson = 0\n";
    let held = format!("{elastic}dirichlet = [\"back\"]\n");
    let pushed = "traction = { front = [0, 5e5, 0] }\n";
    let foot = body(
        "foot",
        &tracker_scene("[0, -0.5, 0]", "[1, 1, 2]", "[2, 2, 4]", "[1, 1, 2]"),
        &held,
    );
    let head = body(
        "head",
        &tracker_scene("[0, -0.5, 2]", "[1, 1, 2]", "[3, 3, 6]", "[1, 1, 2]"),
        &format!("{elastic}{pushed}"),
    );
    let beam = body(
        "beam",
        &tracker_scene("[3.5, -0.5, 0]", "[1, 1, 4]", "[2, 2, 8]", "[1, 1, 2]"),
        &format!("{held}{pushed}"),
    );
    HardCase {
        point: None,
        name: "calculix-83-tie",
        title: "two tied blocks and a beam beside them (CalculiX#83)".into(),
        text: format!(
            "dimension = 3\nphysics = \"elasticity\"\n{foot}{head}{beam}[[tie]]\nbodies = [\"foot\", \"head\"]\n"
        ),
        // The load of the head, from the foot on the head.
        force: Some(KnownForce {
            axis: 1,
            value: -5e5,
            within: 1.0,
        }),
    }
}

/// Two fractures that cross, all four pieces with meshes of their own.
fn crossing() -> HardCase {
    let piece = |name: &str, at: [usize; 2], n: usize, parts: usize, given: &str| {
        let place = tracker_scene(&format!("{at:?}"), "1", &n.to_string(), &parts.to_string());
        body(name, &place, &format!("dirichlet = {{ {given} }}\n"))
    };
    let pieces = [
        piece("sw", [0, 0], 8, 2, "left = { x = 0 }, bottom = { y = 0 }"),
        piece(
            "se",
            [1, 0],
            6,
            2,
            "right = { x = -0.01 }, bottom = { y = 0 }",
        ),
        piece(
            "nw",
            [0, 1],
            10,
            2,
            "left = { x = 0 }, top = { y = \"-0.01 + 0.03*x\" }",
        ),
        piece(
            "ne",
            [1, 1],
            9,
            3,
            "right = { x = \"-0.005*(y - 1)\" }, top = { y = \"-0.02 + 0.01*x\" }",
        ),
    ];
    HardCase {
        point: None,
        name: "flow123d-1381-crossing",
        title: "two fractures that cross, closed in part (flow123d#1381)".into(),
        text: format!(
            "physics = \"elasticity\"\n[interface]\ndefault = \"contact\"\n{}",
            pieces.concat()
        ),
        force: None,
    }
}
