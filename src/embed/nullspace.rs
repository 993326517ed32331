//! The kernel of one subdomain matrix, from the matrix alone.
//!
//! A few dofs F are held, so many and so chosen that the other dofs I follow from them. The Schur complement S on F is
//! small, and its kernel is that of K:
//!
//! ```text
//!     K v = 0   ⇔   S v_F = 0,  v_I = −K_II⁻¹ K_IF v_F,        S = K_FF − K_FI K_II⁻¹ K_IF
//! ```
//!
//! A subdomain of an unstructured mesh may have more motions without energy than a body has rigid ones: cells that hang
//! by an edge or a node turn about it. No vector that a host knows tells of them.

use std::sync::Arc;

use super::kernels::{orthogonal, KernelVectors};
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use cholesky::multifrontal::{PartialCholesky, SingularInterior};
use cholesky::symbolic::Symbolic;

/// A pivot of K_II below this fraction of its diagonal entry adds the dof to F: S would lose as many digits. One dof
/// too many does no harm. Motions without energy leave 1e-16 or so, coefficients that jump by 1e6 leave 1e-6.
const WEAK: f64 = 1e-5;

/// Factorisations after which pivots that are weak but not zero are left as they are.
const PASSES: usize = 4;

/// With more dofs in F than this, beside those of the guess, the matrix is no stiffness matrix. Every one costs a
/// factorisation.
const MOST: usize = 500;

/// Eigenvalues of S, in units of the diagonal of K, below this are looked at. True motions have 1e-14.
const SMALL: f64 = 1e-8;

/// A vector belongs to the kernel if the terms of each row of K v cancel to less than this fraction. Rounding leaves
/// 1e-13; a long thin part that bends softly has 1e-8.
const CANCELS: f64 = 1e-10;

/// Energies below this negative number, relative to the sum of the absolute values of their terms, are no rounding.
const NEGATIVE: f64 = -1e-10;

/// A matrix that is not positive semidefinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Indefinite {
    /// A local dof that moves most in a motion of negative energy.
    pub dof: u32,
    /// vᵀ K v of that motion, relative to the sum of the absolute values of its terms, where it is known.
    pub energy: Option<f64>,
}

/// A basis of the kernel of `k`, orthogonal, with entries of order one. `guess` has motions that may be in the kernel;
/// they shorten the work and change nothing else.
///
/// # Errors
/// A matrix that is not positive semidefinite.
pub fn kernel(k: &Csr, guess: &KernelVectors) -> Result<KernelVectors, Indefinite> {
    let mut held = spread_dofs(guess);
    let mut passes = 0;
    let (factor, s) = loop {
        let symbolic = Symbolic::new(k, &held, None);
        match PartialCholesky::new(k, Arc::new(symbolic)) {
            Err(SingularInterior { dof }) => held.push(dof),
            Ok((factor, s)) => {
                let weak = factor.weak_dofs(k, WEAK);
                if weak.is_empty() || passes == PASSES {
                    break (factor, s);
                }
                passes += 1;
                held.extend(weak);
            }
        }
        if held.len() > guess.len() + MOST {
            let dof = held[held.len() - 1];
            return Err(Indefinite { dof, energy: None });
        }
    };
    let scale: Vec<f64> = held
        .iter()
        .map(|&i| k.get(i as usize, i as usize).sqrt())
        .collect();
    let mut found = KernelVectors::new();
    for z in low_end(&s, &scale) {
        let mut v = vec![0.0; k.n()];
        for ((&i, z), scale) in held.iter().zip(&z).zip(&scale) {
            v[i as usize] = z / scale;
        }
        factor.backward(&mut v);
        let energy = relative_energy(k, &v);
        if energy < NEGATIVE {
            let largest = (0..k.n()).max_by(|&a, &b| v[a].abs().total_cmp(&v[b].abs()));
            return Err(Indefinite {
                dof: largest.unwrap_or(0) as u32,
                energy: Some(energy),
            });
        }
        if annihilates(k, &v, CANCELS) {
            found.push(v);
        }
    }
    Ok(orthogonal(&found))
}

