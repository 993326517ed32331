//! Unit tests of `crates/scene/src/assembly/zero_energy.rs`.

use super::*;
use elements::cell::{Cure, Material, Plane};
use elements::form::Physics;
use elements::kind::CellKind;
use elements::law::Law;
use mesh::Cells;

const FORM: Form = Form {
    physics: Physics::Elasticity {
        plane: Plane::Strain,
        cure: Cure::None,
    },
    element: elements::cell::Element::Q1,
};

/// A mesh of cells at reference points that are moved, nodes at one place being one.
fn mesh(kind: CellKind, cells: &[[f64; 3]]) -> CellMesh {
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut list = Cells::default();
    for offset in cells {
        let nodes: Vec<u32> = element_nodes(kind)
            .into_iter()
            .map(|p| {
                let x = [0, 1, 2].map(|d| p[d] + offset[d]);
                let near = |q: &[f64; 3]| (0..3).all(|d| (q[d] - x[d]).abs() < 1e-9);
                points.iter().position(near).unwrap_or_else(|| {
                    points.push(x);
                    points.len() - 1
                }) as u32
            })
            .collect();
        list.push(kind, &nodes);
    }
    CellMesh::new(kind.dim(), points, list, Vec::new(), Vec::new())
}

/// The nodes of a cell between 0 and 1 in each direction.
fn element_nodes(kind: CellKind) -> Vec<[f64; 3]> {
    let corners: &[[f64; 3]] = match kind.linear() {
        CellKind::Wedge6 => &[
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0],
        ],
        CellKind::Quad4 => &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        _ => &[
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
            [0.0, 1.0, 1.0],
        ],
    };
    let mut out = corners.to_vec();
    let middles = kind.edges().iter().take(kind.nodes() - kind.corners());
    for [a, b] in middles.map(|e| e.map(usize::from)) {
        out.push([0, 1, 2].map(|d| 0.5 * (corners[a][d] + corners[b][d])));
    }
    out
}

/// The assembled matrix by rows.
fn assembled(mesh: &CellMesh) -> Vec<f64> {
    let (c, n) = (mesh.dim, mesh.dim * mesh.points.len());
    let material = Material::Elastic {
        law: Law::Isotropic {
            young: 1.0,
            poisson: 0.3,
        },
        plane: Plane::Strain,
        cure: Cure::None,
    };
    let mut k = vec![0.0; n * n];
    for e in 0..mesh.cells.len() {
        let (kind, nodes) = (mesh.cells.kind(e), mesh.cells.nodes(e));
        let m = c * nodes.len();
        let mut own = vec![0.0; m * m];
        let points = mesh.cell_points(e);
        element::stiffness(kind, c, &points, &material, Integration::Reduced, &mut own);
        let dof = |i: usize| c * nodes[i / c] as usize + i % c;
        for i in 0..m {
            for j in 0..m {
                k[n * dof(i) + dof(j)] += own[m * i + j];
            }
        }
    }
    k
}

/// Columns, rows and blocks of cells: as many motions as the assembled matrix has eigenvalues zero beyond the rigid
/// ones, all without energy and independent.
#[test]
fn motions_are_those_of_the_assembled_matrix() {
    let tower = |n: usize| -> Vec<[f64; 3]> { (0..n).map(|k| [0.0, 0.0, k as f64]).collect() };
    let row = |n: usize| -> Vec<[f64; 3]> { (0..n).map(|k| [k as f64, 0.0, 0.0]).collect() };
    let mut block = Vec::new();
    for k in 0..8 {
        block.push([(k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64]);
    }
    let cases = [
        (CellKind::Wedge6, tower(1), Some(1)),
        (CellKind::Wedge6, tower(2), Some(2)),
        (CellKind::Wedge6, tower(7), Some(7)),
        (CellKind::Hex20, tower(1), Some(6)),
        (CellKind::Hex20, tower(4), None),
        (
            CellKind::Hex20,
            vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            None,
        ),
        (CellKind::Hex20, block, Some(0)),
        // Two cells with an edge, and with a corner in common.
        (CellKind::Hex20, vec![[0.0; 3], [1.0, 1.0, 0.0]], None),
        (CellKind::Hex20, vec![[0.0; 3], [1.0, 1.0, 1.0]], None),
        (CellKind::Quad8, row(1), Some(1)),
        (CellKind::Quad8, row(5), None),
    ];
    for (kind, cells, known) in cases {
        let mesh = mesh(kind, &cells);
        let rules = vec![Integration::Reduced; cells.len()];
        let found = slack(&FORM, &mesh, &rules, &|k| mesh.points[k]);
        let (k, n) = (assembled(&mesh), mesh.dim * mesh.points.len());
        let matrix = faer::Mat::from_fn(n, n, |i, j| k[n * i + j]);
        let eigen = matrix
            .self_adjoint_eigen(faer::Side::Lower)
            .expect("eigenvalues");
        let values = eigen.S().column_vector();
        let zeros = (0..n).filter(|&i| values[i] < 1e-11).count();
        let rigid = element::rigid_of(&FORM, mesh.dim, &mesh.points);
        let what = format!("{} x {kind:?}", cells.len());
        assert_eq!(found.len() + rigid.len(), zeros, "{what}");
        assert!(
            known.is_none_or(|known| known == found.len()),
            "{what}: {}",
            found.len()
        );
        let whole = |motion: &ZeroEnergyMode| {
            let mut u = vec![0.0; n];
            motion.iter().for_each(|&(dof, v)| u[dof as usize] = v);
            u
        };
        let all: Vec<Vec<f64>> = found.iter().map(whole).chain(rigid).collect();
        for u in &all {
            let row = |i: usize| (0..n).map(|j| k[n * i + j] * u[j]).sum::<f64>();
            let energy: f64 = (0..n).map(|i| u[i] * row(i)).sum();
            assert!(energy.abs() < 1e-12, "{what}: {energy:e}");
        }
        let columns = faer::Mat::from_fn(n, all.len(), |i, j| all[j][i]);
        let svd = columns.thin_svd().expect("singular values");
        let least = svd
            .S()
            .column_vector()
            .iter()
            .fold(f64::INFINITY, |a, s| a.min(*s));
        assert!(least > 1e-2, "{what}: {least:e}");
    }
}

/// Every triangle of a column turns by itself.
#[test]
fn columns_of_wedges_have_a_motion_for_each_cell() {
    let cells: Vec<[f64; 3]> = (0..200).map(|k| [0.0, 0.0, f64::from(k)]).collect();
    let mesh = mesh(CellKind::Wedge6, &cells);
    let rules = vec![Integration::Reduced; cells.len()];
    let found = slack(&FORM, &mesh, &rules, &|k| mesh.points[k]);
    assert_eq!(found.len(), 200);
    // With full integration there is none.
    assert!(slack(&FORM, &mesh, &[], &|k| mesh.points[k]).is_empty());
}
