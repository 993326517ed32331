//! Files of meshes under the names, and with the names, that other programs write.

use crate::support::checks::number;
use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use serde_json::Value;
use std::fs;

const SCENE: &str = "../../tests/data/cases/13_extension.toml";
const MESH: &str = "../../tests/data/cases/13_extension.msh2";

/// The energy that `solve` reports of a scene.
fn energy(ranks: usize, scene: &str) -> f64 {
    let rtol = ["-fetifeti_ksp_rtol", "1e-11"];
    let args = [&["solve", scene, "--quiet", "--json", "-"], &rtol[..]].concat();
    let out = run_fetifeti(ranks, &args);
    assert_eq!(out.code, 0, "{}", out.all());
    let report: Value = serde_json::from_str(&out.stdout).expect("JSON");
    number(&report["energy"])
}

/// A unit cube of one element under its own weight: its mean strain is ½, the energy −½ (½)².
const CUBE: f64 = -0.125;

/// Gmsh writes name.msh2 or name.msh41 where it is told the format; what is in the file says which it is.
#[test]
fn the_ending_of_a_mesh_may_name_its_format() {
    for ranks in [1, 2] {
        let found = energy(ranks, SCENE);
        assert!((found - CUBE).abs() < 1e-9, "{found}");
    }
    let scratch = Scratch::new("cases_extension");
    let (scene, mesh) = (fs::read_to_string(SCENE), fs::read_to_string(MESH));
    let (scene, mesh) = (scene.expect(SCENE), mesh.expect(MESH));
    for name in ["m.msh", "m.msh4", "m.MSH41", "m.msh22"] {
        scratch.file(name, &mesh);
        let text = scene.replace("13_extension.msh2", name);
        let found = energy(1, &scratch.file("s.toml", &text));
        assert!((found - CUBE).abs() < 1e-9, "{name}: {found}");
    }
    // An obstacle's own mesh.
    scratch.file("die.msh2", &mesh);
    let text = format!(
        "{scene}\n[[obstacle]]\nbody = \"A\"\nside = \"all\"\nsurface = \"foot\"\nmesh = \"die.msh2\"\n\
         reverse = true\ndistance = 0.5\n"
    )
    .replace("13_extension.msh2", "m.msh")
    .replace("dirichlet = { foot = 0 }", "dirichlet = { foot = { x = 0, y = 0 } }");
    let found = energy(1, &scratch.file("die.toml", &text));
    assert!((found - CUBE).abs() < 1e-6, "{found}");
    let other = scene.replace("13_extension.msh2", "m.mshx");
    let path = scratch.file("other.toml", &other);
    let out = run_fetifeti(1, &["solve", &path]);
    assert_eq!(out.code, 2);
    assert!(
        out.stderr.contains("m.mshx: a mesh of Gmsh (.msh)"),
        "{}",
        out.stderr
    );
}

/// Neper writes physical names without quotes.
#[test]
fn physical_names_need_no_quotes() {
    let scratch = Scratch::new("cases_quotes");
    let (scene, mesh) = (fs::read_to_string(SCENE), fs::read_to_string(MESH));
    let (scene, mesh) = (scene.expect(SCENE), mesh.expect(MESH));
    scratch.file("m.msh", &mesh.replace('"', ""));
    let text = scene.replace("13_extension.msh2", "m.msh");
    let path = scratch.file("s.toml", &text);
    let found = energy(1, &path);
    assert!((found - CUBE).abs() < 1e-9, "{found}");
}

/// What does not exist is named together with what does.
#[test]
fn a_side_that_does_not_exist_lists_those_that_do() {
    let scratch = Scratch::new("cases_sides");
    let mesh = fs::read_to_string(MESH).expect(MESH);
    scratch.file("m.msh", &mesh);
    let scene = fs::read_to_string(SCENE).expect(SCENE);
    let scene = scene.replace("13_extension.msh2", "m.msh");
    let plane = "plane = { point = [0, 0, -1], normal = [0, 0, 1] }";
    let mixed = "[[body]]\nname = \"box\"\norigin = [4, 0, 0]\nsize = [1, 1, 1]\nelements = 1\n";
    let tries = [
        (
            "[[obstacle]]\nbody = \"A\"\nside = \"top\"",
            "s.toml:14: the side `top`, which body `A` does not have (sides are `foot`, `all`)",
        ),
        (
            "[[obstacle]]\nbody = \"A\"\nside = [\"foot\", \"top\"]",
            "s.toml:14: the side `top`, which body `A` does not have (sides are `foot`, `all`)",
        ),
        (
            "[[obstacle]]\nbody = \"B\"\nside = \"foot\"",
            "s.toml:12: an obstacle names body `B`, which the scene does not have (bodies are `A`)",
        ),
        (
            &format!("{mixed}[[obstacle]]\nbody = \"all\"\nside = \"middle\""),
            "the side `middle`, which no such body has (sides are `foot`, `all`, `left`, `right`, `bottom`, `top`, \
             `back`, `front`)",
        ),
    ];
    for (entry, sentence) in tries {
        let path = scratch.file("s.toml", &format!("{scene}\n{entry}\n{plane}\n"));
        let out = run_fetifeti(1, &["plan", &path]);
        assert_eq!(out.code, 2, "{}", out.all());
        assert!(out.stderr.contains(sentence), "{}", out.stderr);
    }
    let contact = "[[contact]]\nsurfaces = [\"foot\", \"head\"]\n";
    let path = scratch.file("c.toml", &format!("{scene}\n{contact}"));
    let out = run_fetifeti(1, &["plan", &path]);
    let sentence =
        "the boundary group `head`, which no body of the mesh has (groups are `foot`, `all`)";
    assert!(out.stderr.contains(sentence), "{}", out.stderr);
}
