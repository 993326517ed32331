//! The scenes of the benchmark, as text in the format of scene files, with their meshes.

use std::path::{Path, PathBuf};

use super::unstructured;
use base::Result;
use mesh::{gmsh, MeshFile};
use report::output;

/// A scene with a name.
#[derive(Debug)]
pub struct NamedScene {
    /// Its name.
    pub name: &'static str,
    /// A description in one line.
    pub description: &'static str,
    /// The scene, and a smaller one for `--quick`.
    scene: fn(quick: bool) -> String,
    /// The mesh that the scene names, if it names one.
    mesh: Option<fn(quick: bool) -> MeshFile>,
}

impl NamedScene {
    /// The case of this name.
    pub fn find(name: &str) -> Option<&'static NamedScene> {
        CASES.iter().find(|c| c.name == name)
    }

    /// Writes the scene file, and the mesh beside it. Returns the path of the scene and the names of all files.
    ///
    /// # Errors
    /// [`ErrorKind::Environment`](base::ErrorKind::Environment) if they cannot be written.
    pub fn write(&self, dir: &Path, quick: bool) -> Result<(PathBuf, Vec<String>)> {
        let mut names = vec![format!("{}.toml", self.name)];
        let file = dir.join(&names[0]);
        let mut text = (self.scene)(quick);
        if let Some(mesh) = self.mesh {
            let mesh = mesh(quick);
            // Cases that stand in one directory have meshes of their own.
            let name = format!("{}.msh", self.name);
            text = text.replace(&mesh.name, &name);
            let bytes = gmsh::write(&mesh);
            output::write_file(&dir.join(&name), |out| out.write_all(&bytes))?;
            names.push(name);
        }
        output::write_text(&file, &text)?;
        Ok((file, names))
    }
}

/// All cases, in the order in which they are run.
pub const CASES: [NamedScene; 17] = [
    NamedScene {
        name: "poisson-1024",
        description: "tied Poisson problem in the plane, 1024 x 1024 elements, equal subdomains (quick: 128 x 128)",
        scene: |quick| poisson(quick, false),
        mesh: None,
    },
    NamedScene {
        name: "poisson-1024-random",
        description: "the same with every node moved and rho random by element: \
                      no two subdomains are equal (quick: 128 x 128)",
        scene: |quick| poisson(quick, true),
        mesh: None,
    },
    NamedScene {
        name: "contact-512",
        description: "model contact problem, 2 bodies of 512 x 512 elements, one of them floating (quick: 64 x 64)",
        scene: contact,
        mesh: None,
    },
    NamedScene {
        name: "cube-24",
        description: "tied elastic cube, 24 x 24 x 24 elements (quick: 12 x 12 x 12)",
        scene: |quick| cube(if quick { 12 } else { 24 }),
        mesh: None,
    },
    NamedScene {
        name: "cube-40",
        description: "tied elastic cube, 40 x 40 x 40 elements (quick: 20 x 20 x 20)",
        scene: |quick| cube(if quick { 20 } else { 40 }),
        mesh: None,
    },
    NamedScene {
        name: "cube-contact-24",
        description: "two elastic blocks in contact, 24 x 24 x 24 elements together (quick: 12 x 12 x 12)",
        scene: cube_contact,
        mesh: None,
    },
    NamedScene {
        name: "holes",
        description: "Poisson problem on a plate with 25 holes, a million triangles' corners (quick: 20,000)",
        scene: |quick| unstructured::plate(quick, false),
        mesh: Some(|quick| unstructured::plate_mesh(quick, false)),
    },
    NamedScene {
        name: "plate",
        description: "elastic plate with 25 holes, triangles, a million unknowns (quick: 20,000)",
        scene: |quick| unstructured::plate(quick, true),
        mesh: Some(|quick| unstructured::plate_mesh(quick, true)),
    },
    NamedScene {
        name: "rod-4",
        description: "connecting rod, tied to cap, journal and pin, tetrahedra of 4 nodes, 300,000 unknowns \
                      (quick: 20,000)",
        scene: |_| unstructured::rod(None, false),
        mesh: Some(|quick| unstructured::rod_mesh(quick, false)),
    },
    NamedScene {
        name: "rod-10",
        description: "the same of tetrahedra of 10 nodes",
        scene: |_| unstructured::rod(None, true),
        mesh: Some(|quick| unstructured::rod_mesh(quick, true)),
    },
    NamedScene {
        name: "rod-contact-4",
        description: "connecting rod, tied to its cap, in contact with journal and pin, tetrahedra of 4 nodes",
        scene: |_| unstructured::rod(Some(0.0), false),
        mesh: Some(|quick| unstructured::rod_mesh(quick, false)),
    },
    NamedScene {
        name: "rod-contact-4-friction",
        description: "rod-contact-4 with friction, 0.2",
        scene: |_| unstructured::rod(Some(0.2), false),
        mesh: Some(|quick| unstructured::rod_mesh(quick, false)),
    },
    NamedScene {
        name: "rod-contact-10",
        description: "the same of tetrahedra of 10 nodes",
        scene: |_| unstructured::rod(Some(0.0), true),
        mesh: Some(|quick| unstructured::rod_mesh(quick, true)),
    },
    NamedScene {
        name: "blocks-contact-4",
        description: "two blocks in contact, meshes that match, tetrahedra of 4 nodes, 300,000 unknowns \
                      (quick: 20,000)",
        scene: |_| unstructured::blocks(false),
        mesh: Some(|quick| unstructured::blocks_mesh(quick, false)),
    },
    NamedScene {
        name: "blocks-contact-4-mortar",
        description: "the same with edges in the ratio 2:3 across the contact: mortar rows",
        scene: |_| unstructured::blocks(true),
        mesh: Some(|quick| unstructured::blocks_mesh(quick, true)),
    },
    NamedScene {
        name: "bodies-contact-512",
        description: "8 x 8 x 8 elastic blocks, all faces in contact, 33,000 candidates, 192,000 unknowns \
                      (quick: 3 x 3 x 3)",
        scene: |quick| bodies(if quick { 3 } else { 8 }),
        mesh: None,
    },
    NamedScene {
        name: "bodies-contact-4096",
        description: "16 x 16 x 16 of them, 287,000 candidates, 1.5 million unknowns (quick: 4 x 4 x 4)",
        scene: |quick| bodies(if quick { 4 } else { 16 }),
        mesh: None,
    },
];

