//! Tests of the stiffness: against other ways to compute it, its kernel, the patch test.

use super::testing::{
    combinations, distorted, elastic, matrix, rotation, shape_gradient, times, unit, Grid, Random,
};
use super::*;
use crate::law::Law;
use crate::q1;
use faer::{Mat, Side};

fn close(a: &Mat<f64>, b: &Mat<f64>, tolerance: f64) {
    let difference = (a - b).norm_max();
    assert!(
        difference <= tolerance * b.norm_max(),
        "{difference:e} of {:e}",
        b.norm_max()
    );
}

/// Hooke's law for the strains (xx, yy, xy doubled) or (xx, yy, zz, yz, xz, xy doubled), as textbooks print it.
fn textbook_law(dim: usize, e: f64, nu: f64, plane: Plane) -> Mat<f64> {
    if dim == 2 && plane == Plane::Stress {
        let f = e / (1.0 - nu * nu);
        let d = [
            [f, f * nu, 0.0],
            [f * nu, f, 0.0],
            [0.0, 0.0, f * (1.0 - nu) / 2.0],
        ];
        return Mat::from_fn(3, 3, |i, j| d[i][j]);
    }
    let f = e / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let n = if dim == 2 { 3 } else { 6 };
    Mat::from_fn(n, n, |i, j| match (i == j, i < dim, j < dim) {
        (true, true, _) => f * (1.0 - nu),
        (true, false, _) => f * (1.0 - 2.0 * nu) / 2.0,
        (false, true, true) => f * nu,
        _ => 0.0,
    })
}

