//! Distance between a finite element function and an exact solution.

use super::{Grid, SubdomainElements, SubdomainMesh};
use elements::{cell, element};
use mesh::Cells;

/// Error norms over the whole problem.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ErrorNorms {
    /// ‖u_h − u‖ in L².
    pub l2: f64,
    /// ‖∇(u_h − u)‖ in L²: the H¹ seminorm.
    pub h1: f64,
    /// The energy norm (∫ ρ|∇(u_h − u)|²)^½.
    pub energy: f64,
}

impl ErrorNorms {
    /// The norms from the squares that `error_squares` gives, summed over all subdomains (and ranks).
    pub fn from_squares(squares: [f64; 3]) -> ErrorNorms {
        let [l2, h1, energy] = squares.map(f64::sqrt);
        ErrorNorms { l2, h1, energy }
    }
}

/// Squares of the L² norm, the H¹ seminorm and the energy norm of the error on one subdomain, by four Gauss points in
/// each direction.
///
/// `nodal` has an entry per degree of freedom; `exact` returns u and ∇u at a point: row i of the gradient belongs to
/// component i.
pub fn error_squares<F>(mesh: &SubdomainMesh, nodal: &[f64], exact: F) -> [f64; 3]
where
    F: FnMut([f64; 3]) -> ([f64; 3], [[f64; 3]; 3]),
{
    match &mesh.elements {
        SubdomainElements::Grid(grid) => on_grid(mesh, grid, nodal, exact),
        SubdomainElements::Cells(cells) => on_cells(mesh, cells, nodal, exact),
    }
}

fn on_cells<F>(mesh: &SubdomainMesh, cells: &Cells, nodal: &[f64], mut exact: F) -> [f64; 3]
where
    F: FnMut([f64; 3]) -> ([f64; 3], [[f64; 3]; 3]),
{
    let c = mesh.components();
    let mut squares = [0.0; 3];
    let (mut points, mut local) = (Vec::new(), Vec::new());
    for (e, (kind, nodes)) in cells.iter().enumerate() {
        points.clear();
        local.clear();
        for &k in nodes {
            let k = k as usize;
            points.push(mesh.points[k]);
            local.extend_from_slice(&nodal[c * k..c * (k + 1)]);
        }
        let material = mesh.material(e);
        let here = element::error_squares(kind, mesh.dim, &points, &material, &local, &mut exact);
        (0..3).for_each(|k| squares[k] += here[k]);
    }
    squares
}

fn on_grid<F>(mesh: &SubdomainMesh, grid: &Grid, nodal: &[f64], mut exact: F) -> [f64; 3]
where
    F: FnMut([f64; 3]) -> ([f64; 3], [[f64; 3]; 3]),
{
    let (c, corners) = (mesh.components(), grid.corners());
    let mut squares = [0.0; 3];
    let mut local = vec![0.0; corners * c];
    for (e, place) in grid.element_places().enumerate() {
        let nodes = grid.element_nodes(place);
        for (values, &node) in local.chunks_exact_mut(c).zip(&nodes) {
            values.copy_from_slice(&nodal[c * node..c * (node + 1)]);
        }
        let points = mesh.element_points(grid, place);
        let (element, material) = (mesh.form.element, mesh.material(e));
        let points = &points[..corners];
        let here = cell::error_squares(mesh.dim, points, element, &material, &local, &mut exact);
        (0..3).for_each(|k| squares[k] += here[k]);
    }
    squares
}

#[cfg(test)]
#[path = "../../tests/assembly/norms.rs"]
mod tests;
