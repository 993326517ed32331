//! Averages of motions: of each whole edge or face, the functionals that see motions without energy beyond the means of
//! its components.
//!
//! The functionals are orthonormal, and perpendicular to the means. On an edge or
//! face with nodes x about their centre, the motions that a mean does not see are the rotations ω × x. Those that
//! vanish there are left out, as that about a straight edge. The basis follows from the span alone:
//! the same edge or face elsewhere has the same one but for rounding, and equal subdomains stay equal.
//!
//! The rank of the lowest subdomain that shares an edge or face computes them, and all others take its numbers.

use std::collections::{BTreeMap, HashMap};

use mpi::topology::SimpleCommunicator;

use super::entities::{Average, AverageKind};
use super::sharing::DofSharing;
use crate::substructures::{Problem, Subdomain};
use base::linalg::sorted::distinct;
use bytemuck::{Pod, Zeroable};
use parallel::exchange::exchange_by_rank;
use parallel::parcels::Parcels;

/// A motion is dependent if less than this part of the largest one, or of what it was before the means were taken out,
/// is left of it. Positions in single precision leave 1e-7.
const DEPENDENT: [f64; 2] = [1e-3, 1e-6];

/// Two dofs move alike if their motions differ in size by less than this: the first of them is the pivot.
const ALIKE: f64 = 1e-6;

/// An edge or face of one subdomain.
struct Whole {
    /// Its subdomains, increasing.
    sharers: Vec<u32>,
    /// Dual dofs of all components in the order of body dof: the body dof, the local dof, the component.
    dofs: Vec<(u64, u32, usize)>,
}

/// An edge or face, by its lowest body dof, and one of its subdomains.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Eq, Hash, Pod, Zeroable)]
struct WholeSharer {
    whole: u64,
    subdomain: u64,
}

/// Adds the functionals of motions to the means of each local subdomain. `wholes` has, for each mean, the number of its
/// edge or face. Collective.
pub(super) fn add(
    comm: &SimpleCommunicator,
    problem: &Problem,
    sharing: &DofSharing,
    wholes: &[Vec<u64>],
    averages: &mut [Vec<Average>],
) {
    let rank_of = |s: u32| sharing.locations.rank(s);
    let subs = problem.local.iter().zip(wholes).zip(&*averages);
    let mine: Vec<Vec<Whole>> = subs
        .map(|((sub, wholes), means)| of_subdomain(sharing, sub, wholes, means))
        .collect();
    // Columns that all subdomains of a body have in common come from the lowest one alone.
    let mut outgoing = Parcels::for_each_rank(comm);
    for (sub, list) in problem.local.iter().zip(&mine) {
        let (columns, common) = match &sub.near_kernel {
            Some(columns) => (columns, true),
            None => (&sub.own_kernel, false),
        };
        for whole in list {
            if common && whole.sharers[0] as usize != sub.index {
                continue;
            }
            let entries = columns
                .iter()
                .flat_map(|c| whole.dofs.iter().map(|&(_, i, _)| c[i as usize]));
            outgoing[rank_of(whole.sharers[0])].push(whole.dofs[0].0, entries);
        }
    }
    let received = exchange_by_rank(comm, outgoing);
    let mut columns: HashMap<u64, Vec<f64>> = HashMap::new();
    for (whole, entries) in received.iter().flat_map(Parcels::iter) {
        columns.entry(whole).or_default().extend(entries);
    }
    let mut outgoing = Parcels::for_each_rank(comm);
    for (sub, list) in problem.local.iter().zip(&mine) {
        for whole in list.iter().filter(|w| w.sharers[0] as usize == sub.index) {
            let component: Vec<usize> = whole.dofs.iter().map(|d| d.2).collect();
            let columns = columns.remove(&whole.dofs[0].0).unwrap_or_default();
            let columns = columns.chunks_exact(component.len()).map(<[f64]>::to_vec);
            let found = beyond_means(columns.collect(), &component).concat();
            for &to in &whole.sharers {
                let to_sharer = WholeSharer {
                    whole: whole.dofs[0].0,
                    subdomain: to.into(),
                };
                outgoing[rank_of(to)].push(to_sharer, found.iter().copied());
            }
        }
    }
    let received = exchange_by_rank(comm, outgoing);
    let answers: HashMap<WholeSharer, &[f64]> = received.iter().flat_map(Parcels::iter).collect();
    for ((sub, list), out) in problem.local.iter().zip(&mine).zip(averages) {
        for whole in list {
            let of = WholeSharer {
                whole: whole.dofs[0].0,
                subdomain: sub.index as u64,
            };
            let functionals = answers[&of].chunks_exact(whole.dofs.len());
            out.extend(functionals.zip(&whole.dofs).map(|(weights, name)| Average {
                kind: AverageKind::Motion,
                key: name.0,
                dofs: whole.dofs.iter().map(|d| d.1).collect(),
                weights: Some(weights.to_vec()),
            }));
        }
    }
}

