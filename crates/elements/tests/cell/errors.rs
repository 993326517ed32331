//! Unit tests of `crates/elements/src/cell/errors.rs`.

use super::super::testing::{combinations, distorted, elastic, matrix, unit, Grid, Random};
use super::super::{Cure, Plane};
use super::*;
use faer::Mat;

#[test]
fn norms_of_a_known_function() {
    // u = (x y, 0, 0) on the unit square: ∫ x²y² = 1/9, ∫ y² + x² = 2/3;
    // ε_xx = y, ε_xy = x/2: 2μ(1/3 + 2/12) + λ/3 = μ + λ/3.
    let material = elastic(1.0, 0.25, Plane::Strain, Cure::None);
    let (lambda, mu) = material.lame(2);
    for element in [Element::Q1, Element::P1] {
        let exact = |[x, y, _]: [f64; 3]| {
            (
                [x * y, 0.0, f64::NAN],
                [[y, x, f64::NAN], [0.0, 0.0, 0.0], [f64::NAN; 3]],
            )
        };
        let got = error_squares(2, &unit(2), element, &material, &[0.0; 8], exact);
        for (value, expected) in got
            .into_iter()
            .zip([1.0 / 9.0, 2.0 / 3.0, mu + lambda / 3.0])
        {
            assert!((value - expected).abs() < 1e-14, "{element:?} {got:?}");
        }
    }
    // Scalar u = x y z: ∫ u² = 1/27, ∫ |∇u|² = 3/9.
    let exact = |[x, y, z]: [f64; 3]| ([x * y * z; 3], [[y * z, x * z, x * y]; 3]);
    for element in [Element::Q1, Element::P1] {
        let material = Material::Scalar { rho: 6.0 };
        let got = error_squares(3, &unit(3), element, &material, &[0.0; 8], exact);
        for (value, expected) in got.into_iter().zip([1.0 / 27.0, 1.0 / 3.0, 2.0]) {
            // P1's rule is exact to degree 5 only; ∫ u² has degree 6.
            let bound = if element == Element::P1 { 1e-4 } else { 1e-14 };
            assert!((value - expected).abs() < bound, "{element:?} {got:?}");
        }
    }
}

#[test]
fn the_energy_of_a_discrete_function_is_that_of_the_stiffness() {
    // Exact where the stiffness' rule is: on parallelepipeds.
    for dim in [2, 3] {
        let cell: Vec<_> = unit(dim)
            .iter()
            .map(|p| {
                [
                    p[0] + 0.3 * p[1],
                    2.0 * p[1] - 0.2 * p[2],
                    0.7 * p[2] + 0.1 * p[0],
                ]
            })
            .collect();
        for (element, material) in combinations(dim) {
            let mut random = Random::new(2);
            let k = matrix(dim, &cell, element, &material);
            let u = Mat::from_fn(k.nrows(), 1, |_, _| random.next());
            let nodal: Vec<f64> = (0..k.nrows()).map(|i| u[(i, 0)]).collect();
            let zero = |_| ([0.0; 3], [[0.0; 3]; 3]);
            let got = error_squares(dim, &cell, element, &material, &nodal, zero)[2];
            let expected = (u.transpose() * &k * &u)[(0, 0)];
            assert!(
                (got - expected).abs() < 1e-12 * expected,
                "{got} {expected}"
            );
        }
    }
}

#[test]
fn a_linear_function_has_no_error_in_its_interpolant() {
    for dim in [2, 3] {
        for (element, material) in combinations(dim) {
            let cell = distorted(dim, 6);
            let slope = [[0.3, -1.1, 0.4], [0.7, 0.5, -0.2], [-0.6, 0.9, 1.3]];
            let exact = |p: [f64; 3]| {
                (
                    slope.map(|r| (0..dim).map(|j| r[j] * p[j]).sum::<f64>() + 2.0),
                    slope,
                )
            };
            let c = material.components(dim);
            let nodal: Vec<f64> = (0..c << dim).map(|k| exact(cell[k / c]).0[k % c]).collect();
            let got = error_squares(dim, &cell, element, &material, &nodal, exact);
            assert!(got.iter().all(|v| v.abs() < 1e-24), "{material:?} {got:?}");
        }
    }
}

/// u_i of a manufactured solution: a product of sines per component, its gradient, and −∇·σ with (λ, μ) given.
struct Manufactured {
    dim: usize,
    lambda: f64,
    mu: f64,
    components: usize,
}

