use std::collections::BTreeSet;

use super::super::meshes::{
    hexes, middle, mixed, quads, second_order, tets, triangles, without, Mesh,
};
use super::super::Partition;
use super::*;
use crate::MeshPartition;

struct Cut {
    part: Vec<u32>,
    adjacency: Adjacency,
    sharing: Sharing,
    interface: Interface,
}

/// The interface of given parts, and what holds of every interface.
fn of_parts(mesh: &Mesh, part: Vec<u32>, rims: bool) -> Cut {
    let adjacency = Adjacency::new(&mesh.cells);
    let n = part.iter().max().map_or(0, |&p| p as usize + 1);
    let sharing = Sharing::new(&mesh.cells, &part, n, mesh.points.len());
    let interface = Interface::new(&mesh.cells, &adjacency, &mesh.points, &part, &sharing, rims);
    let cut = Cut {
        part,
        adjacency,
        sharing,
        interface,
    };
    check(mesh, &cut);
    cut
}

fn into(mesh: &Mesh, n: usize, rims: bool) -> Cut {
    let work = vec![1.0; mesh.cells.len()];
    of_parts(
        mesh,
        Partition::new(&mesh.cells, &Adjacency::new(&mesh.cells), &work, n).part,
        rims,
    )
}

/// The parts of blocks of a grid.
fn blocks(mesh: &Mesh, n: [usize; 3], each: [f64; 3]) -> Vec<u32> {
    let part = |c: usize| {
        let x = middle(mesh, c);
        let [i, j, k] = [0, 1, 2].map(|d| (x[d] / each[d]) as usize);
        ((k * n[1] + j) * n[0] + i) as u32
    };
    (0..mesh.cells.len()).map(part).collect()
}

fn counts(cut: &Cut) -> [usize; 3] {
    let i = &cut.interface;
    [i.vertices.len(), i.edges.len(), i.faces.len()]
}

/// The subdomains of an edge or face.
fn sharers<'a>(cut: &'a Cut, nodes: &[u32]) -> &'a [u32] {
    cut.sharing.of(nodes[0])
}

/// Every shared node is in one vertex, edge or face, with the right subdomains, which all know of it.
fn check(mesh: &Mesh, cut: &Cut) {
    let mut times = vec![0; mesh.points.len()];
    let i = &cut.interface;
    i.vertices.iter().for_each(|&n| times[n as usize] += 1);
    for nodes in i.edges.iter().chain(&i.faces) {
        assert!(nodes.is_sorted() && !nodes.is_empty());
        for &n in nodes {
            times[n as usize] += 1;
            assert_eq!(cut.sharing.of(n), sharers(cut, nodes));
        }
    }
    // By another way: the parts of all cells that have a node.
    let mut having = vec![BTreeSet::new(); mesh.points.len()];
    for (c, (_, nodes)) in mesh.cells.iter().enumerate() {
        nodes.iter().for_each(|&n| {
            having[n as usize].insert(cut.part[c]);
        });
    }
    let parts = MeshPartition::new(cut.part.clone(), cut.sharing.clone(), i.clone());
    for (n, (having, times)) in having.iter().zip(times).enumerate() {
        assert!(having.iter().eq(cut.sharing.of(n as u32)));
        assert!(having.iter().eq(parts.sharers(n)));
        assert_eq!(times, usize::from(having.len() > 1), "node {n}");
        assert_eq!(parts.is_vertex(n), i.vertices.contains(&(n as u32)));
    }
    for p in 0..parts.len() {
        let has = |n: u32| having[n as usize].contains(&(p as u32));
        let all = (0..mesh.points.len() as u32).filter(|&n| has(n));
        assert!(all.eq(parts.nodes(p).iter().copied()), "subdomain {p}");
        let edges = i.edges.iter().map(|nodes| (1, nodes));
        let entities = edges.chain(i.faces.iter().map(|nodes| (2, nodes)));
        let mine = entities.enumerate().filter(|(_, (_, e))| has(e[0]));
        let mine = mine.map(|(k, (dim, nodes))| (k, dim, &nodes[..]));
        assert!(mine.eq(parts.entities(p)), "subdomain {p}");
    }
}

