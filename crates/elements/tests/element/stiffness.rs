use super::super::integration::check;
use super::super::testing::{
    affine, combinations, distorted, elastic, matrix, solid_kinds, straight, Cut, Cuts, Mesh,
    Order, Random, INTEGRATIONS, STEEL,
};
use super::*;
use crate::cell::{rigid_count, rigid_motions, Cure, Plane};
use faer::{Mat, Side};

#[test]
fn matrices_are_symmetric_to_the_last_bit() {
    for kind in solid_kinds() {
        for (material, integration) in combinations(kind) {
            let k = matrix(kind, &distorted(kind, 3), &material, integration);
            for i in 0..k.nrows() {
                for j in 0..i {
                    assert_eq!(
                        k[(i, j)],
                        k[(j, i)],
                        "{kind:?} {material:?} {integration:?}"
                    );
                }
            }
        }
    }
}

/// Motions without energy that are not rigid.
fn spurious(kind: CellKind, material: &Material, integration: Integration) -> usize {
    match (integration, kind, material) {
        (Integration::Reduced, CellKind::Quad8, Material::Elastic { .. }) => 1,
        (Integration::Reduced, CellKind::Hex20, Material::Elastic { .. }) => 6,
        (Integration::Reduced, CellKind::Wedge6, Material::Elastic { .. }) => 1,
        _ => 0,
    }
}

#[test]
fn the_kernel_has_the_rigid_motions_and_nothing_else() {
    for kind in solid_kinds() {
        let dim = kind.dim();
        for (material, integration) in combinations(kind) {
            for points in [affine(kind), distorted(kind, 5)] {
                let k = matrix(kind, &points, &material, integration);
                let c = material.components(dim);
                let rigid = if c == 1 { 1 } else { rigid_count(dim) };
                let values = k
                    .self_adjoint_eigenvalues(Side::Lower)
                    .expect("eigenvalues");
                let largest = values[values.len() - 1];
                let zeros = values.iter().filter(|v| v.abs() < 1e-11 * largest).count();
                let few = values.iter().filter(|v| v.abs() < 1e-7 * largest).count();
                let expected = rigid + spurious(kind, &material, integration);
                assert_eq!(
                    (zeros, few),
                    (expected, expected),
                    "{kind:?} {material:?} {integration:?}: {values:?}"
                );
                for r in 0..rigid {
                    let motion = |p: [f64; 3]| match c {
                        1 => [1.0, 0.0, 0.0],
                        _ => rigid_motions(dim, [1.0, -2.0, 0.0], 1.0, p)[r],
                    };
                    let u = Mat::from_fn(k.nrows(), 1, |row, _| motion(points[row / c])[row % c]);
                    assert!(
                        (&k * &u).norm_max() < 1e-13 * largest,
                        "{kind:?} {integration:?}"
                    );
                }
            }
        }
    }
}

/// The stiffness by the textbook: Σ w Bᵀ D B at the points of the rule for errors.
fn textbook(kind: CellKind, points: &[[f64; 3]], poisson: f64, young: f64) -> Mat<f64> {
    let dim = kind.dim();
    let pairs: &[(usize, usize)] = match dim {
        2 => &[(0, 0), (1, 1), (0, 1)],
        _ => &[(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)],
    };
    let f = young / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let m = pairs.len();
    let law = Mat::from_fn(m, m, |i, j| match (i == j, i < dim, j < dim) {
        (true, true, _) => f * (1.0 - poisson),
        (true, false, _) => f * (1.0 - 2.0 * poisson) / 2.0,
        (false, true, true) => f * poisson,
        _ => 0.0,
    });
    let n = dim * kind.nodes();
    let mut k = Mat::<f64>::zeros(n, n);
    for (at, weight) in super::super::quadrature::rule(kind, Purpose::Error) {
        let slope = super::super::shape_functions::shape(kind, at).slope;
        let j = Mat::from_fn(dim, dim, |i, s| {
            points
                .iter()
                .enumerate()
                .map(|(a, p)| p[i] * slope[s][a])
                .sum::<f64>()
        });
        let det = j.determinant();
        let inverse = faer::linalg::solvers::DenseSolveCore::inverse(&j.partial_piv_lu());
        let gradient =
            |a: usize, i: usize| (0..dim).map(|s| inverse[(s, i)] * slope[s][a]).sum::<f64>();
        let b = Mat::from_fn(m, n, |row, col| {
            let ((p, q), (a, i)) = (pairs[row], (col / dim, col % dim));
            let mut entry = 0.0;
            if i == p {
                entry += gradient(a, q);
            }
            if i == q && p != q {
                entry += gradient(a, p);
            }
            entry
        });
        k += b.transpose() * &law * &b * faer::Scale(weight * det);
    }
    k
}

