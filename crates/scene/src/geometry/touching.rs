//! The interfaces of boxes that touch: common faces, edges and corners, and the node pairs on them.

use super::facing::{coinciding, shortest};
use super::interface::{BodyInterface, InterfaceShape, Link, SharedNode, TOLERANCE};
use super::normals;
use super::sweep::near;
use crate::body::Body;
use crate::model::profile::Limits;
use base::{Error, Result};
use mesh::{BoxMesh, Mesh};
use std::collections::HashMap;

/// Pairs of bodies that touch, in order of their numbers.
pub(crate) fn touching(bodies: &[Body]) -> Result<Vec<BodyInterface>> {
    let slack = |a: usize| {
        let [low, high] = bodies[a].bounds;
        TOLERANCE
            * match bodies[a].mesh() {
                Mesh::Grid(grid) => grid.step()[0],
                Mesh::Cells(_) => high[0] - low[0],
            }
    };
    let bent = |k: usize| (&bodies[k].spec.map, &bodies[k].spec.motion);
    let mut edges: HashMap<usize, f64> = HashMap::new();
    let mut edge = |k: usize| {
        let of = || shortest(&bodies[k].spec);
        *edges.entry(k).or_insert_with(of)
    };
    let mut out = Vec::new();
    for [a, b] in near(bodies, slack) {
        match [a, b].map(|k| bodies[k].mesh().grid()) {
            [Some(x), Some(y)] if bent(a) == bent(b) => {
                out.extend(common(bodies, [x, y], [a, b])?);
            }
            _ => out.extend(coinciding(bodies, [a, b], &mut edge)),
        }
    }
    out.sort_by_key(|i| i.bodies);
    out.shrink_to_fit();
    Ok(out)
}

/// The node lines of two boxes along one direction: pairs that coincide, and those that one of them has alone.
struct NodeLines {
    /// (position, line of the first, line of the second)
    pairs: Vec<(f64, usize, usize)>,
    /// (position, line) of each body where the other has none
    alone: [Vec<(f64, usize)>; 2],
}

/// The interface of boxes `a` and `b`, unbent or bent by the same map.
fn common(
    bodies: &[Body],
    meshes: [&BoxMesh; 2],
    [a, b]: [usize; 2],
) -> Result<Option<BodyInterface>> {
    let dim = meshes[0].dim();
    let (mut low, mut high, mut stretches) = ([0.0; 3], [0.0; 3], [false; 3]);
    for d in 0..dim {
        low[d] = meshes[0].origin[d].max(meshes[1].origin[d]);
        high[d] = meshes[0].end()[d].min(meshes[1].end()[d]);
        let tolerance = TOLERANCE * meshes[0].step()[d].min(meshes[1].step()[d]);
        let length = high[d] - low[d];
        if length < -tolerance {
            return Ok(None);
        }
        stretches[d] = length > tolerance;
    }
    let along: Vec<usize> = (0..dim).filter(|&d| stretches[d]).collect();
    if along.len() == dim {
        let ranges: Vec<String> = (0..dim)
            .map(|d| format!("[{}, {}]", low[d], high[d]))
            .collect();
        return Err(Error::input(format!(
            "bodies `{}` and `{}` overlap in {} (bodies may only touch)",
            bodies[a].spec.name,
            bodies[b].spec.name,
            ranges.join(" × ")
        ))
        .at(&bodies[b].spec.location));
    }
    let lines = [0, 1, 2].map(|d| {
        if stretches[d] {
            match_lines(meshes, d, low[d], high[d])
        } else {
            // The boxes touch across this direction: the first one lies before the second if its origin is lower.
            let first_before = meshes[0].origin[d] < meshes[1].origin[d];
            let line = |body: usize| {
                if (body == 0) == first_before {
                    meshes[body].elements[d]
                } else {
                    0
                }
            };
            NodeLines {
                pairs: vec![(low[d], line(0), line(1))],
                alone: [Vec::new(), Vec::new()],
            }
        }
    });
    let t = |position: [f64; 3]| {
        let mut t = [0.0; 2];
        for (t, &d) in t.iter_mut().zip(along.iter().take(dim - 1)) {
            *t = ((position[d] - low[d]) / (high[d] - low[d])).clamp(0.0, 1.0);
        }
        t
    };
    let face = along.len() + 1 == dim;
    let across = (0..dim).find(|&d| !stretches[d]).expect("one at least");
    let first_before = meshes[0].origin[across] < meshes[1].origin[across];
    let sides = [usize::from(first_before), usize::from(!first_before)].map(|s| 2 * across + s);
    let mut shared = Vec::new();
    for &(z, ka, kb) in &lines[2].pairs {
        for &(y, ja, jb) in &lines[1].pairs {
            for &(x, ia, ib) in &lines[0].pairs {
                shared.push(SharedNode {
                    nodes: [meshes[0].node([ia, ja, ka]), meshes[1].node([ib, jb, kb])],
                    t: t([x, y, z]),
                    link: Link::Free,
                });
            }
        }
    }
    let normals = if face {
        let nodes: Vec<usize> = shared.iter().map(|s| s.nodes[0]).collect();
        normals::of_side(&bodies[a].spec, sides[0], &nodes)
    } else {
        vec![[0.0; 3]; shared.len()]
    };
    Ok(Some(BodyInterface {
        bodies: [a, b],
        shape: if face {
            InterfaceShape::Face
        } else {
            InterfaceShape::Corner
        },
        sides,
        unmatched: unmatched(meshes, &lines, t),
        order: [0, 1],
        normals,
        entry: None,
        distances: vec![0.0; shared.len()],
        shared,
        limits: Limits::default(),
        adjusted: Default::default(),
        area: None,
        mortar: None,
    }))
}

