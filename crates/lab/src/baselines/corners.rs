//! Vertices that hold subdomains to each other, for PCBDDC with several subdomains on a rank. With one on each rank it
//! picks them by itself (`-pc_bddc_corner_selection`): of the nodes that two subdomains share alone as many as the
//! space has dimensions, far from each other. Here too, but only where one of the two is not held by the vertices that
//! it has: three nodes more for every face of a box would make the coarse problem several times as large for nothing.

use std::collections::BTreeMap;

use crate::assembled::layout::UnknownLayout;
use crate::assembled::system::AssembledSystem;
use base::linalg::vec3::{cross, dot, minus};
use base::Result;
use parallel::contiguous_share;
use petsc::{PetscInt, Scatter, Session, Vec as PetscVec};
use scene::Scene;

/// A node is on a line where its distance is below this part of the length.
const ON_LINE: f64 = 1e-6;

/// The local unknowns at these nodes. The parts of `system` are the subdomains of `scene`. Collective.
///
/// # Errors
/// PETSc's.
pub fn corners(
    session: &Session,
    scene: &Scene,
    layout: &UnknownLayout,
    system: &AssembledSystem,
) -> Result<Vec<PetscInt>> {
    let local = &system.local;
    let n = local.unknowns.len();
    let first = contiguous_share(scene.n_subdomains(), session.size(), session.rank()).start;
    let part: Vec<usize> = (0..n)
        .map(|i| local.starts.partition_point(|&start| start <= i) - 1)
        .collect();
    let numbers: Vec<f64> = part.iter().map(|k| (first + k + 1) as f64).collect();
    let over_parts = |values: &[f64]| -> Result<Vec<f64>> {
        let (sum, own) = (
            system.b.duplicate()?,
            PetscVec::from_slice(session, values)?,
        );
        let scatter = Scatter::new(&sum, &local.unknowns, &own)?;
        scatter.reverse_add(&own, &sum)?;
        scatter.forward(&sum, &own)?;
        let all = own.array()?.to_vec();
        Ok(all)
    };
    let points = |nodes: &[u64]| -> Vec<[f64; 3]> {
        nodes.iter().map(|&node| layout.position(node)).collect()
    };
    let shares = over_parts(&vec![1.0; n])?;
    let sums = over_parts(&numbers)?;
    let squares = over_parts(&numbers.iter().map(|k| k * k).collect::<Vec<_>>())?;
    // The nodes of a part by who shares them; one alone is a vertex of PCBDDC.
    let mut classes: BTreeMap<(usize, [u64; 3]), Vec<u64>> = BTreeMap::new();
    for i in (0..n).filter(|&i| shares[i] > 1.0) {
        let who = [shares[i], sums[i], squares[i]].map(f64::to_bits);
        let nodes = classes.entry((part[i], who)).or_default();
        if nodes.last() != Some(&local.nodes[i]) {
            nodes.push(local.nodes[i]);
        }
    }
    let mut vertices: Vec<Vec<u64>> = vec![Vec::new(); local.starts.len()];
    let single = classes.iter().filter(|(_, nodes)| nodes.len() == 1);
    single.for_each(|((part, _), nodes)| vertices[*part].push(nodes[0]));
    let held = |nodes: &Vec<u64>| far_apart(&points(nodes), scene.dim()).len() == scene.dim();
    let held: Vec<bool> = vertices.iter().map(held).collect();
    let own: Vec<f64> = part.iter().map(|&k| f64::from(u8::from(held[k]))).collect();
    let both = over_parts(&own)?;
    // Nodes that a part shares with one other, where one of the two is not held.
    let mut shared: BTreeMap<(usize, u64), Vec<u64>> = BTreeMap::new();
    for i in (0..n).filter(|&i| shares[i] == 2.0 && both[i] < 2.0) {
        let pair = (part[i], (sums[i] - numbers[i]) as u64);
        let nodes = shared.entry(pair).or_default();
        if nodes.last() != Some(&local.nodes[i]) {
            nodes.push(local.nodes[i]);
        }
    }
    let mut chosen: Vec<(usize, u64)> = Vec::new();
    for ((part, _), nodes) in shared {
        let far = far_apart(&points(&nodes), scene.dim());
        chosen.extend(far.into_iter().map(|k| (part, nodes[k])));
    }
    chosen.sort_unstable();
    let is_chosen = |i: &usize| chosen.binary_search(&(part[*i], local.nodes[*i])).is_ok();
    let all = (0..numbers.len()).filter(is_chosen);
    Ok(all.map(|i| i as PetscInt).collect())
}

/// At most `n` ≤ 3 of some points: the ends of a long line, and the point farthest from it. The choice hangs on the
/// points and their order alone, so that both sides of a pair make the same one.
fn far_apart(points: &[[f64; 3]], n: usize) -> Vec<usize> {
    let farthest = |distance: &dyn Fn([f64; 3]) -> f64| {
        let each = points.iter().map(|&x| distance(x)).enumerate();
        each.fold(
            (0, -1.0),
            |best, now| if now.1 > best.1 { now } else { best },
        )
    };
    let square = |x: [f64; 3]| dot(x, x);
    let from = |k: usize| farthest(&|x| square(minus(x, points[k])));
    let mut found = Vec::new();
    if !points.is_empty() {
        let a = from(0).0;
        let (b, length) = from(a);
        found.push(a);
        if length > 0.0 && n > 1 {
            found.push(b);
            let along = minus(points[b], points[a]);
            // |(x − a) × (b − a)|² is the square of distance times length.
            let (c, area) = farthest(&|x| square(cross(minus(x, points[a]), along)));
            if n > 2 && area > (ON_LINE * length).powi(2) {
                found.push(c);
            }
        }
    }
    found
}

#[cfg(test)]
#[path = "../../tests/baselines/corners.rs"]
mod tests;
