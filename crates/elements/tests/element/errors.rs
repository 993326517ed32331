use super::super::testing::{
    affine, combinations, distorted, elastic, matrix, solid_kinds, straight, Cut, Cuts, Mesh,
    Order, STEEL,
};
use super::super::volume;
use super::*;
use crate::cell::{Cure, Plane};
use faer::Mat;

#[test]
fn the_energy_of_a_function_is_that_of_the_stiffness() {
    for kind in solid_kinds() {
        let dim = kind.dim();
        for (material, integration) in combinations(kind) {
            if integration != Integration::Full {
                continue;
            }
            let points = affine(kind);
            let k = matrix(kind, &points, &material, integration);
            let nodal: Vec<f64> = (0..k.nrows())
                .map(|i| ((i * 5 + 2) % 7) as f64 - 3.0)
                .collect();
            let u = Mat::from_fn(k.nrows(), 1, |i, _| nodal[i]);
            let expected = (u.transpose() * &k * &u)[(0, 0)];
            let zero = |_| ([0.0; 3], [[0.0; 3]; 3]);
            let [_, _, energy] = error_squares(kind, dim, &points, &material, &nodal, zero);
            assert!(
                (energy / expected - 1.0).abs() < 1e-12,
                "{kind:?} {material:?} {energy} {expected}"
            );
        }
    }
}

#[test]
fn constants_and_linear_functions_have_the_norms_of_their_formulas() {
    for kind in solid_kinds() {
        let dim = kind.dim();
        let points = straight(kind, 2);
        let volume = volume(kind, dim, &points);
        let nodal = vec![0.0; dim * kind.nodes()];
        let constant = |_| ([2.0, -1.0, 3.0], [[0.0; 3]; 3]);
        let squares = error_squares(kind, dim, &points, &STEEL, &nodal, constant);
        let expected = volume * if dim == 2 { 5.0 } else { 14.0 };
        assert!(
            (squares[0] - expected).abs() < 1e-13 * expected
                && squares[1] == 0.0
                && squares[2] == 0.0
        );
        let slope = [[1.0, 2.0, 0.5], [0.0, -1.0, 4.0], [0.3, 0.2, 0.1]];
        let linear = |_| ([0.0; 3], slope);
        let squares = error_squares(kind, dim, &points, &STEEL, &nodal, linear);
        let sum: f64 = slope[..dim]
            .iter()
            .flat_map(|row| &row[..dim])
            .map(|g| g * g)
            .sum();
        assert!(
            (squares[1] - volume * sum).abs() < 1e-12 * squares[1],
            "{kind:?}"
        );
    }
}

#[test]
fn a_linear_function_has_no_error_on_curved_cells() {
    let u = |[x, y, z]: [f64; 3]| [1.0 + x - y + z, 2.0 * x + 3.0 * z, x - 0.5 * y];
    let slope = [[1.0, -1.0, 1.0], [2.0, 0.0, 3.0], [1.0, -0.5, 0.0]];
    for kind in solid_kinds() {
        let dim = kind.dim();
        let points = distorted(kind, 9);
        let nodal: Vec<f64> = points.iter().flat_map(|&p| u(p)[..dim].to_vec()).collect();
        let squares = error_squares(kind, dim, &points, &STEEL, &nodal, |p| (u(p), slope));
        assert!(
            squares.iter().all(|s| s.abs() < 1e-26),
            "{kind:?}: {squares:?}"
        );
    }
}

/// u_i = A_i sin(k_i·x + φ_i).
const WAVES: [(f64, [f64; 3], f64); 3] = [
    (1.0, [1.5, -1.0, 0.7], 0.3),
    (-0.7, [0.8, 1.7, -0.6], 1.1),
    (0.9, [-1.1, 0.5, 1.4], -0.4),
];

fn wave(dim: usize, p: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let (mut u, mut slope) = ([0.0; 3], [[0.0; 3]; 3]);
    for (i, (size, k, phase)) in WAVES.into_iter().enumerate().take(dim) {
        let angle = (0..dim).map(|j| k[j] * p[j]).sum::<f64>() + phase;
        u[i] = size * angle.sin();
        for j in 0..dim {
            slope[i][j] = size * k[j] * angle.cos();
        }
    }
    (u, slope)
}

/// −∇·σ of these waves, with −∂_j ∂_l u_i = k_j k_l u_i.
fn force(dim: usize, material: &Material, p: [f64; 3]) -> [f64; 3] {
    let (lambda, mu) = material.lame(dim);
    let (u, _) = wave(dim, p);
    let mut out = [0.0; 3];
    for i in 0..dim {
        let k = WAVES[i].1;
        out[i] += mu * (0..dim).map(|j| k[j] * k[j]).sum::<f64>() * u[i];
        if material.components(dim) == 1 {
            continue;
        }
        for j in 0..dim {
            let k = WAVES[j].1;
            out[i] += (lambda + mu) * k[i] * k[j] * u[j];
        }
    }
    out
}