/// Eigenvectors of the scaled S with eigenvalues below [`SMALL`].
fn low_end(s: &Dense, scale: &[f64]) -> KernelVectors {
    let n = scale.len();
    if n == 0 {
        return KernelVectors::new();
    }
    let a = faer::Mat::from_fn(n, n, |i, j| s.get(i, j) / (scale[i] * scale[j]));
    let eigen = a
        .self_adjoint_eigen(faer::Side::Lower)
        .expect("eigenvalues of a small symmetric finite matrix converge");
    let values = eigen.S().column_vector();
    let low = (0..n).filter(|&c| values[c] < SMALL);
    low.map(|c| (0..n).map(|i| eigen.U()[(i, c)]).collect())
        .collect()
}

/// As many dofs as there are independent motions, far from each other: the dof that moves most, then the one that moves
/// most in what is left (Gram–Schmidt on rows).
fn spread_dofs(motions: &KernelVectors) -> Vec<u32> {
    let mut rest = orthogonal(motions);
    let mut out = Vec::new();
    for _ in 0..rest.len() {
        let n = rest[0].len();
        let size = |i: &usize| rest.iter().map(|x| x[*i] * x[*i]).sum::<f64>();
        let Some(best) = (0..n).max_by(|a, b| size(a).total_cmp(&size(b)).then(b.cmp(a))) else {
            break;
        };
        let row: Vec<f64> = rest.iter().map(|x| x[best]).collect();
        let square: f64 = row.iter().map(|x| x * x).sum();
        if square == 0.0 {
            break;
        }
        out.push(best as u32);
        // x ← x − (x_best / |row|²) Σ row_c x_c in every column: nothing moves the dof any more.
        let mut along = vec![0.0; n];
        for (x, r) in rest.iter().zip(&row) {
            along.iter_mut().zip(x).for_each(|(a, x)| *a += r * x);
        }
        for (x, r) in rest.iter_mut().zip(&row) {
            let factor = r / square;
            x.iter_mut().zip(&along).for_each(|(x, a)| *x -= factor * a);
        }
    }
    out
}

/// vᵀ K v, relative to the sum of the absolute values of its terms.
fn relative_energy(k: &Csr, v: &[f64]) -> f64 {
    let (mut sum, mut size) = (0.0, 0.0);
    for i in 0..k.n() {
        let (col, val) = k.row(i);
        for (&j, &a) in col.iter().zip(val) {
            let term = v[i] * a * v[j as usize];
            sum += term;
            size += term.abs();
        }
    }
    if size > 0.0 {
        sum / size
    } else {
        0.0
    }
}

/// Whether the terms of each row of K v cancel to less than `fraction` of their size.
pub fn annihilates(k: &Csr, v: &[f64], fraction: f64) -> bool {
    cancels(k, &k.val, v, fraction)
}

/// Whether the terms of each row of K v cancel to less than `fraction` of their size, for the K with the pattern of `k`
/// and these entries.
pub fn cancels(k: &Csr, entries: &[f64], v: &[f64], fraction: f64) -> bool {
    let largest = v.iter().fold(0.0f64, |a, v| a.max(v.abs()));
    (0..k.n()).all(|i| {
        let range = k.row_ptr[i]..k.row_ptr[i + 1];
        let (col, val) = (&k.col[range.clone()], &entries[range]);
        let terms = col.iter().zip(val);
        let sum: f64 = terms.map(|(&j, a)| a * v[j as usize]).sum();
        let size: f64 = val.iter().map(|a| a.abs()).sum();
        sum.abs() <= fraction * size * largest
    })
}

#[cfg(test)]
#[path = "../../tests/inside/embed/nullspace.rs"]
mod tests;
