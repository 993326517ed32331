//! The energy of given displacements: scenes, decks and steps say the same.

use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use serde_json::Value;

/// The energies that a solve reports: of a deck with several steps, step by step.
fn energies(scratch: &Scratch, ranks: usize, file: &str, steps: usize) -> Vec<f64> {
    let out = scratch.path("out");
    let run = run_fetifeti(
        ranks,
        &[
            "solve",
            file,
            "--quiet",
            "--out",
            &out,
            "-fetifeti_ksp_rtol",
            "1e-11",
        ],
    );
    assert_eq!(run.code, 0, "{}", run.all());
    let of = |place: String| {
        let text = std::fs::read_to_string(place).expect("a report");
        let report: Value = serde_json::from_str(&text).expect("JSON");
        report["energy"].as_f64().expect("a number")
    };
    match steps {
        1 => vec![of(format!("{out}/report.json"))],
        n => (1..=n)
            .map(|k| of(format!("{out}/step{k}/report.json")))
            .collect(),
    }
}

fn near(found: &[f64], wanted: &[f64]) {
    for (a, b) in found.iter().zip(wanted) {
        assert!(
            (a - b).abs() < 1e-9 * b.abs().max(1.0),
            "{found:?}, not {wanted:?}"
        );
    }
    assert_eq!(found.len(), wanted.len());
}

const CUBE: &str = "*NODE, NSET=NALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n\
                    7, 1, 1, 1\n8, 0, 1, 1\n*ELEMENT, TYPE=C3D8, ELSET=A\n1, 1,2,3,4,5,6,7,8\n*MATERIAL, NAME=M\n\
                    *ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=A, MATERIAL=M\n*NSET, NSET=B\n1,2,3,4\n\
                    *NSET, NSET=T\n5,6,7,8\n";

/// ½ E A u²/L.
#[test]
fn a_deck_has_the_energy_of_its_given_displacements() {
    let scratch = Scratch::new("case-energy");
    for ranks in [1, 2] {
        let file = "../../tests/data/cases/03_energy_of_given_displacement.inp";
        near(&energies(&scratch, ranks, file, 1), &[5.0]);
    }
    // The same mesh in a scene.
    scratch.file("cube.inp", CUBE);
    let scene = "dimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"cube.inp\"\n[[body]]\nname = \"A\"\n\
                 young = 1000\npoisson = 0\ndirichlet = { B = 0, T = { z = 0.1 } }\n";
    let scene = scratch.file("cube.toml", scene);
    near(&energies(&scratch, 1, &scene, 1), &[5.0]);
}

/// Steps with other values, by amplitudes, forces besides, turned systems and equations.
#[test]
fn every_step_of_a_deck_has_its_energy() {
    let scratch = Scratch::new("case-energy-steps");
    // Stretched by 0.1, then by 0.2; then a force of 4 × 25 at held nodes, which works by 0.2; then half of it.
    let steps = "*AMPLITUDE, NAME=HALF\n0., 0., 1., 0.5\n*STEP\n*STATIC\n*BOUNDARY\nB, 1, 3\nT, 3, 3, 0.1\n*END STEP\n\
                 *STEP\n*STATIC\n*BOUNDARY\nT, 3, 3, 0.2\n*END STEP\n\
                 *STEP\n*STATIC\n*CLOAD\nT, 3, 25.\n*END STEP\n\
                 *STEP\n*STATIC\n*CLOAD, OP=NEW\n*BOUNDARY, OP=NEW\nB, 1, 3\n\
                 *BOUNDARY, AMPLITUDE=HALF\nT, 3, 3, 0.2\n*END STEP\n";
    let deck = scratch.file("steps.inp", &format!("{CUBE}{steps}"));
    near(&energies(&scratch, 1, &deck, 4), &[5.0, 20.0, 0.0, 5.0]);
    // In a turned system: the top moves along x + y, as equations, and is free across.
    let turned = "*TRANSFORM, NSET=NALL\n1., 1., 0., -1., 1., 0.\n*STEP\n*STATIC\n*BOUNDARY\nB, 1, 3\nT, 1, 1, 0.1\n\
                  T, 2, 2\n*END STEP\n";
    let deck = scratch.file("turned.inp", &format!("{CUBE}{turned}"));
    let straight = "*STEP\n*STATIC\n*BOUNDARY\nB, 1, 3\nT, 1, 2, 0.0707106781186548\n*END STEP\n";
    let like = scratch.file("straight.inp", &format!("{CUBE}{straight}"));
    let wanted = energies(&scratch, 1, &like, 1);
    assert!(wanted[0] > 1.0, "{wanted:?}");
    near(&energies(&scratch, 1, &deck, 1), &wanted);
    // An equation with a node that is given: node 5 is lifted, 6, 7 and 8 follow.
    let follow = "*EQUATION\n2\n6, 3, 1., 5, 3, -1.\n*EQUATION\n2\n7, 3, 1., 5, 3, -1.\n\
                  *EQUATION\n2\n8, 3, 1., 5, 3, -1.\n\
                  *STEP\n*STATIC\n*BOUNDARY\nB, 1, 3\n5, 3, 3, 0.1\n*END STEP\n";
    let deck = scratch.file("follow.inp", &format!("{CUBE}{follow}"));
    near(&energies(&scratch, 1, &deck, 1), &[5.0]);
}

/// Load steps of a scene, and a body that is tied to given values of another one.
#[test]
fn load_steps_and_tied_bodies_have_the_energy_of_given_values() {
    let scratch = Scratch::new("case-energy-scene");
    let scene = "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"a\"\nsize = [1, 1, 1]\n\
                 elements = [2, 2, 2]\n\
                 subdomains = [2, 1, 1]\nyoung = 1000\npoisson = 0\n\
                 dirichlet = { back = 0, front = { z = 0.1 } }\n[steps]\ntimes = [0.5, 1]\ndirichlet = \"t\"\n";
    let scene = scratch.file("steps.toml", scene);
    let out = scratch.path("steps");
    let args = [
        "solve",
        &scene,
        "--quiet",
        "--out",
        &out,
        "-fetifeti_ksp_rtol",
        "1e-11",
    ];
    let run = run_fetifeti(1, &args);
    assert_eq!(run.code, 0, "{}", run.all());
    let text = std::fs::read_to_string(format!("{out}/report.json")).expect("a report");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    near(&[report["energy"].as_f64().expect("a number")], &[5.0]);
    // Two cubes, tied where both have nodes with given values: those of the second follow from the first.
    let tied = "dimension = 2\nphysics = \"elasticity\"\nplane = \"stress\"\n[[body]]\nname = \"a\"\nsize = [1, 1]\n\
                elements = [2, 2]\nyoung = 1000\npoisson = 0\ndirichlet = { left = 0, right = { x = 0.1, y = 0 } }\n\
                [[body]]\nname = \"b\"\norigin = [1, 0]\nsize = [1, 1]\nelements = [2, 2]\nyoung = 1000\npoisson = 0\n\
                dirichlet = { right = 0 }\n";
    let tied = scratch.file("tied.toml", tied);
    for ranks in [1, 2] {
        near(&energies(&scratch, ranks, &tied, 1), &[10.0]);
    }
}
