//! Unit tests of `crates/elements/src/mortar/space.rs`.

use super::*;

#[test]
fn polygons_are_cut() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let shifted = square.map(|[x, y]| [x + 0.25, y - 0.5]);
    assert!((area(&cut(&square, &shifted)) - 0.375).abs() < 1e-15);
    // The order around does not matter.
    let turned: Vec<[f64; 2]> = shifted.iter().rev().copied().collect();
    assert!((area(&cut(&square, &turned)) - 0.375).abs() < 1e-15);
    let inside = [[0.2, 0.2], [0.6, 0.3], [0.3, 0.7]];
    assert!((area(&cut(&square, &inside)) - area(&inside)).abs() < 1e-15);
    assert!((area(&cut(&inside, &square)) - area(&inside)).abs() < 1e-15);
    let away = square.map(|[x, y]| [x + 2.0, y]);
    assert_eq!(area(&cut(&square, &away)), 0.0);
    // A common edge is no common part.
    let beside = square.map(|[x, y]| [x + 1.0, y]);
    assert_eq!(area(&cut(&square, &beside)), 0.0);
}