/// The edges and faces of a subdomain, from the means of their components.
fn of_subdomain(
    sharing: &DofSharing,
    sub: &Subdomain,
    wholes: &[u64],
    means: &[Average],
) -> Vec<Whole> {
    let mut found: BTreeMap<u64, Vec<(u64, u32, usize)>> = BTreeMap::new();
    for (component, (whole, mean)) in wholes.iter().zip(means).enumerate() {
        let dofs = mean.dofs.iter();
        let dofs = dofs.map(|&i| (sub.dofs[i as usize], i, component));
        found.entry(*whole).or_default().extend(dofs);
    }
    let whole = |mut dofs: Vec<(u64, u32, usize)>| {
        dofs.sort_unstable();
        let copies = sharing.shared(dofs[0].0).iter();
        Whole {
            sharers: copies.map(|c| c.subdomain).collect(),
            dofs,
        }
    };
    found.into_values().map(whole).collect()
}

/// An orthonormal basis of what the columns have beyond constants in each component.
pub fn beyond_means(mut columns: Vec<Vec<f64>>, component: &[usize]) -> Vec<Vec<f64>> {
    let norm = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
    let whole = columns.iter().map(|c| norm(c)).fold(0.0, f64::max);
    let components = distinct(component.iter().copied());
    for column in &mut columns {
        for c in &components {
            let on = || (0..component.len()).filter(|&i| component[i] == *c);
            let mean = on().map(|i| column[i]).sum::<f64>() / on().count() as f64;
            on().for_each(|i| column[i] -= mean);
        }
    }
    // R = Q Σ Vᵀ from the eigenvalues of RᵀR: what is left has a tenth of a percent of the largest.
    let k = columns.len();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let gram = faer::Mat::from_fn(k, k, |a, b| product(&columns[a], &columns[b]));
    let Ok(eigen) = gram.self_adjoint_eigen(faer::Side::Lower) else {
        return Vec::new();
    };
    let values = eigen.S().column_vector();
    let size = |c: usize| values[c].max(0.0).sqrt();
    let largest = (0..k).map(size).fold(0.0, f64::max);
    let kept = (0..k).filter(|&c| size(c) > (DEPENDENT[0] * largest).max(DEPENDENT[1] * whole));
    let mut q: Vec<Vec<f64>> = kept
        .map(|c| {
            let entry = |i: usize| {
                (0..k)
                    .map(|a| columns[a][i] * eigen.U()[(a, c)])
                    .sum::<f64>()
            };
            (0..component.len()).map(|i| entry(i) / size(c)).collect()
        })
        .collect();
    canonical(&mut q, component.len())
}

/// The orthonormal basis of the span of `q` that pivots choose: the first dof that moves most, and the motion of unit
/// size that moves it most; then the same of what is left.
fn canonical(q: &mut [Vec<f64>], n: usize) -> Vec<Vec<f64>> {
    let mut out: Vec<Vec<f64>> = Vec::new();
    for _ in 0..q.len() {
        let square = |i: usize| q.iter().map(|x| x[i] * x[i]).sum::<f64>();
        let most = (0..n).map(square).fold(0.0, f64::max);
        let Some(pivot) = (0..n).find(|&i| square(i) >= (1.0 - ALIKE) * most) else {
            break;
        };
        let row: Vec<f64> = q.iter().map(|x| x[pivot] / square(pivot).sqrt()).collect();
        let along: Vec<f64> = (0..n)
            .map(|i| q.iter().zip(&row).map(|(x, r)| x[i] * r).sum())
            .collect();
        for (x, r) in q.iter_mut().zip(&row) {
            x.iter_mut().zip(&along).for_each(|(x, a)| *x -= r * a);
        }
        out.push(along);
    }
    out
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/interface/motions.rs"]
mod tests;
