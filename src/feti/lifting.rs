//! Z_c: coarse functions of the bodies that vanish where bodies may touch (method section 5).
//!
//! Columns of Z_c are the columns of Ψ at vertices and averages that subdomains of the body share, their copies averaged inside the body with the scaling weights, set to zero on
//! candidate contact nodes. Removing their span S̃-orthogonally from what B_Dᵀ lifts,
//!
//! ```text
//!     M_C⁻¹ = B_D ( S̃ − Y A⁺ Yᵀ ) B_Dᵀ,      Y = S̃ Z_c,   A = Z_cᵀ S̃ Z_c
//! ```
//!
//! lets a jump on a body's face decay over the whole body instead of over the layer of subdomains beside it. B Z_c = 0 for
//! every active set, so nothing here changes in a contact step.

use std::cell::RefCell;

use mpi::traits::Communicator;

use super::clock::{self, Phase};
use super::coarse_functions::average_copies;
use super::exchange::exchange_words;
use super::halo::Halo;
use super::local::dense::{multiply, Dense};
use super::local::problem::Operator;
use super::local::scaled::Local;
use super::local::semidefinite::Semidefinite;
use super::sharing::Sharing;
use super::stiffness::{Columns, Stiffness, Work};
use crate::petsc::{Session, Vec as PetscVec};
use crate::substructures::Substructures;
use crate::Result;

/// So many subdomains of a body are added up before their sum is sent to the one who factors A.
const GROUP: usize = 32;

/// Z_c of all bodies, with A factored. Columns carry the numbers of the primal dofs they come from.
pub struct Lifting {
    /// Z_c on each local subdomain's interface: n_Γ × its columns.
    pub z: Vec<Dense>,
    /// Y = S Z_c, same shape.
    y: Vec<Dense>,
    /// For each local subdomain, the ghost column behind each of its columns.
    columns: Vec<Vec<u32>>,
    /// Global number of each ghost column.
    ghosts: Vec<u32>,
    halo: Halo,
    /// For each owned body: first owned column and the factor of its block of A.
    bodies: Vec<(usize, Semidefinite)>,
    vector: PetscVec,
    ghost: RefCell<Vec<f64>>,
    /// Rank of A and its order (columns that are not zero), over this rank's bodies.
    pub rank_and_order: (usize, usize),
}