/// Rows of constraints on the rigid motions of all subdomains: at every vertex the subdomains move alike. Returns the
/// number of motions of the assembly that are left, by elimination.
fn motions_left(mesh: &Mesh, cut: &Cut) -> usize {
    let plane = mesh.cells.kind(0).dim() == 2;
    let each = if plane { 3 } else { 6 };
    let n = each * cut.sharing.n;
    let scale = mesh
        .points
        .iter()
        .flatten()
        .fold(1.0f64, |a, x| a.max(x.abs()));
    let motion = |x: [f64; 3], component: usize| -> Vec<f64> {
        let [x, y, z] = x.map(|x| x / scale);
        match (plane, component) {
            (true, 0) => vec![1.0, 0.0, -y],
            (true, _) => vec![0.0, 1.0, x],
            (false, 0) => vec![1.0, 0.0, 0.0, 0.0, z, -y],
            (false, 1) => vec![0.0, 1.0, 0.0, -z, 0.0, x],
            (false, _) => vec![0.0, 0.0, 1.0, y, -x, 0.0],
        }
    };
    let mut basis: Vec<(usize, Vec<f64>)> = Vec::new();
    for &node in &cut.interface.vertices {
        for pair in cut.sharing.of(node).windows(2) {
            for component in 0..if plane { 2 } else { 3 } {
                let mut row = vec![0.0; n];
                for (k, v) in motion(mesh.points[node as usize], component)
                    .into_iter()
                    .enumerate()
                {
                    row[each * pair[0] as usize + k] = v;
                    row[each * pair[1] as usize + k] = -v;
                }
                for (pivot, known) in &basis {
                    let factor = row[*pivot] / known[*pivot];
                    row.iter_mut()
                        .zip(known)
                        .for_each(|(r, k)| *r -= factor * k);
                }
                let pivot = (0..n).max_by(|&a, &b| row[a].abs().total_cmp(&row[b].abs()));
                if let Some(pivot) = pivot.filter(|&p| row[p].abs() > 1e-7) {
                    basis.push((pivot, row));
                }
            }
        }
    }
    n - basis.len()
}

