//! Unit tests of `crates/scene/src/geometry/sweep.rs`.

use super::*;
use crate::geometry::matching::{Mismatch, NodeMatching};
use crate::Scene;

/// A wall of boxes with cells of second order, which are meshes of cells, and two rings that touch beside it.
const WALL: &str = "
order = 2
[grid]
bodies = [6, 5]
size = [6, 5]
elements = 2
load = 1
";

const RINGS: &str = "
order = 2
[[body]]
name = \"inner\"
shape = { annulus = { inner = 1, outer = 1.5, from = 0, to = 90 } }
elements = [2, 4]
load = 1
[[body]]
name = \"outer\"
shape = { annulus = { inner = 1.5, outer = 2, from = 0, to = 90 } }
elements = [2, 4]
load = 1
[[body]]
name = \"far\"
shape = { annulus = { inner = 5, outer = 5.5, from = 20, to = 70 } }
elements = [2, 4]
load = 1
[[body]]
name = \"beside\"
origin = [-1.1, 1]
size = 1
elements = 2
load = 1
";

/// The number of pairs of bodies that are looked at, and of those that meet. All that meet, and all whose nodes cannot
/// be paired, must be looked at.
fn looked_at(text: &str, names: [&str; 2], reach: f64) -> [usize; 2] {
    let scene = Scene::parse("sweep.toml", text).expect("a scene");
    let bodies = &scene.bodies;
    let mut matching = NodeMatching::new(bodies);
    let sides = names.map(|name| {
        let side = |b: &Body| b.mesh().side_of_name(name).expect("a side");
        bodies.iter().map(side).collect::<Vec<usize>>()
    });
    let mut surfaces = sides.iter().map(|sides| {
        let each = sides.iter().enumerate();
        each.map(|(b, side)| matching.surface(b, *side))
            .collect::<Vec<_>>()
    });
    let (first, second) = (surfaces.next().unwrap(), surfaces.next().unwrap());
    drop(surfaces);
    let near = may_face(&first, &second, reach);
    assert!(near.is_sorted());
    let mut meet = 0;
    for a in 0..bodies.len() {
        for b in (0..bodies.len()).filter(|b| *b != a) {
            let found = matching.find([a, b], [sides[0][a], sides[1][b]], reach);
            if !matches!(found, Err(Mismatch::Apart(_))) {
                meet += 1;
                let known = near.binary_search(&[a, b]).is_ok();
                assert!(known, "{names:?} of {a} and {b} within {reach}");
            }
        }
    }
    [near.iter().filter(|[a, b]| a != b).count(), meet]
}

#[test]
fn all_sides_that_meet_are_looked_at() {
    for reach in [1e-3, 0.3, f64::INFINITY] {
        for text in [WALL, RINGS] {
            for names in [
                ["right", "left"],
                ["top", "bottom"],
                ["top", "top"],
                ["all", "all"],
            ] {
                let [looked, meet] = looked_at(text, names, reach);
                println!("{names:?} {reach}: {looked} looked at, {meet} meet");
            }
        }
    }
}

/// There are 870 pairs.
#[test]
fn sides_far_apart_are_not_looked_at() {
    let [looked, meet] = looked_at(WALL, ["right", "left"], 0.01);
    // 25 beside each other, and 40 with a corner in common.
    assert_eq!(meet, 65);
    assert!(looked <= 25 * 3, "{looked}");
    let [looked, meet] = looked_at(WALL, ["right", "left"], f64::INFINITY);
    // Every body at least with those at its right in its row; those at its left are not looked at.
    assert!(meet >= 5 * 15, "{meet}");
    assert!(looked < 870 * 3 / 4, "{looked}");
}
