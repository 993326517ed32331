//! The scenes of the benchmark on meshes in which nothing is equal.

use super::shapes;
use mesh::MeshFile;

/// Poisson's equation on a plate with holes; elastic, if `elastic`. About a million unknowns, or 20,000.
pub(super) fn plate(quick: bool, elastic: bool) -> String {
    let n = across(quick, elastic);
    let (title, physics, values) = if elastic {
        (
            "Plane stress",
            "physics = \"elasticity\"\nplane = \"stress\"\n",
            "young = 1\npoisson = 0.3\ndirichlet = { left = 0 }\ntraction = { right = [1, 0.1] }\n",
        )
    } else {
        (
            "Poisson's equation",
            "",
            "load = \"1 + x + y^2\"\ndirichlet = { left = 0, bottom = 0 }\n",
        )
    };
    format!(
        "title = \"{title} on a plate with holes, {n} nodes along a side\"\n{physics}\n\
         [mesh]\nfile = \"plate.msh\"\n\n[[body]]\nname = \"plate\"\n{values}"
    )
}

/// Its mesh.
pub(super) fn plate_mesh(quick: bool, elastic: bool) -> MeshFile {
    shapes::plate(across(quick, elastic))
}

fn across(quick: bool, elastic: bool) -> usize {
    match (quick, elastic) {
        (false, false) => 1000,
        (false, true) => 700,
        (true, false) => 140,
        (true, true) => 100,
    }
}

/// A connecting rod and its cap, tied to each other; tied to journal and pin too, or the rod in contact with them, with
/// this coefficient of friction. About 300,000 unknowns, or 20,000.
pub(super) fn rod(contact: Option<f64>, quadratic: bool) -> String {
    let title = match contact {
        None => "tied to",
        Some(0.0) => "in contact with",
        Some(_) => "in contact with friction with",
    };
    let nodes = if quadratic { 10 } else { 4 };
    let mut text = format!(
        "title = \"Connecting rod {title} journal and pin, tetrahedra of {nodes} nodes\"\n\
         dimension = 3\nphysics = \"elasticity\"\n\n[mesh]\nfile = \"rod.msh\"\n"
    );
    let steel = "young = 210e9\npoisson = 0.3\n";
    for (name, rest) in [
        ("rod", "dirichlet = { middle = { z = 0 } }"),
        ("cap", "dirichlet = { middle = { z = 0 } }"),
        ("journal", "dirichlet = { middle = { z = 0 }, journal_end = 0 }"),
        (
            "pin",
            "dirichlet = { middle = { z = 0 }, pin_end = { y = 0 } }\ntraction = { pin_end = [-2e7, 0, 0] }",
        ),
    ] {
        text += &format!("\n[[body]]\nname = \"{name}\"\n{steel}{rest}\n");
    }
    if let Some(friction) = contact {
        // The rod is pushed: its own half of the big eye presses on the journal. The cap stays free of it, because
        // other methods cannot have a node in two contacts.
        text +=
            "\n[interface]\ndefault = \"free\"\n\n[[tie]]\nsurfaces = [\"parting\", \"parting\"]\n";
        for other in ["journal", "pin"] {
            text += &format!("\n[[contact]]\nbodies = [\"rod\", \"{other}\"]\n");
            if friction > 0.0 {
                text += &format!("friction = {friction}\n");
            }
        }
    }
    text
}

/// Its mesh.
pub(super) fn rod_mesh(quick: bool, quadratic: bool) -> MeshFile {
    let edge = match (quick, quadratic) {
        (false, false) => 1.05e-3,
        (false, true) => 1.9e-3,
        (true, false) => 2.5e-3,
        (true, true) => 5e-3,
    };
    shapes::rod(edge, quadratic)
}

/// A block that is pressed on another one, with a gap that opens towards the far corner. About 300,000 unknowns, or
/// 20,000.
pub(super) fn blocks(mortar: bool) -> String {
    let title = if mortar {
        "edges in the ratio 2:3"
    } else {
        "meshes that match"
    };
    let body = |name: &str, young: usize, rest: &str| {
        format!("\n[[body]]\nname = \"{name}\"\nyoung = {young}\npoisson = 0.3\n{rest}\n")
    };
    format!(
        "title = \"Blocks in contact, {title}\"\ndimension = 3\nphysics = \"elasticity\"\n\n\
         [mesh]\nfile = \"blocks.msh\"\n{}{}\n\
         [[contact]]\nsurfaces = [\"low_face\", \"high_face\"]\ngap = \"0.02*(x^2 + y^2)\"\n",
        body("low", 100, "dirichlet = { bottom = 0 }"),
        body(
            "high",
            200,
            "dirichlet = { left = { x = 0 }, front = { y = 0 } }\ntraction = { top = [0, 0, -2] }"
        ),
    )
}

/// Their mesh. With edges in the ratio 2:3 there are about as many unknowns as with equal ones.
pub(super) fn blocks_mesh(quick: bool, mortar: bool) -> MeshFile {
    let edge = if quick { 1.0 / 18.0 } else { 1.0 / 43.0 };
    shapes::blocks(if mortar {
        [1.3 * edge, 1.3 * edge / 1.5]
    } else {
        [edge; 2]
    })
}
