//! Turned and mirrored copies of a part have the direct solution on 1, 2 and 4 ranks, tied and in contact.

use super::direct::{compare, solve, Answer};
use crate::support::copies::{Copies, Kind};
use crate::support::mpi::{as_rank, Scratch};
use scene::Scene;

#[test]
fn copies_have_the_direct_solution() {
    let ranks = as_rank(|session, case| {
        let (path, out) = case.split_once(' ').expect("a scene and a directory");
        solve(session, "copies", &Scene::load(path)?, out)
    });
    for (joint, kind) in [("tie", Kind::Tetrahedra), ("contact", Kind::Hexahedra)] {
        let copies = Copies {
            kind,
            n: 5,
            pairs: 2,
            moved: 0.0,
            joint,
            subdomains: 4,
        };
        let model = Scratch::new(&format!("copies-{joint}"));
        let path = copies.write(&model);
        let answers = [1, 2, 4].map(|n| {
            let scratch = Scratch::new(&format!("copies-{joint}-{n}"));
            let out = ranks.run(n, &format!("{path} {}", scratch.0.display()));
            assert_eq!(out.code, 0, "{}", out.all());
            Answer::read(&scratch.path("copies"))
        });
        let scene = Scene::load(&path).expect("a scene");
        compare(joint, &scene, &answers);
    }
}
