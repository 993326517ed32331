//! The multipliers of merged rows, from the equilibrium of the nodes.

use std::collections::{BTreeMap, BTreeSet};

use mpi::topology::SimpleCommunicator;

use super::Merged;
use crate::substructures::{Row, SolvedRow};
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use parallel::exchange::sum_all;

/// The multipliers of the rows of this rank inside groups, in their order. Where rows are redundant they are those of
/// the smallest norm. `forces` are f − K u of each local subdomain, `solved` the other rows. Collective.
pub fn multipliers(
    comm: &SimpleCommunicator,
    merged: &Merged,
    forces: &[Vec<f64>],
    solved: &[SolvedRow],
) -> Vec<f64> {
    let (given, dofs) = (&merged.given, &merged.dofs);
    let at = |dof: u64| dofs.all.binary_search(&dof).ok();
    // f − K u − B_oᵀ λ_o at every tied dof.
    let mut left = vec![0.0; dofs.all.len()];
    for (sub, forces) in given.local.iter().zip(forces) {
        for (&dof, force) in sub.dofs.iter().zip(forces) {
            if let Some(k) = at(dof) {
                left[k] += force;
            }
        }
    }
    for (row, solved) in merged.of_method(&given.rows).zip(solved) {
        for &(dof, value) in &row.terms {
            if let Some(k) = at(dof) {
                left[k] -= value * solved.multiplier;
            }
        }
    }
    sum_all(comm, &mut left);
    let own: Vec<&Row> = { given.rows.iter().zip(&merged.inside) }
        .filter_map(|(row, inside)| inside.then_some(row))
        .collect();
    let mut nodes: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (r, row) in own.iter().enumerate() {
        let first = dofs.first[at(row.terms[0].0).expect("its dofs are tied")];
        nodes.entry(first).or_default().push(r);
    }
    let mut out = vec![0.0; own.len()];
    for rows in nodes.into_values() {
        // λ = B y has the smallest norm: Bᵀ B y = f − K u − B_oᵀ λ_o.
        let of = |r: usize| own[rows[r]].terms.iter();
        let tied: BTreeSet<u64> = (0..rows.len()).flat_map(of).map(|t| t.0).collect();
        let tied: Vec<u64> = tied.into_iter().collect();
        let place = |dof: &u64| tied.binary_search(dof).expect("it is one of them");
        let mut gram = Dense::zeros(tied.len(), tied.len());
        for r in 0..rows.len() {
            for x in of(r) {
                for y in of(r) {
                    let (i, j) = (place(&x.0), place(&y.0));
                    gram.set(i, j, gram.get(i, j) + x.1 * y.1);
                }
            }
        }
        let mut y: Vec<f64> = tied.iter().map(|d| left[at(*d).expect("tied")]).collect();
        Semidefinite::new(&gram).solve(&mut y);
        let product = |r: usize| of(r).map(|(dof, v)| v * y[place(dof)]).sum::<f64>();
        let lambda: Vec<f64> = (0..rows.len()).map(product).collect();
        for (&r, value) in rows.iter().zip(lambda) {
            out[r] = value;
        }
    }
    out
}
