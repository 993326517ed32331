//! Strain and stress of a solution, from the cells of subdomains to the nodes of bodies.
//!
//! Every cell gives values at its nodes ([`element::stress_at_nodes`]). They jump from cell to cell; a node has the
//! mean of its cells, weighted by their volumes. On meshes of second order the mean converges with the square of the
//! size of cells, one order faster than the values inside cells of first order do.

use super::thermal::add_thermal_stress;
use super::{Grid, SubdomainElements, SubdomainMesh};
use bytemuck::{Pod, Zeroable};
use elements::cell::{centre_stress, CellStress, Element};
use elements::element::{self, NodeStress};
use elements::kind::CellKind;

/// Calls `each` with every cell of a subdomain: its number, its volume, and strain and stress at its nodes in the order
/// of [`SubdomainMesh::cells`]. `nodal` has all degrees of freedom, given ones included.
pub fn for_each_cell(
    mesh: &SubdomainMesh,
    nodal: &[f64],
    mut each: impl FnMut(usize, f64, &[NodeStress]),
) {
    let mut at = [NodeStress::default(); CellKind::MOST_NODES];
    let (mut points, mut u) = (Vec::new(), Vec::new());
    for (e, (kind, nodes)) in mesh.cells().iter().enumerate() {
        take(
            mesh,
            nodal,
            nodes.iter().map(|&k| k as usize),
            &mut points,
            &mut u,
        );
        let at = &mut at[..points.len()];
        let (material, rule) = (mesh.material(e), mesh.integration(e));
        let volume = element::volume(kind, mesh.dim, &points);
        match &mesh.elements {
            SubdomainElements::Grid(grid) if mesh.form.element == Element::P1 => {
                // Simplices inside the cell have constant stress; their mean stands for all corners.
                at.fill(whole(&of_grid(mesh, grid, e, nodal)));
            }
            _ => element::stress_at_nodes(kind, mesh.dim, &points, &material, rule, &u, at),
        }
        add_thermal_stress(mesh, (e, kind, nodes), -1.0, at);
        each(e, volume, at);
    }
}

/// Strain and stress at the nodes of element `e` with these nodes, into `at`; `u` has the element's degrees of freedom.
pub fn at_nodes(
    mesh: &SubdomainMesh,
    (e, kind, nodes): (usize, CellKind, &[u32]),
    u: &[f64],
    at: &mut [NodeStress],
) {
    let points: Vec<[f64; 3]> = nodes.iter().map(|&k| mesh.points[k as usize]).collect();
    let (material, rule) = (mesh.material(e), mesh.integration(e));
    element::stress_at_nodes(kind, mesh.dim, &points, &material, rule, u, at);
    add_thermal_stress(mesh, (e, kind, nodes), -1.0, at);
}

/// ∫ (σ* − σ_h) : (ε* − ε_h) and ∫ σ_h : ε_h over all cells. `recovered` gives σ* and ε* at a node of a cell: its
/// number among the nodes of all cells, one cell after the other.
pub fn squares(
    mesh: &SubdomainMesh,
    nodal: &[f64],
    recovered: impl Fn(usize) -> NodeStress,
) -> [f64; 2] {
    let (mut points, mut u, mut at) = (Vec::new(), Vec::new(), Vec::new());
    let mut sums = [0.0; 2];
    let mut first = 0;
    for (e, (kind, nodes)) in mesh.cells().iter().enumerate() {
        let each = nodes.iter().map(|&k| k as usize);
        take(mesh, nodal, each, &mut points, &mut u);
        at.clear();
        at.extend((first..first + nodes.len()).map(&recovered));
        first += nodes.len();
        // Here σ is C ε: what expansion takes from both stresses is the same.
        add_thermal_stress(mesh, (e, kind, nodes), 1.0, &mut at);
        let (dim, material, rule) = (mesh.dim, mesh.material(e), mesh.integration(e));
        let here = match &mesh.elements {
            SubdomainElements::Grid(grid) if mesh.form.element == Element::P1 => {
                let own = whole(&of_grid(mesh, grid, e, nodal));
                element::recovered_squares_of(kind, dim, &points, &material, &own, &at)
            }
            _ => element::recovered_squares(kind, dim, &points, &material, rule, &u, &at),
        };
        (0..2).for_each(|k| sums[k] += here[k]);
    }
    sums
}

