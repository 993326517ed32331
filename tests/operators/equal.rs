//! Unit tests of `src/feti/subdomain/equal.rs`.

use crate::testing::with_session;
use fetifeti::inside::equal::*;
use fetifeti::inside::{DofSharing, Jump};
use fetifeti::settings::Primal;
use fetifeti::Problem;
use parallel::team::Team;
use scene::{Faces, Scene};
use std::sync::Arc;

#[test]
fn a_regular_grid_has_one_matrix_per_kind_of_boundary() {
    with_session(|session| {
        let scene = Scene::lee(3, 4, 3, Faces::Whole).expect("a scene");
        let problem = scene.substructures(&|_| true).expect("substructures");
        let weights: Vec<Vec<f64>> = problem.local.iter().map(|s| s.rho.clone()).collect();
        let sharing =
            DofSharing::new(session.comm(), &problem, &weights, Primal::default()).expect("shared");
        let jump = Jump::new(session.comm(), &problem, &sharing);
        let first = representatives(&problem, &jump, &Team::new(2).expect("threads"));
        let mut kinds: Vec<usize> = first.iter().map(|f| f.first).collect();
        kinds.sort_unstable();
        kinds.dedup();
        // Subdomains inside a body, at its faces and corners, and at the sides and corners of the square.
        assert!(
            kinds.len() <= 40,
            "{} kinds of {}",
            kinds.len(),
            first.len()
        );
        for (j, like) in first.iter().enumerate() {
            let i = like.first;
            assert!(i <= j && like.factor == 1.0 && like.turn.is_none());
            assert_eq!(multiple(&problem, &jump, i, j), Some(1.0));
        }
    });
}

#[test]
fn coefficients_of_subdomains_do_not_make_kinds_but_those_of_elements_do() {
    with_session(|session| {
        let scene = Scene::lee(2, 3, 4, Faces::Whole).expect("a scene");
        let mut problem = scene.substructures(&|_| true).expect("substructures");
        let count = |problem: &Problem| {
            let weights: Vec<Vec<f64>> = problem.local.iter().map(|s| s.rho.clone()).collect();
            let sharing = DofSharing::new(session.comm(), problem, &weights, Primal::default())
                .expect("shared");
            let jump = Jump::new(session.comm(), problem, &sharing);
            let first = representatives(problem, &jump, &Team::new(1).expect("threads"));
            let kinds = first
                .iter()
                .enumerate()
                .filter(|(j, f)| f.first == *j)
                .count();
            (kinds, first)
        };
        let (plain, before) = count(&problem);
        // 1/3 is no power of two: products are rounded.
        for (j, sub) in problem.local.iter_mut().enumerate() {
            let rho = (j as f64 + 1.0) / 3.0;
            Arc::make_mut(&mut sub.k)
                .val
                .iter_mut()
                .for_each(|v| *v *= rho);
        }
        let (scaled, first) = count(&problem);
        assert_eq!(plain, scaled);
        for (j, (f, b)) in first.iter().zip(&before).enumerate() {
            assert_eq!(f.first, b.first);
            let expected = (j as f64 + 1.0) / (f.first as f64 + 1.0);
            assert!((f.factor - expected).abs() < 1e-14 * expected);
        }
        // One element that is stiffer by a millionth is another matrix.
        let last = first.iter().rposition(|f| f.first + 1 < first.len());
        let j = last.expect("a subdomain");
        let k = Arc::make_mut(&mut problem.local[j].k);
        let at = k.row_ptr[1] - 1;
        k.val[at] *= 1.0 + 1e-6;
        assert!(count(&problem).0 > scaled || first[j].first == j);
    });
}
