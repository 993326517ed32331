//! A square plate with 25 round holes of different sizes.

use crate::delaunay::{build, circle, polyline, GroupNumbers, Planform};
use elements::kind::CellKind;
use mesh::MeshFile;

/// Triangles with about `across` nodes along each side of the unit square. Groups: `plate`; `left`, `right`, `bottom`,
/// `top`, `holes`.
pub(in super::super) fn plate(across: usize) -> MeshFile {
    let edge = 1.0 / across as f64;
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut curves: Vec<Vec<[f64; 2]>> = (0..4)
        .map(|k| polyline(corners[k], corners[(k + 1) % 4], across))
        .collect();
    let holes: Vec<([f64; 2], f64)> = (0..25).map(|k| hole(k % 5, k / 5)).collect();
    for &(centre, radius) in &holes {
        let n = (std::f64::consts::TAU * radius / edge).ceil() as usize;
        curves.push(circle(centre, radius, n.max(12)));
    }
    let beyond = |[x, y]: [f64; 2]| {
        let out = |&([a, b], r): &([f64; 2], f64)| (x - a).hypot(y - b) > r;
        holes.iter().all(out)
    };
    let plan = Planform::fill(&curves, edge, beyond);
    let cells: Vec<Vec<u32>> = plan
        .triangles
        .iter()
        .map(|t| t.map(|n| n as u32).to_vec())
        .collect();
    let groups = GroupNumbers {
        names: &["plate", "left", "right", "bottom", "top", "holes"],
        of_cell: vec![1; cells.len()],
    };
    let points = plan.points.iter().map(|&[x, y]| [x, y, 0.0]).collect();
    build(
        "plate.msh",
        points,
        CellKind::Triangle3,
        &cells,
        &groups,
        |[x, y, _], _| match () {
            () if x == 0.0 => 2,
            () if x == 1.0 => 3,
            () if y == 0.0 => 4,
            () if y == 1.0 => 5,
            () => 6,
        },
    )
}

/// Centre and radius of a hole. Sizes and places follow no pattern that subdomains could repeat.
fn hole(i: usize, j: usize) -> ([f64; 2], f64) {
    let radius = 0.03 + 0.01 * ((7 * i + 3 * j) % 5) as f64;
    let shift = |k: usize| 0.018 * ((k % 3) as f64 - 1.0);
    let centre = [
        0.1 + 0.2 * i as f64 + shift(i + 2 * j),
        0.1 + 0.2 * j as f64 + shift(2 * i + j + 1),
    ];
    (centre, radius)
}
