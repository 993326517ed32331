//! The stiffness of one cell.

use super::hourglass;
use super::incompatible;
use super::integration::{moduli, Integration};
use super::map::{by_kind, fma, for_each_sample, relative};
use super::quadrature::Purpose;
use super::table::{table, Table};
use crate::fem::cell::{Material, Moduli};
use crate::mesh::CellKind;

/// The stiffness matrix of a cell, row-major into `out`, of length (nodes · C)²; symmetric to the last bit.
///
/// Scalar: ∫ ρ ∇N_a·∇N_b. Elastic: ∫ 2μ ε(u):ε(v) + λ (∇·u)(∇·v), the last term as [`Cure`](crate::fem::cell::Cure)
/// says, integrated as [`Integration`] says.
///
/// # Panics
/// When a length is wrong, or [`check`](super::check) refuses.
pub fn stiffness(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    material: &Material,
    integration: Integration,
    out: &mut [f64],
) {
    let n = kind.nodes() * material.components(dim);
    assert_eq!(out.len(), n * n, "a cell has {n} degrees of freedom");
    let moduli = moduli(kind, dim, material, integration);
    let bilinear = matches!(kind, CellKind::Quad4 | CellKind::Hex8);
    let table = match integration {
        Integration::Reduced if bilinear => {
            return hourglass::stiffness(kind, points, material, out)
        }
        Integration::Incompatible => return incompatible::stiffness(kind, points, moduli, out),
        Integration::Reduced => table(kind, Purpose::Reduced),
        Integration::Full => table(kind, Purpose::Full),
    };
    match material {
        Material::Scalar { rho } => by_kind!(kind, scalar(points, table, *rho, out)),
        Material::Elastic { .. } => by_kind!(kind, elastic(points, table, moduli, out)),
    }
}

fn scalar<const D: usize, const N: usize>(
    points: &[[f64; 3]],
    table: &Table,
    rho: f64,
    out: &mut [f64],
) {
    let mut k = [[0.0; N]; N];
    for_each_sample::<D, N>(&relative(points), table, |s| {
        for slope in &s.gradient {
            add_product(s.weight, slope, slope, &mut k);
        }
    });
    for a in 0..N {
        for b in a..N {
            out[N * a + b] = rho * k[a][b];
            out[N * b + a] = rho * k[a][b];
        }
    }
}

fn elastic<const D: usize, const N: usize>(
    points: &[[f64; 3]],
    table: &Table,
    moduli: Moduli,
    out: &mut [f64],
) {
    let mut products = Products::<D, N>::new();
    for_each_sample::<D, N>(&relative(points), table, |s| {
        products.add(s.weight, &s.gradient);
    });
    products.stiffness(moduli, out);
}

/// Adds `weight` g hᵀ.
#[inline(always)]
pub(super) fn add_product<const N: usize>(
    weight: f64,
    g: &[f64; N],
    h: &[f64; N],
    k: &mut [[f64; N]; N],
) {
    for (row, g) in k.iter_mut().zip(g) {
        let g = weight * g;
        for (entry, h) in row.iter_mut().zip(h) {
            *entry = fma(g, *h, *entry);
        }
    }
}

/// Integrals of products of gradients: with them the matrix is a few additions per entry, whatever the material.
pub(super) struct Products<const D: usize, const N: usize> {
    /// `[pair(i, j)][a][b]` = ∫ ∂_i N_a ∂_j N_b for i ≤ j; the others are their transposes.
    products: [[[f64; N]; N]; 6],
    /// `[i][a]` = ∫ ∂_i N_a.
    mean: [[f64; N]; D],
    volume: f64,
}

/// The place of i ≤ j among the pairs.
#[inline(always)]
const fn pair(i: usize, j: usize) -> usize {
    // 00 01 11 02 12 22: the pairs of the plane come first.
    j * (j + 1) / 2 + i
}

impl<const D: usize, const N: usize> Products<D, N> {
    #[inline(always)]
    pub fn new() -> Self {
        Products {
            products: [[[0.0; N]; N]; 6],
            mean: [[0.0; N]; D],
            volume: 0.0,
        }
    }

    /// Adds a point of the rule.
    #[inline(always)]
    pub fn add(&mut self, weight: f64, gradient: &[[f64; N]; D]) {
        self.volume += weight;
        for j in 0..D {
            for i in 0..=j {
                add_product(
                    weight,
                    &gradient[i],
                    &gradient[j],
                    &mut self.products[pair(i, j)],
                );
            }
            for (sum, g) in self.mean[j].iter_mut().zip(&gradient[j]) {
                *sum = fma(weight, *g, *sum);
            }
        }
    }

    /// The stiffness, into the (D · N)² numbers of `out`.
    #[inline(always)]
    pub fn stiffness(&self, moduli: Moduli, out: &mut [f64]) {
        let Moduli {
            shear,
            point,
            mean: by_mean,
        } = moduli;
        let by_mean = by_mean / self.volume;
        let n = D * N;
        for a in 0..N {
            for b in a..N {
                let trace: f64 = (0..D).map(|i| self.products[pair(i, i)][a][b]).sum();
                for i in 0..D {
                    // A diagonal block is computed on and above its diagonal only.
                    for j in if a == b { i } else { 0 }..D {
                        let (here, turned) = if i <= j {
                            let product = &self.products[pair(i, j)];
                            (product[a][b], product[b][a])
                        } else {
                            let product = &self.products[pair(j, i)];
                            (product[b][a], product[a][b])
                        };
                        let mut entry = point * here                    // ∫ ∂_i N_a ∂_j N_b
                            + by_mean * self.mean[i][a] * self.mean[j][b] // the same by means
                            + shear * turned; // ∫ ∂_j N_a ∂_i N_b
                        if i == j {
                            entry += shear * trace; // ∫ ∇N_a·∇N_b
                        }
                        out[n * (D * a + i) + D * b + j] = entry;
                        out[n * (D * b + j) + D * a + i] = entry;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/fem/element/stiffness.rs"]
mod tests;
