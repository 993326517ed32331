//! Stiffness of one subdomain, and the loads that follow from given values.

use super::cells::CellStiffness;
use super::sparse;
use super::{Grid, SubdomainElements, SubdomainMesh};
use base::linalg::csr::Csr;
use mesh::places;

/// Couplings of one node with itself and its neighbours: block o of C × C belongs to the neighbour at offset
/// (o mod 3 − 1, o/3 mod 3 − 1, o/9 − 1).
type Stencil<const C: usize> = [[[f64; C]; C]; 27];

/// K^(ij) on the free dofs, n × n.
///
/// Springs add to the diagonal: ∫ k u·v with nodal quadrature. The rows of a node are the sum over the elements around
/// it: they come out in order and sorted, and no search is needed.
pub fn matrix(mesh: &SubdomainMesh) -> Csr {
    let grid = match &mesh.elements {
        SubdomainElements::Grid(grid) => grid,
        SubdomainElements::Cells(cells) => return sparse::matrix(mesh, cells),
    };
    match mesh.components() {
        1 => rows::<1>(mesh, grid),
        2 => rows::<2>(mesh, grid),
        _ => rows::<3>(mesh, grid),
    }
}

/// The columns of K at nonzero given values: a row for each free degree of freedom, columns by degree of freedom of the
/// mesh. They do not change when given values are scaled.
pub fn given_columns(mesh: &SubdomainMesh) -> Csr {
    let grid = match &mesh.elements {
        SubdomainElements::Grid(grid) => grid,
        SubdomainElements::Cells(cells) => return sparse::given_columns(mesh, cells),
    };
    match mesh.components() {
        1 => columns::<1>(mesh, grid),
        2 => columns::<2>(mesh, grid),
        _ => columns::<3>(mesh, grid),
    }
}

/// The load on the free dofs with the given values eliminated, f_F − K_FD u_D: `load`, which has an entry per degree of
/// freedom, less the [`given_columns`] times the given values.
pub fn free_load(mesh: &SubdomainMesh, columns: &Csr, load: &[f64]) -> Vec<f64> {
    let free = (0..load.len()).filter(|&k| mesh.dof[k] != SubdomainMesh::PRESCRIBED);
    let rows = free.enumerate().map(|(i, k)| {
        let (col, val) = columns.row(i);
        let given = col.iter().map(|&c| mesh.prescribed[c as usize]);
        val.iter().zip(given).fold(load[k], |f, (v, g)| f - v * g)
    });
    rows.collect()
}

fn rows<const C: usize>(mesh: &SubdomainMesh, grid: &Grid) -> Csr {
    let cells = CellStiffness::new(mesh, grid);
    let n = mesh.n_free();
    let width = C * 3_usize.pow(mesh.dim as u32);
    let mut k = Csr {
        row_ptr: Vec::with_capacity(n + 1),
        col: Vec::with_capacity(width * n),
        val: Vec::with_capacity(width * n),
    };
    k.row_ptr.push(0);
    let given = |dof: u32| dof == SubdomainMesh::PRESCRIBED;
    for (node, place) in places(grid.nodes()).enumerate() {
        let dofs = &mesh.dof[C * node..C * (node + 1)];
        if dofs.iter().all(|&d| given(d)) {
            continue;
        }
        let stencil = stencil::<C>(grid, &cells, place);
        for c in (0..C).filter(|&c| !given(dofs[c])) {
            let spring = mesh.spring.get(node).copied().unwrap_or(0.0);
            for (block, other) in neighbours(grid, &stencil, place) {
                let columns = &mesh.dof[C * other..C * (other + 1)];
                for (j, &value) in block[c].iter().enumerate() {
                    if !given(columns[j]) {
                        let own = other == node && j == c;
                        k.col.push(columns[j]);
                        k.val.push(if own { value + spring } else { value });
                    }
                }
            }
            k.row_ptr.push(k.col.len());
        }
    }
    k
}

fn columns<const C: usize>(mesh: &SubdomainMesh, grid: &Grid) -> Csr {
    let mut cells = None;
    let given = |k: usize| mesh.dof[k] == SubdomainMesh::PRESCRIBED;
    let mut out = Csr {
        row_ptr: vec![0],
        col: Vec::new(),
        val: Vec::new(),
    };
    let empty = [[[0.0; C]; C]; 27];
    for (node, place) in places(grid.nodes()).enumerate() {
        // The stencil is needed only at neighbours of given values.
        let beside = neighbours(grid, &empty, place).any(|(_, other)| {
            (0..C).any(|j| given(C * other + j) && mesh.prescribed[C * other + j] != 0.0)
        });
        let stencil = beside.then(|| {
            let cells = cells.get_or_insert_with(|| CellStiffness::new(mesh, grid));
            stencil::<C>(grid, cells, place)
        });
        for c in (0..C).filter(|c| !given(C * node + c)) {
            for (block, other) in stencil.iter().flat_map(|s| neighbours(grid, s, place)) {
                for (j, &value) in block[c].iter().enumerate() {
                    if given(C * other + j) {
                        out.col.push((C * other + j) as u32);
                        out.val.push(value);
                    }
                }
            }
            out.row_ptr.push(out.col.len());
        }
    }
    out
}

/// The nodes around a node (itself included) in increasing order, each with its block of the stencil.
fn neighbours<'s, const C: usize>(
    grid: &Grid,
    stencil: &'s Stencil<C>,
    [i, j, k]: [usize; 3],
) -> impl Iterator<Item = (&'s [[f64; C]; C], usize)> {
    let ([nx, ny, nz], dim) = (grid.nodes(), grid.dim());
    let layers = if dim == 3 { 0..27 } else { 9..18 };
    layers.filter_map(move |o| {
        let (p, q, r) = (i + o % 3, j + o / 3 % 3, k + o / 9);
        if p < 1 || q < 1 || r < 1 || p > nx || q > ny || r > nz {
            return None;
        }
        Some((&stencil[o], ((r - 1) * ny + (q - 1)) * nx + (p - 1)))
    })
}

/// The rows of K at a node.
#[inline]
fn stencil<const C: usize>(
    grid: &Grid,
    cells: &CellStiffness<'_>,
    place: [usize; 3],
) -> Stencil<C> {
    let mut out = [[[0.0; C]; C]; 27];
    let corners = grid.corners();
    let n = corners * C;
    let counts = grid.counts();
    for a in 0..corners {
        // The node is corner a of the cell at place − offset(a).
        let offset = [a & 1, a >> 1 & 1, a >> 2];
        if (0..3).any(|d| place[d] < offset[d] || place[d] - offset[d] >= counts[d]) {
            continue;
        }
        let cell = [0, 1, 2].map(|d| place[d] - offset[d]);
        let (matrix, scale) = cells.at((cell[2] * counts[1] + cell[1]) * counts[0] + cell[0]);
        for b in 0..corners {
            let shift = |d: usize| 1 + (b >> d & 1) - (a >> d & 1);
            let block = &mut out[9 * shift(2) + 3 * shift(1) + shift(0)];
            for (c, row) in block.iter_mut().enumerate() {
                let from = (a * C + c) * n + b * C;
                for (entry, value) in row.iter_mut().zip(&matrix[from..from + C]) {
                    *entry += scale * value;
                }
            }
        }
    }
    out
}

#[cfg(test)]
#[path = "../../tests/assembly/assemble.rs"]
mod tests;
