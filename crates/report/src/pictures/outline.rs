//! The lines between the bodies and subdomains of a plane mesh.

use super::mesh::{bounds, rounding, PlaneMesh};
use super::pieces;
use rayon::slice::ParallelSliceMut;
use std::collections::HashMap;

/// Polylines.
pub(super) struct OutlineLines {
    /// Around the bodies.
    pub bodies: Vec<Vec<[f64; 2]>>,
    /// Between subdomains of one body.
    pub subdomains: Vec<Vec<[f64; 2]>>,
}

/// A position rounded to a millionth of the mesh: equal for all copies of a point.
type PlanePositionKey = [i64; 2];

impl PlaneMesh<'_> {
    /// The number of different bodies or subdomains in a list by cell, if they are numbered consecutively.
    pub(super) fn count(&self, numbers: &[u32]) -> usize {
        numbers.iter().max().map_or(0, |&m| m as usize + 1)
    }

    /// The lines around bodies and between subdomains, with the points at `shown`. With `apart` every body gets its own
    /// outline, because bodies that touched may have separated.
    pub(super) fn lines(&self, shown: &[[f64; 2]], apart: bool) -> OutlineLines {
        // Edges by point numbers: most edges occur twice in one subdomain, and so lie inside it.
        let mut edges: Vec<(u64, u32)> = Vec::with_capacity(4 * self.corners.len());
        for (cell, quad) in self.corners.iter().enumerate() {
            for (a, b) in pieces::edges(*quad) {
                edges.push((
                    (u64::from(a.min(b)) << 32) | u64::from(a.max(b)),
                    cell as u32,
                ));
            }
        }
        edges.par_sort_unstable();
        // The remaining edges are compared by position, which is the same for copies of one edge.
        let key = self.rounding();
        let key_in = |p: u32, body: u32| -> PlanePositionKey {
            let [x, y] = key(self.points[p as usize]);
            // With `apart`, the keys of different bodies are far from each other; differences within a body do not
            // change.
            let far = if apart { i64::from(body) << 24 } else { 0 };
            [x + far, y]
        };
        let mut at: HashMap<(PlanePositionKey, PlanePositionKey), (bool, u32, usize)> =
            HashMap::new(); // all of one body?, which, how many
        let mut position: HashMap<PlanePositionKey, [f64; 2]> = HashMap::new();
        for group in edges.chunk_by(|a, b| a.0 == b.0) {
            let subdomain = |e: &(u64, u32)| self.subdomain[e.1 as usize];
            if group.len() == 2 && subdomain(&group[0]) == subdomain(&group[1]) {
                continue;
            }
            let (a, b) = ((group[0].0 >> 32) as u32, group[0].0 as u32);
            let key = |p: u32| key_in(p, self.body[group[0].1 as usize]);
            let ends = (key(a).min(key(b)), key(a).max(key(b)));
            position.insert(key(a), shown[a as usize]);
            position.insert(key(b), shown[b as usize]);
            for e in group {
                let body = self.body[e.1 as usize];
                let entry = at.entry(ends).or_insert((true, body, 0));
                entry.0 &= entry.1 == body;
                entry.2 += 1;
            }
        }
        let mut bodies = Vec::new();
        let mut subdomains = Vec::new();
        for (ends, (same, _, count)) in at {
            if same && count > 1 {
                subdomains.push(ends);
            } else {
                bodies.push(ends);
            }
        }
        OutlineLines {
            bodies: chains(bodies, &position),
            subdomains: chains(subdomains, &position),
        }
    }
}

/// Joins segments to polylines; a segment that is listed twice, once for either side of an interface, counts once.
pub(super) fn joined(segments: impl Iterator<Item = ([f64; 2], [f64; 2])>) -> Vec<Vec<[f64; 2]>> {
    let segments: Vec<_> = segments.collect();
    let ends = || segments.iter().flat_map(|s| [s.0, s.1]);
    let key = rounding(bounds(ends()));
    let position: HashMap<PlanePositionKey, [f64; 2]> = ends().map(|p| (key(p), p)).collect();
    let mut edges: Vec<(PlanePositionKey, PlanePositionKey)> = segments
        .iter()
        .map(|&(a, b)| (key(a).min(key(b)), key(a).max(key(b))))
        .collect();
    edges.sort_unstable();
    edges.dedup();
    chains(edges, &position)
}

/// Joins edges to polylines, straight ahead where possible, so that grids become long straight lines.
fn chains(
    mut edges: Vec<(PlanePositionKey, PlanePositionKey)>,
    position: &HashMap<PlanePositionKey, [f64; 2]>,
) -> Vec<Vec<[f64; 2]>> {
    edges.sort_unstable();
    let mut touching: HashMap<PlanePositionKey, Vec<usize>> = HashMap::new();
    for (k, e) in edges.iter().enumerate() {
        touching.entry(e.0).or_default().push(k);
        touching.entry(e.1).or_default().push(k);
    }
    let mut used = vec![false; edges.len()];
    let mut out = Vec::new();
    for start in 0..edges.len() {
        if used[start] {
            continue;
        }
        used[start] = true;
        let mut chain = vec![edges[start].0, edges[start].1];
        for _ in 0..2 {
            loop {
                let (before, end) = (chain[chain.len() - 2], chain[chain.len() - 1]);
                let there = &touching[&end];
                let ahead = [end[0] - before[0], end[1] - before[1]];
                let next = there.iter().copied().filter(|&k| !used[k]).find_map(|k| {
                    let far = if edges[k].0 == end {
                        edges[k].1
                    } else {
                        edges[k].0
                    };
                    let step = [far[0] - end[0], far[1] - end[1]];
                    let cross = (ahead[0] * step[1] - ahead[1] * step[0]).abs() as f64;
                    let dot = (ahead[0] * step[0] + ahead[1] * step[1]) as f64;
                    // Rounded positions: straight to within a few degrees; around a bend only where nothing else ends.
                    (dot > 0.0 && (cross < 0.1 * dot || there.len() == 2)).then_some((k, far))
                });
                let Some((k, far)) = next else { break };
                used[k] = true;
                chain.push(far);
            }
            chain.reverse();
        }
        out.push(chain.iter().map(|key| position[key]).collect());
    }
    out
}

#[cfg(test)]
#[path = "../../tests/pictures/outline.rs"]
pub(crate) mod tests;