fn apart(mesh: &Mesh, a: u32, b: u32) -> f64 {
    let [a, b] = [a, b].map(|n| mesh.points[n as usize]);
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

fn area(mesh: &Mesh, a: u32, b: u32, c: u32) -> f64 {
    let [a, b, c] = [a, b, c].map(|n| mesh.points[n as usize]);
    let (u, v) = (
        [0, 1, 2].map(|d| b[d] - a[d]),
        [0, 1, 2].map(|d| c[d] - a[d]),
    );
    let cross = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
    (cross(0, 1).powi(2) + cross(1, 2).powi(2) + cross(2, 0).powi(2)).sqrt() / 2.0
}

/// The largest distance of two nodes or area of three.
fn best(mesh: &Mesh, nodes: &[u32]) -> f64 {
    let mut best = 0.0f64;
    for (i, &a) in nodes.iter().enumerate() {
        for (j, &b) in nodes.iter().enumerate().skip(i + 1) {
            if mesh.cells.kind(0).dim() == 2 {
                best = best.max(apart(mesh, a, b));
                continue;
            }
            for &c in &nodes[j + 1..] {
                best = best.max(area(mesh, a, b, c));
            }
        }
    }
    best
}

/// Each two subdomains with a common side have vertices in common, and far apart: against all choices there are.
fn neighbours_hold(mesh: &Mesh, cut: &Cut) {
    let mut pairs = BTreeSet::new();
    for c in 0..mesh.cells.len() {
        for d in cut.adjacency.neighbours(c) {
            let (p, q) = (cut.part[c], cut.part[d as usize]);
            if p < q {
                pairs.insert((p, q));
            }
        }
    }
    for (p, q) in pairs {
        let common = |n: &u32| [p, q].iter().all(|p| cut.sharing.of(*n).contains(p));
        let all: Vec<u32> = cut.sharing.shared().filter(common).collect();
        let chosen: Vec<u32> = cut
            .interface
            .vertices
            .iter()
            .copied()
            .filter(common)
            .collect();
        let (most, have) = (best(mesh, &all), best(mesh, &chosen));
        assert!(
            have > 0.15 * most,
            "subdomains {p} and {q}: {have} of {most}"
        );
    }
}

/// By hand: blocks of bricks in a grid of 2 × 2 × 2 and 3 × 3 × 3.
#[test]
fn blocks_of_bricks() {
    let mesh = hexes([6, 6, 6]);
    let eight = blocks(&mesh, [2, 2, 2], [3.0; 3]);
    // The middle, and the middles of the six sides of the body; one edge from the middle to each; 12 faces.
    let cut = of_parts(&mesh, eight.clone(), false);
    assert_eq!(counts(&cut), [7, 6, 12]);
    assert!(cut
        .interface
        .edges
        .iter()
        .all(|e| e.len() == 2 && sharers(&cut, e).len() == 4));
    assert!(cut
        .interface
        .faces
        .iter()
        .all(|f| f.len() == 9 && sharers(&cut, f).len() == 2));
    // On the surface 24 rims, which go around the edges of the body in pairs.
    let cut = of_parts(&mesh, eight, true);
    assert_eq!(counts(&cut), [7, 18, 12]);
    assert_eq!(cut.interface.faces.iter().map(Vec::len).max(), Some(4));
    neighbours_hold(&mesh, &cut);
    let cut = of_parts(&mesh, blocks(&mesh, [3, 3, 3], [2.0; 3]), false);
    assert_eq!(counts(&cut), [8 + 24, 36, 54]);
    assert_eq!(motions_left(&mesh, &cut), 6);
}

/// By hand: blocks of squares.
#[test]
fn blocks_of_squares() {
    let mesh = quads([9, 6]);
    let cut = of_parts(&mesh, blocks(&mesh, [3, 2, 1], [3.0, 3.0, 1.0]), true);
    // Inside 2, and the ends on the boundary: 2 · 2 + 2. Edges: 4 + 3.
    assert_eq!(counts(&cut), [8, 7, 0]);
    assert!(cut
        .interface
        .edges
        .iter()
        .all(|e| e.len() == 2 && sharers(&cut, e).len() == 2));
    assert_eq!(motions_left(&mesh, &cut), 3);
}

#[test]
fn all_motions_are_held() {
    let meshes = [
        triangles([30, 20], |x, y| (x - 10.0).hypot(y - 10.0) < 4.0),
        quads([20, 20]),
        tets([6, 6, 6]),
        hexes([12, 5, 5]),
        mixed([4, 4, 6]),
        second_order(&tets([4, 4, 4])),
        second_order(&hexes([5, 5, 5])),
        second_order(&triangles([15, 15], |_, _| false)),
    ];
    for mesh in meshes {
        let rigid = if mesh.cells.kind(0).dim() == 2 { 3 } else { 6 };
        for n in [2, 5, 12] {
            for rims in [false, true] {
                let cut = into(&mesh, n, rims);
                neighbours_hold(&mesh, &cut);
                assert_eq!(motions_left(&mesh, &cut), rigid, "{n} parts");
            }
        }
    }
}

/// A subdomain inside another: what they share is closed and has no ends.
#[test]
fn one_inside_another() {
    let mesh = triangles([20, 20], |_, _| false);
    let inner =
        |c: usize| u32::from((middle(&mesh, c)[0] - 10.0).hypot(middle(&mesh, c)[1] - 10.0) < 5.0);
    let cut = of_parts(&mesh, (0..mesh.cells.len()).map(inner).collect(), true);
    assert_eq!(counts(&cut), [2, 2, 0]);
    neighbours_hold(&mesh, &cut);
    assert_eq!(motions_left(&mesh, &cut), 3);

    let mesh = hexes([6, 6, 6]);
    let inner = |c: usize| u32::from(middle(&mesh, c).iter().all(|x| (2.0..4.0).contains(x)));
    let cut = of_parts(&mesh, (0..mesh.cells.len()).map(inner).collect(), true);
    assert_eq!(counts(&cut), [3, 0, 1]);
    assert_eq!(cut.interface.faces[0].len(), 26 - 3);
    neighbours_hold(&mesh, &cut);
    assert_eq!(motions_left(&mesh, &cut), 6);
}

/// Bricks at both ends of a row are one subdomain, those between another: two faces, not one.
#[test]
fn two_faces_between_two_subdomains() {
    let mesh = without(&hexes([6, 4, 4]), |_| false);
    let ring = |c: usize| {
        let x = middle(&mesh, c);
        u32::from(x[0] > 2.0 && x[0] < 4.0 && x[1] < 2.0)
    };
    let cut = of_parts(&mesh, (0..mesh.cells.len()).map(ring).collect(), false);
    // A bar across the bottom: its two sides and its top are one face.
    assert_eq!(cut.interface.faces.len(), 1);
    let through = |c: usize| {
        let x = middle(&mesh, c);
        u32::from(x[0] > 2.0 && x[0] < 4.0)
    };
    let cut = of_parts(&mesh, (0..mesh.cells.len()).map(through).collect(), false);
    assert_eq!(cut.interface.faces.len(), 2);
    neighbours_hold(&mesh, &cut);
}

/// Pieces that touch in a node or along an edge only: a vertex; the ends of the edge. They can turn, as the mesh can.
#[test]
fn pieces_that_touch() {
    let grid = hexes([2, 2, 2]);
    let node = without(&grid, |c| c != 0 && c != 7);
    let cut = into(&node, 2, true);
    assert_eq!(counts(&cut), [1, 0, 0]);
    assert_eq!(motions_left(&node, &cut), 9);

    let long = hexes([2, 2, 5]);
    let edge = without(&long, |c| c % 4 != 0 && c % 4 != 3);
    for rims in [false, true] {
        let cut = into(&edge, 2, rims);
        assert_eq!(counts(&cut), [2, 1, 0]);
        assert_eq!(cut.interface.edges[0].len(), 4);
        assert_eq!(motions_left(&edge, &cut), 7);
    }

    let flat = without(&quads([2, 2]), |c| c == 1 || c == 2);
    let cut = into(&flat, 2, true);
    assert_eq!(counts(&cut), [1, 0, 0]);
    assert_eq!(motions_left(&flat, &cut), 4);
}

/// Nothing is shared: one subdomain, and two that do not touch.
#[test]
fn nothing_shared() {
    for mesh in [hexes([1, 1, 1]), tets([2, 2, 2]), quads([3, 3])] {
        let cut = into(&mesh, 1, true);
        assert_eq!(counts(&cut), [0, 0, 0]);
        assert_eq!(cut.sharing.shared().count(), 0);
        assert_eq!(cut.interface, Interface::default());
    }
    let apart = without(&hexes([3, 1, 1]), |c| c == 1);
    assert_eq!(counts(&into(&apart, 2, true)), [0, 0, 0]);
}

/// Every cell by itself: all nodes that are shared hold.
#[test]
fn cells_as_subdomains() {
    for mesh in [tets([2, 2, 1]), quads([3, 3]), hexes([3, 2, 2])] {
        let n = mesh.cells.len();
        let cut = into(&mesh, n, true);
        neighbours_hold(&mesh, &cut);
        assert_eq!(
            motions_left(&mesh, &cut),
            if mesh.cells.kind(0).dim() == 2 { 3 } else { 6 }
        );
    }
}

#[test]
fn needles_hold() {
    let mesh = hexes([1, 1, 60]);
    let cut = into(&mesh, 6, true);
    neighbours_hold(&mesh, &cut);
    assert_eq!(motions_left(&mesh, &cut), 6);
    let mesh = tets([1, 1, 40]);
    let cut = into(&mesh, 5, false);
    neighbours_hold(&mesh, &cut);
    assert_eq!(motions_left(&mesh, &cut), 6);
}

/// A plate of one layer of bricks: the rims above and below are not one edge, though edges of bricks join them.
#[test]
fn rims_of_a_plate() {
    let mesh = hexes([12, 6, 1]);
    let cut = of_parts(&mesh, blocks(&mesh, [2, 1, 1], [6.0, 6.0, 1.0]), true);
    for edge in &cut.interface.edges {
        let inside = |n: &&u32| (0.5..5.5).contains(&mesh.points[**n as usize][1]);
        let level = |n: &u32| mesh.points[*n as usize][2] as u64;
        let levels: BTreeSet<u64> = edge.iter().filter(inside).map(level).collect();
        assert!(levels.len() <= 1, "{edge:?}");
    }
    let nodes: usize = cut.interface.edges.iter().map(Vec::len).sum();
    assert_eq!(nodes + cut.interface.vertices.len(), 14);
    assert!(cut.interface.edges.len() >= 2);
    neighbours_hold(&mesh, &cut);
    assert_eq!(motions_left(&mesh, &cut), 6);
}