/// 4 × 4 bodies of 4 × 4 subdomains of 64 × 64 elements; small: 2 × 2 of 2 × 2 of 32 × 32. The load has no symmetry:
/// with one, decompositions into two or four parts need no iteration.
fn poisson(quick: bool, random: bool) -> String {
    let (bodies, elements) = if quick { (2, 32) } else { (4, 64) };
    let n = bodies * bodies * elements;
    let title = if random { ", nothing equal" } else { "" };
    let mut text = format!(
        "title = \"Poisson, {n} x {n} elements{title}\"\n\n[grid]\nbodies = {bodies}\nsubdomains = {bodies}\n\
         elements_per_subdomain = {elements}\nload = \"1 + x + y^2\"\ndirichlet = \"all\"\n"
    );
    if random {
        // Numbers without a pattern: the fraction of a large multiple of a sine. Coordinates are binary fractions, so
        // that bodies compute the same numbers on common faces. Inner nodes move by up to a fifth of an element in x
        // and in y; ρ is from 0.1 to 10, its logarithm spread evenly.
        let draw = |a: &str, b: &str, c: &str| {
            format!("mod(43758.5453*sin({a}*{n}*x + {b}*{n}*y + {c}), 1)")
        };
        let inside = "(x > 0)*(x < 1)*(y > 0)*(y < 1)";
        let step = 0.4 / n as f64;
        let moved = |v: &str, draw: &str| format!("{v} + {step:e}*{inside}*({draw} - 0.5)");
        text += &format!(
            "rho = \"10^(2*{} - 1)\"\nshape = {{ x = \"{}\", y = \"{}\" }}\n",
            draw("12.9898", "78.233", "0.5"),
            moved("x", &draw("39.3461", "11.1351", "1.5")),
            moved("y", &draw("73.1568", "52.2353", "2.5")),
        );
    }
    text
}

