//! Deluxe scaling: inside a body the copies of an edge or face are averaged with their Schur complements as weights.
//!
//! A group is a set of dofs that the same subdomains share: an edge, or a face with the edges in it. With
//!
//! ```text
//!     A_k = (Σ S)⁻¹ S_k,      E w = Σ_k A_k w_k,      B_D,locᵀ = (I − E) B_loc⁺
//! ```
//!
//! the identity B B_Dᵀ B = B holds as for weights that are numbers. Dofs that carry rows of B_gl keep weights that are
//! numbers: B_gl acts on the weighted average of the copies, which B_D,locᵀ must not change.

use std::collections::{BTreeMap, HashMap};

use mpi::topology::SimpleCommunicator;

use super::columns::JumpEntry;
use super::operator::Jump;
use crate::feti::adaptive::classes::{self, DualClass};
use crate::feti::interface::sharing::DofSharing;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::substructures::Problem;
use base::linalg::dense::{self, Dense, Scratch};
use parallel::exchange::exchange_by_rank;
use parallel::parcels::Parcels;

/// Replaces the weights of B_loc in `jump`, whose entries are on interface positions. Collective.
pub fn apply(
    comm: &SimpleCommunicator,
    problem: &Problem,
    sharing: &DofSharing,
    jump: &mut Jump,
    locals: &[ScaledSubdomain],
) {
    let groups: Vec<Vec<DualClass>> = (0..locals.len())
        .map(|j| {
            let between = jump
                .columns
                .of(j)
                .between_bodies(locals[j].gamma().n_gamma());
            classes::of(&problem.local[j], sharing, &locals[j], |i| !between[i])
        })
        .collect();
    // The entries of S go to every sharer.
    let mut outgoing = Parcels::for_each_rank(comm);
    for (j, sub) in problem.local.iter().enumerate() {
        for group in &groups[j] {
            let s = locals[j].s_on(&group.at);
            for &to in &group.sharers {
                let (of, entries) = ([to.into(), sub.index as u64, group.name()], s.data.iter());
                outgoing[sharing.locations.rank(to)].push(of, entries.copied());
            }
        }
    }
    let mut received: HashMap<(u64, u64), BTreeMap<u64, Vec<f64>>> = HashMap::new();
    for ([to, from, group], data) in exchange_by_rank(comm, outgoing)
        .iter()
        .flat_map(Parcels::iter)
    {
        let of_group = received.entry((to, group)).or_default();
        of_group.insert(from, data.to_vec());
    }
    let mut more = vec![Vec::new(); locals.len()];
    for (j, sub) in problem.local.iter().enumerate() {
        for group in &groups[j] {
            let schur = &received[&(sub.index as u64, group.name())];
            // All sharers add the same numbers in the same order, so that their results are identical.
            if let Some(weights) = group.weights(schur.values()) {
                let own = group.sharers.binary_search(&(sub.index as u32));
                group.replace(jump, j, (own.expect("a sharer"), &weights), &mut more[j]);
            }
        }
    }
    jump.columns = std::mem::take(&mut jump.columns).extended(&more);
}

impl DualClass {
    /// (Σ S)⁻¹ S_k for every sharer; `None` if nothing holds the group.
    fn weights<'a>(&self, schur: impl Iterator<Item = &'a Vec<f64>> + Clone) -> Option<Vec<Dense>> {
        let m = self.at.len();
        let mut l = Dense::zeros(m, m);
        for s in schur.clone() {
            l.data.iter_mut().zip(s).for_each(|(l, s)| *l += s);
        }
        let diagonal: Vec<f64> = (0..m).map(|i| l.get(i, i)).collect();
        dense::cholesky(l.view_mut(), &mut Scratch::default()).ok()?;
        if (0..m).any(|i| l.get(i, i).powi(2) <= 1e-10 * diagonal[i]) {
            return None;
        }
        let solve = |s: &Vec<f64>| {
            let mut a = Dense {
                rows: m,
                cols: m,
                data: s.clone(),
            };
            dense::solve_lower(l.view(), a.view_mut());
            dense::solve_lower_transpose(l.view(), a.view_mut());
            a
        };
        Some(schur.map(solve).collect())
    }

    /// Replaces B_D in the rows of this group on copy number `c`, that of local subdomain `j`. Entries at places where
    /// it has none yet are added to `more`.
    fn replace(
        &self,
        jump: &mut Jump,
        j: usize,
        (c, weights): (usize, &[Dense]),
        more: &mut Vec<JumpEntry>,
    ) {
        let (n, q) = (self.at.len(), self.sharers.len());
        let columns = jump.columns.of(j);
        let mut place = HashMap::new();
        for (p, &i) in self.at.iter().enumerate() {
            place.insert(i as u32, p);
        }
        // Rows of a dof are numbered pair after pair, and every copy has an entry in each of them.
        let mut rows: Vec<Vec<(u32, usize)>> = vec![Vec::new(); n];
        for (k, (&row, at)) in columns.row.iter().zip(columns.at).enumerate() {
            if let Some(&p) = place.get(at) {
                rows[p].push((row, k));
            }
        }
        rows.iter_mut().for_each(|r| r.sort_unstable());
        let pairs = (0..q).flat_map(|a| (a + 1..q).map(move |b| (a, b)));
        for (pair, ab) in pairs.enumerate() {
            let entries = self.pair(ab, c, weights);
            for (x, rows) in rows.iter().enumerate() {
                let (row, own) = rows[pair];
                for (y, &at) in self.at.iter().enumerate() {
                    let value = entries.get(y, x);
                    if x == y {
                        jump.columns.set_bd(j, own, value);
                    } else if value != 0.0 {
                        more.push(JumpEntry {
                            row,
                            at: at as u32,
                            b: 0.0,
                            bd: value,
                        });
                    }
                }
            }
        }
    }

    /// B_Dᵀ of the rows (a, b) on copy c: Σ_k A_k (z_c − z_k) with z = B⁺ λ, summed without cancellation.
    fn pair(&self, (a, b): (usize, usize), c: usize, weights: &[Dense]) -> Dense {
        let (n, q) = (self.at.len(), weights.len() as f64);
        let value = |k: usize| f64::from(u8::from(k == a)) - f64::from(u8::from(k == b));
        let mut out = Dense::zeros(n, n);
        for (k, weight) in weights.iter().enumerate() {
            let factor = (value(c) - value(k)) / q;
            if factor != 0.0 {
                let terms = out.data.iter_mut().zip(&weight.data);
                terms.for_each(|(o, w)| *o += factor * w);
            }
        }
        out
    }
}