impl Lifting {
    /// Builds Z_c; `None` if no body has a column. Collective.
    pub fn new(
        session: &Session,
        problem: &Substructures,
        sharing: &Sharing,
        stiffness: &Stiffness,
    ) -> Result<Option<Lifting>> {
        let comm = session.comm();
        let space = &stiffness.space;
        let averaged = average_copies(session, problem, sharing, stiffness);

        let mut ghosts: Vec<u32> = averaged.iter().flat_map(|a| a.columns.clone()).collect();
        ghosts.sort_unstable();
        ghosts.dedup();
        let place = |g: &u32| {
            let at = ghosts.binary_search(g);
            at.expect("every column was collected") as u32
        };
        let columns: Vec<Vec<u32>> = averaged
            .iter()
            .map(|a| a.columns.iter().map(place).collect())
            .collect();
        let z: Vec<Dense> = averaged.into_iter().map(|a| a.z).collect();

        // Groups of subdomains of one body, each with its own sum of Z_cᵀ S Z_c.
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (j, sub) in problem.local.iter().enumerate() {
            let group = groups
                .iter_mut()
                .rev()
                .find(|g| problem.local[g[0]].body == sub.body);
            match group.filter(|g| g.len() < GROUP) {
                Some(group) => group.push(j),
                None => groups.push(vec![j]),
            }
        }
        let (locals, zs, places) = (&stiffness.locals, &z, &columns);
        let sums = stiffness
            .team
            .map(groups.len(), |g| Sum::new(locals, zs, places, &groups[g]));
        let mut y = vec![Dense::default(); z.len()];
        let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); comm.size() as usize];
        for (members, mut sum) in groups.iter().zip(sums) {
            for (&j, yj) in members.iter().zip(&mut sum.y) {
                y[j] = std::mem::take(yj);
            }
            let to = space.owner[problem.local[members[0]].body] as usize;
            sum.pack(&ghosts, &mut outgoing[to]);
        }
        let received = exchange_words(comm, outgoing);
        let bodies: Vec<(usize, Semidefinite)> = stiffness.team.map(space.owned.len(), |b| {
            let range = &space.owned[b].range;
            let n = range.len();
            let mut a = Dense::zeros(n, n);
            let first = space.first + range.start;
            received
                .iter()
                .for_each(|words| unpack(words, first, &mut a));
            a.mirror_lower();
            (range.start, Semidefinite::new(&a))
        });
        let rank = bodies.iter().map(|b| b.1.rank()).sum();
        let order = bodies.iter().map(|b| b.1.nonzero()).sum::<usize>();
        let mut total = [order as f64];
        super::exchange::sum_all(comm, &mut total);
        if total[0] == 0.0 {
            return Ok(None);
        }
        let vector = PetscVec::mpi(session, space.n_owned)?;
        let halo = Halo::new(session, &vector, &ghosts)?;
        Ok(Some(Lifting {
            z,
            y,
            columns,
            ghost: RefCell::new(vec![0.0; ghosts.len()]),
            ghosts,
            halo,
            bodies,
            vector,
            rank_and_order: (rank, order),
        }))
    }

    /// y ← Z_c x on local subdomain `j`, x given by global column number.
    pub fn combine(&self, j: usize, x: impl Fn(u32) -> f64, y: &mut [f64]) {
        let columns = self.columns[j].iter();
        let c: Vec<f64> = columns.map(|&g| x(self.ghosts[g as usize])).collect();
        y.fill(0.0);
        self.z[j].add_mul(&c, y);
    }

    /// Sends Yᵀ work.v on its way. Collective.
    pub fn begin(&self, stiffness: &Stiffness, work: &[Work]) -> Result<()> {
        let mut ghost = self.ghost.borrow_mut();
        ghost.fill(0.0);
        let mut local: Vec<Vec<f64>> = self.columns.iter().map(|c| vec![0.0; c.len()]).collect();
        let ys = &self.y;
        stiffness.team.for_each(&mut local, |j, t| {
            ys[j].add_mul_transpose(&work[j].v, t); /*    t ← Yᵀ v        */
        });
        for (t, places) in local.iter().zip(&self.columns) {
            for (&g, v) in places.iter().zip(t) {
                ghost[g as usize] += v;
            }
        }
        self.halo.sum_begin(&ghost, &self.vector)
    }

    /// work.y ← work.y − Y A⁺ Yᵀ work.v, after [`begin`](Self::begin). Collective.
    pub fn finish(&self, stiffness: &Stiffness, work: &mut [Work]) -> Result<()> {
        let mut ghost = self.ghost.borrow_mut();
        let (ys, columns) = (&self.y, &self.columns);
        self.halo.sum_end(&self.vector)?;
        {
            let mut owned = self.vector.array_mut()?;
            clock::timed(Phase::Lifting, || {
                for (start, factor) in &self.bodies {
                    let n = factor.order();
                    factor.solve(&mut owned[*start..start + n]); /*  c ← A⁺ t        */
                }
            });
        }
        self.halo.fetch(&self.vector, &mut ghost)?;
        let ghost = &*ghost;
        stiffness.team.for_each(work, |j, w| {
            let c: Vec<f64> = columns[j].iter().map(|&g| -ghost[g as usize]).collect();
            ys[j].add_mul(&c, &mut w.y); /*               y ← y − Y c     */
        });
        Ok(())
    }

    /// The same for several columns of every local subdomain, y ← y − Y A⁺ Yᵀ v. Collective.
    pub fn remove_many(&self, stiffness: &Stiffness, blocks: &mut [Columns]) -> Result<()> {
        let n = blocks.first().map_or(0, |b| b.v.cols);
        let (inputs, ys, columns) = (&*blocks, &self.y, &self.columns);
        let products = stiffness.team.map(blocks.len(), |j| {
            let mut t = Dense::zeros(ys[j].cols, n);
            ys[j].add_mul_transpose_columns(&inputs[j].v, &mut t); /*  t ← Yᵀ v        */
            t
        });
        let ghosts = self.ghosts.len();
        let mut all = Dense::zeros(ghosts, n);
        for (t, places) in products.iter().zip(columns) {
            for c in 0..n {
                let column = all.col_mut(c);
                for (&g, v) in places.iter().zip(t.col(c)) {
                    column[g as usize] += v;
                }
            }
        }
        for c in 0..n {
            self.halo.sum(all.col(c), &self.vector)?;
            {
                let mut owned = self.vector.array_mut()?;
                for (start, factor) in &self.bodies {
                    let part = &mut owned[*start..start + factor.order()];
                    if part.iter().any(|t| *t != 0.0) {
                        factor.solve(part); /*                         c ← A⁺ t        */
                    }
                }
            }
            self.halo.fetch(&self.vector, all.col_mut(c))?;
        }
        let all = &all;
        stiffness.team.for_each(blocks, |j, b| {
            let mut x = Dense::zeros(columns[j].len(), n);
            for c in 0..n {
                for (x, &g) in x.col_mut(c).iter_mut().zip(&columns[j]) {
                    *x = -all.get(g as usize, c);
                }
            }
            ys[j].add_mul_columns(&x, &mut b.y); /*                    y ← y − Y c     */
        });
        Ok(())
    }
}

