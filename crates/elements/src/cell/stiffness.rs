//! The stiffness of one cell.

use super::map::for_each_sample;
use super::material::{IsotropicModuli, Moduli};
use super::reference::Rule;
use super::{Element, Material};
use crate::law::Tangent;

/// The stiffness matrix of a cell, row-major into `out`, of length (2^`dim` · C)²; symmetric to the last bit.
///
/// Scalar: ∫ ρ ∇N_a·∇N_b. Elastic: ∫ 2μ ε(u):ε(v) + λ (∇·u)(∇·v), the last term as [`Cure`](super::Cure) says.
///
/// # Panics
/// When `dim` is not 2 or 3, a length is wrong, or the material is refused by [`Material::check`] for its cure.
pub fn stiffness(
    dim: usize,
    points: &[[f64; 3]],
    element: Element,
    material: &Material,
    out: &mut [f64],
) {
    let n = points.len() * material.components(dim);
    assert_eq!(out.len(), n * n, "a cell has {n} degrees of freedom");
    match (dim, material) {
        (2, Material::Scalar { rho }) => scalar::<2, 4>(points, element, *rho, out),
        (3, Material::Scalar { rho }) => scalar::<3, 8>(points, element, *rho, out),
        (2, _) => elastic::<2, 4>(points, element, material.moduli(dim, element), out),
        (3, _) => elastic::<3, 8>(points, element, material.moduli(dim, element), out),
        _ => panic!("cells have dimension 2 or 3, not {dim}"),
    }
}

fn scalar<const D: usize, const N: usize>(
    points: &[[f64; 3]],
    element: Element,
    rho: f64,
    out: &mut [f64],
) {
    let mut k = [[0.0; N]; N];
    for_each_sample::<D, N>(points, element, Rule::Stiffness, |s| {
        for slope in &s.gradient[..D] {
            for (row, g) in k.iter_mut().zip(slope) {
                for (entry, h) in row.iter_mut().zip(slope) {
                    *entry += s.weight * g * h;
                }
            }
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
    element: Element,
    moduli: Moduli,
    out: &mut [f64],
) {
    // Products `[i][j][a][b]` = ∫ ∂_i N_a ∂_j N_b for i ≤ j; the others are their transposes. From them the matrix is
    // a few additions per entry, whatever the material.
    let mut products = [[[[0.0; N]; N]; D]; D];
    let mut mean = [[0.0; N]; D];
    let mut volume = 0.0;
    for_each_sample::<D, N>(points, element, Rule::Stiffness, |s| {
        volume += s.weight;
        for i in 0..D {
            let weighted = s.gradient[i].map(|g| s.weight * g);
            for j in i..D {
                for (row, g) in products[i][j].iter_mut().zip(weighted) {
                    for (entry, h) in row.iter_mut().zip(&s.gradient[j]) {
                        *entry += g * h;
                    }
                }
            }
            for (sum, g) in mean[i].iter_mut().zip(weighted) {
                *sum += g;
            }
        }
    });
    let IsotropicModuli {
        shear,
        point,
        mean: by_mean,
    } = match moduli {
        Moduli::Isotropic(moduli) => moduli,
        Moduli::General(tangent) => return general(&products, &tangent, out),
    };
    let by_mean = by_mean / volume;
    let n = D * N;
    for a in 0..N {
        for b in a..N {
            let trace: f64 = (0..D).map(|i| products[i][i][a][b]).sum();
            for i in 0..D {
                // A diagonal block is computed on and above its diagonal only.
                for j in if a == b { i } else { 0 }..D {
                    let (here, turned) = if i <= j {
                        (products[i][j][a][b], products[i][j][b][a])
                    } else {
                        (products[j][i][b][a], products[j][i][a][b])
                    };
                    let mut entry = point * here                    // ∫ ∂_i N_a ∂_j N_b
                        + by_mean * mean[i][a] * mean[j][b]         // the same by means
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

/// Σ C_ijkl ∫ ∂_j N_a ∂_l N_b for the components i and k of nodes a and b.
fn general<const D: usize, const N: usize>(
    products: &[[[[f64; N]; N]; D]; D],
    tangent: &Tangent,
    out: &mut [f64],
) {
    let n = D * N;
    for a in 0..N {
        for b in a..N {
            for i in 0..D {
                // A diagonal block is computed on and above its diagonal only.
                for k in if a == b { i } else { 0 }..D {
                    let mut sum = 0.0;
                    for j in 0..D {
                        for l in 0..D {
                            let product = match j <= l {
                                true => products[j][l][a][b],
                                false => products[l][j][b][a],
                            };
                            sum += tangent.at(i, j, k, l) * product;
                        }
                    }
                    out[n * (D * a + i) + D * b + k] = sum;
                    out[n * (D * b + k) + D * a + i] = sum;
                }
            }
        }
    }
}
