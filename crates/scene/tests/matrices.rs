//! Unit tests of `crates/scene/src/matrices.rs`.

use std::collections::HashSet;

use super::*;
use crate::Scene;

/// Four boxes of two subdomains: two alike, one shorter, one of another material; with some places more for the first.
fn scene(more: &str) -> Scene {
    let young = if more.contains("young") {
        ""
    } else {
        "young = 3\n"
    };
    let text = format!(
        "physics = \"elasticity\"\n\
         [[body]]\nname = \"a\"\nsize = [2, 1]\nsubdomains = [2, 1]\nelements = [4, 2]\n{young}{more}\n\
         [[body]]\nname = \"b\"\norigin = [20, 0]\nsize = [2, 1]\nsubdomains = [2, 1]\nelements = [4, 2]\nyoung = 3\n\
         [[body]]\nname = \"c\"\norigin = [30, 0]\nsize = [1.5, 1]\nsubdomains = [2, 1]\nelements = [4, 2]\nyoung = 3\n\
         [[body]]\nname = \"d\"\norigin = [40, 0]\nsize = [2, 1]\nsubdomains = [2, 1]\nelements = [4, 2]\nyoung = 4\n"
    );
    Scene::parse("s.toml", &text).expect("a scene")
}

/// The number of different matrices; each has the bits of the matrix of its subdomain alone, and is that of the placed
/// mesh up to rounding.
fn different(scene: &Scene) -> usize {
    let problem = scene.substructures(&|_| true).expect("substructures");
    for sub in &problem.local {
        let alone = scene.subdomain(sub.index).expect("a subdomain").k;
        assert_eq!(*sub.k, *alone, "subdomain {}", sub.index);
        let placed = crate::assembly::matrix(&scene.subdomain_mesh(sub.index).expect("a mesh"));
        assert_eq!((&placed.row_ptr, &placed.col), (&alone.row_ptr, &alone.col));
        let size = alone.val.iter().fold(0.0_f64, |s, v| s.max(v.abs()));
        let pairs = placed.val.iter().zip(&alone.val);
        let away = pairs.fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
        assert!(away < 1e-11 * size, "subdomain {}: {away}", sub.index);
    }
    let places = problem.local.iter().map(|sub| Arc::as_ptr(&sub.k));
    places.collect::<HashSet<_>>().len()
}

#[test]
fn boxes_of_one_size_and_material_have_one_matrix() {
    assert_eq!(different(&scene("")), 3);
}

#[test]
fn what_the_matrix_follows_from_tells_them_apart() {
    // Both subdomains of the first box are others now, or its left one alone.
    assert_eq!(different(&scene("poisson = 0.2")), 4);
    assert_eq!(different(&scene("dirichlet = { left = 0 }")), 4);
    assert_eq!(different(&scene("dirichlet = { left = { x = 1 } }")), 4);
    assert_eq!(different(&scene("spring = { left = 2 }")), 4);
    assert_eq!(different(&scene("young = \"3 + x\"")), 5);
}

#[test]
fn copies_have_the_matrices_of_their_turn() {
    // Shifts do not count, be they ever so far. A turned box is a mesh of any shape: its two subdomains differ.
    let shifted = "instances = [[0.1, 3], [1e5, 7.3], [0.7, 0.3]]";
    assert_eq!(different(&scene(shifted)), 3);
    let turned = "instances = [[0, 3, 30], [1e3, 7.3, 30], [5, 5, 90], [7.7, 5, 90]]";
    assert_eq!(different(&scene(turned)), 7);
}