/// Nodes of one body without a partner in the other, by body and increasing t.
fn unmatched(
    meshes: [&BoxMesh; 2],
    lines: &[NodeLines; 3],
    t: impl Fn([f64; 3]) -> [f64; 2],
) -> Vec<([f64; 2], usize, usize)> {
    let mut out = Vec::new();
    if lines.iter().all(|l| l.alone.iter().all(Vec::is_empty)) {
        return out;
    }
    for (body, mesh) in meshes.iter().enumerate() {
        // Tuples (position, line, whether the other body has no such line).
        let all = [0, 1, 2].map(|d| {
            let NodeLines { pairs, alone } = &lines[d];
            let mut list: Vec<(f64, usize, bool)> = pairs
                .iter()
                .map(|&(x, i, j)| (x, [i, j][body], false))
                .chain(alone[body].iter().map(|&(x, i)| (x, i, true)))
                .collect();
            list.sort_by(|a, b| a.0.total_cmp(&b.0));
            list
        });
        for &(z, k, c) in &all[2] {
            for &(y, j, b) in &all[1] {
                for &(x, i, a) in all[0].iter().filter(|l| l.2 || b || c) {
                    debug_assert!(a || b || c);
                    out.push((t([x, y, z]), body, mesh.node([i, j, k])));
                }
            }
        }
    }
    out.sort_by(|a, b| {
        let t = |e: &([f64; 2], usize, usize)| (e.0[1], e.0[0]);
        t(a).partial_cmp(&t(b)).unwrap_or(std::cmp::Ordering::Equal)
    });
    out
}

/// The node lines of two boxes between `low` and `high`, matched by position.
fn match_lines(meshes: [&BoxMesh; 2], d: usize, low: f64, high: f64) -> NodeLines {
    let lists = meshes.map(|mesh| {
        let at = |i: usize| {
            let mut place = [0; 3];
            place[d] = i;
            (mesh.position(place)[d], i)
        };
        stretch(mesh, d, low, high)
            .map(at)
            .collect::<Vec<(f64, usize)>>()
    });
    let near = TOLERANCE * meshes[0].step()[d].min(meshes[1].step()[d]);
    let mut lines = NodeLines {
        pairs: Vec::new(),
        alone: [Vec::new(), Vec::new()],
    };
    let (mut i, mut j) = (0, 0);
    loop {
        match (lists[0].get(i), lists[1].get(j)) {
            (None, None) => return lines,
            (Some(p), Some(q)) if (p.0 - q.0).abs() <= near => {
                lines.pairs.push((p.0, p.1, q.1));
                i += 1;
                j += 1;
            }
            (Some(p), other) if other.is_none_or(|q| p.0 < q.0) => {
                lines.alone[0].push(*p);
                i += 1;
            }
            (_, Some(q)) => {
                lines.alone[1].push(*q);
                j += 1;
            }
            (Some(_), None) => unreachable!("taken by the branch above"),
        }
    }
}

/// The node lines between `low` and `high`.
fn stretch(mesh: &BoxMesh, d: usize, low: f64, high: f64) -> std::ops::RangeInclusive<usize> {
    let place = |v: f64| (v - mesh.origin[d]) / mesh.step()[d];
    let first = (place(low) - TOLERANCE).ceil().max(0.0) as usize;
    let last = (place(high) + TOLERANCE).floor().max(0.0) as usize;
    first..=last.min(mesh.elements[d])
}
