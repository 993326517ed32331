//! Parameters along the sides of meshes of cells.

use std::collections::{BTreeMap, HashSet};

use base::linalg::vec3::{minus, norm};
use mesh::CellMesh;

/// Parameters of nodes of a side: in the plane the length along it, on solids the place between the least and greatest
/// of the two coordinates that vary most; from 0 to 1.
pub(crate) fn parameters(mesh: &CellMesh, side: usize, nodes: &[usize]) -> Vec<[f64; 2]> {
    match mesh.dim {
        2 => along_curve(mesh, side, nodes),
        _ => in_a_plane(mesh, nodes),
    }
}

fn in_a_plane(mesh: &CellMesh, nodes: &[usize]) -> Vec<[f64; 2]> {
    let range = |d: usize| {
        let of = nodes.iter().map(|&k| mesh.points[k][d]);
        let low = of.clone().fold(f64::INFINITY, f64::min);
        (low, of.fold(f64::NEG_INFINITY, f64::max) - low)
    };
    let ranges = [0, 1, 2].map(range);
    let across = (0..3)
        .min_by(|&a, &b| ranges[a].1.total_cmp(&ranges[b].1))
        .unwrap_or(2);
    let along: Vec<usize> = (0..3).filter(|&d| d != across).collect();
    let at = |point: [f64; 3]| {
        [0, 1].map(|k| {
            let (low, length) = ranges[along[k]];
            if length > 0.0 {
                ((point[along[k]] - low) / length).clamp(0.0, 1.0)
            } else {
                0.0
            }
        })
    };
    nodes.iter().map(|&k| at(mesh.points[k])).collect()
}

/// Lengths along the chains of edges between the nodes, one chain after the other. A chain begins at its end of least
/// coordinates, a closed one at its node of least coordinates.
fn along_curve(mesh: &CellMesh, side: usize, nodes: &[usize]) -> Vec<[f64; 2]> {
    let meant: HashSet<usize> = nodes.iter().copied().collect();
    let mut beside: BTreeMap<usize, Vec<usize>> = nodes.iter().map(|&k| (k, Vec::new())).collect();
    for &(cell, face) in &mesh.sides[side].faces {
        let mut chain: Vec<usize> = mesh
            .cells
            .side_nodes(cell as usize, face.into())
            .map(|k| k as usize)
            .collect();
        // The middle of a segment comes last among its nodes.
        if let [_, b, middle] = chain[..] {
            (chain[1], chain[2]) = (middle, b);
        }
        for pair in chain
            .windows(2)
            .filter(|p| p.iter().all(|k| meant.contains(k)))
        {
            for (from, to) in [(pair[0], pair[1]), (pair[1], pair[0])] {
                beside.entry(from).or_default().push(to);
            }
        }
    }
    let mut starts: Vec<usize> = nodes.to_vec();
    let order = |a: &usize, b: &usize| {
        let key = |k: usize| (beside[&k].len() != 1, mesh.points[k]);
        key(*a)
            .partial_cmp(&key(*b))
            .unwrap_or(std::cmp::Ordering::Equal)
    };
    starts.sort_by(order);
    let mut length: BTreeMap<usize, f64> = BTreeMap::new();
    let mut total = 0.0;
    for start in starts {
        if length.contains_key(&start) {
            continue;
        }
        let mut here = start;
        length.insert(here, total);
        while let Some(&next) = beside[&here].iter().find(|k| !length.contains_key(k)) {
            total += norm(minus(mesh.points[next], mesh.points[here]));
            length.insert(next, total);
            here = next;
        }
    }
    let scale = if total > 0.0 { total } else { 1.0 };
    nodes.iter().map(|k| [length[k] / scale, 0.0]).collect()
}
