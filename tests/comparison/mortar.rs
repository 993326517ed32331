//! `fetifeti compare` on contact between sides whose nodes do not match: the loop on the assembled problem changes
//! variables, and must find the set and the solution of the loop on the multipliers, and of a quadratic programme.

use crate::support::assembled::Assembled;
use crate::support::compared::{solved, SceneFile};
use crate::support::mpi::Scratch;
use crate::support::sample::sample;
use crate::support::surface_mesh;
use scene::Scene;

const RTOL: f64 = 1e-8;

/// A plate on another one, with a gap that opens to one side.
fn plates(order: usize) -> String {
    format!(
        "physics = \"elasticity\"\norder = {order}\n[[body]]\nname = \"low\"\nsize = [2, 1]\nelements = [6, 4]\n\
         subdomains = [3, 2]\nyoung = 100\npoisson = 0.3\ndirichlet = [\"bottom\"]\n\
         [[body]]\nname = \"up\"\norigin = [0, 1]\nsize = [2, 1]\nelements = [10, 4]\nsubdomains = [2, 2]\n\
         young = 300\npoisson = 0.3\ndirichlet = {{ left = {{ x = 0 }} }}\ntraction = {{ top = [0.1, -1] }}\n\
         [[contact]]\nbodies = [\"low\", \"up\"]\ngap = \"0.02*x\"\nmultipliers = \"up\"\n"
    )
}

/// A bulged block on another one, on which a third one is tied.
fn blocks() -> String {
    let body = |name: &str, y: f64, elements: [usize; 3], keys: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [0, {y}, 0]\nsize = [2, 1, 2]\nelements = {elements:?}\n\
             subdomains = [2, 1, 1]\npoisson = 0.3\n{keys}\n"
        )
    };
    let held = "dirichlet = { left = { x = 0 }, back = { z = 0 } }";
    let bulge = "shape = { y = \"y + 0.02*(x^2 + z^2)*(2 - y)\" }";
    "dimension = 3\nphysics = \"elasticity\"\n".to_string()
        + &body(
            "low",
            0.0,
            [4, 2, 4],
            "young = 100\ndirichlet = [\"bottom\"]",
        )
        + &body(
            "up",
            1.0,
            [6, 2, 5],
            &format!("young = 200\n{held}\n{bulge}"),
        )
        + &body(
            "cover",
            2.0,
            [4, 2, 3],
            "young = 50\ntraction = { top = [0, -2, 0] }",
        )
        + "[[tie]]\nbodies = [\"up\", \"cover\"]\n\
           [[contact]]\nbodies = [\"up\", \"low\"]\nsides = [\"bottom\", \"top\"]\n"
}

/// A block that a rigid die of a mesh is pressed into.
fn die() -> String {
    let mesh = concat!(env!("FETIFETI_ROOT"), "/examples/scenes/die.msh");
    format!(
        "physics = \"elasticity\"\n[[body]]\nname = \"block\"\norigin = [0, 0.06]\nsize = [2, 1]\n\
         elements = [20, 10]\nsubdomains = [4, 2]\nyoung = 10\npoisson = 0.4\ndirichlet = {{ top = 0 }}\n\
         [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\nsurface = \"die\"\nmesh = \"{mesh}\"\n\
         move = [0, 0.12]\n"
    )
}

/// A block in space on a rigid floor of triangles and quadrilaterals, in the file `mesh`.
fn floored(mesh: &str) -> String {
    format!(
        "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"block\"\norigin = [0, 0.02, 0]\n\
         size = [2, 1, 2]\nelements = [6, 3, 4]\nsubdomains = [2, 1, 1]\nyoung = 10\n\
         dirichlet = {{ left = {{ x = 0 }}, back = {{ z = 0 }} }}\ntraction = {{ top = [0.1, \"-1.5 + x\", 0] }}\n\
         [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\ngap = \"0.01*x^2\"\nsurface = \"floor\"\n\
         mesh = \"{mesh}\"\n"
    )
}

#[test]
fn all_methods_agree_where_nodes_do_not_match() {
    let scratch = Scratch::new("compare-floor");
    let floor = scratch.file("floor.msh", &surface_mesh::floor("floor"));
    let cases = [
        ("plates", plates(1)),
        ("plates-2", plates(2)),
        ("blocks", blocks()),
        ("die", die()),
        ("floor", floored(&floor)),
    ];
    for (name, text) in sample(3, cases) {
        let file = SceneFile::new(name, &text);
        // PCBDDC and KSPFETIDP start a rank for each subdomain, which takes seconds.
        let with: &[&str] = match name {
            "plates" => &[],
            _ => &["--with", "gamg,hypre,mumps"],
        };
        let report = file.compare(&[with, &["-fetifeti_ksp_rtol", "1e-8"]].concat());
        let scene = Scene::parse("s.toml", &text).expect("a scene");
        let programme = Assembled::of_scene(&scene).solve();
        let reference = report.facts.contact.expect("inequalities");
        let active = reference.active.expect("a direct solution");
        assert_eq!(active, programme.closed.len(), "{name}");
        assert!(0 < active && active < reference.rows, "{name}: {active}");
        assert!(reference.feasibility.expect("a direct solution") < 1e-13);
        assert!(reference.min_multiplier.expect("a direct solution") > -1e-13);
        assert!(report.facts.reference_residual.expect("a direct solution") < 1e-11);
        for r in report.rows.iter().filter(|r| solved(r)) {
            let what = format!("{name}, {} on {} ranks: {r:?}", r.run.method, r.run.ranks);
            assert!(r.run.residual.expect("a residual") <= RTOL, "{what}");
            assert!(r.run.error.expect("an error") < 10.0 * RTOL, "{what}");
            let contact = r.run.contact.expect("what became of the inequalities");
            assert_eq!(contact.differ, Some(0), "{what}");
        }
    }
}
