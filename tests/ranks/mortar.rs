//! Sides whose nodes do not match: the answers on 1, 2, 4 and 7 ranks, in the sample on 1 and 7, are the direct
//! solution of the assembled problem. Among them are the cases that others report (`study hard-cases`).

use super::direct::{compare, solve, Answer};
use crate::support::mpi::{as_rank, Scratch};
use crate::support::sample::sample;
use lab::study::hard_cases::trackers;
use scene::Scene;

/// A strip on a stiff one, with a curved gap, with a block of many rows on the stiff or the soft side; two tied plates;
/// a plate on another one, with a gap that opens to one side; two blocks, of which one is bulged; two plates on a rigid
/// surface.
fn scenes() -> Vec<(&'static str, String)> {
    let plates = |joint: &str| {
        format!(
            "physics = \"elasticity\"\n[[body]]\nname = \"low\"\nsize = [2, 1]\nelements = [15, 8]\n\
             subdomains = [3, 2]\nyoung = 100\npoisson = 0.3\ndirichlet = [\"bottom\"]\n\
             [[body]]\nname = \"up\"\norigin = [0, 1]\n\
             size = [2, 1]\nelements = [20, 8]\nsubdomains = [4, 2]\nyoung = 300\n\
             poisson = 0.3\ndirichlet = {{ left = {{ x = 0 }} }}\n\
             traction = {{ top = [0.1, -1] }}\n{joint}"
        )
    };
    let blocks = "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"low\"\nsize = [2, 1, 2]\n\
        elements = [6, 3, 6]\nsubdomains = [2, 1, 2]\nyoung = 100\npoisson = 0.3\ndirichlet = [\"bottom\"]\n\
        [[body]]\nname = \"high\"\norigin = [0, 1, 0]\nshape = { y = \"y + 0.02*(x^2 + z^2)*(2 - y)\" }\n\
        size = [2, 1, 2]\nelements = [8, 3, 7]\nsubdomains = [2, 1, 1]\nyoung = 200\npoisson = 0.3\n\
        dirichlet = { left = { x = 0 }, back = { z = 0 } }\ntraction = { top = [0, -2, 0] }\n\
        [[contact]]\nbodies = [\"high\", \"low\"]\nsides = [\"bottom\", \"top\"]\n";
    let long = "physics = \"elasticity\"\n[[body]]\nname = \"low\"\nsize = [6, 0.4]\nelements = [90, 6]\n\
        subdomains = [6, 1]\nyoung = 1e6\npoisson = 0.3\ndirichlet = [\"bottom\"]\n[[body]]\nname = \"up\"\n\
        origin = [0, 0.4]\nsize = [6, 0.4]\nelements = [70, 6]\n\
        subdomains = [5, 1]\nyoung = 1\npoisson = 0.3\ndirichlet = { left = { x = 0 } }\n\
        traction = { top = [0, -0.01] }\n[[contact]]\nbodies = [\"low\", \"up\"]\ngap = \"0.001*(x - 2)^2\"\n";
    let die = "physics = \"elasticity\"\n[[body]]\nname = \"low\"\norigin = [0, 0.03]\nsize = [2, 0.5]\n\
        elements = [32, 8]\nsubdomains = [4, 2]\nyoung = 10\npoisson = 0.4\ndirichlet = { left = { x = 0 } }\n\
        [[body]]\nname = \"up\"\norigin = [0, 0.53]\nsize = [2, 0.5]\nelements = [20, 5]\nsubdomains = [2, 1]\n\
        young = 30\npoisson = 0.3\ndirichlet = { left = { x = 0 } }\ntraction = { top = [0.05, -0.5] }\n\
        [[contact]]\nbodies = [\"low\", \"up\"]\n[[obstacle]]\nbody = \"low\"\nside = \"bottom\"\n\
        surface = \"die\"\nmesh = \"../../examples/scenes/die.msh\"\n";
    // Without any force there is nothing to compare with.
    let moved = |name: &str| !name.starts_with("4c-1585");
    let reported = trackers().into_iter().filter(|c| moved(c.name));
    let mut scenes = vec![
        ("die", die.into()),
        ("long", long.into()),
        ("soft", format!("{long}multipliers = \"up\"\n")),
        ("tied", plates("[[tie]]\nbodies = [\"low\", \"up\"]\n")),
        (
            "gap",
            plates("[[contact]]\nbodies = [\"low\", \"up\"]\ngap = \"0.004*x\"\nmultipliers = \"up\"\n"),
        ),
        ("blocks", blocks.into()),
    ];
    scenes.extend(reported.map(|case| (case.name, case.text)));
    scenes
}

#[test]
fn sides_that_do_not_match_have_the_direct_solution() {
    let ranks = as_rank(|session, out| {
        for (name, text) in scenes() {
            solve(session, name, &Scene::parse("s.toml", &text)?, out)?;
        }
        Ok(())
    });
    let scratch = sample(2, [1, 2, 7, 4]).map(|n| {
        let scratch = Scratch::new(&format!("mortar-{n}"));
        let out = ranks.run(n, &scratch.0.display().to_string());
        assert_eq!(out.code, 0, "{}", out.all());
        scratch
    });
    let scratch: Vec<_> = scratch.collect();
    for (name, text) in scenes() {
        let scene = Scene::parse("s.toml", &text).expect("a scene");
        assert!(
            scene.mortar_rows().count() >= 5,
            "{name}: {}",
            scene.mortar_rows().count()
        );
        let answers = scratch.iter().map(|s| Answer::read(&s.path(name)));
        compare(name, &scene, &answers.collect::<Vec<_>>());
    }
}
