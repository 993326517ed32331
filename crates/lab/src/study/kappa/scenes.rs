//! Scenes of contact with friction that stand without it, too, of several sizes.

use super::friction::ContactLaw;
use std::fmt::Write;

/// A scene that differs in size and in the law of its contacts.
#[derive(Debug, Clone, Copy)]
pub struct FrictionScene {
    /// Name in tables.
    pub name: &'static str,
    /// Values of H_s/h.
    pub sizes: &'static [usize],
    /// Number of these with `--quick`.
    pub quick: usize,
    /// The coefficient of friction.
    pub coefficient: f64,
    /// The text without its contacts, for H_s/h.
    bodies: fn(usize) -> String,
    /// Each contact without the keys of its law.
    contacts: &'static [&'static str],
}

const GROUND: &str = "[[obstacle]]\nbody = \"all\"\nside = \"bottom\"\ndistance = 0.1\n\
                      plane = { point = [0.0, 0.0], normal = [0.0, 1.0] }\n";

/// The scenes of the study.
pub const SCENES: [FrictionScene; 3] = [
    FrictionScene {
        name: "blocks-2d",
        sizes: &[2, 4, 8],
        quick: 2,
        coefficient: 0.05,
        bodies: blocks,
        contacts: &["[[contact]]\nbodies = [\"upper\", \"lower\"]\n"],
    },
    FrictionScene {
        name: "bricks-2d",
        sizes: &[2, 4, 8],
        quick: 1,
        coefficient: 0.1,
        bodies: bricks,
        contacts: &["[[contact]]\nbodies = \"all\"\n", GROUND],
    },
    FrictionScene {
        name: "push-3d",
        sizes: &[2, 3, 4],
        quick: 1,
        coefficient: 0.25,
        bodies: push,
        contacts: &["[[obstacle]]\nbody = \"block\"\nside = \"bottom\"\n\
                     plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }\n"],
    },
];

/// The scene with H_s/h = `elements` and a law.
pub fn text(scene: &FrictionScene, elements: usize, law: ContactLaw) -> String {
    let mut out = (scene.bodies)(elements);
    for contact in scene.contacts {
        out += contact;
        out += &law.keys(scene.coefficient);
    }
    out
}

/// Two blocks, the upper one pressed and pushed, with its left end held in the direction of the push.
fn blocks(n: usize) -> String {
    format!(
        "dimension = 2\nphysics = \"elasticity\"\n\
         [[body]]\nname = \"lower\"\norigin = [0.0, 0.0]\nsize = [2.0, 1.0]\nelements = [{}, {}]\n\
         subdomains = [4, 2]\nyoung = 1.0\npoisson = 0.3\ndirichlet = {{ bottom = 0 }}\n\
         [[body]]\nname = \"upper\"\norigin = [0.5, 1.0]\nsize = [1.0, 1.0]\nelements = [{}, {}]\n\
         subdomains = [2, 2]\nyoung = 2.0\npoisson = 0.2\ntraction = {{ top = [0.03, -0.1] }}\n\
         dirichlet = {{ left = {{ x = 0 }} }}\n",
        4 * n,
        2 * n,
        2 * n,
        2 * n
    )
}

/// Three courses of bricks, pressed from above, and the one in the middle from the left; a buttress holds their
/// right ends.
fn bricks(n: usize) -> String {
    let mut out = String::from("dimension = 2\nphysics = \"elasticity\"\n");
    for course in 0..3 {
        let ends: &[usize] = if course % 2 == 0 {
            &[0, 2, 4, 6]
        } else {
            &[0, 1, 3, 5, 6]
        };
        for (k, end) in ends.windows(2).enumerate() {
            let width = end[1] - end[0];
            let _ = write!(
                out,
                "[[body]]\nname = \"b{course}{k}\"\norigin = [{}.0, {course}.0]\nsize = [{width}.0, 1.0]\n\
                 elements = [{}, {n}]\nsubdomains = [{width}, 1]\nyoung = 1.0\npoisson = 0.2\nload = [0, -0.01]\n",
                end[0],
                width * n,
            );
            if course == 2 {
                out += "traction = { top = [0.0, -0.05] }\n";
            }
            if end[0] == 0 && course == 1 {
                out += "pressure = { left = 0.1 }\n";
            }
            if end[1] == 6 {
                out += "dirichlet = { right = { x = 0 } }\n";
            }
        }
    }
    out
}

/// A block on the ground, pressed and pushed, with two of its sides held in their normal direction.
fn push(n: usize) -> String {
    format!(
        "dimension = 3\nphysics = \"elasticity\"\n\
         [[body]]\nname = \"block\"\norigin = [0, 0, 0]\nsize = [1.0, 1.0, 1.0]\nelements = [{}, {}, {}]\n\
         subdomains = [2, 2, 2]\nyoung = 1.0\npoisson = 0.3\ntraction = {{ top = [0.015, -0.1, 0.01] }}\n\
         dirichlet = {{ left = {{ x = 0 }}, back = {{ z = 0 }} }}\n",
        2 * n,
        2 * n,
        2 * n
    )
}