/// Strain and stress of every cell: at the centres of the cells of a grid, elsewhere the mean over the nodes.
pub fn cell_stresses(mesh: &SubdomainMesh, nodal: &[f64]) -> Vec<CellStress> {
    let mut out = Vec::with_capacity(mesh.n_elements());
    match &mesh.elements {
        SubdomainElements::Grid(grid) => {
            for (e, (kind, nodes)) in mesh.cells().iter().enumerate() {
                // The temperature of a cell of first order is constant.
                let mut cell = [whole(&of_grid(mesh, grid, e, nodal))];
                add_thermal_stress(mesh, (e, kind, nodes), -1.0, &mut cell);
                out.push(of_tensors(&cell[0]));
            }
        }
        SubdomainElements::Cells(_) => for_each_cell(mesh, nodal, |_, _, at| {
            let mut sum = NodalStressSum::default();
            at.iter().for_each(|node| sum.add(1.0, node));
            out.push(of_tensors(&sum.mean()));
        }),
    }
    out
}

/// A weighted sum of strains and stresses at a node.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
pub struct NodalStressSum {
    /// The sum, strain before stress.
    pub values: [f64; 12],
    /// The sum of the weights.
    pub weight: f64,
}

impl NodalStressSum {
    /// Adds the value of a cell.
    pub fn add(&mut self, weight: f64, node: &NodeStress) {
        let values = node.strain.iter().chain(&node.stress);
        self.values
            .iter_mut()
            .zip(values)
            .for_each(|(sum, value)| *sum += weight * value);
        self.weight += weight;
    }

    /// Adds another sum.
    pub fn merge(&mut self, other: &NodalStressSum) {
        self.values
            .iter_mut()
            .zip(&other.values)
            .for_each(|(sum, value)| *sum += value);
        self.weight += other.weight;
    }

    /// The mean; zero without cells.
    pub fn mean(&self) -> NodeStress {
        let of = |k: usize| match self.weight {
            0.0 => 0.0,
            weight => self.values[k] / weight,
        };
        NodeStress {
            strain: std::array::from_fn(of),
            stress: std::array::from_fn(|k| of(6 + k)),
        }
    }
}

/// Strain and stress at the centre of element `e` of a grid.
fn of_grid(mesh: &SubdomainMesh, grid: &Grid, e: usize, nodal: &[f64]) -> CellStress {
    let [nx, ny, _] = grid.counts();
    let nodes = grid.element_nodes([e % nx, e / nx % ny, e / (nx * ny)]);
    let (mut points, mut u) = (Vec::new(), Vec::new());
    let corners = nodes[..grid.corners()].iter().copied();
    take(mesh, nodal, corners, &mut points, &mut u);
    let element = mesh.form.element;
    centre_stress(mesh.dim, &points, element, &mesh.material(e), &u)
}

/// Positions and degrees of freedom of some nodes.
fn take(
    mesh: &SubdomainMesh,
    nodal: &[f64],
    nodes: impl Iterator<Item = usize>,
    points: &mut Vec<[f64; 3]>,
    u: &mut Vec<f64>,
) {
    let c = mesh.components();
    points.clear();
    u.clear();
    for k in nodes {
        points.push(mesh.points[k]);
        u.extend_from_slice(&nodal[c * k..c * (k + 1)]);
    }
}

fn of_tensors(at: &NodeStress) -> CellStress {
    CellStress {
        strain: tensor(&at.strain),
        stress: tensor(&at.stress),
    }
}

fn tensor(&[xx, yy, zz, xy, yz, xz]: &[f64; 6]) -> [[f64; 3]; 3] {
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

/// The six components of strain and stress, in the order of [`NodeStress`].
fn whole(cell: &CellStress) -> NodeStress {
    NodeStress {
        strain: components(&cell.strain),
        stress: components(&cell.stress),
    }
}

/// The components xx, yy, zz, xy, yz, xz of a symmetric tensor.
pub fn components(s: &[[f64; 3]; 3]) -> [f64; 6] {
    [s[0][0], s[1][1], s[2][2], s[0][1], s[1][2], s[0][2]]
}

#[cfg(test)]
#[path = "../../tests/assembly/recovery.rs"]
mod tests;
