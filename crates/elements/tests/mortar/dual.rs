//! Unit tests of `crates/elements/src/mortar/dual.rs`: rows between flat sides with different meshes, of all kinds.

use super::*;
use crate::mortar::{samples, MortarFace};

/// A point of a square of side 1 that is turned in space, from coordinates on the square.
fn place([s, t]: [f64; 2], lift: f64) -> [f64; 3] {
    let (u, v, w) = ([0.6, 0.8, 0.0], [-0.48, 0.36, 0.8], [0.64, -0.48, 0.6]);
    [0, 1, 2].map(|d| s * u[d] + t * v[d] + lift * w[d] + 5.0)
}

/// A square with n × n faces of a kind, its inner nodes moved. `up`: the normal is that of the square, else its
/// opposite.
fn square(kind: CellKind, n: usize, up: bool, lift: f64, length: f64) -> MortarSide {
    let (mut points, mut faces): (Vec<[f64; 3]>, Vec<MortarFace>) = (Vec::new(), Vec::new());
    let mut flat: Vec<[f64; 2]> = Vec::new();
    let mut number = |at: [f64; 2], points: &mut Vec<[f64; 3]>| {
        let same = |p: &[f64; 2]| (p[0] - at[0]).abs() + (p[1] - at[1]).abs() < 1e-9;
        flat.iter().position(same).unwrap_or_else(|| {
            flat.push(at);
            points.push(place(at, lift));
            flat.len() - 1
        }) as u32
    };
    let h = length / n as f64;
    let node = |i: usize, j: usize| {
        let inner = |k: usize| k > 0 && k < n;
        let move_by = |k: usize| {
            if inner(i) && inner(j) {
                0.2 * h * ((k * 7 + 3 * i + 5 * j) as f64).sin()
            } else {
                0.0
            }
        };
        [i as f64 * h + move_by(1), j as f64 * h + move_by(2)]
    };
    let middle = |a: [f64; 2], b: [f64; 2]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    for j in 0..n {
        for i in 0..n {
            let quad = [
                node(i, j),
                node(i + 1, j),
                node(i + 1, j + 1),
                node(i, j + 1),
            ];
            let lists: Vec<Vec<[f64; 2]>> = match kind.corners() {
                4 => vec![quad.to_vec()],
                _ => vec![
                    vec![quad[0], quad[1], quad[2]],
                    vec![quad[0], quad[2], quad[3]],
                ],
            };
            for mut corners in lists {
                if !up {
                    corners.reverse();
                }
                let c = corners.len();
                if kind.order() == 2 {
                    for k in 0..c {
                        corners.push(middle(corners[k], corners[(k + 1) % c]));
                    }
                }
                if kind == CellKind::Quad9 {
                    let sum = |d: usize| corners[..4].iter().map(|x| x[d]).sum::<f64>() / 4.0;
                    corners.push([sum(0), sum(1)]);
                }
                let nodes = corners.iter().map(|&x| number(x, &mut points)).collect();
                faces.push(MortarFace { kind, nodes });
            }
        }
    }
    MortarSide::new(3, points, faces)
}

/// A polygon in the plane, from (0, 0) to `length` · (0.8, 0.6), with n segments of different lengths.
fn line(kind: CellKind, n: usize, up: bool, length: f64) -> MortarSide {
    let at = |t: f64| {
        let s = length * (t + 0.2 * t * (1.0 - t));
        [0.8 * s - 3.0, 0.6 * s + 1.0, 0.0]
    };
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for k in 0..=n {
        points.push(at(k as f64 / n as f64));
    }
    for k in 0..n as u32 {
        let mut nodes = if up { vec![k + 1, k] } else { vec![k, k + 1] };
        if kind == CellKind::Line3 {
            let [a, b] = [k as usize, k as usize + 1].map(|k| points[k]);
            nodes.push(points.len() as u32);
            points.push([0, 1, 2].map(|d| 0.5 * (a[d] + b[d])));
        }
        faces.push(MortarFace { kind, nodes });
    }
    MortarSide::new(2, points, faces)
}

const SURFACES: [CellKind; 5] = [
    CellKind::Triangle3,
    CellKind::Triangle6,
    CellKind::Quad4,
    CellKind::Quad8,
    CellKind::Quad9,
];

/// The largest defect of rows between flat sides: sums of coefficients, linear functions, total of the areas, and
/// nodal forces of a constant pressure on the nodes of both sides, where these lie opposite each other as a whole.
fn defect(
    side: &MortarSide,
    other: &MortarSide,
    excluded: &dyn Fn(u32) -> bool,
    area: f64,
    whole: bool,
) -> f64 {
    let list = rows(side, other, &samples(side, other, 0.3), excluded, &|_| 1.0);
    assert!(!list.is_empty());
    assert!(list.iter().all(|r| r.area > 0.0 && !excluded(r.node)));
    let mut worst = 0.0_f64;
    let mut off = |v: f64| worst = worst.max(v.abs());
    let across = |x: [f64; 3]| 1.0 + 0.3 * x[0] - 0.7 * x[1] + 0.4 * x[2];
    let lift = match side.dim() {
        2 => 0.0,
        _ => across(place([0.0; 2], 0.1)) - across(place([0.0; 2], 0.0)),
    };
    let mut own = vec![0.0; side.points().len()];
    let mut theirs = vec![0.0; other.points().len()];
    for row in &list {
        off(row.own.iter().map(|t| t.1).sum::<f64>() - 1.0);
        off(row.other.iter().map(|t| t.1).sum::<f64>() - 1.0);
        let here: f64 = row
            .own
            .iter()
            .map(|t| t.1 * across(side.points()[t.0 as usize]))
            .sum();
        let there: f64 = row
            .other
            .iter()
            .map(|t| t.1 * across(other.points()[t.0 as usize]))
            .sum();
        off(here + lift - there);
        row.own
            .iter()
            .for_each(|t| own[t.0 as usize] += row.area * t.1);
        row.other
            .iter()
            .for_each(|t| theirs[t.0 as usize] += row.area * t.1);
    }
    off(list.iter().map(|r| r.area).sum::<f64>() - area);
    for (of, sums) in [(side, own), (other, theirs)] {
        if !whole && std::ptr::eq(of, side) {
            continue;
        }
        let mut expected = vec![0.0; sums.len()];
        for face in of.faces() {
            let x: Vec<[f64; 3]> = face
                .nodes
                .iter()
                .map(|&k| of.points()[k as usize])
                .collect();
            let weights = crate::element::side_weights(face.kind, of.dim(), &x);
            for (&k, v) in face.nodes.iter().zip(weights.area) {
                expected[k as usize] += v;
            }
        }
        sums.iter().zip(&expected).for_each(|(a, b)| off(a - b));
    }
    worst
}

