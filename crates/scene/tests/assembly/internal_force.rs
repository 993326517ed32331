//! Unit tests of `crates/scene/src/assembly/internal_force.rs`.

use super::*;
use crate::assembly::matrix;
use elements::form::{Form, Physics};
use elements::kind::CellKind;

/// A strip of two squares of side 1 with springs, as a grid and as cells; Young's moduli 1 and 3.
fn strip(as_cells: bool) -> SubdomainMesh {
    let mut mesh = SubdomainMesh {
        index: 0,
        body: 0,
        dim: 2,
        form: Form {
            physics: Physics::Elasticity {
                plane: Default::default(),
                cure: Default::default(),
            },
            ..Form::default()
        },
        elements: SubdomainElements::Grid(Grid {
            elements: [2, 1, 0],
            step: Some([1.0, 1.0, 0.0]),
        }),
        points: (0..6)
            .map(|k| [(k % 3) as f64, (k / 3) as f64, 0.0])
            .collect(),
        dof: (0..12).collect(),
        prescribed: vec![0.0; 12],
        rho: vec![1.0, 3.0],
        poisson: vec![0.3, 0.2],
        laws: Default::default(),
        heat: None,
        integration: Vec::new(),
        spring: vec![0.0, 0.0, 2.0, 0.0, 0.0, 2.0],
    };
    if as_cells {
        let cells = mesh.cells().into_owned();
        assert!(cells.iter().all(|(kind, _)| kind == CellKind::Quad4));
        mesh.elements = SubdomainElements::Cells(cells);
    }
    mesh
}

#[test]
fn the_force_is_the_assembled_matrix_times_the_displacement() {
    let u: Vec<f64> = (0..12).map(|k| ((7 * k + 3) % 11) as f64 / 11.0).collect();
    for as_cells in [false, true] {
        let mut mesh = strip(as_cells);
        let k = matrix(&mesh);
        let mut expected = vec![0.0; 12];
        for (row, value) in expected.iter_mut().enumerate() {
            let (columns, values) = k.row(row);
            *value = columns
                .iter()
                .zip(values)
                .map(|(&c, v)| v * u[c as usize])
                .sum();
        }
        // Given values change nothing: their forces are reactions.
        mesh.dof[0] = SubdomainMesh::PRESCRIBED;
        for (a, b) in internal_force(&mesh, &u).iter().zip(&expected) {
            assert!((a - b).abs() < 1e-13, "{a}, not {b}");
        }
        // Without springs: node 0 stands on none.
        let mut v = vec![0.0; 12];
        v[0] = 2.0;
        let held = force_at_given(&mesh, &u, &[v]);
        let (columns, values) = k.row(0);
        let own = columns.iter().position(|&c| c == 0).unwrap();
        assert!((held.energies[0] - 4.0 * values[own]).abs() < 1e-13);
        let [(0, force)] = held.force[..] else {
            panic!("{held:?}");
        };
        assert!((force - expected[0]).abs() < 1e-13, "{force}");
        assert!(held.terms >= force.abs());
    }
}
