//! Equations between displacements: the answers on 1, 2 and 4 ranks are the direct solution of the assembled problem.

use super::direct::{compare, solve, Answer};
use crate::support::mpi::{as_rank, Scratch};
use crate::support::plates::joined_plates;
use fetifeti::problem::RowSource;
use scene::{Row, Scene};

/// Cells along a side of each plate: so many that every plate is cut.
const N: usize = 48;

#[test]
fn joined_plates_have_the_direct_solution() {
    let ranks = as_rank(|session, case| {
        let (path, out) = case.split_once(' ').expect("a deck and a directory");
        solve(session, "plates", &Scene::load(path)?, out)
    });
    let model = Scratch::new("plates");
    let path = model.file("plates.inp", &joined_plates(N, &[]));
    let answers = [1, 2, 4].map(|n| {
        let scratch = Scratch::new(&format!("plates-{n}"));
        let out = ranks.run(n, &format!("{path} {}", scratch.0.display()));
        assert_eq!(out.code, 0, "{}", out.all());
        Answer::read(&scratch.path("plates"))
    });
    let scene = Scene::load(&path).expect("a deck");
    assert!(scene.n_subdomains() >= 4, "{}", scene.n_subdomains());
    let of_equation = |row: &&Row| matches!(row.source, RowSource::Equation(_));
    let equations = scene.rows.iter().filter(of_equation).count();
    assert!(equations > 4 * N, "{equations}");
    compare("plates", &scene, &answers);
}
