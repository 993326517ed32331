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
use std::sync::Arc;

use mpi::traits::Communicator;

use super::clock::{self, Phase};
use super::exchange::{exchange, exchange_words};
use super::halo::Halo;
use super::local::dense::{multiply, Dense};
use super::local::problem::LocalProblem;
use super::local::semidefinite::Semidefinite;
use super::primal::PrimalEntry;
use super::sharing::Sharing;
use super::stiffness::{Columns, Stiffness, Work};
use crate::petsc::{Session, Vec as PetscVec};
use crate::substructures::Substructures;
use crate::Result;

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

        let (locals, zs) = (&stiffness.locals, &z);
        let products = stiffness.team.map(z.len(), |j| {
            let (s, z) = (&locals[j].s, zs);
            let mut y = Dense::zeros(z[j].rows, z[j].cols);
            multiply(y.view_mut(), false, 1.0, s.view(), z[j].view());
            let mut a = Dense::zeros(z[j].cols, z[j].cols);
            multiply(a.view_mut(), false, 1.0, z[j].view().transpose(), y.view());
            (y, a)
        });
        let mut entries: Vec<Vec<PrimalEntry>> = vec![Vec::new(); comm.size() as usize];
        let mut y = Vec::new();
        for (j, (yj, a)) in products.into_iter().enumerate() {
            let to = space.owner[problem.local[j].body] as usize;
            for (q, &gq) in columns[j].iter().enumerate() {
                for (p, &gp) in columns[j].iter().enumerate() {
                    entries[to].push(PrimalEntry {
                        row: ghosts[gp as usize],
                        col: ghosts[gq as usize],
                        value: a.get(p, q),
                    });
                }
            }
            y.push(yj);
        }
        let entries = exchange(comm, &entries).concat();
        let mut bodies = Vec::new();
        let (mut rank, mut order) = (0, 0);
        for body in &space.owned {
            let n = body.range.len();
            let first = space.first + body.range.start;
            let mut a = Dense::zeros(n, n);
            for e in &entries {
                let i = (e.row as usize).wrapping_sub(first);
                if i < n {
                    a.data[i + (e.col as usize - first) * n] += e.value;
                }
            }
            order += (0..n).filter(|&i| a.get(i, i) > 0.0).count();
            let factor = Semidefinite::new(&a);
            rank += factor.rank();
            bodies.push((body.range.start, factor));
        }
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

    /// work.y ← work.y − Y A⁺ Yᵀ work.v. Collective.
    pub fn remove(&self, stiffness: &Stiffness, work: &mut [Work]) -> Result<()> {
        let mut ghost = self.ghost.borrow_mut();
        ghost.fill(0.0);
        let mut local: Vec<Vec<f64>> = self.columns.iter().map(|c| vec![0.0; c.len()]).collect();
        let (inputs, ys, columns) = (&*work, &self.y, &self.columns);
        stiffness.team.for_each(&mut local, |j, t| {
            ys[j].add_mul_transpose(&inputs[j].v, t); /*  t ← Yᵀ v        */
        });
        for (t, places) in local.iter().zip(&self.columns) {
            for (&g, v) in places.iter().zip(t) {
                ghost[g as usize] += v;
            }
        }
        self.halo.sum(&ghost, &self.vector)?;
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

/// Z_c on one subdomain with the global numbers of its columns.
struct Averaged {
    z: Dense,
    columns: Vec<u32>,
}

/// (column, value) pairs of one interface dof, a handful in no order.
type SparseRow = Vec<(u32, f64)>;

/// The value in a column, zero at first.
fn value_at(row: &mut SparseRow, column: u32) -> &mut f64 {
    let at = row.iter().position(|(c, _)| *c == column);
    let at = at.unwrap_or_else(|| {
        row.push((column, 0.0));
        row.len() - 1
    });
    &mut row[at].1
}

/// Exchanges rows of Ψ between the copies of every shared dof and averages them.
fn average_copies(
    session: &Session,
    problem: &Substructures,
    sharing: &Sharing,
    stiffness: &Stiffness,
) -> Vec<Averaged> {
    let comm = session.comm();
    let space = &stiffness.space;
    // [subdomain, local dof, n, (column, share of the value) × n] to every holder of a copy
    let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); comm.size() as usize];
    let global = |j: usize, p: usize| space.ghosts[space.of_subdomain[j][p] as usize];
    for (j, sub) in problem.local.iter().enumerate() {
        let local = &stiffness.locals[j];
        let shared = shared_columns(stiffness, j);
        for (i, &dof) in local.interface[..local.n_delta].iter().enumerate() {
            let copies = sharing.shared(sub.dofs[dof as usize]);
            let total: f64 = copies.iter().map(|c| c.weight).sum();
            let Some(own) = copies.iter().find(|c| c.subdomain as usize == sub.index) else {
                continue;
            };
            for to in copies {
                let list = &mut outgoing[sharing.rank_of[to.subdomain as usize] as usize];
                list.extend([
                    u64::from(to.subdomain),
                    u64::from(to.local),
                    shared.len() as u64,
                ]);
                for &p in &shared {
                    let value = own.weight / total * local.psi.get(i, p);
                    list.extend([u64::from(global(j, p)), value.to_bits()]);
                }
            }
        }
    }
    let locals = &stiffness.locals;
    let places: Vec<Vec<(u32, u32)>> = locals
        .iter()
        .map(|local| {
            let mut place: Vec<(u32, u32)> = local.interface.iter().copied().zip(0..).collect();
            place.sort_unstable();
            place
        })
        .collect();
    let empty = |local: &Arc<LocalProblem>| vec![SparseRow::new(); local.n_gamma()];
    let mut rows: Vec<Vec<SparseRow>> = locals.iter().map(empty).collect();
    for words in exchange_words(comm, outgoing) {
        let mut rest = &words[..];
        while let [subdomain, dof, n, tail @ ..] = rest {
            let (pairs, tail) = tail.split_at(2 * *n as usize);
            let j = stiffness.jump.local_index(*subdomain as u32);
            let at = places[j].binary_search_by_key(&(*dof as u32), |p| p.0);
            let at = places[j][at.expect("a shared dof is an interface dof")].1;
            let row = &mut rows[j][at as usize];
            for pair in pairs.chunks_exact(2) {
                *value_at(row, pair[0] as u32) += f64::from_bits(pair[1]);
            }
            rest = tail;
        }
    }
    (0..rows.len())
        .map(|j| {
            let local = &locals[j];
            for p in 0..stiffness.jump.n_shared[j] {
                *value_at(&mut rows[j][local.n_delta + p], global(j, p)) = 1.0;
            }
            gather(&rows[j], &candidates(stiffness, j))
        })
        .collect()
}

