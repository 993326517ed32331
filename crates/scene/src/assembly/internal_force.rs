//! The forces with which the elements of a subdomain resist a displacement.

use super::cells::CellStiffness;
use super::{sparse, Grid, SubdomainElements, SubdomainMesh};

/// K u at all degrees of freedom, given ones included; springs add to K. `nodal` has an entry per degree of freedom.
pub fn internal_force(mesh: &SubdomainMesh, nodal: &[f64]) -> Vec<f64> {
    let c = mesh.components();
    let spring = |k: usize| mesh.spring.get(k / c).copied().unwrap_or(0.0);
    let of_spring = |(k, u): (usize, &f64)| spring(k) * u;
    let mut force: Vec<f64> = nodal.iter().enumerate().map(of_spring).collect();
    let add = |dofs: &[usize], matrix: &[f64], scale: f64| {
        for (&k, row) in dofs.iter().zip(matrix.chunks_exact(dofs.len())) {
            let sum: f64 = row.iter().zip(dofs).map(|(a, &j)| a * nodal[j]).sum();
            force[k] += scale * sum;
        }
    };
    each_element(mesh, |_| true, add);
    force
}

/// The forces that hold a subdomain at given values.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct InternalForce {
    /// (degree of freedom of the mesh, row of K times u without springs).
    pub force: Vec<(usize, f64)>,
    /// The sum of the sizes of all terms: their rounding is a part of it.
    pub terms: f64,
    /// vᵀ K v of some displacements v, without springs.
    pub energies: Vec<f64>,
}

/// K u at given values, and vᵀ K v of some `motions` that are zero at free degrees of freedom. Only elements beside
/// given values are looked at.
pub fn force_at_given(mesh: &SubdomainMesh, nodal: &[f64], motions: &[Vec<f64>]) -> InternalForce {
    let given = |k: usize| mesh.dof[k] == SubdomainMesh::PRESCRIBED;
    let of_all = (0..mesh.dof.len()).filter(|&k| given(k));
    let mut out = InternalForce {
        force: of_all.map(|k| (k, 0.0)).collect(),
        terms: 0.0,
        energies: vec![0.0; motions.len()],
    };
    if out.force.is_empty() {
        return out;
    }
    let InternalForce {
        force,
        terms,
        energies,
    } = &mut out;
    let add = |dofs: &[usize], matrix: &[f64], scale: f64| {
        for (&k, row) in dofs.iter().zip(matrix.chunks_exact(dofs.len())) {
            let Ok(at) = force.binary_search_by_key(&k, |f| f.0) else {
                continue;
            };
            for (a, &j) in row.iter().zip(dofs) {
                let term = scale * a * nodal[j];
                force[at].1 += term;
                *terms += term.abs();
            }
            for (energy, v) in energies.iter_mut().zip(motions) {
                let sum: f64 = row.iter().zip(dofs).map(|(a, &j)| a * v[j]).sum();
                *energy += scale * v[k] * sum;
            }
        }
    };
    each_element(mesh, given, add);
    out
}

/// Calls `add` with the degrees of freedom of every element that has one that is `wanted`, with its matrix and the
/// factor of that.
fn each_element(
    mesh: &SubdomainMesh,
    wanted: impl Fn(usize) -> bool,
    mut add: impl FnMut(&[usize], &[f64], f64),
) {
    let c = mesh.components();
    match &mesh.elements {
        SubdomainElements::Grid(grid) => each_of_grid(mesh, grid, wanted, add),
        SubdomainElements::Cells(cells) => {
            let dofs = |nodes: &[u32]| -> Vec<usize> {
                let of_node = |&k: &u32| (0..c).map(move |i| c * k as usize + i);
                nodes.iter().flat_map(of_node).collect()
            };
            let some = |nodes: &[u32]| dofs(nodes).into_iter().any(&wanted);
            sparse::some_matrices(mesh, cells, some, |nodes, matrix| {
                add(&dofs(nodes), matrix, 1.0);
            });
        }
    }
}

fn each_of_grid(
    mesh: &SubdomainMesh,
    grid: &Grid,
    wanted: impl Fn(usize) -> bool,
    mut add: impl FnMut(&[usize], &[f64], f64),
) {
    let (cells, c) = (CellStiffness::new(mesh, grid), mesh.components());
    let n = grid.corners() * c;
    for (e, place) in grid.element_places().enumerate() {
        let nodes = grid.element_nodes(place);
        let dofs: Vec<usize> = (0..n).map(|i| c * nodes[i / c] + i % c).collect();
        if dofs.iter().any(|&k| wanted(k)) {
            let (matrix, scale) = cells.at(e);
            add(&dofs, matrix, scale);
        }
    }
}

#[cfg(test)]
#[path = "../../tests/assembly/internal_force.rs"]
mod tests;