/// Orders of convergence in L² and in energy from n to 2n cells per direction on a curved domain.
fn orders(
    dim: usize,
    n: usize,
    order: Order,
    cut: Cuts,
    material: &Material,
    integration: Integration,
) -> [f64; 2] {
    let map = |[x, y, z]: [f64; 3]| {
        [
            x + 0.1 * (2.0 * y).sin(),
            y + 0.08 * (2.0 * x).cos() + 0.05 * z * x,
            if dim == 2 { 0.0 } else { z + 0.1 * (x * y) },
        ]
    };
    let errors = [n, 2 * n].map(|n| {
        let mesh = Mesh::curved(dim, n, order, cut, map);
        let c = material.components(dim);
        let exact = |p| wave(dim, p);
        let u = mesh.solve(
            material,
            integration,
            |p| exact(p).0,
            |p| force(dim, material, p),
        );
        let mut sum = [0.0; 2];
        for (kind, nodes) in &mesh.cells {
            let nodal: Vec<f64> = nodes
                .iter()
                .flat_map(|&p| u[c * p..c * p + c].to_vec())
                .collect();
            let squares = error_squares(
                *kind,
                dim,
                &mesh.cell_points(nodes),
                material,
                &nodal,
                exact,
            );
            sum[0] += squares[0];
            sum[1] += squares[2];
        }
        sum.map(f64::sqrt)
    });
    [0, 1].map(|k| (errors[0][k] / errors[1][k]).log2())
}

#[test]
fn errors_fall_with_the_order_of_the_cells() {
    let whole: Cuts = |_| Cut::Whole;
    let simplices: Cuts = |_| Cut::Simplices;
    let wedges: Cuts = |_| Cut::Wedges;
    let pyramids: Cuts = |_| Cut::Pyramids;
    let stress = elastic(3.0, 0.3, Plane::Stress, Cure::None);
    let scalar = Material::Scalar { rho: 2.0 };
    let cured = elastic(3.0, 0.499, Plane::Strain, Cure::BBar);
    let full = Integration::Full;
    let cases = [
        (2, 8, Order::First, simplices, STEEL, full),
        (2, 8, Order::First, whole, STEEL, full),
        (2, 8, Order::First, whole, cured, full),
        (2, 8, Order::First, whole, STEEL, Integration::Reduced),
        (2, 8, Order::First, whole, stress, Integration::Incompatible),
        (2, 8, Order::Second, simplices, stress, full),
        (2, 8, Order::Serendipity, whole, STEEL, full),
        (2, 8, Order::Serendipity, whole, STEEL, Integration::Reduced),
        (2, 8, Order::Second, whole, scalar, full),
        (3, 4, Order::First, simplices, STEEL, full),
        (3, 4, Order::First, pyramids, STEEL, full),
        (3, 4, Order::First, wedges, STEEL, full),
        (3, 4, Order::First, wedges, STEEL, Integration::Reduced),
        (3, 4, Order::First, whole, STEEL, full),
        (3, 4, Order::First, whole, STEEL, Integration::Reduced),
        (3, 4, Order::First, whole, STEEL, Integration::Incompatible),
        (3, 3, Order::Second, simplices, STEEL, full),
        (3, 3, Order::Serendipity, wedges, STEEL, full),
        (
            3,
            3,
            Order::Serendipity,
            wedges,
            STEEL,
            Integration::Reduced,
        ),
        (3, 3, Order::Serendipity, whole, STEEL, full),
        (3, 3, Order::Serendipity, whole, STEEL, Integration::Reduced),
        (3, 3, Order::Second, whole, STEEL, full),
        (3, 3, Order::Second, whole, scalar, full),
    ];
    for (dim, n, order, cut, material, integration) in cases {
        let expected = if order == Order::First { 2.0 } else { 3.0 };
        let [l2, energy] = orders(dim, n, order, cut, &material, integration);
        let what = format!(
            "{dim} {order:?} {:?} {material:?} {integration:?}: {l2:.2} {energy:.2}",
            cut([0; 3])
        );
        eprintln!("{what}");
        assert!(l2 > expected - 0.3 && l2 < expected + 0.5, "{what}");
        assert!(
            energy > expected - 1.25 && energy < expected + 0.3,
            "{what}"
        );
    }
}
