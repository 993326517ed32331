//! For the tests of cells: distorted cells, small grids, a dense solver.

use super::{stiffness, Cure, Element, Material, Plane};
use crate::law::Law;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// Numbers in \[−1, 1\), the same for the same seed.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1)
    }

    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// ∂N_a/∂s and ∂N_a/∂t of the bilinear shape functions at (s, t) ∈ \[0,1\]².
pub fn shape_gradient(s: f64, t: f64) -> [[f64; 2]; 4] {
    [[t - 1.0, s - 1.0], [1.0 - t, -s], [-t, 1.0 - s], [t, s]]
}

pub fn elastic(young: f64, poisson: f64, plane: Plane, cure: Cure) -> Material {
    Material::Elastic {
        law: Law::Isotropic { young, poisson },
        plane,
        cure,
    }
}

/// Every element with every material it takes, in this dimension.
pub fn combinations(dim: usize) -> Vec<(Element, Material)> {
    let mut all = Vec::new();
    for element in [Element::Q1, Element::P1] {
        all.push((element, Material::Scalar { rho: 2.5 }));
        for plane in [Plane::Strain, Plane::Stress] {
            for cure in [Cure::None, Cure::Selective, Cure::BBar] {
                for poisson in [0.0, 0.3, 0.4999] {
                    let material = elastic(3.0, poisson, plane, cure);
                    if material.check(dim, element).is_ok() && (dim == 2 || plane == Plane::Strain)
                    {
                        all.push((element, material));
                    }
                }
            }
        }
    }
    all
}

/// The unit square (z = 0) or cube.
pub fn unit(dim: usize) -> Vec<[f64; 3]> {
    (0..1 << dim)
        .map(|a| [a & 1, a >> 1 & 1, a >> 2 & 1].map(|c| c as f64))
        .collect()
}

/// The unit cell with its corners moved at random.
pub fn distorted(dim: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Random::new(seed);
    let mut points = unit(dim);
    for point in &mut points {
        for x in &mut point[..dim] {
            *x += 0.15 * random.next();
        }
    }
    points
}

pub fn matrix(dim: usize, points: &[[f64; 3]], element: Element, material: &Material) -> Mat<f64> {
    let n = points.len() * material.components(dim);
    let mut k = vec![0.0; n * n];
    stiffness(dim, points, element, material, &mut k);
    Mat::from_fn(n, n, |i, j| k[i * n + j])
}

/// A grid of n\[0\] × n\[1\] (× n\[2\]) cells on the image of the unit cell.
pub struct Grid {
    pub dim: usize,
    pub points: Vec<[f64; 3]>,
    /// Corners of the cells.
    pub cells: Vec<Vec<usize>>,
    /// Nodes on the boundary.
    pub boundary: Vec<bool>,
}

impl Grid {
    pub fn new(dim: usize, n: [usize; 3], mut map: impl FnMut([f64; 3]) -> [f64; 3]) -> Grid {
        let n = [n[0], n[1], if dim == 2 { 0 } else { n[2] }];
        let index = |i: usize, j: usize, k: usize| (k * (n[1] + 1) + j) * (n[0] + 1) + i;
        let (mut points, mut boundary, mut cells) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..=n[2] {
            for j in 0..=n[1] {
                for i in 0..=n[0] {
                    let at = [i, j, k];
                    points.push(map(std::array::from_fn(|d| {
                        at[d] as f64 / n[d].max(1) as f64
                    })));
                    boundary.push((0..dim).any(|d| at[d] == 0 || at[d] == n[d]));
                    if (0..dim).all(|d| at[d] < n[d]) {
                        let corner = |a: usize| index(i + (a & 1), j + (a >> 1 & 1), k + (a >> 2));
                        cells.push((0..1 << dim).map(corner).collect());
                    }
                }
            }
        }
        Grid {
            dim,
            points,
            cells,
            boundary,
        }
    }

    pub fn corners(&self, cell: usize) -> Vec<[f64; 3]> {
        self.cells[cell].iter().map(|&n| self.points[n]).collect()
    }

    /// The degrees of freedom of a cell.
    pub fn dofs(&self, cell: usize, components: usize) -> Vec<usize> {
        self.cells[cell]
            .iter()
            .flat_map(|&n| (0..components).map(move |c| components * n + c))
            .collect()
    }

    pub fn assemble(&self, element: Element, material: &Material) -> Mat<f64> {
        let components = material.components(self.dim);
        let n = self.points.len() * components;
        let mut k = Mat::zeros(n, n);
        for cell in 0..self.cells.len() {
            let local = matrix(self.dim, &self.corners(cell), element, material);
            let dofs = self.dofs(cell, components);
            for (i, &p) in dofs.iter().enumerate() {
                for (j, &q) in dofs.iter().enumerate() {
                    k[(p, q)] += local[(i, j)];
                }
            }
        }
        k
    }
}

/// The solution of K u = f with the given values where there are any.
pub fn solve(k: &Mat<f64>, f: &[f64], given: &[Option<f64>]) -> Vec<f64> {
    let free: Vec<usize> = (0..f.len()).filter(|&i| given[i].is_none()).collect();
    let inner = Mat::from_fn(free.len(), free.len(), |i, j| k[(free[i], free[j])]);
    let rhs = Mat::from_fn(free.len(), 1, |i, _| {
        let known: f64 = (0..f.len())
            .filter_map(|j| given[j].map(|value| k[(free[i], j)] * value))
            .sum();
        f[free[i]] - known
    });
    let x = inner.llt(Side::Lower).unwrap().solve(&rhs);
    let mut u: Vec<f64> = given.iter().map(|g| g.unwrap_or(0.0)).collect();
    for (i, &dof) in free.iter().enumerate() {
        u[dof] = x[(i, 0)];
    }
    u
}

/// A rotation about an oblique axis in 3D, in the plane in 2D.
pub fn rotation(dim: usize) -> [[f64; 3]; 3] {
    let (s, c) = 0.7f64.sin_cos();
    let (p, q) = 1.1f64.sin_cos();
    if dim == 2 {
        [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
    } else {
        [[c, -s * q, s * p], [s, c * q, -c * p], [0.0, p, q]]
    }
}

pub fn times(m: &[[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2])
}
