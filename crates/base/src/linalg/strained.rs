//! Displacements without the rigid motion of their subdomain.
//!
//! A stiff subdomain that others carry along moves by far more than it strains. K R = 0 holds in numbers only to ε ‖K‖,
//! so that K u has forces of ε ‖K‖ |u| that K (u − R α) has not. Their resultant is carried by the softer neighbours:
//! with E in the ratio 10¹² it is one per cent of the load, and (u, λ) seem to be wrong by as much.

use super::csr::Csr;

/// A subdomain moves rigidly if uᵀK u is below this part of Σ d u², d = diag(K). Forces of K u are then wrong by more
/// than 1e-13 of themselves, and where nothing holds the motion there is nothing that bounds what they do.
pub const RIGID: f64 = 1e-6;

/// A column lies in the kernel of K if ‖K q‖ is below this part of ‖q‖, in the norms of D⁻¹ and D.
const KERNEL: f64 = 1e-12;

/// u without the part in the kernel of K, if the subdomain moves rigidly; `energy` is uᵀK u, d the diagonal of K, and
/// the columns span the kernels that K could have.
pub fn strained(
    k: &Csr,
    columns: Option<&[Vec<f64>]>,
    d: &[f64],
    u: &[f64],
    energy: f64,
) -> Option<Vec<f64>> {
    let columns = columns?;
    let dot = |a: &[f64], b: &[f64]| -> f64 {
        let each = a.iter().zip(b).zip(d);
        each.map(|((a, b), d)| a * b * d).sum()
    };
    if energy.abs() > RIGID * dot(u, u) {
        return None;
    }
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(columns.len());
    let remove = |basis: &[Vec<f64>], x: &mut [f64]| {
        // Twice is enough.
        for q in basis.iter().chain(basis) {
            let part = dot(q, x);
            x.iter_mut().zip(q).for_each(|(x, q)| *x -= part * q);
        }
    };
    for column in columns {
        let mut q = column.clone();
        let before = dot(&q, &q);
        remove(&basis, &mut q);
        let square = dot(&q, &q);
        if square.is_nan() || square <= 1e-20 * before {
            continue;
        }
        let length = square.sqrt();
        q.iter_mut().for_each(|x| *x /= length);
        let mut force = vec![0.0; q.len()];
        k.mul(&q, &mut force);
        let size: f64 = force.iter().zip(d).map(|(f, d)| f * f / d).sum();
        if size <= KERNEL * KERNEL {
            basis.push(q);
        }
    }
    let mut out = u.to_vec();
    remove(&basis, &mut out);
    (!basis.is_empty()).then_some(out)
}

#[cfg(test)]
#[path = "../../tests/linalg/strained.rs"]
mod tests;
