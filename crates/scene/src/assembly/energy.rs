//! The energy of given values alone.

use super::cells::CellStiffness;
use super::{sparse, Grid, SubdomainElements, SubdomainMesh};

/// ½ u_Dᵀ K_DD u_D − f_Dᵀ u_D of one subdomain, springs included; zero where all given values are zero. `load` has an
/// entry per degree of freedom.
pub fn given_energy(mesh: &SubdomainMesh, load: &[f64]) -> f64 {
    if mesh.prescribed.iter().all(|u| *u == 0.0) {
        return 0.0;
    }
    let c = mesh.components();
    let mut energy = match &mesh.elements {
        SubdomainElements::Grid(grid) => of_grid(mesh, grid),
        SubdomainElements::Cells(cells) => sparse::energy_of_given(mesh, cells),
    };
    for (k, u) in mesh.prescribed.iter().enumerate() {
        let spring = mesh.spring.get(k / c).copied().unwrap_or(0.0);
        energy += (0.5 * spring * u - load[k]) * u;
    }
    energy
}

/// ½ u_Dᵀ K_DD u_D of the elements of a grid.
fn of_grid(mesh: &SubdomainMesh, grid: &Grid) -> f64 {
    let (cells, c) = (CellStiffness::new(mesh, grid), mesh.components());
    let n = grid.corners() * c;
    let mut energy = 0.0;
    for (e, place) in grid.element_places().enumerate() {
        let nodes = grid.element_nodes(place);
        let u: Vec<f64> = (0..n)
            .map(|i| mesh.prescribed[c * nodes[i / c] + i % c])
            .collect();
        if u.iter().all(|u| *u == 0.0) {
            continue;
        }
        let (matrix, scale) = cells.at(e);
        let force = |i: usize| -> f64 {
            let row = &matrix[i * n..(i + 1) * n];
            row.iter().zip(&u).map(|(k, u)| k * u).sum()
        };
        energy += 0.5 * scale * (0..n).map(|i| u[i] * force(i)).sum::<f64>();
    }
    energy
}
