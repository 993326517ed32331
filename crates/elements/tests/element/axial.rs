use super::super::testing::{
    distorted, elastic, matrix, solid_kinds, Cut, Cuts, Mesh, Order, INTEGRATIONS,
};
use super::super::{
    check, error_squares, middle, stress_at_nodes, volume, Integration, NodeStress,
};
use super::*;
use crate::cell::Cure;
use crate::law::Law;
use faer::{Mat, Side};

const RING: Material = Material::Elastic {
    law: Law::Isotropic {
        young: 3.0,
        poisson: 0.3,
    },
    plane: Plane::Axial,
    cure: Cure::None,
};

/// Every plane cell with every integration and cure that there is.
fn combinations() -> Vec<(CellKind, Material, Integration)> {
    let mut all = Vec::new();
    for kind in solid_kinds().filter(|kind| kind.dim() == 2) {
        for cure in [Cure::None, Cure::Selective, Cure::BBar] {
            for integration in INTEGRATIONS {
                let material = elastic(3.0, 0.3, Plane::Axial, cure);
                if check(kind, 2, &material, integration).is_ok() {
                    all.push((kind, material, integration));
                }
            }
        }
    }
    all
}

/// A distorted cell away from the axis.
fn away(kind: CellKind) -> Vec<[f64; 3]> {
    distorted(kind, 3)
        .iter()
        .map(|p| [p[0] + 1.5, p[1], 0.0])
        .collect()
}

#[test]
fn there_are_full_and_reduced_rings() {
    let found: Vec<_> = combinations()
        .into_iter()
        .map(|(kind, _, integration)| (kind, integration))
        .collect();
    let full = Integration::Full;
    let expected = [
        (CellKind::Triangle3, full),
        (CellKind::Triangle6, full),
        (CellKind::Quad4, full),
        (CellKind::Quad4, full),
        (CellKind::Quad4, full),
        (CellKind::Quad8, full),
        (CellKind::Quad8, Integration::Reduced),
        (CellKind::Quad9, full),
    ];
    assert_eq!(found, expected);
}

#[test]
fn only_motions_along_the_axis_have_no_energy() {
    for (kind, material, integration) in combinations() {
        let k = matrix(kind, &away(kind), &material, integration);
        for i in 0..k.nrows() {
            for j in 0..i {
                assert_eq!(k[(i, j)], k[(j, i)]);
            }
        }
        let values = k
            .self_adjoint_eigenvalues(Side::Lower)
            .expect("eigenvalues");
        let largest = values[values.len() - 1];
        let zeros = values.iter().filter(|v| v.abs() < 1e-12 * largest).count();
        let few = values.iter().filter(|v| v.abs() < 1e-6 * largest).count();
        assert_eq!(
            (zeros, few),
            (1, 1),
            "{kind:?} {material:?} {integration:?}: {values:?}"
        );
        let along = Mat::from_fn(k.nrows(), 1, |row, _| (row % 2) as f64);
        assert!((&k * &along).norm_max() < 1e-13 * largest);
    }
}

#[test]
fn rings_that_grow_evenly_have_the_energy_of_their_volume() {
    // u_r = r, u_y = y: three equal strains; the volume of the ring is 2π r̄ A by Guldin's rule.
    for (kind, material, integration) in combinations() {
        let points: Vec<_> = super::super::testing::affine(kind)
            .iter()
            .map(|p| [p[0] + 1.5, p[1], 0.0])
            .collect();
        let k = matrix(kind, &points, &material, integration);
        let u = Mat::from_fn(k.nrows(), 1, |row, _| points[row / 2][row % 2]);
        let energy = (u.transpose() * &k * &u)[(0, 0)];
        let (lambda, mu) = material.lame(3);
        let ring = TAU * middle(kind, &points)[0] * volume(kind, 2, &points);
        let expected = (6.0 * mu + 9.0 * lambda) * ring;
        assert!(
            (energy / expected - 1.0).abs() < 1e-13,
            "{kind:?} {material:?} {integration:?}"
        );
    }
}