impl Manufactured {
    /// The factor of u_i in direction d (or its derivative of order `order`), with phases so that nothing vanishes
    /// by symmetry.
    fn factor(i: usize, d: usize, x: f64, order: u32) -> f64 {
        let w = 1.0 + 0.4 * ((i + 2 * d) % 3) as f64;
        let phase = 0.3 + 0.5 * (i + d) as f64 + f64::from(order) * std::f64::consts::FRAC_PI_2;
        w.powi(order as i32) * (w * x + phase).sin()
    }

    fn derivative(&self, i: usize, orders: [u32; 3], p: [f64; 3]) -> f64 {
        (0..self.dim)
            .map(|d| Manufactured::factor(i, d, p[d], orders[d]))
            .product()
    }

    fn exact(&self, p: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
        let (mut u, mut g) = ([0.0; 3], [[0.0; 3]; 3]);
        for i in 0..self.components {
            u[i] = self.derivative(i, [0; 3], p);
            for j in 0..self.dim {
                let mut orders = [0; 3];
                orders[j] += 1;
                g[i][j] = self.derivative(i, orders, p);
            }
        }
        (u, g)
    }

    fn force(&self, p: [f64; 3]) -> [f64; 3] {
        let second = |i: usize, j: usize, k: usize| {
            let mut orders = [0; 3];
            orders[j] += 1;
            orders[k] += 1;
            self.derivative(i, orders, p)
        };
        let mut f = [0.0; 3];
        for i in 0..self.components {
            for j in 0..self.dim {
                f[i] -= self.mu * second(i, j, j);
                if self.components > 1 {
                    f[i] -= (self.lambda + self.mu) * second(j, i, j);
                }
            }
        }
        f
    }
}

fn norms(dim: usize, n: usize, element: Element, material: &Material) -> [f64; 3] {
    use super::super::body_load;
    use super::super::testing::solve;
    use crate::q1::Quadrature;
    // A smooth map that bends all cells.
    let grid = Grid::new(dim, [n; 3], |[x, y, z]| {
        [
            x + 0.2 * y * y,
            y + 0.15 * x * (1.0 - x),
            z * (1.0 + 0.2 * x),
        ]
    });
    let (lambda, mu) = material.lame(dim);
    let c = material.components(dim);
    let exact = Manufactured {
        dim,
        lambda,
        mu,
        components: c,
    };
    let k = grid.assemble(element, material);
    let mut f = vec![0.0; k.nrows()];
    let given: Vec<Option<f64>> = (0..k.nrows())
        .map(|dof| grid.boundary[dof / c].then(|| exact.exact(grid.points[dof / c]).0[dof % c]))
        .collect();
    let mut local = vec![0.0; c << dim];
    for cell in 0..grid.cells.len() {
        let corners = grid.corners(cell);
        let force = |p| exact.force(p);
        body_load(
            dim,
            &corners,
            element,
            Quadrature::Gauss,
            c,
            force,
            &mut local,
        );
        for (dof, value) in grid.dofs(cell, c).into_iter().zip(&local) {
            f[dof] += value;
        }
    }
    let u = solve(&k, &f, &given);
    let mut sum = [0.0; 3];
    for cell in 0..grid.cells.len() {
        let nodal: Vec<f64> = grid.dofs(cell, c).into_iter().map(|dof| u[dof]).collect();
        let corners = grid.corners(cell);
        let squares = error_squares(dim, &corners, element, material, &nodal, |p| exact.exact(p));
        for (total, value) in sum.iter_mut().zip(squares) {
            *total += value;
        }
    }
    sum.map(f64::sqrt)
}

#[test]
fn errors_fall_with_order_two_in_l2_and_one_in_energy() {
    for dim in [2, 3] {
        let mut materials = vec![Material::Scalar { rho: 3.0 }];
        for cure in [Cure::None, Cure::Selective, Cure::BBar] {
            materials.push(elastic(2.0, 0.3, Plane::Strain, cure));
        }
        if dim == 2 {
            materials.push(elastic(2.0, 0.3, Plane::Stress, Cure::None));
        }
        for element in [Element::Q1, Element::P1] {
            for material in &materials {
                if material.check(dim, element).is_err() {
                    continue;
                }
                let sizes = if dim == 2 { [8, 16] } else { [4, 8] };
                let [coarse, fine] = sizes.map(|n| norms(dim, n, element, material));
                for (norm, order) in [(0, 2.0), (1, 1.0), (2, 1.0)] {
                    let rate = (coarse[norm] / fine[norm]).log2();
                    assert!(
                        (rate - order).abs() < 0.15,
                        "{dim}D {element:?} {material:?}: norm {norm} falls with order {rate}"
                    );
                }
            }
        }
    }
}
