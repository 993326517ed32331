//! Unit tests of `crates/lab/src/baselines/bench/shapes`.

use super::*;
use base::linalg::vec3::{cross, dot, minus, norm};
use elements::kind::CellKind;
use mesh::{Members, MeshFile};

/// The cells of a group.
fn group<'a>(mesh: &'a MeshFile, name: &str) -> &'a [u32] {
    let group = mesh.groups.iter().find(|g| g.name == name);
    match &group.unwrap_or_else(|| panic!("no group {name}")).members {
        Members::Cells { cells, .. } => cells,
        other => panic!("{name}: {other:?}"),
    }
}

fn corners(mesh: &MeshFile, cell: u32, n: usize) -> Vec<[f64; 3]> {
    let nodes = &mesh.cells.nodes(cell as usize)[..n];
    nodes.iter().map(|&n| mesh.points[n as usize]).collect()
}

/// Length, area or volume of the cells of a group, by their corners; all have to be positive.
fn measure(mesh: &MeshFile, name: &str) -> f64 {
    let of = |&c: &u32| {
        let dim = mesh.cells.kind(c as usize).dim();
        let x = corners(mesh, c, dim + 1);
        let edge = |k: usize| minus(x[k], x[0]);
        let size = match dim {
            1 => norm(edge(1)),
            2 => 0.5 * norm(cross(edge(1), edge(2))),
            _ => dot(cross(edge(1), edge(2)), edge(3)) / 6.0,
        };
        assert!(size > 0.0, "{name}: cell {c} has size {size}");
        size
    };
    group(mesh, name).iter().map(of).sum()
}

/// The area of a polygon with `n` corners on a circle.
fn polygon(radius: f64, n: f64) -> f64 {
    0.5 * n * radius.powi(2) * (std::f64::consts::TAU / n).sin()
}

#[test]
fn the_plate_is_a_square_without_its_holes() {
    let mesh = plate(100);
    for side in ["left", "right", "bottom", "top"] {
        let n = group(&mesh, side).len();
        assert!(
            n == 100 && (measure(&mesh, side) - 1.0).abs() < 1e-12,
            "{side}: {n}"
        );
    }
    // A polygon of edges e has its circumference and area in the radius of the circle around it.
    let rim = measure(&mesh, "holes");
    let holes = 1.0 - measure(&mesh, "plate");
    let radii: Vec<f64> = (0..25)
        .map(|k| 0.03 + 0.01 * ((7 * (k % 5) + 3 * (k / 5)) % 5) as f64)
        .collect();
    let n = |r: f64| (100.0 * std::f64::consts::TAU * r).ceil();
    let area: f64 = radii.iter().map(|&r| polygon(r, n(r))).sum();
    let length: f64 = radii
        .iter()
        .map(|&r| 2.0 * n(r) * r * (std::f64::consts::PI / n(r)).sin())
        .sum();
    assert!((holes - area).abs() < 1e-12, "{holes} {area}");
    assert!((rim - length).abs() < 1e-10, "{rim} {length}");
    for t in group(&mesh, "plate") {
        let x = corners(&mesh, *t, 3);
        for k in 0..3 {
            let [u, v] = [1, 2].map(|i| minus(x[(k + i) % 3], x[k]));
            let angle = (norm(cross(u, v))).atan2(dot(u, v)).to_degrees();
            assert!(angle > 25.0, "an angle of {angle} degrees in triangle {t}");
        }
    }
}

#[test]
fn the_rod_has_its_parts_and_surfaces() {
    let [linear, quadratic] = [false, true].map(|q| rod(2.5e-3, q));
    assert!(linear.cells.kinds().contains(&CellKind::Tet4));
    assert!(quadratic.cells.kinds().contains(&CellKind::Tet10));
    let count = |r: f64| 4.0 * (r * std::f64::consts::FRAC_PI_2 / 2.5e-3).ceil();
    for mesh in [&linear, &quadratic] {
        let volume = |name: &str| measure(mesh, name);
        // Journal and pin are cylinders over polygons, half the eyes' thickness high.
        for (name, bore, end, r) in [
            ("journal", "journal_bore", "journal_end", 0.025),
            ("pin", "pin_bore", "pin_end", 0.011),
        ] {
            let area = polygon(r, count(r));
            assert!((measure(mesh, end) - area).abs() < 1e-9 * area, "{end}");
            assert!((volume(name) - 0.010 * area).abs() < 1e-9 * area, "{name}");
            let rim = 2.0 * count(r) * r * (std::f64::consts::PI / count(r)).sin();
            assert!(
                (measure(mesh, bore) - 0.010 * rim).abs() < 1e-9 * rim,
                "{bore}"
            );
        }
        let parting = measure(mesh, "parting");
        assert!((parting - 2.0 * 0.015 * 0.010).abs() < 1e-12, "{parting}");
        // Half a ring of circles; the polygons of this edge length miss a thousandth of it or two.
        let ring = 0.5 * std::f64::consts::PI * (0.04f64.powi(2) - 0.025f64.powi(2)) * 0.010;
        assert!(
            (volume("cap") - ring).abs() < 5e-3 * ring,
            "{} {ring}",
            volume("cap")
        );
        // Half the ring, the small eye, and a shank that is thicker towards both eyes: 2.6 rings.
        assert!(
            (2.3..2.8).contains(&(volume("rod") / ring)),
            "{}",
            volume("rod")
        );
    }
    // Nodes of second order lie in the middles of edges, in the order that the kind says.
    for &c in group(&quadratic, "rod") {
        let at = corners(&quadratic, c, 10);
        for (k, [p, q]) in [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]]
            .into_iter()
            .enumerate()
        {
            let middle = [0, 1, 2].map(|d| 0.5 * (at[p][d] + at[q][d]));
            assert!(norm(minus(at[4 + k], middle)) < 1e-15);
        }
    }
}
