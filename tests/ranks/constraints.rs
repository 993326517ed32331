//! Nodes at which joints meet: tied and in contact, tied twice, carrier of one pair and other side of the next, with
//! given values, at cross points. The rows are independent or consistent, and the answers on 1, 2 and 4 ranks are the
//! direct solution.

use std::collections::BTreeMap;

use faer::{Mat, Side};

use super::direct::{compare, solve, Answer};
use crate::support::mpi::{as_rank, Scratch};
use scene::Scene;

/// A plate with its lower left corner, its size, its elements, and more keys.
fn plate(name: &str, at: [f64; 2], size: [f64; 2], elements: [usize; 2], more: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\norigin = {at:?}\nsize = {size:?}\nelements = {elements:?}\nyoung = 100\n\
         poisson = 0.3\n{more}\n"
    )
}

/// A plate below two plates that touch each other; `joints` is what joins them.
fn three(joints: &str) -> String {
    let low = plate(
        "low",
        [0.0, 0.0],
        [2.0, 1.0],
        [14, 5],
        "subdomains = [2, 1]\ndirichlet = [\"bottom\"]",
    );
    let left = plate(
        "left",
        [0.0, 1.0],
        [1.0, 1.0],
        [5, 5],
        "traction = { top = [0.2, -1] }",
    );
    let right = plate(
        "right",
        [1.0, 1.0],
        [1.0, 1.0],
        [6, 6],
        "traction = { top = [-0.1, -2] }",
    );
    format!("physics = \"elasticity\"\n{low}{left}{right}{joints}")
}

fn tie(a: &str, b: &str, multipliers: &str) -> String {
    format!("[[tie]]\nbodies = [\"{a}\", \"{b}\"]\nmultipliers = \"{multipliers}\"\n")
}

fn contact(a: &str, b: &str, multipliers: &str) -> String {
    format!("[[contact]]\nbodies = [\"{a}\", \"{b}\"]\nmultipliers = \"{multipliers}\"\n")
}

/// The smallest singular value of the rows, each divided by its length: how far they are from being dependent.
fn independence(scene: &Scene) -> f64 {
    let rows = scene.mortar_rows().map(|row| row.terms(&scene.bodies));
    let rows: Vec<_> = rows.collect();
    let unit = |k: usize| -> BTreeMap<u64, f64> {
        let length = rows[k].iter().map(|t| t.1 * t.1).sum::<f64>().sqrt();
        let each = rows[k].iter();
        each.map(|&(dof, v)| (dof, v / length)).collect()
    };
    let units: Vec<_> = (0..rows.len()).map(unit).collect();
    let gram = Mat::from_fn(rows.len(), rows.len(), |i, j| {
        let common = units[i]
            .iter()
            .filter_map(|(dof, v)| Some(v * units[j].get(dof)?));
        common.sum::<f64>()
    });
    let values = gram
        .self_adjoint_eigenvalues(Side::Lower)
        .expect("eigenvalues");
    values[0].max(0.0).sqrt()
}

