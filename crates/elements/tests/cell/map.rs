//! Unit tests of `crates/elements/src/cell/map.rs`.

use super::super::testing::{distorted, unit};
use super::*;

#[test]
fn distorted_cells_are_positive_and_mirrored_or_folded_ones_are_not() {
    for dim in [2, 3] {
        for element in [Element::Q1, Element::P1] {
            for seed in 0..20 {
                let mut cell = distorted(dim, seed);
                assert!(jacobian_is_positive(dim, &cell, element));
                cell.swap(0, 1);
                assert!(!jacobian_is_positive(dim, &cell, element));
            }
            let flat: Vec<_> = unit(dim).iter().map(|p| [p[0], 0.0, p[2]]).collect();
            assert!(!jacobian_is_positive(dim, &flat, element));
            let mut lost = unit(dim);
            lost[1][0] = f64::NAN;
            assert!(!jacobian_is_positive(dim, &lost, element));
        }
    }
    // One corner drawn in beyond the opposite diagonal: positive at the centre, folded at that corner.
    let mut dart = unit(2);
    dart[3] = [0.4, 0.4, 0.0];
    assert!(!jacobian_is_positive(2, &dart, Element::Q1));
}

#[test]
fn the_rules_find_the_volume_and_linear_functions_have_their_gradient() {
    // The quadrilateral with corners (0,0), (2,0), (0,1), (3,3) has area 4.5 by the shoelace formula.
    let quad = [
        [0.0, 0.0, 9.0],
        [2.0, 0.0, 9.0],
        [0.0, 1.0, 9.0],
        [3.0, 3.0, 9.0],
    ];
    for element in [Element::Q1, Element::P1] {
        for rule in [Rule::Stiffness, Rule::Load, Rule::Error] {
            let mut area = 0.0;
            for_each_sample::<2, 4>(&quad, element, rule, |s| {
                area += s.weight;
                let slope: f64 = (0..4).map(|a| s.gradient[1][a] * quad[a][1]).sum();
                assert!((slope - 1.0).abs() < 1e-14);
            });
            assert!((area - 4.5).abs() < 1e-13, "{element:?} {rule:?} {area}");
        }
    }
}