#[test]
fn stresses_around_are_those_of_the_displacement_over_the_radius() {
    for (kind, material, integration) in combinations() {
        let points = away(kind);
        let nodal: Vec<f64> = points
            .iter()
            .flat_map(|p| [0.5 * p[0], 2.0 * p[1]])
            .collect();
        let mut out = vec![NodeStress::default(); points.len()];
        stress_at_nodes(kind, 2, &points, &material, integration, &nodal, &mut out);
        let (lambda, mu) = material.lame(3);
        for node in out {
            let expected = [0.5, 2.0, 0.5, 0.0, 0.0, 0.0];
            for c in 0..6 {
                assert!(
                    (node.strain[c] - expected[c]).abs() < 1e-12,
                    "{kind:?} {integration:?} {node:?}"
                );
                let stress = 2.0 * mu * expected[c] + if c < 3 { 3.0 * lambda } else { 0.0 };
                assert!((node.stress[c] - stress).abs() < 1e-11, "{kind:?}");
            }
        }
    }
}

/// Lamé's tube: u_r = a r + b/r, u_y = c y, without a force.
fn tube([r, y, _]: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let (a, b, c) = (0.3, 1.2, -0.4);
    let slope = [[a - b / (r * r), 0.0, 0.0], [0.0, c, 0.0], [0.0; 3]];
    ([a * r + b / r, c * y, 0.0], slope)
}

#[test]
fn tubes_converge_with_the_order_of_the_cells() {
    let whole: Cuts = |_| Cut::Whole;
    let simplices: Cuts = |_| Cut::Simplices;
    for (order, cut, integration) in [
        (Order::First, simplices, Integration::Full),
        (Order::First, whole, Integration::Full),
        (Order::Serendipity, simplices, Integration::Full),
        (Order::Serendipity, whole, Integration::Full),
        (Order::Serendipity, whole, Integration::Reduced),
        (Order::Second, whole, Integration::Full),
    ] {
        let errors = [6, 12].map(|n| {
            let map = |[x, y, _]: [f64; 3]| [0.8 + x + 0.1 * (2.0 * y).sin(), y + 0.1 * x * y, 0.0];
            let mesh = Mesh::curved(2, n, order, cut, map);
            let u = mesh.solve(&RING, integration, |p| tube(p).0, |_| [0.0; 3]);
            let mut sum = [0.0; 2];
            for (kind, nodes) in &mesh.cells {
                let nodal: Vec<f64> = nodes
                    .iter()
                    .flat_map(|&p| [u[2 * p], u[2 * p + 1]])
                    .collect();
                let squares =
                    error_squares(*kind, 2, &mesh.cell_points(nodes), &RING, &nodal, tube);
                sum[0] += squares[0];
                sum[1] += squares[2];
            }
            sum.map(f64::sqrt)
        });
        let [l2, energy] = [0, 1].map(|k| (errors[0][k] / errors[1][k]).log2());
        let expected = if order == Order::First { 2.0 } else { 3.0 };
        assert!(
            (l2 - expected).abs() < 0.25,
            "{order:?} {integration:?} {l2:.2}"
        );
        assert!(
            (energy - expected + 1.0).abs() < 0.3,
            "{order:?} {integration:?} {energy:.2}"
        );
    }
}

#[test]
fn norms_are_those_of_the_ring() {
    for kind in solid_kinds().filter(|kind| kind.dim() == 2) {
        let points: Vec<_> = super::super::testing::affine(kind)
            .iter()
            .map(|p| [p[0] + 1.5, p[1], 0.0])
            .collect();
        let ring = TAU * middle(kind, &points)[0] * volume(kind, 2, &points);
        let zero = |_| ([0.0; 3], [[0.0; 3]; 3]);
        let nodal: Vec<f64> = points.iter().flat_map(|p| [p[0], p[1]]).collect();
        let [_, h1, energy] = error_squares(kind, 2, &points, &RING, &nodal, zero);
        let (lambda, mu) = RING.lame(3);
        assert!(
            (energy / ((6.0 * mu + 9.0 * lambda) * ring) - 1.0).abs() < 1e-12,
            "{kind:?}"
        );
        // With u_r/r among the slopes.
        assert!((h1 / (3.0 * ring) - 1.0).abs() < 1e-12, "{kind:?}");
    }
}
