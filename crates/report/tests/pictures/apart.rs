//! Unit tests of `crates/report/src/pictures/apart.rs`.

use super::*;
use crate::pictures::surface::tests::Blocks;
use crate::pictures::surface::FaceMark;

/// Two blocks on top of each other, marked on a part of their common face only: both move along its normal.
#[test]
fn bodies_move_apart_along_the_normal_of_their_contact() {
    let mut blocks = Blocks::new(2, 2);
    // The upper block is moved aside, so that the middles of the blocks differ in x, too.
    for p in blocks.points.iter_mut().filter(|p| p[1] > 1.5) {
        p[0] += 0.5;
    }
    let corners = [
        [0.0, 1.0, 0.0],
        [0.5, 1.0, 0.0],
        [0.5, 1.0, 0.5],
        [0.0, 1.0, 0.5],
    ];
    let marks = [0, 1].map(|body| FaceMark {
        body,
        partner: Some(1 - body),
        corners,
        closed: Some(true),
    });
    let solid = blocks.view();
    let [lower, upper] = shifts(&solid, &solid.surface(&marks))[..] else {
        panic!("two bodies");
    };
    for d in [0, 2] {
        assert!(
            lower[d].abs() < 1e-12 && upper[d].abs() < 1e-12,
            "{lower:?} {upper:?}"
        );
    }
    assert!(lower[1] < -0.1 && upper[1] > 0.1, "{lower:?} {upper:?}");
    let plain = shifts(&solid, &solid.surface(&[]));
    assert!(plain[0][0] < -0.05, "{plain:?}");
}

/// Rollers on a sector of 120° between two rings: no roller is moved into a ring, and rollers keep their distances.
#[test]
fn no_body_of_a_ring_moves_through_another() {
    let rollers = 5;
    let (outer, inner) = (rollers, rollers + 1);
    let mut wishes = Vec::new();
    for k in 0..rollers {
        let angle = (-150.0 + 30.0 * k as f64).to_radians();
        let up = [-angle.cos(), -angle.sin(), 0.0];
        for bodies in [[outer, k], [k, inner]] {
            wishes.push(Wish {
                bodies,
                shift: up,
                weight: 1.0 + k as f64,
            });
        }
    }
    let t = least_squares_shifts(rollers + 2, &wishes);
    for Wish {
        bodies: [a, b],
        shift,
        ..
    } in &wishes
    {
        let apart = dot(minus(t[*b], t[*a]), *shift);
        assert!(apart > 0.1, "{a} and {b}: {apart}");
    }
    for k in 1..rollers {
        assert!(norm(minus(t[k], t[0])) < 1e-9, "{t:?}");
    }
    // As a system of equations: the gradient of the sum of squares is zero.
    for body in 0..rollers + 2 {
        let mut gradient = [0.0; 3];
        for w in &wishes {
            let rest = minus(minus(t[w.bodies[1]], t[w.bodies[0]]), w.shift);
            let sign =
                f64::from(u8::from(w.bodies[1] == body)) - f64::from(u8::from(w.bodies[0] == body));
            (0..3).for_each(|d| gradient[d] += sign * w.weight * rest[d]);
        }
        assert!(norm(gradient) < 1e-8, "{gradient:?}");
    }
}

/// A pin in a bush leaves along the axis, on the side where it is.
#[test]
fn a_body_leaves_one_that_encloses_it_along_their_axis() {
    let axis = [0.6, 0.0, 0.8];
    let side = [0.8, 0.0, -0.6];
    let mut contact = TouchingFaces::default();
    for k in 0..12 {
        let angle = f64::from(k).mul_add(30.0, 7.0).to_radians();
        let normal = [0, 1, 2].map(|d| angle.cos() * side[d] + angle.sin() * [0.0, 1.0, 0.0][d]);
        contact.area += 1.0;
        for i in 0..3 {
            contact.normals[i] += normal[i];
            (0..3).for_each(|j| contact.spread[i][j] += normal[i] * normal[j]);
        }
    }
    for sign in [1.0, -1.0] {
        let along = contact.direction(axis.map(|x| 0.1 * sign * x));
        assert!(
            norm(minus(along, axis.map(|x| sign * x))) < 1e-9,
            "{along:?}"
        );
    }
}

/// Squares of side 1 at height `z` above the places in `at`.
fn tops(at: &[[i32; 2]], z: f64) -> Vec<[[f64; 3]; 4]> {
    let corner =
        |[x, y]: [i32; 2], i: i32, j: i32| [f64::from(x + i) + 0.5, f64::from(y + j) + 0.5, z];
    let face = |p: &[i32; 2]| [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| corner(*p, i, j));
    at.iter().map(face).collect()
}

/// A bolt whose head stands on a plate and whose nut is under it has to move by the height of the plate and of the bolt
/// below it; a block on another one not at all.
#[test]
fn the_clearance_counts_what_is_in_the_way() {
    let up = [0.0, 0.0, 1.0];
    let plate: Vec<[i32; 2]> = (-5..5).flat_map(|x| (-5..5).map(move |y| [x, y])).collect();
    let plate = [tops(&plate, 0.0), tops(&plate, 3.0)].concat();
    let bolt = [tops(&[[0, 0]], 3.0), tops(&[[0, 0]], -2.0)].concat();
    assert!((clearance(&plate, &bolt, up) - 5.0).abs() < 1e-12);
    let block = [tops(&[[0, 0]], 3.0), tops(&[[0, 0]], 7.0)].concat();
    assert!(clearance(&plate, &block, up).abs() < 1e-12);
    let aside = tops(&[[20, 0]], -2.0);
    assert!(clearance(&plate, &aside, up).abs() < 1e-12);
}
