//! The factor of a semidefinite matrix that several ranks share.
//!
//! Subtrees of the elimination tree are dealt out to the ranks. What is above them, the top, is eliminated by every
//! rank, after the ranks have exchanged what their subtrees leave to it. So a rank stores its subtrees and the top, and
//! a solve takes two sums over the ranks: of what subtrees leave to the rows of the top, and of the solution.

use std::cell::RefCell;
use std::rc::Rc;

use mpi::traits::Communicator;

use super::multifrontal::{Elimination, PartialCholesky, Pivots};
use super::team::Team;
use crate::linalg::csr::Csr;
use crate::parallel::clock::{self, Phase};
use crate::parallel::exchange::{gather_all, sum_all};

/// The factor of a semidefinite matrix, shared by a team.
pub struct SharedCholesky {
    team: Rc<Team>,
    /// The panels that this rank has.
    factor: PartialCholesky,
    /// A number for every row; those of this rank's subtrees and of the top are in use.
    work: RefCell<Vec<f64>>,
}

impl SharedCholesky {
    /// The factor of `k`, of which a rank needs the rows of its subtrees and of the top, and the dofs that it leaves
    /// out ([`semidefinite`](PartialCholesky::semidefinite)). Collective.
    pub fn semidefinite(k: &Csr, team: Rc<Team>, least: f64) -> (SharedCholesky, Vec<u32>) {
        let (comm, symbolic) = (&team.comm, &*team.symbolic);
        let mut elimination = Elimination::new(k, symbolic, symbolic);
        let mut left: Vec<u32> = Vec::new();
        let eliminate = |elimination: &mut Elimination<'_>, fronts: &[usize]| {
            let mut weak = Vec::new();
            let mut pivots = Pivots::Above(least, &mut weak);
            for &f in fronts {
                let done = elimination.front(f, &mut pivots);
                done.expect("no pivot is too small");
            }
            weak
        };
        let own = eliminate(&mut elimination, &team.own);
        if comm.size() > 1 {
            let mut words = vec![own.len() as u64];
            words.extend(own.iter().map(|&dof| u64::from(dof)));
            for &f in &team.roots {
                let n = symbolic.fronts[f].below.len();
                let update = elimination.take(f);
                words.push(f as u64);
                let columns = (0..n).flat_map(|j| &update[j * n + j..(j + 1) * n]);
                words.extend(columns.map(|v| v.to_bits()));
            }
            let mut updates = Vec::new();
            for words in gather_all(comm, &words) {
                let (dofs, mut rest) = words[1..].split_at(words[0] as usize);
                left.extend(dofs.iter().map(|&dof| dof as u32));
                while let [f, tail @ ..] = rest {
                    let n = symbolic.fronts[*f as usize].below.len();
                    let (values, tail) = tail.split_at(n * (n + 1) / 2);
                    let mut update = vec![0.0; n * n];
                    let mut values = values.iter().map(|&v| f64::from_bits(v));
                    for j in 0..n {
                        let column = &mut update[j * n + j..(j + 1) * n];
                        column.iter_mut().zip(&mut values).for_each(|(u, v)| *u = v);
                    }
                    updates.push((*f as usize, update));
                    rest = tail;
                }
            }
            // The order in which the top adds them does not depend on who has them.
            updates.sort_by_key(|u| u.0);
            for (f, update) in updates {
                elimination.give(f, update);
            }
        } else {
            left = own;
        }
        left.extend(eliminate(&mut elimination, &team.top));
        let factor = PartialCholesky {
            symbolic: team.symbolic.clone(),
            panels: elimination.panels,
        };
        let work = vec![0.0; team.n()].into();
        (SharedCholesky { team, factor, work }, left)
    }

    /// b ← A⁺ b, the same on every rank: zero at the dofs that are left out, after rounding. Collective.
    pub fn solve(&self, b: &mut [f64]) {
        let (team, factor) = (&*self.team, &self.factor);
        if team.comm.size() == 1 {
            factor.solve(b);
            return;
        }
        let mut y = factor.in_order(b);
        let rows = || team.top_rows.iter().map(|&p| p as usize);
        let begin: Vec<f64> = rows().map(|p| std::mem::take(&mut y[p])).collect();
        factor.lower_of(team.fronts(&team.own), &mut y);
        let mut left: Vec<f64> = rows().map(|p| y[p]).collect();
        sum_all(&team.comm, &mut left);
        for (p, (begin, left)) in rows().zip(begin.iter().zip(&left)) {
            y[p] = begin + left;
        }
        factor.lower_of(team.fronts(&team.top), &mut y);
        factor.upper_of(team.fronts(&team.top).rev(), &mut y);
        factor.upper_of(team.fronts(&team.own).rev(), &mut y);
        let others = y.iter_mut().enumerate().filter(|r| !team.tells_row(r.0));
        others.for_each(|(_, y)| *y = 0.0);
        sum_all(&team.comm, &mut y);
        factor.by_dof(&y, b);
    }

    /// A⁺ b for a vector b that no rank has whole. `own` has the entries of the rows of this rank's subtrees. `top` has
    /// this rank's share of the entries of the top; the shares of all ranks are summed. Both have the solution on
    /// return. One sum over the ranks, of the rows of the top. Collective.
    pub fn solve_shares(&self, own: &mut [f64], top: &mut [f64]) {
        let (team, factor) = (&*self.team, &self.factor);
        let mut y = self.work.borrow_mut();
        let put = |rows: &[u32], values: &[f64], y: &mut [f64]| {
            rows.iter()
                .zip(values)
                .for_each(|(&p, v)| y[p as usize] = *v);
        };
        let get = |rows: &[u32], values: &mut [f64], y: &[f64]| {
            rows.iter()
                .zip(values)
                .for_each(|(&p, v)| *v = y[p as usize]);
        };
        put(&team.own_rows, own, &mut y);
        team.top_rows.iter().for_each(|&p| y[p as usize] = 0.0);
        factor.lower_of(team.fronts(&team.own), &mut y);
        let left = team.top_rows.iter().map(|&p| y[p as usize]);
        top.iter_mut().zip(left).for_each(|(t, l)| *t += l);
        clock::timed(Phase::Reduction, || sum_all(&team.comm, top));
        put(&team.top_rows, top, &mut y);
        factor.lower_of(team.fronts(&team.top), &mut y);
        factor.upper_of(team.fronts(&team.top).rev(), &mut y);
        factor.upper_of(team.fronts(&team.own).rev(), &mut y);
        get(&team.own_rows, own, &y);
        get(&team.top_rows, top, &y);
    }

    /// The ranks that share it, and who of them has what.
    pub fn team(&self) -> &Team {
        &self.team
    }

    /// For each of these dofs, which are left out, the vector v with A v = 0 that is one there.
    /// Collective.
    pub fn null_vectors(&self, dofs: &[u32]) -> Vec<Vec<(u32, f64)>> {
        let (team, symbolic) = (&*self.team, &*self.factor.symbolic);
        let mut held = [&team.own[..], &team.top[..]].concat();
        held.sort_unstable();
        let position = |dof: u32| symbolic.position[dof as usize] as usize;
        let mut words: Vec<u64> = Vec::new();
        for (k, &dof) in dofs.iter().enumerate() {
            if !team.has_row(position(dof)) {
                continue;
            }
            let v = self.factor.null_vector(dof, team.fronts(&held).rev());
            for (i, value) in v {
                if team.tells_row(position(i)) {
                    words.extend([k as u64, u64::from(i), value.to_bits()]);
                }
            }
        }
        let mut vectors = vec![Vec::new(); dofs.len()];
        for words in gather_all(&team.comm, &words) {
            for entry in words.chunks_exact(3) {
                let value = f64::from_bits(entry[2]);
                vectors[entry[0] as usize].push((entry[1] as u32, value));
            }
        }
        for v in &mut vectors {
            v.sort_by_key(|e| e.0);
        }
        vectors
    }
}
