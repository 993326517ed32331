//! Unit tests of `src/feti/cost/forms.rs`.

use crate::testing::with_session;
use fetifeti::inside::equal::Likeness;
use fetifeti::inside::forms::*;
use fetifeti::inside::which::OperatorForm;
use fetifeti::inside::{DofSharing, Jump};
use fetifeti::settings::{Operators, Primal};
use parallel::team::Team;
use scene::Scene;

/// The forms for a grid with one kind of physics; `rho` is a function of position.
fn forms(grid: &'static str, memory: f64, check: fn(&[OperatorForm])) {
    with_session(move |session| {
        let scene = Scene::parse("grid.toml", grid).expect("a scene");
        let problem = scene.substructures(&|_| true).expect("substructures");
        let weights: Vec<Vec<f64>> = problem.local.iter().map(|s| s.rho.clone()).collect();
        let sharing =
            DofSharing::new(session.comm(), &problem, &weights, Primal::default()).expect("shared");
        let jump = Jump::new(session.comm(), &problem, &sharing);
        let own = |first| Likeness {
            first,
            factor: 1.0,
            turn: None,
        };
        let first: Vec<Likeness> = (0..problem.local.len()).map(own).collect();
        let team = Team::new(1).expect("threads");
        let kinds = kinds(&problem, &jump, &first);
        let (forms, _) = choose(
            &kinds,
            &vec![None; kinds.len()],
            &team,
            Operators::Auto,
            APPLICATIONS[0],
            memory,
            false,
        );
        check(&forms);
    });
}

const SOLID: &str = "title = \"solid\"\ndimension = 3\nphysics = \"elasticity\"\n\
                     [grid]\nbodies = [1, 1, 1]\nsubdomains = [2, 2, 2]\n\
                     elements_per_subdomain = 9\nload = [0, -1, 0]\ndirichlet = [\"bottom\"]\n";
const PLANE: &str = "title = \"plane\"\n[grid]\nbodies = 1\nsubdomains = 3\nelements_per_subdomain = 48\nload = 1\n";

#[test]
fn large_solids_that_differ_are_solved_sparsely_and_plane_ones_are_dense() {
    forms(
        SOLID,
        1e12,
        |f| assert!(f.contains(&OperatorForm::Implicit)),
    );
    forms(PLANE, 1e12, |f| {
        assert!(!f.contains(&OperatorForm::Implicit))
    });
}

#[test]
fn what_does_not_fit_is_solved_sparsely() {
    forms(
        PLANE,
        0.0,
        |f| assert!(!f.contains(&OperatorForm::Explicit)),
    );
    let n = 4.0 * 48.0; // a subdomain has no more rows than that
    forms(PLANE, 2.5 * 8.0 * n * n, |f| {
        let dense = f.iter().filter(|f| **f == OperatorForm::Explicit).count();
        assert!((2..9).contains(&dense), "{dense} of {}", f.len());
    });
}