/// The textbook's B matrix from the gradients of the shape functions.
fn textbook_b(dim: usize, gradient: &[[f64; 3]]) -> Mat<f64> {
    let pairs: &[(usize, usize)] = if dim == 2 {
        &[(0, 0), (1, 1), (0, 1)]
    } else {
        &[(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    };
    Mat::from_fn(pairs.len(), dim * gradient.len(), |row, col| {
        let (p, q) = pairs[row];
        let (a, i) = (col / dim, col % dim);
        let mut entry = 0.0;
        if i == p {
            entry += gradient[a][q];
        }
        if i == q && p != q {
            entry += gradient[a][p];
        }
        entry
    })
}

#[test]
fn the_scalar_rectangle_is_the_closed_form() {
    let (dx, dy, rho) = (0.3, 1.7, 4.0);
    let box_: Vec<_> = unit(2)
        .iter()
        .map(|p| [1.0 + dx * p[0], -2.0 + dy * p[1], 0.0])
        .collect();
    let expected = q1::stiffness(dx, dy);
    let k = matrix(2, &box_, Element::Q1, &Material::Scalar { rho });
    close(
        &k,
        &Mat::from_fn(4, 4, |a, b| rho * expected[a][b]),
        3e-16 * 4.0,
    );
}

#[test]
fn boxes_are_the_tensor_products_of_integrals_on_an_interval() {
    // ∫ N_a' N_b', ∫ N_a' N_b, ∫ N_a N_b on [0, h].
    let line = |h: f64, kind: (bool, bool), a: usize, b: usize| match kind {
        (true, true) => (if a == b { 1.0 } else { -1.0 }) / h,
        (true, false) => a as f64 - 0.5,
        (false, true) => b as f64 - 0.5,
        (false, false) => h * if a == b { 1.0 / 3.0 } else { 1.0 / 6.0 },
    };
    let size = [0.3, 1.7, 0.8];
    for dim in [2, 3] {
        let cell: Vec<_> = unit(dim)
            .iter()
            .map(|p| [size[0] * p[0], size[1] * p[1], size[2] * p[2]])
            .collect();
        let volume: f64 = size[..dim].iter().product();
        for cure in [Cure::None, Cure::Selective, Cure::BBar] {
            let material = elastic(2.0, 0.35, Plane::Strain, cure);
            let (lambda, mu) = material.lame(dim);
            let product = |i: usize, j: usize, a: usize, b: usize| -> f64 {
                (0..dim)
                    .map(|d| line(size[d], (d == i, d == j), a >> d & 1, b >> d & 1))
                    .product()
            };
            // The mean of ∂_i N_a is its value in the middle of the box.
            let middle = |i: usize, a: usize| {
                (2.0 * (a >> i & 1) as f64 - 1.0) / size[i] / (1 << (dim - 1)) as f64
            };
            let expected = Mat::from_fn(dim << dim, dim << dim, |p, q| {
                let (a, i, b, j) = (p / dim, p % dim, q / dim, q % dim);
                let trace: f64 = (0..dim).map(|d| product(d, d, a, b)).sum();
                let sym = mu * (product(j, i, a, b) + if i == j { trace } else { 0.0 });
                let (full, mean) = (product(i, j, a, b), volume * middle(i, a) * middle(j, b));
                sym + match cure {
                    Cure::None => lambda * full,
                    Cure::Selective => lambda * mean,
                    Cure::BBar => lambda * mean + 2.0 / 3.0 * mu * (mean - full),
                }
            });
            close(
                &matrix(dim, &cell, Element::Q1, &material),
                &expected,
                1e-14,
            );
        }
    }
}

#[test]
fn q1_is_the_textbooks_b_d_b_with_two_gauss_points_per_direction() {
    for plane in [Plane::Strain, Plane::Stress] {
        for seed in 0..5 {
            let cell = distorted(2, seed);
            let d = textbook_law(2, 5.0, 0.3, plane);
            let mut expected = Mat::zeros(8, 8);
            for (s, ws) in q1::GAUSS2 {
                for (t, wt) in q1::GAUSS2 {
                    let slopes = shape_gradient(s, t);
                    let j = |i: usize, k: usize| -> f64 {
                        (0..4).map(|a| cell[a][i] * slopes[a][k]).sum()
                    };
                    let det = j(0, 0) * j(1, 1) - j(0, 1) * j(1, 0);
                    let gradient: Vec<_> = slopes
                        .iter()
                        .map(|g| {
                            [
                                (g[0] * j(1, 1) - g[1] * j(1, 0)) / det,
                                (g[1] * j(0, 0) - g[0] * j(0, 1)) / det,
                                0.0,
                            ]
                        })
                        .collect();
                    let b = textbook_b(2, &gradient);
                    expected += (b.transpose() * &d * &b) * faer::Scale(ws * wt * det);
                }
            }
            let material = elastic(5.0, 0.3, plane, Cure::None);
            close(&matrix(2, &cell, Element::Q1, &material), &expected, 1e-14);
        }
    }
}

/// Gradients of the barycentric coordinates from the linear system that defines them, and the volume.
fn simplex_gradients(dim: usize, vertices: &[[f64; 3]]) -> (Vec<[f64; 3]>, f64) {
    use faer::linalg::solvers::Solve;
    // Row v: (1, x_v, y_v, z_v); the inverse's columns are the coefficients of the coordinates.
    let rows = Mat::from_fn(dim + 1, dim + 1, |v, c| {
        if c == 0 {
            1.0
        } else {
            vertices[v][c - 1]
        }
    });
    let inverse = rows
        .partial_piv_lu()
        .solve(Mat::<f64>::identity(dim + 1, dim + 1));
    let volume = rows.determinant().abs() / (1..=dim).product::<usize>() as f64;
    let gradient =
        |v: usize| std::array::from_fn(|i| if i < dim { inverse[(i + 1, v)] } else { 0.0 });
    ((0..=dim).map(gradient).collect(), volume)
}

#[test]
fn p1_is_the_sum_of_the_textbooks_simplices() {
    let simplices: [&[&[usize]]; 2] = [
        &[&[0, 1, 3], &[0, 2, 3]],
        &[
            &[0, 1, 3, 7],
            &[0, 1, 5, 7],
            &[0, 2, 3, 7],
            &[0, 2, 6, 7],
            &[0, 4, 5, 7],
            &[0, 4, 6, 7],
        ],
    ];
    for (dim, list) in [(2, simplices[0]), (3, simplices[1])] {
        for plane in [Plane::Strain, Plane::Stress] {
            let cell = distorted(dim, 3);
            let d = textbook_law(dim, 5.0, 0.3, plane);
            let n = dim << dim;
            let (mut expected, mut laplace) = (Mat::zeros(n, n), Mat::zeros(1 << dim, 1 << dim));
            for simplex in list {
                let vertices: Vec<_> = simplex.iter().map(|&v| cell[v]).collect();
                let (gradient, volume) = simplex_gradients(dim, &vertices);
                let mut all = vec![[0.0; 3]; 1 << dim];
                for (&v, g) in simplex.iter().zip(gradient) {
                    all[v] = g;
                }
                let b = textbook_b(dim, &all);
                expected += (b.transpose() * &d * &b) * faer::Scale(volume);
                let g = Mat::from_fn(3, 1 << dim, |i, a| all[a][i]);
                laplace += (g.transpose() * &g) * faer::Scale(volume);
            }
            let material = elastic(5.0, 0.3, plane, Cure::None);
            close(
                &matrix(dim, &cell, Element::P1, &material),
                &expected,
                1e-13,
            );
            let scalar = Material::Scalar { rho: 1.0 };
            close(&matrix(dim, &cell, Element::P1, &scalar), &laplace, 1e-13);
        }
    }
}

#[test]
fn it_is_symmetric_to_the_last_bit_and_its_kernel_is_the_rigid_motions() {
    for dim in [2, 3] {
        for (element, material) in combinations(dim) {
            for seed in 0..4 {
                // The box too: there the modes of the middle and of the corners decouple.
                let cell = if seed == 0 {
                    unit(dim)
                } else {
                    distorted(dim, seed)
                };
                let k = matrix(dim, &cell, element, &material);
                let n = k.nrows();
                for i in 0..n {
                    for j in 0..n {
                        assert_eq!(k[(i, j)].to_bits(), k[(j, i)].to_bits());
                    }
                }
                let components = material.components(dim);
                let kernel = if components == 1 {
                    1
                } else {
                    dim * (dim + 1) / 2
                };
                let values = k.self_adjoint_eigenvalues(Side::Lower).unwrap();
                let noise = 1e-14 * values[n - 1] * n as f64;
                assert!(
                    values[..kernel].iter().all(|v| v.abs() < noise),
                    "{values:?}"
                );
                let least = values[kernel];
                assert!(least > 0.02, "{element:?} {material:?} {values:?}");
                // And they are the rigid motions themselves.
                for mode in 0..kernel {
                    let u = Mat::from_fn(n, 1, |dof, _| {
                        let (p, i) = (cell[dof / components], dof % components);
                        rigid_motions(dim, [0.5; 3], 1.0, p)[mode][i]
                    });
                    assert!((&k * &u).norm_max() < noise);
                }
            }
        }
    }
}

#[test]
fn a_turned_cell_has_the_turned_matrix() {
    for dim in [2, 3] {
        let q = rotation(dim);
        for (element, material) in combinations(dim) {
            let cell = distorted(dim, 5);
            let turned: Vec<_> = cell.iter().map(|&p| times(&q, p)).collect();
            let components = material.components(dim);
            let k = matrix(dim, &cell, element, &material);
            let turn = Mat::from_fn(k.nrows(), k.nrows(), |i, j| {
                match (components, i / components == j / components) {
                    (_, false) => 0.0,
                    (1, true) => 1.0,
                    (_, true) => q[i % dim][j % dim],
                }
            });
            let expected = &turn * &k * turn.transpose();
            close(&matrix(dim, &turned, element, &material), &expected, 1e-13);
        }
    }
}

/// Linear displacement on a grid of distorted cells: no force on inner nodes, the exact energy.
#[test]
fn the_patch_test_passes_on_distorted_cells() {
    let slope = [[0.3, -1.1, 0.4], [0.7, 0.5, -0.2], [-0.6, 0.9, 1.3]];
    for dim in [2, 3] {
        let mut random = Random::new(11);
        let grid = Grid::new(dim, [3; 3], |p| {
            // Every node moves but for those of a side, which stay in it.
            p.map(|x| 3.0 * x + f64::from(x > 0.0 && x < 1.0) * 0.15 * random.next())
        });
        for cell in 0..grid.cells.len() {
            for element in [Element::Q1, Element::P1] {
                assert!(jacobian_is_positive(dim, &grid.corners(cell), element));
            }
        }
        for (element, material) in combinations(dim) {
            let components = material.components(dim);
            let k = grid.assemble(element, &material);
            let n = k.nrows();
            let u = Mat::from_fn(n, 1, |dof, _| {
                let p = grid.points[dof / components];
                let row = slope[dof % components];
                (0..dim).map(|j| row[j] * p[j]).sum::<f64>()
            });
            let force = &k * &u;
            let scale = k.norm_max() * u.norm_max();
            for dof in 0..n {
                if !grid.boundary[dof / components] {
                    let residual = force[(dof, 0)].abs() / scale;
                    assert!(residual < 1e-14 * n as f64, "{material:?} {residual:e}");
                }
            }
            let volume = 3f64.powi(dim as i32);
            let mut law = 0.0;
            if let Material::Elastic {
                law: Law::Isotropic { young, poisson },
                plane,
                ..
            } = material
            {
                let d = textbook_law(dim, young, poisson, plane);
                let strain: Vec<f64> = if dim == 2 {
                    vec![slope[0][0], slope[1][1], slope[0][1] + slope[1][0]]
                } else {
                    let s = |i: usize, j: usize| slope[i][j] + slope[j][i];
                    vec![
                        slope[0][0],
                        slope[1][1],
                        slope[2][2],
                        s(1, 2),
                        s(0, 2),
                        s(0, 1),
                    ]
                };
                for (i, e) in strain.iter().enumerate() {
                    for (j, f) in strain.iter().enumerate() {
                        law += e * d[(i, j)] * f;
                    }
                }
            } else {
                law = 2.5 * (0..dim).map(|j| slope[0][j].powi(2)).sum::<f64>();
            }
            let energy = (u.transpose() * &force)[(0, 0)];
            assert!(
                (energy - volume * law).abs() < 1e-12 * energy.abs(),
                "{element:?} {material:?}: {energy} {}",
                volume * law
            );
        }
    }
}
