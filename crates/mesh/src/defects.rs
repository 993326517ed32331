//! Defects of a mesh of cells: nodes that are there twice, nodes that hang on the side of a cell, and cells that lie on
//! each other.

use std::collections::HashSet;

use super::cell_mesh::CellMesh;
use super::point_grid::PointGrid;
use arrayvec::ArrayVec;
use base::linalg::vec3::{cross, dot, minus, norm};

/// Two nodes of a body are one if their distance is at most this fraction of the body's size.
const SAME: f64 = 1e-9;

/// A node lies on a side if its distance is at most this fraction of the side's length.
const ON: f64 = 1e-6;

/// A node lies on a curved edge if its distance is at most this fraction of the height of the edge's arc. Where two
/// edges replace one, their nodes are on the true curve. A parabola differs from an arc of 60 degrees by 0.017 of its
/// height.
const ON_ARC: f64 = 0.02;

/// A kind of defect in a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Defect {
    /// The first place, as a sentence without its end.
    pub first: String,
    /// The proper state that was expected instead.
    pub expected: &'static str,
    /// Number of places.
    pub places: usize,
}

impl Defect {
    /// The defect at `places`, each as a sentence; `None` if there is none.
    fn of(mut places: impl Iterator<Item = String>, expected: &'static str) -> Option<Defect> {
        let first = places.next()?;
        Some(Defect {
            first,
            expected,
            places: 1 + places.count(),
        })
    }
}

/// The nodes of sides that a joint names two of: a body that touches or ties itself may have nodes of one on the other.
pub fn of_both_sides<'a>(
    mesh: &CellMesh,
    joints: impl IntoIterator<Item = [&'a str; 2]>,
) -> HashSet<u32> {
    let side = |name: &str| mesh.sides.iter().find(|s| s.name == name);
    let both = joints.into_iter().filter(|[a, b]| a != b);
    let both = both.filter_map(|[a, b]| Some([side(a)?, side(b)?]));
    both.flatten().flat_map(|s| &s.nodes).copied().collect()
}

/// The defects of a mesh, at most one of each kind. Equations, ties and contacts join the nodes `joined` to others:
/// they may be there twice, and hang.
pub fn defects(mesh: &CellMesh, joined: &HashSet<u32>) -> Vec<Defect> {
    let kinds = [doubled(mesh, joined), hanging(mesh, joined), folded(mesh)];
    kinds.into_iter().flatten().collect()
}

/// Two nodes at one place: the mesh is torn there.
fn doubled(mesh: &CellMesh, joined: &HashSet<u32>) -> Option<Defect> {
    let range = |d: usize| {
        let of = mesh.points.iter().map(|p| p[d]);
        let low = of.clone().fold(f64::INFINITY, f64::min);
        of.fold(f64::NEG_INFINITY, f64::max) - low
    };
    let near = SAME * (0..3).map(range).fold(0.0, f64::max);
    // Cells much wider than the distance: most searches look into one of them.
    let grid = PointGrid::new(mesh.points.iter().copied().enumerate(), 1e4 * near);
    let twice = mesh.points.iter().enumerate().filter_map(|(k, point)| {
        let apart = |l: usize| ![l, k].iter().all(|&n| joined.contains(&(n as u32)));
        let same = |&l: &usize| l < k && norm(minus(mesh.points[l], *point)) <= near && apart(l);
        let other = grid.around(*point, near).find(same)?;
        let (a, b) = (mesh.node_ids[other], mesh.node_ids[k]);
        Some(format!("nodes {a} and {b} are both at {point:?}"))
    });
    Defect::of(twice, "one node was expected where cells of a body meet")
}

/// Two cells on one side of the side that they share. Both have its nodes in the same order, where neighbours have them
/// in opposite orders. The centres are looked at, too: an inverted cell has a sentence of its own.
fn folded(mesh: &CellMesh) -> Option<Defect> {
    let adjacency = mesh.adjacency();
    let sides = |c: usize| 0..mesh.cells.kind(c).sides().len();
    let behind = |(c, side): (usize, usize)| {
        let other = adjacency.across(c, side)? as usize;
        // Every pair is looked at once.
        if other < c {
            return None;
        }
        let on = corners(mesh, c, side);
        let twin = |s: &usize| {
            let theirs = corners(mesh, other, *s);
            theirs.len() == on.len() && theirs.iter().all(|k| on.contains(k))
        };
        let theirs = corners(mesh, other, sides(other).find(twin)?);
        let one_side = || ahead(mesh, c, &on) * ahead(mesh, other, &on) > 0.0;
        // Sound neighbours have opposite orders: nothing else is looked at.
        (same_order(&on, &theirs) && one_side()).then(|| {
            let [a, b] = [c, other].map(|c| mesh.cell_ids[c]);
            let nodes: Vec<String> = on.iter().map(|&k| mesh.node_ids[k as usize].to_string()).collect();
            let nodes = nodes.join(", ");
            format!("cells {a} and {b} lie on the same side of the side that they share (nodes {nodes})")
        })
    };
    let all = (0..mesh.cells.len()).flat_map(|c| sides(c).map(move |side| (c, side)));
    Defect::of(all.filter_map(behind), "one on each side was expected")
}