/// The primal dofs of local subdomain `j` that it shares: vertices and averages.
fn shared_columns(stiffness: &Stiffness, j: usize) -> Vec<usize> {
    let jump = &stiffness.jump;
    let first = stiffness.locals[j].n_vertices();
    (0..jump.n_shared[j])
        .chain(first..first + jump.averages[j].len())
        .collect()
}

/// Which interface positions of local subdomain `j` may be in contact: those with an entry of B_gl.
fn candidates(stiffness: &Stiffness, j: usize) -> Vec<bool> {
    let columns = &stiffness.jump.columns[j];
    let mut out = vec![false; stiffness.locals[j].n_gamma()];
    for (&row, &at) in columns.row.iter().zip(&columns.at) {
        out[at as usize] |= stiffness.jump.ghost_is_contact[row as usize];
    }
    out
}

fn gather(rows: &[SparseRow], candidate: &[bool]) -> Averaged {
    let live = || {
        rows.iter()
            .zip(candidate)
            .zip(0..)
            .filter(|((_, c), _)| !**c)
    };
    let mut columns: Vec<u32> = live()
        .flat_map(|((row, _), _)| row.iter().map(|(column, _)| *column))
        .collect();
    columns.sort_unstable();
    columns.dedup();
    let mut z = Dense::zeros(rows.len(), columns.len());
    for ((row, _), i) in live() {
        for (column, value) in row {
            let at = columns.binary_search(column);
            z.set(i, at.expect("every column was collected"), *value);
        }
    }
    Averaged { z, columns }
}
