//! The factor of a semidefinite matrix that several ranks share.
//!
//! Subtrees of the elimination tree are dealt out to the ranks. What is above them, the top, is eliminated by every
//! rank, after the ranks have exchanged what their subtrees leave to it. So a rank stores its subtrees and the top, and
//! a solve takes two sums over the ranks: of what subtrees leave to the rows of the top, and of the solution.

use std::rc::Rc;
use std::sync::Arc;

use mpi::topology::{Color, SimpleCommunicator};
use mpi::traits::Communicator;

use super::multifrontal::{Elimination, PartialCholesky, Pivots};
use super::symbolic::{Front, Symbolic};
use crate::linalg::csr::Csr;
use crate::parallel::exchange::{gather_all, sum_all};

/// Whose a front is, and its rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Whose {
    /// Of the subtrees of this rank.
    Own,
    /// Of all ranks.
    Top,
    Other,
}

/// Ranks that share a factor, and who of them has which front.
pub struct Team {
    comm: SimpleCommunicator,
    /// The pattern; it has room for the panels of the own fronts and of the top alone.
    symbolic: Arc<Symbolic>,
    /// Fronts in the order of elimination.
    own: Vec<usize>,
    top: Vec<usize>,
    /// The own fronts whose parents are in the top.
    roots: Vec<usize>,
    /// Whose each row is, in the order of elimination.
    rows: Vec<Whose>,
}

impl Team {
    /// Divides the ranks of `comm` into `copies` teams of the same size, which have the same factor, and deals out the
    /// fronts of `symbolic`. Collective.
    ///
    /// # Panics
    /// If `copies` does not divide the number of ranks.
    pub fn new(comm: &SimpleCommunicator, symbolic: Symbolic, copies: usize) -> Team {
        let size = comm.size() as usize;
        assert_eq!(size % copies, 0, "teams of the same size");
        let team = comm.rank() / (size / copies) as i32;
        let comm = comm.split_by_color(Color::with_value(team));
        let comm = comm.expect("every rank has a colour");
        let rank = comm.rank() as u32;
        let ranks = deal(&symbolic.fronts, comm.size() as usize);
        let whose = |f: usize| match ranks[f] {
            None => Whose::Top,
            Some(r) if r == rank => Whose::Own,
            Some(_) => Whose::Other,
        };
        let of = |w: Whose| (0..ranks.len()).filter(|&f| whose(f) == w).collect();
        let (own, top): (Vec<usize>, Vec<usize>) = (of(Whose::Own), of(Whose::Top));
        let above = |f: &usize| symbolic.fronts[*f].parent.map(whose) == Some(Whose::Top);
        let roots = own.iter().copied().filter(above).collect();
        let mut rows = Vec::with_capacity(symbolic.n_interior());
        for (f, front) in symbolic.fronts.iter().enumerate() {
            rows.extend(std::iter::repeat_n(whose(f), front.width()));
        }
        let symbolic = symbolic.with_panels(|f| whose(f) != Whose::Other);
        Team {
            comm,
            symbolic: symbolic.into(),
            own,
            top,
            roots,
            rows,
        }
    }

    fn fronts<'a>(
        &'a self,
        numbers: &'a [usize],
    ) -> impl DoubleEndedIterator<Item = &'a Front> + 'a {
        numbers.iter().map(|&f| &self.symbolic.fronts[f])
    }
}

