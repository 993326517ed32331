//! Edges and faces of a subdomain, and the rigid motions of its body.

use crate::assembly::{Grid, SubdomainMesh};
use crate::body::Body;
use elements::cell;
use fetifeti::problem::{Entity, EntityKind};
use mesh::{places, CellMesh, Mesh};
use std::collections::BTreeMap;

/// The open edges and faces of a subdomain of a solid, by component, with their free dofs in increasing order. The list
/// is empty in the plane, where vertices suffice. `inside` is the number of the subdomain in its body, `dofs` has the
/// body dof of each local dof; the first body dof of an entity is its key.
pub(crate) fn entities(
    body: &Body,
    inside: usize,
    mesh: &SubdomainMesh,
    dofs: &[u64],
) -> Vec<Entity> {
    if mesh.dim < 3 {
        return Vec::new();
    }
    match (body.mesh(), mesh.grid()) {
        (Mesh::Cells(cells), _) => of_cells(cells, inside, mesh, dofs),
        (_, Some(grid)) => of_grid(mesh, grid, dofs),
        _ => Vec::new(),
    }
}

/// The shared edges and faces of the partition, without vertices.
fn of_cells(cells: &CellMesh, inside: usize, mesh: &SubdomainMesh, dofs: &[u64]) -> Vec<Entity> {
    let c = mesh.components();
    let nodes = cells.parts.nodes(inside);
    let mut out = Vec::new();
    for component in 0..c {
        for (whole, (_, dim, list)) in (0..).zip(cells.parts.entities(inside)) {
            let local = |k: &u32| {
                let node = nodes.binary_search(k).expect("a node of the subdomain");
                mesh.local_dof(c * node + component)
            };
            let list: Vec<u32> = list.iter().filter_map(local).collect();
            let Some(first) = list.first() else { continue };
            let key = dofs[*first as usize];
            out.push(Entity::new(kind(dim), key, list).of_whole(whole));
        }
    }
    out
}

/// An edge or a face, by its dimension.
fn kind(dim: usize) -> EntityKind {
    match dim {
        1 => EntityKind::Edge,
        _ => EntityKind::Face,
    }
}

fn of_grid(mesh: &SubdomainMesh, grid: &Grid, dofs: &[u64]) -> Vec<Entity> {
    let c = mesh.components();
    // Key: component, and for each direction whether the entity lies at the lower end, the upper end, or runs along it.
    let mut found: BTreeMap<(usize, [u8; 3]), Vec<u32>> = BTreeMap::new();
    for (node, place) in places(grid.nodes()).enumerate() {
        let code = [0, 1, 2].map(|d| match place[d] {
            0 => 0,
            p if p == grid.elements[d] => 1,
            _ => 2,
        });
        let along = code.iter().filter(|&&k| k == 2).count();
        if along == 0 || along == 3 {
            continue;
        }
        for component in 0..c {
            if let Some(dof) = mesh.local_dof(c * node + component) {
                found.entry((component, code)).or_default().push(dof);
            }
        }
    }
    let entity = |((_, code), list): ((usize, [u8; 3]), Vec<u32>)| {
        let dim = code.iter().filter(|&&k| k == 2).count();
        let whole = code.iter().fold(0, |sum, &k| 3 * sum + u64::from(k));
        Entity::new(kind(dim), dofs[list[0] as usize], list).of_whole(whole)
    };
    found.into_iter().map(entity).collect()
}

/// The rigid motions of a body on the free dofs of one of its subdomains: translations, and rotations about the body's
/// centre, all of order one over the body. 3 columns in the plane, 6 in space.
pub(crate) fn rigid_motions(body: &Body, mesh: &SubdomainMesh) -> Vec<Vec<f64>> {
    let [low, high] = body.bounds;
    let size = (0..3).fold(0.0_f64, |a, d| a.max(0.5 * (high[d] - low[d])));
    let (centre, _) = body.ball();
    let c = mesh.components();
    let n_modes = if c == 2 { 3 } else { 6 };
    // A clone of an empty vector has no room.
    let column = |_| Vec::with_capacity(mesh.n_free());
    let mut out: Vec<Vec<f64>> = (0..n_modes).map(column).collect();
    for (node, &point) in mesh.points.iter().enumerate() {
        let modes = cell::rigid_motions(mesh.dim, centre, size, point);
        for component in 0..c {
            if mesh.local_dof(c * node + component).is_some() {
                for (column, mode) in out.iter_mut().zip(&modes) {
                    column.push(mode[component]);
                }
            }
        }
    }
    out
}
