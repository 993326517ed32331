//! The factor of a semidefinite matrix that several ranks share.
//!
//! A rank eliminates its fronts and stores their panels. What a front leaves to its parent goes to the rank that has
//! that, and so does what a solve leaves to the rows below it; the solution comes back the same way. So a solve takes
//! as many messages, one after the other, as the tree has levels above the subtrees of a rank, up and down.

use std::cell::RefCell;
use std::rc::Rc;

use mpi::traits::Communicator;

use super::multifrontal::{Elimination, PartialCholesky, Pivots};
use super::team::FactorTeam;
use base::linalg::csr::Csr;
use bytemuck::{Pod, Zeroable};
use parallel::clock::{self, Phase};
use parallel::exchange::{gather_all, sum_all};
use parallel::post::{posting, received, received_any, Address};

/// The factor of a semidefinite matrix, shared by a team.
pub struct SharedCholesky {
    team: Rc<FactorTeam>,
    /// The panels that this rank has.
    factor: PartialCholesky,
    /// A number for every row of the pattern; those of this rank and its ghosts are in use.
    work: RefCell<Vec<f64>>,
}

/// An entry of a null vector, by the number of the vector.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct NullEntry {
    vector: u32,
    dof: u32,
    value: f64,
}

impl SharedCholesky {
    /// The factor of `k`, of which a rank needs the rows that it has, and the dofs that it leaves out
    /// ([`semidefinite`](PartialCholesky::semidefinite)), by their numbers among those of all ranks, which increase.
    /// Collective.
    pub fn semidefinite(k: &Csr, team: Rc<FactorTeam>, least: f64) -> (SharedCholesky, Vec<u32>) {
        let (comm, symbolic) = (&team.comm, &*team.symbolic);
        let rows_below = |f: usize| symbolic.fronts[f].below.len();
        let mut elimination = Elimination::new(k, symbolic, symbolic);
        let mut weak: Vec<u32> = Vec::new();
        posting(comm, team.messages().0, |post| {
            let mut pivots = Pivots::Above(least, &mut weak);
            for run in &team.runs {
                for &(child, from) in &run.children {
                    let n = rows_below(child);
                    elimination.put_schur_complement(child, received(comm, from, n * (n + 1) / 2));
                }
                for &f in &team.own[run.fronts.clone()] {
                    let done = elimination.front(f, &mut pivots, &mut || post.progress());
                    done.expect("no pivot is too small");
                    post.progress();
                }
                if let Some(to) = run.parent {
                    post.send(to, elimination.take_schur_complement(team.last(run)));
                }
            }
        });
        let weak: Vec<u32> = weak.iter().map(|&d| team.name(d)).collect();
        let mut left = gather_all(comm, &weak).concat();
        left.sort_unstable();
        let factor = PartialCholesky {
            symbolic: team.symbolic.clone(),
            panels: elimination.panels,
            weakest: elimination.weakest,
        };
        let work = vec![0.0; team.symbolic.n()].into();
        (SharedCholesky { team, factor, work }, left)
    }

    /// b ← A⁺ b, the same on every rank: zero at the dofs that are left out, after rounding. Collective.
    ///
    /// # Panics
    /// If the team is narrowed: then no rank has such vectors.
    pub fn solve(&self, b: &mut [f64]) {
        let (team, factor) = (&*self.team, &self.factor);
        assert!(!team.is_narrow(), "every rank has all dofs");
        if team.comm.size() == 1 {
            factor.solve(b);
            return;
        }
        let mut y = factor.in_order(b);
        let others = |y: &mut [f64]| {
            let rows = y.iter_mut().enumerate().filter(|r| !team.has_row(r.0));
            rows.for_each(|(_, y)| *y = 0.0);
        };
        others(&mut y);
        self.up_and_down(&mut y);
        others(&mut y);
        sum_all(&team.comm, &mut y);
        factor.by_dof(&y, b);
    }

    /// x ← A⁺ b for a vector b that no rank has whole: the sum over the ranks of what they have here, of the rows of
    /// this rank and of its ghosts ([`FactorTeam::dofs`]). On return x has the solution there. Collective.
    pub fn solve_shares(&self, x: &mut [f64]) {
        let team = &*self.team;
        let mut y = self.work.borrow_mut();
        let rows = || team.own_rows.iter().chain(&team.ghost_rows);
        rows().zip(&*x).for_each(|(&p, x)| y[p as usize] = *x);
        self.up_and_down(&mut y);
        rows().zip(x).for_each(|(&p, x)| *x = y[p as usize]);
    }

