//! Unit tests of `crates/elements/src/cell/loads.rs`.

use super::super::testing::{distorted, Grid, Random};
use super::*;

fn total(dim: usize, element: Element, rule: Quadrature, f: fn([f64; 3]) -> f64) -> f64 {
    let mut random = Random::new(4);
    let grid = Grid::new(dim, [2, 3, 2], |p| {
        p.map(|x| x + f64::from(x > 0.0 && x < 1.0) * 0.1 * random.next())
    });
    let mut sum = 0.0;
    for cell in 0..grid.cells.len() {
        let mut out = vec![0.0; 1 << dim];
        body_load(
            dim,
            &grid.corners(cell),
            element,
            rule,
            1,
            |p| [f(p), 9.0, 9.0],
            &mut out,
        );
        sum += out.iter().sum::<f64>();
    }
    sum
}

#[test]
fn totals_over_the_unit_cell_are_exact_on_distorted_grids() {
    for dim in [2, 3] {
        for element in [Element::Q1, Element::P1] {
            for rule in [Quadrature::Midpoint, Quadrature::Gauss] {
                assert!((total(dim, element, rule, |_| 3.0) - 3.0).abs() < 1e-14);
            }
            let linear = total(dim, element, Quadrature::Gauss, |p| 2.0 * p[0] - p[1]);
            assert!((linear - 0.5).abs() < 1e-14);
            let exact = if dim == 2 { 0.0 } else { 0.25 };
            let product = total(dim, element, Quadrature::Gauss, |p| p[0] * p[2]);
            // On a hexahedron that is of degree 4 in the coordinates of the unit cell.
            let bound = if (dim, element) == (3, Element::Q1) {
                1e-5
            } else {
                1e-14
            };
            assert!((product - exact).abs() < bound, "{product}");
        }
    }
}

#[test]
fn forces_and_moments_of_a_cell_are_those_of_the_distribution() {
    // The nodal forces do the work of the distributed ones in every function the element can represent: for N_a x_a
    // summed that is the moment. Compared with the rule of higher order.
    for dim in [2, 3] {
        for element in [Element::Q1, Element::P1] {
            let cell = distorted(dim, 8);
            let force = |p: [f64; 3]| [p[0] - 2.0, 1.0 + p[1], 3.0];
            let mut out = vec![0.0; dim << dim];
            body_load(dim, &cell, element, Quadrature::Gauss, dim, force, &mut out);
            let got: f64 = (0..1 << dim)
                .map(|a| cell[a][0] * out[dim * a + 1] - cell[a][1] * out[dim * a])
                .sum();
            let mut exact = 0.0;
            for_each_sample_of(dim, &cell, element, Rule::Error, |s| {
                let f = force(s.point);
                exact += s.weight * (s.point[0] * f[1] - s.point[1] * f[0]);
            });
            // Two Gauss points per direction are exact on a quadrilateral; on a hexahedron x² det J has degree 4.
            let bound = if (dim, element) == (3, Element::Q1) {
                1e-3
            } else {
                1e-14
            };
            assert!(
                (got - exact).abs() < bound,
                "{dim} {element:?} {got} {exact}"
            );
        }
    }
}

#[test]
fn the_midpoint_rule_gives_every_corner_of_a_box_its_share() {
    let box_: Vec<_> = super::super::testing::unit(3)
        .iter()
        .map(|p| [2.0 * p[0], p[1], 3.0 * p[2]])
        .collect();
    let mut out = [0.0; 24];
    let f = |p: [f64; 3]| p;
    body_load(3, &box_, Element::Q1, Quadrature::Midpoint, 3, f, &mut out);
    for node in out.chunks(3) {
        for (value, expected) in node.iter().zip([1.0, 0.5, 1.5]) {
            assert!((value - 6.0 / 8.0 * expected).abs() < 1e-15);
        }
    }
}