/// The rank of each front, `None` for those of the top: the cut through the tree with the shortest way, counted in
/// operations of the top and of the rank that has most.
fn deal(fronts: &[Front], ranks: usize) -> Vec<Option<u32>> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); fronts.len()];
    let mut work: Vec<f64> = fronts.iter().map(Front::flops).collect();
    let mut subtrees: Vec<usize> = Vec::new();
    for (f, front) in fronts.iter().enumerate() {
        match front.parent {
            Some(t) => {
                work[t] += work[f];
                children[t].push(f);
            }
            None => subtrees.push(f),
        }
    }
    let mut top = 0.0;
    let mut best: Option<(f64, Vec<(usize, u32)>)> = None;
    // More pieces than this are smaller than what they could balance.
    for _ in 0..16 * ranks {
        subtrees.sort_by(|a, b| work[*b].total_cmp(&work[*a]).then(a.cmp(b)));
        let mut loads = vec![0.0; ranks];
        let mut dealt = Vec::with_capacity(subtrees.len());
        for &f in &subtrees {
            let least = (0..ranks).fold(0, |r, s| if loads[s] < loads[r] { s } else { r });
            loads[least] += work[f];
            dealt.push((f, least as u32));
        }
        let way = top + loads.iter().fold(0.0f64, |a, b| a.max(*b));
        if best.as_ref().is_none_or(|(shortest, _)| way < *shortest) {
            best = Some((way, dealt));
        }
        let Some(&largest) = subtrees.first() else {
            break;
        };
        if ranks == 1 || children[largest].is_empty() {
            break;
        }
        subtrees.remove(0);
        subtrees.extend(&children[largest]);
        top += fronts[largest].flops();
    }
    let mut rank = vec![None; fronts.len()];
    for (f, r) in best.map_or(Vec::new(), |b| b.1) {
        rank[f] = Some(r);
    }
    // Parents come after their children: from the roots of the subtrees down.
    for f in (0..fronts.len()).rev() {
        if let (None, Some(t)) = (rank[f], fronts[f].parent) {
            rank[f] = rank[t];
        }
    }
    rank
}

/// The factor of a semidefinite matrix, shared by a team.
pub struct SharedCholesky {
    team: Rc<Team>,
    /// The panels that this rank has.
    factor: PartialCholesky,
}

impl SharedCholesky {
    /// The factor of `k`, which every rank has, and the dofs that it leaves out
    /// ([`semidefinite`](PartialCholesky::semidefinite)). Collective.
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
        (SharedCholesky { team, factor }, left)
    }

    /// b ← A⁺ b, the same on every rank: zero at the dofs that are left out, after rounding. Collective.
    pub fn solve(&self, b: &mut [f64]) {
        let (team, factor) = (&*self.team, &self.factor);
        if team.comm.size() == 1 {
            factor.solve(b);
            return;
        }
        let mut y = factor.in_order(b);
        let top = || (0..).zip(&team.rows).filter(|r| *r.1 == Whose::Top);
        let begin: Vec<f64> = top().map(|(p, _)| std::mem::take(&mut y[p])).collect();
        factor.lower_of(team.fronts(&team.own), &mut y);
        let mut left: Vec<f64> = top().map(|(p, _)| y[p]).collect();
        sum_all(&team.comm, &mut left);
        for ((p, _), (begin, left)) in top().zip(begin.iter().zip(&left)) {
            y[p] = begin + left;
        }
        factor.lower_of(team.fronts(&team.top), &mut y);
        factor.upper_of(team.fronts(&team.top).rev(), &mut y);
        factor.upper_of(team.fronts(&team.own).rev(), &mut y);
        for (y, whose) in y.iter_mut().zip(&team.rows) {
            *y = if self.speaks(*whose) { *y } else { 0.0 };
        }
        sum_all(&team.comm, &mut y);
        factor.by_dof(&y, b);
    }

    /// Whether this rank tells the others about such rows.
    fn speaks(&self, whose: Whose) -> bool {
        whose == Whose::Own || (whose == Whose::Top && self.team.comm.rank() == 0)
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
            if team.rows[position(dof)] == Whose::Other {
                continue;
            }
            let v = self.factor.null_vector(dof, team.fronts(&held).rev());
            for (i, value) in v {
                if self.speaks(team.rows[position(i)]) {
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

#[cfg(test)]
#[path = "../../tests/inside/cholesky/shared.rs"]
mod tests;
