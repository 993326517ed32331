//! The host's motions without energy: restricted to subdomains, and an orthogonal basis for every body.

use super::parts::TornSubdomain;
use crate::Result;
use parallel::exchange::{exchange_by_rank, highest};
use parallel::halo::Halo;
use parallel::parcels::Parcels;
use petsc::{Session, Vec as PetscVec};
use std::collections::HashMap;

/// A vector is linearly dependent if orthogonalisation shortens it to less than this fraction.
const DEPENDENT: f64 = 1e-8;

/// Columns of one subdomain, by local dof.
pub type KernelVectors = Vec<Vec<f64>>;

/// The host's vectors at the dofs of every part; `None` if there are none. Collective.
pub fn modes(
    vectors: Option<&[PetscVec]>,
    halo: &Halo,
    ghosts: &[u32],
    parts: &[TornSubdomain],
) -> Result<Option<Vec<KernelVectors>>> {
    let Some(vectors) = vectors else {
        return Ok(None);
    };
    let mut columns: Vec<KernelVectors> = vec![Vec::new(); parts.len()];
    let mut values = vec![0.0; ghosts.len()];
    for vector in vectors {
        halo.fetch(vector, &mut values)?;
        let place = |dof: &u32| ghosts.binary_search(dof).expect("a part's dof is a ghost");
        for (part, list) in parts.iter().zip(&mut columns) {
            list.push(part.dofs.iter().map(|dof| values[place(dof)]).collect());
        }
    }
    Ok(Some(columns))
}

/// An orthogonal basis of the span of the columns, with entries of order one.
pub fn orthogonal(columns: &KernelVectors) -> KernelVectors {
    let mut rest = columns.clone();
    let mut out: KernelVectors = Vec::new();
    let norm = |x: &Vec<f64>| x.iter().map(|v| v * v).sum::<f64>().sqrt();
    let lengths: Vec<f64> = rest.iter().map(norm).collect();
    for _ in 0..columns.len() {
        let relative = |c: usize| {
            if lengths[c] > 0.0 {
                norm(&rest[c]) / lengths[c]
            } else {
                0.0
            }
        };
        let best = (0..rest.len()).max_by(|&a, &b| relative(a).total_cmp(&relative(b)));
        let Some(best) = best.filter(|&c| relative(c) > DEPENDENT) else {
            break;
        };
        let length = norm(&rest[best]);
        let q: Vec<f64> = rest[best].iter().map(|v| v / length).collect();
        // Two passes of Gram-Schmidt are enough.
        for _ in 0..2 {
            for x in &mut rest {
                let part: f64 = x.iter().zip(&q).map(|(x, q)| x * q).sum();
                x.iter_mut().zip(&q).for_each(|(x, q)| *x -= part * q);
            }
        }
        rest[best].fill(0.0);
        let scale = (q.len() as f64).sqrt();
        out.push(q.iter().map(|v| v * scale).collect());
    }
    out
}

/// Replaces the columns of every part by combinations that are orthogonal over the whole body, with entries of order
/// one. All parts of a body use the same combinations: some rank adds up the products of all columns of a body, in the
/// order of its parts. Collective.
pub fn over_bodies(session: &Session, body_of: &[usize], columns: &mut [KernelVectors]) {
    let k = columns.iter().map(Vec::len).max().unwrap_or(0);
    let k = highest(session.comm(), k as f64) as usize;
    let (size, width) = (session.size(), k * k + 1);
    let mut outgoing = Parcels::for_each_rank(session.comm());
    for (&body, list) in body_of.iter().zip(columns.iter()) {
        let mut gram = vec![0.0; width];
        for (a, x) in list.iter().enumerate() {
            for (b, y) in list.iter().enumerate() {
                gram[a + b * k] = x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            }
        }
        gram[k * k] = list.first().map_or(0.0, |x| x.len() as f64);
        outgoing[body % size].push(body, gram);
    }
    let received = exchange_by_rank(session.comm(), outgoing);
    let mut sums: HashMap<usize, Vec<f64>> = HashMap::new();
    for (body, gram) in received.iter().flat_map(Parcels::iter) {
        let sum = sums.entry(body).or_insert_with(|| vec![0.0; width]);
        sum.iter_mut().zip(gram).for_each(|(s, x)| *s += x);
    }
    let reply = |list: &Parcels<usize, f64>| -> Vec<f64> {
        let of_bodies = list.iter().flat_map(|(body, _)| &sums[&body]);
        of_bodies.copied().collect()
    };
    let answers = exchange_by_rank(session.comm(), received.iter().map(reply).collect());
    let mut next = vec![0; size];
    for (&body, list) in body_of.iter().zip(columns) {
        let at = &mut next[body % size];
        let gram = &answers[body % size][*at..*at + width];
        *at += width;
        *list = combined(list, &combinations(gram, k), gram[k * k]);
    }
}

/// Coefficient vectors c that are orthonormal in the Gram matrix: cᵀ (Gram matrix) c = 1.
pub(super) fn combinations(gram: &[f64], k: usize) -> KernelVectors {
    let length = |a: usize| match gram[a + a * k] {
        d if d > 0.0 => d.sqrt(),
        _ => 1.0,
    };
    let scaled = faer::Mat::from_fn(k, k, |a, b| gram[a + b * k] / (length(a) * length(b)));
    let Ok(eigen) = scaled.self_adjoint_eigen(faer::Side::Lower) else {
        return Vec::new();
    };
    let values = eigen.S().column_vector();
    let kept = (0..k).filter(|&c| values[c] > DEPENDENT * DEPENDENT.sqrt() * k as f64);
    kept.map(|c| {
        let size = values[c].sqrt();
        let entry = |a: usize| eigen.U()[(a, c)] / (size * length(a));
        (0..k).map(entry).collect()
    })
    .collect()
}

fn combined(list: &KernelVectors, combinations: &KernelVectors, n: f64) -> KernelVectors {
    let one = |c: &Vec<f64>| {
        let mut sum = vec![0.0; list.first().map_or(0, Vec::len)];
        for (x, factor) in list.iter().zip(c) {
            let factor = factor * n.sqrt();
            sum.iter_mut().zip(x).for_each(|(s, x)| *s += factor * x);
        }
        sum
    };
    combinations.iter().map(one).collect()
}