/// Z_cᵀ S Z_c of some subdomains of a body.
struct Sum {
    /// Ghost columns, increasing.
    columns: Vec<u32>,
    /// Its lower triangle counts.
    a: Dense,
    /// S Z_c of each subdomain.
    y: Vec<Dense>,
}

impl Sum {
    fn new(locals: &[Local], z: &[Dense], columns: &[Vec<u32>], members: &[usize]) -> Sum {
        let mut all: Vec<u32> = members.iter().flat_map(|&j| columns[j].clone()).collect();
        all.sort_unstable();
        all.dedup();
        let mut sum = Sum {
            a: Dense::zeros(all.len(), all.len()),
            columns: all,
            y: Vec::new(),
        };
        for &j in members {
            let mut y = Dense::zeros(z[j].rows, z[j].cols);
            locals[j].apply(Operator::S, &z[j], &mut y);
            let mut a = Dense::zeros(z[j].cols, z[j].cols);
            multiply(a.view_mut(), false, 1.0, z[j].view().transpose(), y.view());
            let place = |g: &u32| sum.columns.binary_search(g).expect("it was collected");
            let at: Vec<usize> = columns[j].iter().map(place).collect();
            // Columns are in the same order here and there: lower triangles go into lower triangles.
            for (q, &to) in at.iter().enumerate() {
                let target = sum.a.col_mut(to);
                for (&i, v) in at[q..].iter().zip(&a.col(q)[q..]) {
                    target[i] += v;
                }
            }
            sum.y.push(y);
        }
        sum
    }

    /// [n, global columns, lower triangle by columns].
    fn pack(&self, ghosts: &[u32], words: &mut Vec<u64>) {
        let n = self.columns.len();
        words.push(n as u64);
        words.extend(self.columns.iter().map(|&g| u64::from(ghosts[g as usize])));
        for q in 0..n {
            words.extend(self.a.col(q)[q..].iter().map(|v| v.to_bits()));
        }
    }
}

/// Adds what [`Sum::pack`] has written for the body whose columns begin at global number `first`; that of other bodies is passed over.
fn unpack(mut words: &[u64], first: usize, a: &mut Dense) {
    while let [n, tail @ ..] = words {
        let n = *n as usize;
        let (columns, tail) = tail.split_at(n);
        let (mut values, tail) = tail.split_at(n * (n + 1) / 2);
        words = tail;
        // All columns are of one body.
        if n == 0 || !(first..first + a.rows).contains(&(columns[0] as usize)) {
            continue;
        }
        let at: Vec<usize> = columns.iter().map(|&c| c as usize - first).collect();
        for (q, &to) in at.iter().enumerate() {
            let (column, rest) = values.split_at(n - q);
            values = rest;
            let target = a.col_mut(to);
            for (&i, &v) in at[q..].iter().zip(column) {
                target[i] += f64::from_bits(v);
            }
        }
    }
}
