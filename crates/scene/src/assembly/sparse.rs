//! Assembly of a subdomain of cells of any kind.

use super::SubdomainMesh;
use base::linalg::csr::Csr;
use base::linalg::lists::Lists;
use elements::element;
use mesh::Cells;

/// K on all degrees of freedom of a mesh of cells, by blocks of C × C.
struct BlockSparse {
    /// The nodes that share a cell with each node, itself included, increasing.
    beside: Lists,
    /// Where the blocks of each node begin, in blocks.
    first: Vec<usize>,
    /// The blocks, each by rows.
    values: Vec<f64>,
}

impl BlockSparse {
    fn new(mesh: &SubdomainMesh, cells: &Cells) -> BlockSparse {
        let c = mesh.components();
        let beside = neighbours(cells, mesh.points.len());
        let mut first = vec![0; beside.len()];
        let mut n = 0;
        for (first, list) in first.iter_mut().zip(beside.iter()) {
            *first = n;
            n += list.len();
        }
        let mut values = vec![0.0; n * c * c];
        let mut places = Vec::new();
        each_matrix(mesh, cells, |nodes, matrix| {
            let width = c * nodes.len();
            for (a, &row) in nodes.iter().enumerate() {
                let list = beside.at(row as usize);
                places.clear();
                places.extend(nodes.iter().map(|k| list.partition_point(|l| l < k)));
                for i in 0..c {
                    let entries = &matrix[(c * a + i) * width..(c * a + i + 1) * width];
                    for (place, block) in places.iter().zip(entries.chunks_exact(c)) {
                        let at = (first[row as usize] + place) * c * c + i * c;
                        let into = values[at..at + c].iter_mut().zip(block);
                        into.for_each(|(value, entry)| *value += entry);
                    }
                }
            }
        });
        for (node, spring) in mesh.spring.iter().enumerate() {
            let own = beside.at(node).partition_point(|&l| (l as usize) < node);
            let at = (first[node] + own) * c * c;
            (0..c).for_each(|i| values[at + i * c + i] += spring);
        }
        BlockSparse {
            beside,
            first,
            values,
        }
    }

    /// The entries of row (node, component): degree of freedom of the mesh and value, by increasing degree of freedom.
    fn row(&self, c: usize, node: usize, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let list = self.beside.at(node).iter().enumerate();
        list.flat_map(move |(k, &other)| {
            let at = (self.first[node] + k) * c * c + i * c;
            let values = self.values[at..at + c].iter().enumerate();
            values.map(move |(j, &value)| (c * other as usize + j, value))
        })
    }
}

/// The nodes that share a cell with each node, itself included, increasing.
fn neighbours(cells: &Cells, n_nodes: usize) -> Lists {
    let around = cells.around_nodes(n_nodes);
    let mut seen = vec![u32::MAX; n_nodes];
    let mut out = Lists::default();
    let mut list = Vec::new();
    for node in 0..n_nodes {
        list.clear();
        for &cell in around.at(node) {
            for &other in cells.nodes(cell as usize) {
                if seen[other as usize] != node as u32 {
                    seen[other as usize] = node as u32;
                    list.push(other);
                }
            }
        }
        list.sort_unstable();
        out.push(list.iter().copied());
    }
    out
}

/// Calls `f` with the nodes and the stiffness matrix, by rows, of every cell.
pub fn each_matrix(mesh: &SubdomainMesh, cells: &Cells, f: impl FnMut(&[u32], &[f64])) {
    some_matrices(mesh, cells, |_| true, f);
}

/// [`each_matrix`] of the cells that are `wanted`.
pub fn some_matrices(
    mesh: &SubdomainMesh,
    cells: &Cells,
    wanted: impl Fn(&[u32]) -> bool,
    mut f: impl FnMut(&[u32], &[f64]),
) {
    let c = mesh.components();
    let (mut points, mut matrix) = (Vec::new(), Vec::new());
    for (e, (kind, nodes)) in cells.iter().enumerate() {
        if !wanted(nodes) {
            continue;
        }
        points.clear();
        points.extend(nodes.iter().map(|&k| mesh.points[k as usize]));
        matrix.clear();
        matrix.resize((c * nodes.len()).pow(2), 0.0);
        let (material, rule) = (mesh.material(e), mesh.integration(e));
        element::stiffness(kind, mesh.dim, &points, &material, rule, &mut matrix);
        f(nodes, &matrix);
    }
}

/// As [`matrix`](super::matrix()), for cells of any kind.
pub fn matrix(mesh: &SubdomainMesh, cells: &Cells) -> Csr {
    let (c, blocks) = (mesh.components(), BlockSparse::new(mesh, cells));
    let mut k = Csr {
        row_ptr: Vec::with_capacity(mesh.n_free() + 1),
        col: Vec::with_capacity(blocks.values.len()),
        val: Vec::with_capacity(blocks.values.len()),
    };
    k.row_ptr.push(0);
    for row in free_rows(mesh) {
        for (column, value) in blocks.row(c, row / c, row % c) {
            let dof = mesh.dof[column];
            if dof != SubdomainMesh::PRESCRIBED {
                k.col.push(dof);
                k.val.push(value);
            }
        }
        k.row_ptr.push(k.col.len());
    }
    k
}

/// As [`given_columns`](super::given_columns), for cells of any kind.
pub fn given_columns(mesh: &SubdomainMesh, cells: &Cells) -> Csr {
    let c = mesh.components();
    let mut out = Csr {
        row_ptr: vec![0],
        col: Vec::new(),
        val: Vec::new(),
    };
    let blocks = if mesh.prescribed.iter().any(|u| *u != 0.0) {
        Some(BlockSparse::new(mesh, cells))
    } else {
        None
    };
    for row in free_rows(mesh) {
        for (column, value) in blocks.iter().flat_map(|b| b.row(c, row / c, row % c)) {
            if mesh.dof[column] == SubdomainMesh::PRESCRIBED {
                out.col.push(column as u32);
                out.val.push(value);
            }
        }
        out.row_ptr.push(out.col.len());
    }
    out
}

/// The degrees of freedom of the mesh that are free, increasing.
fn free_rows(mesh: &SubdomainMesh) -> impl Iterator<Item = usize> + '_ {
    (0..mesh.dof.len()).filter(|&k| mesh.dof[k] != SubdomainMesh::PRESCRIBED)
}

/// ½ u_Dᵀ K_DD u_D without springs.
pub fn energy_of_given(mesh: &SubdomainMesh, cells: &Cells) -> f64 {
    let c = mesh.components();
    let mut energy = 0.0;
    let mut u = Vec::new();
    each_matrix(mesh, cells, |nodes, matrix| {
        u.clear();
        for &k in nodes {
            let k = k as usize;
            u.extend_from_slice(&mesh.prescribed[c * k..c * (k + 1)]);
        }
        let rows = matrix.chunks_exact(u.len());
        let form = rows.zip(&u).map(|(row, ui)| {
            let force: f64 = row.iter().zip(&u).map(|(k, uj)| k * uj).sum();
            ui * force
        });
        energy += 0.5 * form.sum::<f64>();
    });
    energy
}
