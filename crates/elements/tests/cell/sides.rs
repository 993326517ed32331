//! Unit tests of `crates/elements/src/cell/sides.rs`.

use super::super::map::for_each_sample_of;
use super::super::testing::{distorted, unit};
use super::*;

fn points(cell: &[[f64; 3]], side: Side, dim: usize) -> Vec<[f64; 3]> {
    side.corners(dim).map(|a| cell[a]).collect()
}

#[test]
fn normals_of_the_unit_cell_point_out_of_it() {
    for dim in [2, 3] {
        for side in (0..2 * dim).map(Side::of_index) {
            let points = points(&unit(dim), side, dim);
            for element in [Element::Q1, Element::P1] {
                let weights = side_weights(dim, &points, side.outward(dim), element);
                assert!((weights.area.iter().sum::<f64>() - 1.0).abs() < 1e-15);
                for i in 0..3 {
                    let sum: f64 = weights.normal.iter().map(|n| n[i]).sum();
                    let sign = if side.upper { 1.0 } else { -1.0 };
                    let expected = if i == side.axis { sign } else { 0.0 };
                    assert!((sum - expected).abs() < 1e-15, "{side:?} {weights:?}");
                }
            }
        }
    }
}

#[test]
fn pressure_on_the_surface_of_a_distorted_cell_has_no_force_and_no_moment() {
    for dim in [2, 3] {
        for element in [Element::Q1, Element::P1] {
            for seed in 0..5 {
                let cell = distorted(dim, seed);
                let (mut force, mut moment, mut size) = ([0.0; 3], [0.0; 3], 0.0);
                let mut divergence = 0.0;
                for side in (0..2 * dim).map(Side::of_index) {
                    let points = points(&cell, side, dim);
                    let mut out = vec![0.0; points.len() * dim];
                    let pressure = |_, n: [f64; 3]| n.map(|v| -4.0 * v);
                    let outward = side.outward(dim);
                    side_load(dim, &points, outward, element, dim, pressure, &mut out);
                    for (p, g) in points.iter().zip(out.chunks(dim)) {
                        let g = [g[0], g[1], g.get(2).copied().unwrap_or(0.0)];
                        for i in 0..3 {
                            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                            force[i] += g[i];
                            moment[i] += p[j] * g[k] - p[k] * g[j];
                            size += g[i].abs();
                            divergence -= p[i] * g[i] / (4.0 * dim as f64);
                        }
                    }
                }
                assert!(size > 1.0);
                assert!(force.iter().all(|v| v.abs() < 1e-14), "{force:?}");
                assert!(moment.iter().all(|v| v.abs() < 1e-14), "{moment:?}");
                // ∫ x·n = dim · volume: orientation and size are right, too.
                let mut volume = 0.0;
                for_each_sample_of(dim, &cell, element, Rule::Load, |s| volume += s.weight);
                assert!((divergence - volume).abs() < 1e-14, "{divergence} {volume}");
            }
        }
    }
}

#[test]
fn tractions_have_their_exact_totals_and_moments() {
    // The edge from (1, 1) to (4, 5) has length 5; q = 2 s along it: total 25, about its start 2·125/3.
    let edge = [[1.0, 1.0, 0.0], [4.0, 5.0, 0.0]];
    let along = |p: [f64; 3]| (p[0] - 1.0) / 3.0 * 5.0;
    let mut out = [0.0; 2];
    let q = |p: [f64; 3], _: [f64; 3]| [2.0 * along(p), 0.0, 0.0];
    side_load(2, &edge, 1.0, Element::Q1, 1, q, &mut out);
    assert!((out[0] + out[1] - 25.0).abs() < 1e-13);
    assert!((5.0 * out[1] - 250.0 / 3.0).abs() < 1e-13);
    // A flat parallelogram of area 6 in space.
    let flat: Vec<_> = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
        .map(|[s, t]| [3.0 * s, 2.0 * t + s, 1.0])
        .to_vec();
    for element in [Element::Q1, Element::P1] {
        let mut out = [0.0; 12];
        let q = |p: [f64; 3], n: [f64; 3]| [p[0], p[1], 7.0 * n[2]];
        side_load(3, &flat, -1.0, element, 3, q, &mut out);
        let total = |i: usize| out.iter().skip(i).step_by(3).sum::<f64>();
        // The centroid is (1.5, 1.5), and outward = −1 turns the normal down.
        for (i, expected) in [9.0, 9.0, -42.0].into_iter().enumerate() {
            assert!((total(i) - expected).abs() < 1e-13, "{}", total(i));
        }
    }
}
