//! Bodies near the limit of their friction, where all nodes slip and the turn of their forces holds them.

use crate::friction::near;
use crate::support::{mpi, program};
use mpi::Scratch;
use program::run_fetifeti;
use serde_json::Value;

/// A block on another one in space, pulled along x and by `aside` of that along z, by the three strategies: the limit
/// of the pull is 0.03 of friction.
fn blocks(pull: f64, aside: f64) -> String {
    format!(
        "dimension = 3\nphysics = \"elasticity\"\n[interface]\ndefault = \"free\"\n\
         [[body]]\nname = \"base\"\nsize = [4, 1, 1]\nelements = [8, 2, 2]\nyoung = 10\npoisson = 0.3\n\
         dirichlet = [\"bottom\"]\n\
         [[body]]\nname = \"block\"\norigin = [1, 1, 0]\nsize = [2, 1, 1]\nelements = [4, 2, 2]\nyoung = 1\n\
         poisson = 0.3\nload = [{pull}, -0.1, {}]\n\
         [[contact]]\nbodies = [\"base\", \"block\"]\nfriction = 0.3\n",
        aside * pull
    )
}

const STRATEGIES: [&str; 3] = ["active_set", "augmented_lagrangian", "smalbe"];

/// All nodes slip. No row holds the block, and yet its place is known: slips are along forces. The peers of `compare`
/// find the same place by an assembled matrix, and the strategies of the method do by themselves.
#[test]
fn a_block_near_its_limit_has_its_place() {
    let scratch = Scratch::new("friction-limit");
    for pull in [0.029, 0.0299, 0.02999] {
        let scene = scratch.file("scene.toml", &blocks(pull, 0.0));
        let mut energies = Vec::new();
        for (strategy, ranks) in STRATEGIES.into_iter().flat_map(|s| [(s, 1), (s, 2)]) {
            let more = ["-fetifeti_contact_type", strategy];
            let found = run_fetifeti(
                ranks,
                &[&["solve", &scene, "--json", "-"][..], &more].concat(),
            );
            assert_eq!(found.code, 0, "{pull} {strategy}: {}", found.all());
            let report: Value = serde_json::from_str(&found.stdout).expect("JSON");
            assert!(report.get("free_motions").is_none(), "{strategy}: {report}");
            energies.push(report["energy"].as_f64().expect("a number"));
        }
        // Slips grow as 1/(0.03 − p)^½, and digits of the energy are lost by as much.
        energies
            .iter()
            .for_each(|e| near(*e, energies[0], 2e-5 * energies[0].abs(), "energy"));
    }
    let scene = scratch.file("scene.toml", &blocks(0.0295, 0.1));
    let beside = run_fetifeti(1, &["compare", &scene, "--with", "mumps", "--json", "-"]);
    assert_eq!(beside.code, 0, "{}", beside.all());
    let report: Value = serde_json::from_str(&beside.stdout).expect("JSON");
    for run in report["rows"].as_array().expect("rows") {
        let of = |key: &str| run["contact"][key].as_f64().expect("a number");
        assert!(of("forces") < 1e-5 && of("law") < 1e-5, "{run}");
    }
}

/// Beyond the limit forces of friction cannot balance the load. The error names the block, and how it slides. It is the
/// same sentence by all strategies, on all ranks, and however matrices are stored: it follows from rigid motions alone.
#[test]
fn a_block_beyond_its_limit_slides_along_its_load() {
    let scratch = Scratch::new("friction-beyond");
    for pull in [0.030001, 0.0301, 0.05] {
        let scene = scratch.file("scene.toml", &blocks(pull, 0.0));
        slides(&scene, "block");
    }
}

/// One of many blocks slides: too many for the question before the loop.
#[test]
fn one_of_many_blocks_slides_along_its_load() {
    let scratch = Scratch::new("friction-of-many");
    let mut text = "dimension = 3\nphysics = \"elasticity\"\n".to_string();
    for k in 0..26 {
        let pull = if k == 17 { 0.0301 } else { 0.02 };
        text += &format!(
            "[[body]]\nname = \"block{k}\"\norigin = [0, 0, {}]\nsize = [2, 1, 1]\nelements = [2, 1, 1]\n\
             young = 1\npoisson = 0.3\nload = [{pull}, -0.1, 0]\n\
             [[obstacle]]\nbody = \"block{k}\"\nside = \"bottom\"\nfriction = 0.3\n\
             plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\n",
            2 * k
        );
    }
    slides(&scratch.file("scene.toml", &text), "block17");
}

/// All strategies say with one voice that the block slides along x.
fn slides(scene: &str, block: &str) {
    let ways = ["implicit", "explicit"];
    let mut said: Vec<String> = Vec::new();
    for (strategy, way) in STRATEGIES.iter().flat_map(|s| ways.map(|w| (s, w))) {
        let ranks = if way == "implicit" { 1 } else { 3 };
        let more = [
            "-fetifeti_contact_type",
            strategy,
            "-fetifeti_operators",
            way,
        ];
        let found = run_fetifeti(ranks, &[&["solve", scene][..], &more].concat());
        let text = found.all();
        assert_eq!(found.code, 2, "{strategy} {way}: {text}");
        let sentence = text.lines().find(|line| line.contains("pushed away"));
        let sentence = sentence.unwrap_or_else(|| panic!("{strategy} {way}: {text}"));
        assert!(
            sentence.contains(&format!("\"{block}\"")) && sentence.contains("slides along x"),
            "{strategy} {way}: {text}"
        );
        said.push(sentence.to_string());
    }
    assert!(said.iter().all(|s| *s == said[0]), "{said:#?}");
}
