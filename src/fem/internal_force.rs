//! The forces with which the elements of a subdomain resist a displacement.

use super::cells::Cells;
use super::{sparse, Elements, Grid, SubdomainMesh};

/// K u at all degrees of freedom, given ones included; springs add to K. `nodal` has an entry per degree of freedom.
pub fn internal_force(mesh: &SubdomainMesh, nodal: &[f64]) -> Vec<f64> {
    let c = mesh.components();
    let spring = |k: usize| mesh.spring.get(k / c).copied().unwrap_or(0.0);
    let of_spring = |(k, u): (usize, &f64)| spring(k) * u;
    let mut force: Vec<f64> = nodal.iter().enumerate().map(of_spring).collect();
    match &mesh.elements {
        Elements::Grid(grid) => add_grid(mesh, grid, nodal, &mut force),
        Elements::Cells(cells) => sparse::each_matrix(mesh, cells, |nodes, matrix| {
            let dofs = nodes
                .iter()
                .flat_map(|&k| (0..c).map(move |i| c * k as usize + i));
            add(
                &dofs.collect::<Vec<usize>>(),
                matrix,
                1.0,
                nodal,
                &mut force,
            );
        }),
    }
    force
}

fn add_grid(mesh: &SubdomainMesh, grid: &Grid, nodal: &[f64], force: &mut [f64]) {
    let (cells, c) = (Cells::new(mesh, grid), mesh.components());
    let n = grid.corners() * c;
    for (e, place) in grid.element_places().enumerate() {
        let nodes = grid.element_nodes(place);
        let dofs: Vec<usize> = (0..n).map(|i| c * nodes[i / c] + i % c).collect();
        let (matrix, scale) = cells.at(e);
        add(&dofs, matrix, scale, nodal, force);
    }
}

/// Adds `scale` times the matrix of an element times its part of `nodal`.
fn add(dofs: &[usize], matrix: &[f64], scale: f64, nodal: &[f64], force: &mut [f64]) {
    for (&k, row) in dofs.iter().zip(matrix.chunks_exact(dofs.len())) {
        let sum: f64 = row.iter().zip(dofs).map(|(a, &j)| a * nodal[j]).sum();
        force[k] += scale * sum;
    }
}

#[cfg(test)]
#[path = "../../tests/inside/fem/internal_force.rs"]
mod tests;