    /// The solution, in the order of elimination, from the shares of the ranks; rows that are neither this rank's nor
    /// its ghosts are not touched. Collective.
    fn up_and_down(&self, y: &mut [f64]) {
        let (team, factor) = (&*self.team, &self.factor);
        let comm = &team.comm;
        let below = |f: usize| team.symbolic.fronts[f].below.iter().map(|&p| p as usize);
        let arrived = |f: usize, from: Address| {
            let n = team.symbolic.fronts[f].below.len();
            clock::timed(Phase::Exchange, || received(comm, from, n))
        };
        let (up, down) = team.messages();
        posting(comm, up, |post| {
            for run in &team.runs {
                for &(child, from) in &run.children {
                    let values = arrived(child, from);
                    below(child).zip(values).for_each(|(p, v)| y[p] += v);
                }
                clock::timed(Phase::Natural, || {
                    for fronts in team.bundles(run) {
                        factor.lower_of(fronts, y);
                        post.progress();
                    }
                });
                if let Some(to) = run.parent {
                    // What is left to the rows of others goes with the message; they are summed on the way.
                    let mut left = |p: usize| {
                        if team.has_row(p) {
                            0.0
                        } else {
                            std::mem::take(&mut y[p])
                        }
                    };
                    post.send(to, below(team.last(run)).map(&mut left).collect());
                }
            }
        });
        posting(comm, down, |post| {
            for run in team.runs.iter().rev() {
                if let Some(from) = run.parent {
                    let f = team.last(run);
                    let values = arrived(f, from);
                    below(f).zip(values).for_each(|(p, v)| y[p] = v);
                }
                clock::timed(Phase::Natural, || {
                    for fronts in team.bundles(run).rev() {
                        factor.upper_of(fronts.rev(), y);
                        post.progress();
                    }
                });
                for &(child, to) in &run.children {
                    post.send(to, below(child).map(|p| y[p]).collect());
                }
            }
        });
    }

    /// The ranks that share it, and who of them has what.
    pub fn team(&self) -> &FactorTeam {
        &self.team
    }

    /// For each of these dofs, which are left out, the vector D v, A v = 0, with v one there: by increasing dof. Dofs
    /// have their numbers among those of all ranks; `scale` has D for those that have a number here. Collective.
    pub fn null_vectors(&self, dofs: &[u32], scale: &[f64]) -> Vec<Vec<(u32, f64)>> {
        let (team, symbolic) = (&*self.team, &*self.factor.symbolic);
        let name = |p: u32| team.name(symbolic.interior[p as usize]);
        let row = |name: f64| {
            let row = team.dof(name as u32).and_then(|dof| team.row(dof));
            row.expect("a message is about rows below a front")
        };
        let mut mine: Vec<NullEntry> = Vec::new();
        let mut v = vec![0.0; symbolic.n()];
        for (k, &of_all) in dofs.iter().enumerate() {
            let dof = team.dof(of_all);
            if let Some(own) = dof.filter(|&dof| team.has(dof)) {
                v[team.row(own).expect("an own row")] = 1.0;
            }
            // Where it has no row all that is known of v has come in messages.
            let start = dof.and_then(|dof| team.row(dof)).unwrap_or(usize::MAX);
            let mut largest: f64 = 1.0;
            // Messages have the largest entry so far, then dofs and entries.
            posting(&team.comm, team.messages().1, |post| {
                for run in team.runs.iter().rev() {
                    if let Some(from) = run.parent {
                        let values = received_any(&team.comm, from);
                        largest = largest.max(values[0]);
                        for pair in values[1..].chunks_exact(2) {
                            v[row(pair[0])] = pair[1];
                        }
                    }
                    let fronts = team.fronts(run).rev();
                    (self.factor).substitute_null(&mut v, start, &mut largest, fronts);
                    for &(child, to) in &run.children {
                        let rows = symbolic.fronts[child].below.iter();
                        let entries = rows.filter(|&&p| v[p as usize] != 0.0);
                        let pairs = entries.flat_map(|&p| [f64::from(name(p)), v[p as usize]]);
                        post.send(to, std::iter::once(largest).chain(pairs).collect());
                    }
                }
            });
            for &p in &team.own_rows {
                let value = std::mem::take(&mut v[p as usize]);
                if value != 0.0 {
                    mine.push(NullEntry {
                        vector: k as u32,
                        dof: name(p),
                        value: value * scale[symbolic.interior[p as usize] as usize],
                    });
                }
            }
            team.ghost_rows.iter().for_each(|&p| v[p as usize] = 0.0);
        }
        let mut vectors = vec![Vec::new(); dofs.len()];
        for entry in gather_all(&team.comm, &mine).concat() {
            vectors[entry.vector as usize].push((entry.dof, entry.value));
        }
        for v in &mut vectors {
            v.sort_by_key(|e| e.0);
        }
        vectors
    }
}
