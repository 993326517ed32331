//! The choice of vertices: nodes that hold subdomains to each other.
//!
//! Edges end in vertices. If two subdomains share sides, the vertices that they have in common hold every rigid motion
//! of one against the other, and hold it well: two in the plane and three in space, as far from each other as the
//! common nodes allow, up to a factor. Then no subdomain with fixed vertices can move rigidly, and the assembly at the
//! vertices is as stiff as the mesh itself. See Lesoinne (2003) for the triangle of largest area.

use std::collections::BTreeMap;

use super::classes::{ClassKind, Classes};
use super::sharing::Sharing;
use crate::cells::Cells;
use base::linalg::apart::complete;
use base::linalg::lists::Lists;

/// Which nodes are vertices.
pub(super) fn choose(
    cells: &Cells,
    around: &Lists,
    points: &[[f64; 3]],
    sharing: &Sharing,
    classes: &Classes,
) -> Vec<bool> {
    let corner = corners(cells, sharing.n_nodes());
    let mut vertex = vec![false; sharing.n_nodes()];
    for node in sharing.shared() {
        vertex[node as usize] = classes.kind(node) == Some(ClassKind::Vertex);
    }
    ends(cells, around, sharing, classes, &corner, &mut vertex);
    let space = cells.kinds().first().is_some_and(|k| k.dim() == 3);
    fix_motions(points, sharing, classes, &corner, space, &mut vertex);
    vertex
}

/// Whether each node is a corner of a cell; the others are middles.
fn corners(cells: &Cells, n_nodes: usize) -> Vec<bool> {
    let mut corner = vec![false; n_nodes];
    for (kind, nodes) in cells.iter() {
        nodes[..kind.corners()]
            .iter()
            .for_each(|&n| corner[n as usize] = true);
    }
    corner
}

/// Marks the ends of the edges in space: one node of each group of neighbours in which an edge ends, and the last node
/// of an edge that ends nowhere. An edge of one node that ends nowhere is such a node.
fn ends(
    cells: &Cells,
    around: &Lists,
    sharing: &Sharing,
    classes: &Classes,
    corner: &[bool],
    vertex: &mut [bool],
) {
    let mut degree = vec![0u8; sharing.n_nodes()];
    let mut goals: Vec<(u32, u32)> = Vec::new();
    for &(a, b) in classes.pairs() {
        if classes.same(a, b) {
            for node in [a, b] {
                degree[node as usize] = degree[node as usize].saturating_add(1);
            }
        }
        for (a, b) in [(a, b), (b, a)] {
            if corner[b as usize] && classes.ends_at(a, b) {
                goals.push((a, b));
            }
        }
    }
    goals.sort_unstable();
    let goals_of = |node: u32| {
        let first = goals.partition_point(|g| g.0 < node);
        goals[first..]
            .iter()
            .take_while(move |g| g.0 == node)
            .map(|g| g.1)
    };
    for (kind, nodes) in classes.entities(cells, &vec![false; sharing.n_nodes()]) {
        if kind != ClassKind::Edge {
            continue;
        }
        let mut goals: Vec<u32> = nodes.iter().flat_map(|&node| goals_of(node)).collect();
        goals.sort_unstable();
        goals.dedup();
        for group in groups(cells, around, &goals) {
            let rank = |node: &&u32| {
                (
                    vertex[**node as usize],
                    sharing.of(**node).len(),
                    u32::MAX - **node,
                )
            };
            if let Some(&end) = group.iter().max_by_key(rank) {
                vertex[end as usize] = true;
            }
        }
        for &node in &nodes {
            let i = node as usize;
            if degree[i] <= 1 && corner[i] && goals_of(node).next().is_none() {
                vertex[i] = true;
            }
        }
    }
}

/// Groups of nodes that hang together because cells have two of them.
fn groups(cells: &Cells, around: &Lists, nodes: &[u32]) -> Vec<Vec<u32>> {
    let mut left = nodes.to_vec();
    let mut groups = Vec::new();
    while let Some(first) = left.pop() {
        let mut group = vec![first];
        let mut next = 0;
        while next < group.len() {
            let here = around.at(group[next] as usize);
            let near = |node: &u32| here.iter().any(|&c| cells.nodes(c as usize).contains(node));
            let (found, others) = left.iter().partition::<Vec<u32>, _>(|node| near(node));
            left = others;
            group.extend(found);
            next += 1;
        }
        groups.push(group);
    }
    groups
}

/// Adds vertices until each two subdomains with common sides hold each other.
fn fix_motions(
    points: &[[f64; 3]],
    sharing: &Sharing,
    classes: &Classes,
    corner: &[bool],
    space: bool,
    vertex: &mut [bool],
) {
    let mut common: BTreeMap<(u32, u32), Vec<u32>> = BTreeMap::new();
    for node in sharing.shared().filter(|&n| corner[n as usize]) {
        let parts = sharing.of(node);
        for (k, &p) in parts.iter().enumerate() {
            for &q in &parts[k + 1..] {
                common.entry((p, q)).or_default().push(node);
            }
        }
    }
    for (&pair, nodes) in &common {
        let mut chosen: Vec<usize> = (0..nodes.len())
            .filter(|&k| vertex[nodes[k] as usize])
            .collect();
        // Subdomains without a common side hold each other through others. One edge around may be all they share.
        let neighbours = classes.neighbours(pair);
        if neighbours || chosen.is_empty() {
            let place = |k: usize| points[nodes[k] as usize];
            complete(nodes.len(), place, space && neighbours, &mut chosen);
            chosen
                .iter()
                .for_each(|&k| vertex[nodes[k] as usize] = true);
        }
    }
}
