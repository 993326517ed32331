//! Unit tests of `src/feti/subdomain/congruent.rs`.

use std::sync::Arc;

use crate::testing::with_session;
use fetifeti::inside::equal::Likeness;
use fetifeti::inside::{equal, DofSharing, Jump};
use fetifeti::settings::Primal;
use fetifeti::Problem;
use parallel::team::Team;
use scene::Scene;

/// Subdomains of a ring, in 10 sectors from angle to angle, and what they share.
fn ring(physics: &str, change: impl Fn(&mut Problem)) -> Vec<Likeness> {
    let text = format!(
        "title = \"ring\"\nphysics = \"{physics}\"\n[[body]]\nname = \"ring\"\n\
         shape = {{ annulus = {{ inner = 1, outer = 1.5, from = 0, to = 100 }} }}\n\
         elements = [6, 60]\nsubdomains = [1, 10]\ndirichlet = [\"bottom\"]\n{}\n",
        if physics == "elasticity" {
            "young = 10\npoisson = 0.3"
        } else {
            ""
        }
    );
    let scene = Scene::parse("ring.toml", &text).expect("a scene");
    let mut problem = scene.substructures(&|_| true).expect("substructures");
    change(&mut problem);
    with_session(move |session| {
        let weights: Vec<Vec<f64>> = problem.local.iter().map(|s| s.rho.clone()).collect();
        let sharing =
            DofSharing::new(session.comm(), &problem, &weights, Primal::default()).expect("shared");
        let jump = Jump::new(session.comm(), &problem, &sharing);
        equal::representatives(&problem, &jump, &Team::new(2).expect("threads"))
    })
}

#[test]
fn sectors_of_a_ring_are_one_but_for_its_ends() {
    let all = ring("elasticity", |_| {});
    for (j, like) in all.iter().enumerate() {
        let first = if (1..9).contains(&j) { 1 } else { j };
        assert_eq!(like.first, first, "{j}");
        assert!((like.factor - 1.0).abs() < 1e-13);
        let Some(turn) = like.turn else {
            assert!(j < 2 || j == 9);
            continue;
        };
        let angle = (10.0 * (j as f64 - 1.0)).to_radians();
        assert!((turn.entry(0, 0) - angle.cos()).abs() < 1e-13, "{j}");
        assert!((turn.entry(1, 0) - angle.sin()).abs() < 1e-13, "{j}");
    }
}

#[test]
fn a_scalar_field_needs_no_turn() {
    let all = ring("scalar", |_| {});
    let first: Vec<usize> = all.iter().map(|l| l.first).collect();
    assert_eq!(first, [0, 1, 1, 1, 1, 1, 1, 1, 1, 9]);
    assert!(all.iter().all(|l| l.turn.is_none()));
}

#[test]
fn multiples_are_found_and_other_matrices_are_not() {
    let all = ring("elasticity", |problem| {
        Arc::make_mut(&mut problem.local[3].k)
            .val
            .iter_mut()
            .for_each(|v| *v *= 7.3);
        // Stiffer by 1e-6 in one entry, symmetrically.
        let k = Arc::make_mut(&mut problem.local[5].k);
        k.val[0] *= 1.0 + 1e-6;
    });
    assert_eq!((all[3].first, all[4].first), (1, 1));
    assert!((all[3].factor - 7.3).abs() < 1e-12);
    assert_eq!((all[5].first, all[6].first), (5, 1));
}
