//! Unit tests of `crates/scene/src/rows/terms.rs`.

use super::*;
use crate::DeckScenes;
use std::collections::BTreeMap;
use std::path::Path;

/// The terms of every row at free degrees of freedom are those that the method gets.
fn same_as_the_rows(scene: &Scene) {
    let rows = scene.solver_rows(&|_| true);
    let terms: Vec<RowTerms> = scene.row_terms(&|_| true).collect();
    assert_eq!(rows.len(), terms.len());
    assert!(!rows.is_empty());
    for (row, all) in rows.iter().zip(&terms) {
        let mut expected: BTreeMap<u64, f64> = BTreeMap::new();
        for &(dof, v) in &row.terms {
            *expected.entry(dof).or_default() += v;
        }
        let mut found: BTreeMap<u64, f64> = BTreeMap::new();
        for (at, coefficients) in &all.terms {
            let body = &scene.bodies[at.body];
            let c = body.components;
            for d in (0..c).filter(|d| body.prescribed_at(c * at.node + d).is_none()) {
                let dof = body.first_dof + (c * at.node + d) as u64;
                *found.entry(dof).or_default() += coefficients[d];
            }
        }
        // Components that are rounding are in no row.
        found.retain(|_, v| v.abs() > 1e-12);
        expected.retain(|_, v| v.abs() > 1e-12);
        assert!(found.keys().eq(expected.keys()), "{row:?}");
        for (a, b) in found.values().zip(expected.values()) {
            assert!((a - b).abs() < 1e-12, "{row:?}");
        }
    }
}

#[test]
fn terms_are_those_of_the_rows() {
    let scenes = [
        "model_contact",
        "obstacle",
        "mortar_2d",
        "partly_tied",
        "rings",
        "shrink_fit",
        "die",
        "hertz_sphere",
    ];
    for name in scenes {
        same_as_the_rows(&Scene::load(format!("../../examples/scenes/{name}.toml")).expect(name));
    }
    let cases = ["10_balance_of_inclined_support", "11_balance_of_moments"];
    for name in cases {
        let deck = DeckScenes::load(Path::new(&format!("../../tests/data/cases/{name}.inp")));
        same_as_the_rows(&deck.expect(name).scene(name, 0).expect(name));
    }
}