#[test]
fn constant_pressures_and_linear_displacements_pass_in_space() {
    for (k, kind) in SURFACES.into_iter().enumerate() {
        for (l, other) in SURFACES.into_iter().enumerate() {
            // Both numbers of faces for each kind, on either side.
            let sizes = [(3, 4), (1, 2)];
            for (n, m) in sizes
                .into_iter()
                .skip((k + l) % 2)
                .take(1 + usize::from(k == l))
            {
                let [a, b] = [(kind, n, true, 0.0), (other, m, false, 0.1)]
                    .map(|(kind, n, up, lift)| square(kind, n, up, lift, 1.0));
                let none = defect(&a, &b, &|_| false, 1.0, true);
                assert!(none < 1e-11, "{kind:?} {n}, {other:?} {m}: {none:e}");
                // Nodes without multipliers, as on an edge that is held.
                let held = |k: u32| (a.points()[k as usize][2] - 5.0).abs() < 1e-9;
                let some = defect(&a, &b, &held, 1.0, true);
                assert!(some < 1e-11, "{kind:?} {n}, {other:?} {m}, held: {some:e}");
            }
        }
    }
}

#[test]
fn constant_pressures_and_linear_displacements_pass_in_the_plane() {
    let kinds = [CellKind::Line2, CellKind::Line3];
    for kind in kinds {
        for other in kinds {
            for (n, m) in [(3, 5), (5, 3), (1, 7), (4, 4)] {
                let [a, b] = [(kind, n, true), (other, m, false)]
                    .map(|(kind, n, up)| line(kind, n, up, 1.0));
                let worst = defect(&a, &b, &|_| false, 1.0, true);
                assert!(worst < 1e-12, "{kind:?} {n}, {other:?} {m}: {worst:e}");
                let worst = defect(&a, &b, &|k| k == 0, 1.0, true);
                assert!(
                    worst < 1e-12,
                    "{kind:?} {n}, {other:?} {m}, held: {worst:e}"
                );
            }
        }
    }
}

/// The multiplier side is longer than the other one: its last nodes carry no multipliers, and the pressure on the other
/// side is still constant.
#[test]
fn pressures_are_constant_up_to_the_edge_of_the_contact() {
    for length in [0.61, 0.7, 0.93] {
        for kind in [CellKind::Line2, CellKind::Line3] {
            let [a, b] =
                [(5, true, 1.0), (4, false, length)].map(|(n, up, l)| line(kind, n, up, l));
            let worst = defect(&a, &b, &|_| false, length, false);
            assert!(worst < 1e-12, "{kind:?} {length}: {worst:e}");
        }
        for kind in SURFACES {
            let [a, b] = [(4, true, 0.0, 1.0), (3, false, 0.1, length)]
                .map(|(n, up, lift, l)| square(kind, n, up, lift, l));
            let worst = defect(&a, &b, &|_| false, length * length, false);
            assert!(worst < 1e-10, "{kind:?} {length}: {worst:e}");
        }
    }
}

#[test]
fn nodes_that_match_have_rows_of_two_terms() {
    let [a, b] = [true, false].map(|up| line(CellKind::Line2, 5, up, 1.0));
    let list = rows(&a, &b, &samples(&a, &b, 0.1), &|_| false, &|_| 1.0);
    assert_eq!(list.len(), 6);
    for row in list {
        assert_eq!(row.own.len(), 1);
        assert_eq!((row.own[0].0, row.other[0].0), (row.node, row.node));
        assert!(
            (row.other[0].1 - 1.0).abs() < 1e-14
                && row.other[1..].iter().all(|t| t.1.abs() < 1e-14)
        );
    }
}

/// A factor that is the same everywhere multiplies areas and nothing else: nodes carry multipliers as without it, also
/// those with little opposite.
#[test]
fn a_constant_factor_changes_areas_alone() {
    for length in [0.6, 0.63, 0.7, 0.78] {
        let [a, b] =
            [(5, true, 1.0), (4, false, length)].map(|(n, up, l)| line(CellKind::Line2, n, up, l));
        let list = samples(&a, &b, 0.1);
        let plain = rows(&a, &b, &list, &|_| false, &|_| 1.0);
        for factor in [0.125, 64.0] {
            let found = rows(&a, &b, &list, &|_| false, &|_| factor);
            assert_eq!(found.len(), plain.len(), "{length} {factor}");
            for (row, old) in found.iter().zip(&plain) {
                assert_eq!(row.node, old.node);
                assert!((row.area / (factor * old.area) - 1.0).abs() < 1e-14);
            }
        }
    }
}