#[test]
fn affine_cells_are_integrated_exactly() {
    for kind in solid_kinds() {
        let points = affine(kind);
        let k = matrix(
            kind,
            &points,
            &elastic(3.0, 0.3, Plane::Strain, Cure::None),
            Integration::Full,
        );
        let expected = textbook(kind, &points, 0.3, 3.0);
        let difference = (&k - &expected).norm_max();
        assert!(
            difference < 1e-14 * expected.norm_max(),
            "{kind:?}: {difference:e}"
        );
    }
}

#[test]
fn distorted_cells_are_close_to_their_integral() {
    for kind in solid_kinds() {
        let points = distorted(kind, 2);
        let k = matrix(kind, &points, &STEEL, Integration::Full);
        let expected = textbook(kind, &points, 0.3, 3.0);
        let difference = (&k - &expected).norm_max() / expected.norm_max();
        assert!(difference < 0.1, "{kind:?}: {difference:e}");
    }
}

#[test]
fn the_stiffness_does_not_hang_on_the_place() {
    for kind in solid_kinds() {
        let points = distorted(kind, 4);
        let far: Vec<_> = points
            .iter()
            .map(|p| [p[0] + 1024.0, p[1] - 4096.0, p[2]])
            .collect();
        let [near, far] = [&points, &far].map(|p| matrix(kind, p, &STEEL, Integration::Full));
        assert!(
            (&near - &far).norm_max() < 1e-11 * near.norm_max(),
            "{kind:?}"
        );
    }
}

/// Meshes of 2 cells per direction, of one kind each or mixed, with corners moved inside.
fn patches() -> Vec<(&'static str, usize, Order, Cuts)> {
    fn mixed([i, j, k]: [usize; 3]) -> Cut {
        match (i, j, k) {
            (0, 0, _) => Cut::Wedges,
            (1, 0, _) | (0, 1, 1) => Cut::Whole,
            (0, 1, 0) => Cut::Pyramids,
            _ => Cut::PyramidsAndTetrahedra,
        }
    }
    vec![
        ("triangles", 2, Order::First, |_| Cut::Simplices),
        ("triangles of 6", 2, Order::Second, |_| Cut::Simplices),
        ("quadrilaterals", 2, Order::First, |_| Cut::Whole),
        ("quadrilaterals of 8", 2, Order::Serendipity, |_| Cut::Whole),
        ("quadrilaterals of 9", 2, Order::Second, |_| Cut::Whole),
        ("plane, mixed", 2, Order::First, |[i, j, _]| {
            if i == j {
                Cut::Whole
            } else {
                Cut::Simplices
            }
        }),
        (
            "plane of second order, mixed",
            2,
            Order::Serendipity,
            |[i, _, _]| if i == 0 { Cut::Whole } else { Cut::Simplices },
        ),
        ("tetrahedra", 3, Order::First, |_| Cut::Simplices),
        ("tetrahedra of 10", 3, Order::Second, |_| Cut::Simplices),
        ("pyramids", 3, Order::First, |_| Cut::Pyramids),
        ("wedges", 3, Order::First, |_| Cut::Wedges),
        ("wedges of 15", 3, Order::Serendipity, |_| Cut::Wedges),
        ("hexahedra", 3, Order::First, |_| Cut::Whole),
        ("hexahedra of 20", 3, Order::Serendipity, |_| Cut::Whole),
        ("hexahedra of 27", 3, Order::Second, |_| Cut::Whole),
        ("all kinds", 3, Order::First, mixed),
        (
            "wedges and hexahedra of second order",
            3,
            Order::Serendipity,
            |[i, _, _]| {
                if i == 0 {
                    Cut::Whole
                } else {
                    Cut::Wedges
                }
            },
        ),
    ]
}

/// A map of the unit square or cube to itself that moves what is inside at random.
pub(super) fn shaken(dim: usize) -> impl FnMut([f64; 3]) -> [f64; 3] {
    let mut random = Random::new(11);
    move |mut p| {
        let inside = p[..dim].iter().all(|&x| x > 1e-9 && x < 1.0 - 1e-9);
        for x in &mut p[..dim] {
            let step = 0.12 * random.next();
            if inside {
                *x += step;
            }
        }
        p
    }
}