/// The corners of a side of a cell.
fn corners(mesh: &CellMesh, cell: usize, side: usize) -> ArrayVec<u32, 4> {
    let n = mesh.cells.kind(cell).sides()[side].kind.corners();
    mesh.cells.side_nodes(cell, side).take(n).collect()
}

/// Whether two lists of the same corners go around them the same way.
fn same_order(a: &[u32], b: &[u32]) -> bool {
    match (a, b.iter().position(|k| *k == a[0])) {
        // A segment has one way there and one back.
        ([_, _], first) => first == Some(0),
        (_, Some(first)) => b[(first + 1) % b.len()] == a[1],
        (_, None) => false,
    }
}

/// How far the centre of a cell is in front of the plane through some corners, times an area.
fn ahead(mesh: &CellMesh, cell: usize, on: &[u32]) -> f64 {
    let mean = |points: &[[f64; 3]]| {
        [0, 1, 2].map(|d| points.iter().map(|p| p[d]).sum::<f64>() / points.len() as f64)
    };
    let on: ArrayVec<[f64; 3], 4> = on.iter().map(|&k| mesh.points[k as usize]).collect();
    let along = minus(on[1], on[0]);
    let normal = match on[..] {
        [_, _] => [along[1], -along[0], 0.0],
        [a, b, p, q] => cross(minus(p, a), minus(q, b)),
        _ => cross(along, minus(on[2], on[0])),
    };
    let all = mesh.cell_points(cell);
    dot(
        normal,
        minus(mean(&all[..mesh.cells.kind(cell).corners()]), mean(&on)),
    )
}

/// A node on the side of a cell that does not have it.
fn hanging(mesh: &CellMesh, joined: &HashSet<u32>) -> Option<Defect> {
    let skin = &mesh.sides[mesh.skin()];
    let outline = |&(cell, side): &(u32, u8)| {
        let (cell, side) = (cell as usize, usize::from(side));
        let nodes: Vec<u32> = mesh.cells.side_nodes(cell, side).collect();
        let places = corners(mesh, cell, side).into_iter();
        let places: Vec<[f64; 3]> = places.map(|k| mesh.points[k as usize]).collect();
        (nodes, places)
    };
    let length = |corners: &[[f64; 3]]| norm(minus(corners[1], corners[0]));
    let mean = skin
        .faces
        .iter()
        .map(|face| length(&outline(face).1))
        .sum::<f64>()
        / skin.faces.len() as f64;
    let nodes = skin.nodes.iter();
    let grid = PointGrid::new(nodes.map(|&k| (k as usize, mesh.points[k as usize])), mean);
    let hung = skin.faces.iter().filter_map(|face| {
        let (nodes, corners) = outline(face);
        let near = ON * length(&corners);
        let straight = is_straight(mesh, &nodes, &corners, near);
        // A curved edge reaches beyond its corners by less than its length.
        let slack = if straight { near } else { length(&corners) };
        let bound = |f: fn(f64, f64) -> f64, d: usize| {
            corners.iter().map(|c| c[d]).reduce(f).unwrap_or_default()
        };
        let low = [0, 1, 2].map(|d| bound(f64::min, d) - slack);
        let high = [0, 1, 2].map(|d| bound(f64::max, d) + slack);
        let hangs = |&k: &usize| {
            let (node, x) = (k as u32, mesh.points[k]);
            // A second node at the place of a node of the side does not hang.
            let of_side = |&l: &u32| l == node || norm(minus(mesh.points[l as usize], x)) <= near;
            !joined.contains(&node)
                && if straight {
                    on(&corners, x, near)
                } else {
                    on_edge(mesh, &nodes, &corners, x, near)
                }
                && !nodes.iter().any(of_side)
        };
        let k = grid.within(low, high).find(hangs)?;
        Some(format!(
            "node {} at {:?} hangs on a side of cell {}, which does not have it",
            mesh.node_ids[k], mesh.points[k], mesh.cell_ids[face.0 as usize]
        ))
    });
    Defect::of(hung, "neighbours with common nodes were expected")
}