/// Scenes with a part of the sentence that they get, empty if none.
fn scenes() -> Vec<(&'static str, String, &'static str)> {
    let tied = |m: [&str; 3]| {
        three(
            &(tie("low", "left", m[0]) + &tie("low", "right", m[1]) + &tie("left", "right", m[2])),
        )
    };
    let mixed = |m: [&str; 3]| {
        three(
            &(tie("low", "left", m[0])
                + &contact("low", "right", m[1])
                + &tie("left", "right", m[2])),
        )
    };
    let touching = |m: [&str; 3]| {
        three(
            &(tie("low", "left", m[0])
                + &contact("low", "right", m[1])
                + &contact("left", "right", m[2])),
        )
    };
    let half = "[[tie]]\nbodies = [\"low\", \"up\"]\nrange = [0, 0.4]\n[[contact]]\nbodies = [\"low\", \"up\"]\n\
        range = [0.4, 1]\n";
    let two = |more: &str| {
        let low = plate(
            "low",
            [0.0, 0.0],
            [2.0, 1.0],
            [15, 5],
            "dirichlet = [\"bottom\"]",
        );
        let up = plate(
            "up",
            [0.0, 1.0],
            [2.0, 1.0],
            [10, 5],
            "traction = { top = [0, \"0.5 - x\"] }",
        );
        format!("physics = \"elasticity\"\n{low}{up}{more}")
    };
    let corner = |joints: &str| {
        let floor = plate(
            "floor",
            [0.0, 0.0],
            [2.0, 1.0],
            [9, 4],
            "dirichlet = [\"bottom\"]",
        );
        let wall = plate(
            "wall",
            [-1.0, 1.0],
            [1.0, 2.0],
            [4, 9],
            "dirichlet = [\"left\"]",
        );
        let block = plate(
            "block",
            [0.0, 1.0],
            [1.0, 1.0],
            [6, 6],
            "traction = { top = [-0.3, -1], right = [-1, 0] }",
        );
        format!("physics = \"elasticity\"\n{floor}{wall}{block}{joints}")
    };
    let back = "already determine the nodes opposite through other ties";
    let tied_before = "Another tie holds nodes of";
    let given = "have given values";
    let solid = blocks();
    // Nodes of both plates above meet, and the row between them and `low` is a mortar row.
    let matching = three("").replace("elements = [6, 6]", "elements = [6, 5]");
    let held = three("").replace(
        "traction = { top = [0.2, -1] }",
        "dirichlet = { left = { x = 0.001 } }",
    );
    vec![
        ("cycle", tied(["low", "right", "left"]), back),
        ("cycle-back", tied(["left", "low", "right"]), back),
        ("solid", solid, back),
        ("one-carries-all", tied(["low", "low", "left"]), tied_before),
        ("matching", matching, tied_before),
        ("given", held + &tie("left", "low", "left"), given),
        (
            "tied-and-contact",
            mixed(["low", "low", "right"]),
            tied_before,
        ),
        (
            "tied-and-contact-back",
            mixed(["left", "right", "right"]),
            tied_before,
        ),
        ("chain", touching(["left", "low", "left"]), tied_before),
        ("chain-back", touching(["low", "right", "right"]), ""),
        ("halves", two(half), ""),
        (
            "corner",
            corner(&(contact("floor", "block", "floor") + &contact("block", "wall", "block"))),
            "",
        ),
        (
            "corner-block",
            corner(&(contact("floor", "block", "block") + &contact("block", "wall", "block"))),
            "",
        ),
    ]
}

/// Three blocks around an edge, tied in a circle.
fn blocks() -> String {
    let block = |name: &str, at: &str, size: &str, elements: &str, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = {at}\nsize = {size}\nelements = {elements}\nyoung = 100\n\
             poisson = 0.3\n{more}\n"
        )
    };
    format!(
        "dimension = 3\nphysics = \"elasticity\"\n{}{}{}{}{}{}",
        block(
            "low",
            "[0, 0, 0]",
            "[2, 1, 1]",
            "[6, 2, 3]",
            "dirichlet = [\"bottom\"]"
        ),
        block(
            "left",
            "[0, 1, 0]",
            "[1, 1, 1]",
            "[2, 3, 2]",
            "traction = { top = [0.2, -1, 0.1] }"
        ),
        block(
            "right",
            "[1, 1, 0]",
            "[1, 1, 1]",
            "[3, 2, 4]",
            "traction = { top = [-0.1, -2, 0] }"
        ),
        tie("low", "left", "low"),
        tie("low", "right", "right"),
        tie("left", "right", "left")
    )
}

#[test]
fn nodes_of_several_joints_have_the_direct_solution() {
    let ranks = as_rank(|session, out| {
        for (name, text, _) in scenes() {
            solve(session, name, &Scene::parse("s.toml", &text)?, out)?;
        }
        Ok(())
    });
    let scratch = [1, 2, 4].map(|n| {
        let scratch = Scratch::new(&format!("constraints-{n}"));
        let out = ranks.run(n, &scratch.0.display().to_string());
        assert_eq!(out.code, 0, "{}", out.all());
        scratch
    });
    for (name, text, sentence) in scenes() {
        let scene = Scene::parse("s.toml", &text).expect("a scene");
        match sentence {
            "" => assert!(scene.notes.is_empty(), "{name}: {:?}", scene.notes),
            _ => assert!(
                scene.notes.iter().any(|n| n.contains(sentence)),
                "{name}: {:?}",
                scene.notes
            ),
        }
        // With a multiplier too many it is 0.03 (`cycle`).
        let least = independence(&scene);
        assert!(least > 0.3, "{name}: {least}");
        let answers = [0, 1, 2].map(|k| Answer::read(&scratch[k].path(name)));
        compare(name, &scene, &answers);
    }
}