#[test]
fn linear_displacements_are_solutions_on_distorted_meshes() {
    let linear = |[x, y, z]: [f64; 3]| {
        [
            0.1 + 0.3 * x - 0.2 * y + 0.5 * z,
            -0.4 + 0.7 * x + 0.1 * y - 0.3 * z,
            0.2 - 0.6 * x + 0.4 * y + 0.9 * z,
        ]
    };
    for (name, dim, order, cut) in patches() {
        let mesh = Mesh::new(dim, 2, order, cut, shaken(dim));
        let volume: f64 = mesh
            .cells
            .iter()
            .map(|(kind, nodes)| super::super::volume(*kind, dim, &mesh.cell_points(nodes)))
            .sum();
        assert!((volume - 1.0).abs() < 1e-13, "{name}: {volume}");
        assert!(mesh.boundary.contains(&false), "{name}");
        let materials = [
            Material::Scalar { rho: 2.0 },
            STEEL,
            elastic(3.0, 0.3, Plane::Stress, Cure::None),
            elastic(3.0, 0.499, Plane::Strain, Cure::BBar),
            elastic(3.0, 0.499, Plane::Strain, Cure::Selective),
        ];
        for material in materials {
            for integration in INTEGRATIONS {
                // Only where some cell takes it; the others are integrated in full.
                let mut kinds = mesh.cells.iter().map(|(kind, _)| *kind);
                if kinds.all(|kind| check(kind, dim, &material, integration).is_err()) {
                    continue;
                }
                let cure = matches!(material, Material::Elastic { cure, .. } if cure != Cure::None);
                if cure
                    && mesh
                        .cells
                        .iter()
                        .any(|(kind, _)| !matches!(kind, CellKind::Quad4 | CellKind::Hex8))
                {
                    continue;
                }
                let u = mesh.solve(&material, integration, linear, |_| [0.0; 3]);
                let c = material.components(dim);
                for (p, point) in mesh.points.iter().enumerate() {
                    for i in 0..c {
                        let error = (u[c * p + i] - linear(*point)[i]).abs();
                        assert!(
                            error < 1e-12,
                            "{name} {material:?} {integration:?}: {error:e}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
#[should_panic(expected = "expected full integration")]
fn what_check_refuses_panics() {
    matrix(
        CellKind::Tet4,
        &affine(CellKind::Tet4),
        &STEEL,
        Integration::Reduced,
    );
}

#[test]
fn straight_cells_have_the_volume_of_their_corners() {
    for kind in solid_kinds() {
        let dim = kind.dim();
        let points = straight(kind, 6);
        let linear = kind.linear();
        let [all, corners] = [(kind, &points[..]), (linear, &points[..linear.nodes()])]
            .map(|(kind, points)| super::super::volume(kind, dim, points));
        assert!((all - corners).abs() < 1e-14 * corners, "{kind:?}");
    }
}

#[test]
fn motions_without_energy_of_single_cells_do_not_fit_together() {
    let whole: Cuts = |_| Cut::Whole;
    let wedges: Cuts = |_| Cut::Wedges;
    for (dim, order, cut, regular) in [
        (2, Order::Serendipity, whole, false),
        (2, Order::Serendipity, whole, true),
        (3, Order::Serendipity, whole, false),
        (3, Order::Serendipity, whole, true),
        (3, Order::First, wedges, false),
        (3, Order::First, wedges, true),
    ] {
        let mut shake = shaken(dim);
        let map = |p| if regular { p } else { shake(p) };
        let mesh = Mesh::new(dim, 2, order, cut, map);
        let n = dim * mesh.points.len();
        let mut k = Mat::<f64>::zeros(n, n);
        for (kind, nodes) in &mesh.cells {
            let cell = matrix(
                *kind,
                &mesh.cell_points(nodes),
                &STEEL,
                Integration::Reduced,
            );
            let dofs: Vec<usize> = nodes
                .iter()
                .flat_map(|p| (0..dim).map(move |i| dim * p + i))
                .collect();
            for (i, &row) in dofs.iter().enumerate() {
                for (j, &col) in dofs.iter().enumerate() {
                    k[(row, col)] += cell[(i, j)];
                }
            }
        }
        let values = k
            .self_adjoint_eigenvalues(Side::Lower)
            .expect("eigenvalues");
        let zeros = values
            .iter()
            .filter(|v| v.abs() < 1e-10 * values[n - 1])
            .count();
        assert_eq!(zeros, rigid_count(dim), "{dim} {order:?} {regular}");
    }
}