/// Whether the middle nodes of a side are in the middle of its edges: the corners say little of a curved side.
fn is_straight(mesh: &CellMesh, nodes: &[u32], corners: &[[f64; 3]], near: f64) -> bool {
    let n = corners.len();
    let edges = if n == 2 { 1 } else { n };
    let middle = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % n]);
        [0, 1, 2].map(|d| 0.5 * (a[d] + b[d]))
    };
    let at = |k: usize| nodes.get(n + k).map(|&node| mesh.points[node as usize]);
    (0..edges).all(|k| at(k).is_none_or(|x| norm(minus(x, middle(k))) <= near))
}

/// Whether a point is on an edge of a curved side, away from its nodes. Of curved faces this finds what splits an edge,
/// as every cut into smaller faces does; nodes that hang inside a face, between whole edges, are not found.
fn on_edge(mesh: &CellMesh, nodes: &[u32], corners: &[[f64; 3]], x: [f64; 3], near: f64) -> bool {
    let n = corners.len();
    let edges = if n == 2 { 1 } else { n };
    (0..edges).any(|k| {
        let ends = [corners[k], corners[(k + 1) % n]];
        match nodes.get(n + k).map(|&node| mesh.points[node as usize]) {
            Some(m) => on_arc(&ends, m, x, near),
            None => on(&ends, x, near),
        }
    })
}

/// Whether a point is on a curved edge with the middle node m, away from its nodes.
fn on_arc(ends: &[[f64; 3]], m: [f64; 3], x: [f64; 3], near: f64) -> bool {
    let (a, b) = (ends[0], ends[1]);
    // p(t) = (1 - t²) m + ½ t (t - 1) a + ½ t (t + 1) b with -1 ≤ t ≤ 1.
    let bend = [0, 1, 2].map(|d| 0.5 * (a[d] + b[d]) - m[d]);
    let chord = [0, 1, 2].map(|d| 0.5 * (b[d] - a[d]));
    let away = |t: f64| [0, 1, 2].map(|d| m[d] + t * (chord[d] + t * bend[d]) - x[d]);
    let reach = near.max(ON_ARC * norm(bend));
    // The curve is nowhere farther from its chord than in the middle.
    let from = [0, 1, 2].map(|d| x[d] - m[d] - bend[d]);
    let along = (dot(from, chord) / dot(chord, chord)).clamp(-1.0, 1.0);
    let beside = norm([0, 1, 2].map(|d| from[d] - along * chord[d]));
    if beside > norm(bend) + reach {
        return false;
    }
    // The nearest point: Newton's method for the smallest of the distances at a few points.
    let samples = (-8..=8).map(|k| f64::from(k) / 8.0);
    let Some(mut t) = samples.min_by(|s, t| norm(away(*s)).total_cmp(&norm(away(*t)))) else {
        return false;
    };
    for _ in 0..8 {
        let (p, slope) = (away(t), [0, 1, 2].map(|d| chord[d] + 2.0 * t * bend[d]));
        let curvature = dot(slope, slope) + 2.0 * dot(p, bend);
        if curvature > 0.0 {
            t = (t - dot(p, slope) / curvature).clamp(-1.0, 1.0);
        }
    }
    let nodes = [a, b, m];
    norm(away(t)) <= reach && nodes.iter().all(|node| norm(minus(*node, x)) > 2.0 * reach)
}

/// Whether a point is on a segment, or on a triangle or quadrilateral (of two triangles), away from its corners.
fn on(corners: &[[f64; 3]], x: [f64; 3], near: f64) -> bool {
    if corners.iter().any(|c| norm(minus(*c, x)) <= near) {
        return false;
    }
    let segment = |a: [f64; 3], b: [f64; 3]| {
        let (edge, from) = (minus(b, a), minus(x, a));
        let t = dot(edge, from) / dot(edge, edge);
        (0.0..=1.0).contains(&t) && norm(minus(from, edge.map(|v| t * v))) <= near
    };
    let triangle = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        let normal = cross(minus(b, a), minus(c, a));
        let area = norm(normal);
        if area == 0.0 || dot(minus(x, a), normal).abs() > near * area {
            return false;
        }
        let part = |p: [f64; 3], q: [f64; 3]| dot(cross(minus(p, x), minus(q, x)), normal);
        let least = -1e-9 * area * area;
        part(a, b) >= least && part(b, c) >= least && part(c, a) >= least
    };
    match *corners {
        [a, b] => segment(a, b),
        [a, b, c] => triangle(a, b, c),
        [a, b, c, d] => triangle(a, b, c) || triangle(a, c, d),
        _ => false,
    }
}