/// The model problem of examples/scenes/model_contact.toml, each body of 8 × 8 subdomains of 64 × 64 elements; small: 2
/// × 2 of 32 × 32.
fn contact(quick: bool) -> String {
    let (subdomains, elements) = if quick { (2, 32) } else { (8, 64) };
    let n = subdomains * elements;
    let body = |name: &str, x: usize, rest: &str| {
        format!(
            "\n[[body]]\nname = \"{name}\"\norigin = [{x}, 0]\nsize = [1, 1]\nsubdomains = {subdomains}\n\
             elements_per_subdomain = {elements}\n{rest}"
        )
    };
    format!(
        "title = \"Model contact problem, 2 x {n} x {n} elements\"\n{}{}\n\
         [[contact]]\nbodies = [\"left\", \"right\"]\ngap = 0\n",
        body(
            "left",
            0,
            "dirichlet = [\"left\"]\nload = [{ y = [0.75, 1], value = -3 }]\n"
        ),
        body("right", 1, "load = [{ y = [0, 0.25], value = -1 }]\n")
    )
}

/// A cube of `n`³ elements on the ground: two bodies, one on the other, in subdomains of 4³ or 5³ elements. The small
/// case has subdomains of 3³ or 5³ elements.
fn cube(n: usize) -> String {
    let across = match n {
        ..24 => 4,
        24 => 6,
        _ => 8,
    };
    let (bodies, elements) = ("[1, 2, 1]", n / across);
    let subdomains = format!("[{across}, {}, {across}]", across / 2);
    format!(
        "title = \"Elastic cube, {n} x {n} x {n} elements\"\ndimension = 3\n\
         physics = \"elasticity\"\n\n[grid]\nbodies = {bodies}\n\
         subdomains = {subdomains}\nelements_per_subdomain = {elements}\nyoung = 1\npoisson = 0.3\n\
         load = [\"0.3*y\", -1, 0.1]\ndirichlet = [\"bottom\"]\n"
    )
}

/// A block that is pressed on another one, with a gap that opens towards the far corner.
fn cube_contact(quick: bool) -> String {
    let (n, subdomains, elements) = if quick {
        (12, "[4, 2, 4]", 3)
    } else {
        (24, "[6, 3, 6]", 4)
    };
    let body = |name: &str, y: &str, young: usize, rest: &str| {
        format!(
            "\n[[body]]\nname = \"{name}\"\norigin = [0, {y}, 0]\nsize = [1, 0.5, 1]\nsubdomains = {subdomains}\n\
             elements_per_subdomain = {elements}\nyoung = {young}\npoisson = 0.3\n{rest}"
        )
    };
    format!(
        "title = \"Elastic blocks, {n} x {n} x {n} elements\"\ndimension = 3\nphysics = \"elasticity\"\n{}{}\n\
         [[contact]]\nbodies = [\"low\", \"high\"]\ngap = \"0.02*(x^2 + z^2)\"\n",
        body("low", "0", 100, "dirichlet = [\"bottom\"]\n"),
        body(
            "high",
            "0.5",
            200,
            "dirichlet = { left = { x = 0 }, back = { z = 0 } }\ntraction = { top = [0, -2, 0] }\n"
        )
    )
}

/// n³ elastic blocks of 4³ elements, all faces in contact. The box stands on its bottom between smooth walls, is loaded
/// in places at its top, and every block has a load of its own.
fn bodies(n: usize) -> String {
    let walls = "dirichlet = { bottom = 0, left = { x = 0 }, right = { x = 0 }, front = { z = 0 }, back = { z = 0 } }";
    format!(
        "title = \"{n} x {n} x {n} blocks in contact\"\ndimension = 3\nphysics = \"elasticity\"\n\n\
         [grid]\nbodies = [{n}, {n}, {n}]\nsize = [{n}, {n}, {n}]\nsubdomains = [1, 1, 1]\n\
         elements_per_subdomain = 4\nyoung = 1000\npoisson = 0.3\n\
         traction = {{ top = [0, \"-max(0, sin(2*x)*cos(1.5*z))\", 0] }}\n\
         load = [\"0.5*sin(1 + 1.7*bi + 2.3*bj + 3.1*bk)\", -0.05, \"0.5*cos(1 + 2.7*bi + 1.3*bj + 2.1*bk)\"]\n\
         {walls}\n\n[interface]\ndefault = \"contact\"\n"
    )
}

#[cfg(test)]
#[path = "../../../tests/baselines/bench/cases.rs"]
mod tests;
