//! The natural coarse problem of the floating bodies and the projector that comes with it.
//!
//! ```text
//!     G = Z B R,   e = Rᵀ g,   P = I − Q G (Gᵀ Q G)⁻¹ Gᵀ,   λ₀ = Q G (Gᵀ Q G)⁻¹ e      [Lee (2.11)]
//! ```
//!
//! Rows of G are sparse (the bodies at that node) and live with the row's owner; Gᵀ Q G is small and solved by every rank
//! (prefix `fetifeti_gtg_`).

use std::cell::RefCell;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::exchange::{exchange, gather_all, sum_all};
use super::local::dense::Dense;
use super::local::semidefinite::Semidefinite;
use super::preconditioner::Preconditioner;
use super::primal::PrimalEntry;
use super::settings::{PcType, ProjectorKind};
use super::stiffness::Stiffness;
use crate::petsc::{Comm, Ksp, Mat, Session, Vec as PetscVec};
use crate::substructures::Substructures;
use crate::{Error, Result};

/// Rows of a matrix with r columns, on the rank that owns them.
#[derive(Debug, Clone, Default)]
struct Rows {
    start: Vec<usize>,
    col: Vec<u32>,
    val: Vec<f64>,
}

impl Rows {
    fn from_triplets(n: usize, mut entries: Vec<(u32, u32, f64)>) -> Rows {
        entries.sort_by_key(|e| (e.0, e.1));
        let mut rows = Rows {
            start: vec![0; n + 1],
            ..Rows::default()
        };
        for group in entries.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let sum: f64 = group.iter().map(|e| e.2).sum();
            if sum != 0.0 {
                rows.start[group[0].0 as usize + 1] += 1;
                rows.col.push(group[0].1);
                rows.val.push(sum);
            }
        }
        for i in 0..n {
            rows.start[i + 1] += rows.start[i];
        }
        rows
    }

    fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.start[i]..self.start[i + 1];
        range.map(|k| (self.col[k] as usize, self.val[k]))
    }

    fn n(&self) -> usize {
        self.start.len() - 1
    }

    /// out ← out + Aᵀ λ, this rank's share.
    fn add_transpose(&self, lambda: &[f64], out: &mut [f64]) {
        for (i, &l) in lambda.iter().enumerate() {
            self.row(i).for_each(|(c, v)| out[c] += v * l);
        }
    }

    /// λ ← λ + α A x.
    fn add(&self, alpha: f64, x: &[f64], lambda: &mut [f64]) {
        for (i, l) in lambda.iter_mut().enumerate() {
            *l += alpha * self.row(i).map(|(c, v)| v * x[c]).sum::<f64>();
        }
    }
}

#[derive(Clone, Copy)]
enum Side {
    Plain,
    Transposed,
}

/// G, Q G and the factored Gᵀ Q G; nothing where no body floats.
pub struct NaturalCoarse {
    /// Number of kernel vectors of all bodies, r.
    pub r: usize,
    /// The weight Q that is in use (never `Auto`).
    pub projector: ProjectorKind,
    /// R on the interface of each local subdomain (n_Γ × defect of its body).
    pub kernels: Vec<Dense>,
    /// First column of R of each local subdomain's body.
    first_column: Vec<usize>,
    g: Rows,
    /// Q G where it differs from G.
    qg: Option<Rows>,
    gtqg: Option<Solver>,
}

/// (Gᵀ Q G)⁻¹ as D⁻¹ (D⁻¹ Gᵀ Q G D⁻¹)⁻¹ D⁻¹ with D² its diagonal: with Q = M⁻¹ the rows of stiff and soft bodies differ by the square
/// of the jump in ρ.
struct Solver {
    ksp: Ksp,
    /// 1/D.
    scale: Vec<f64>,
    rhs: PetscVec,
    solution: PetscVec,
    /// Combinations of kernel vectors that no row sees: rigid motions of bodies that nothing holds.
    unheld: Vec<Vec<f64>>,
    scratch: RefCell<Vec<f64>>,
}

impl NaturalCoarse {
    /// Assembles G and Gᵀ Q G for the active rows. Collective.
    pub fn new(
        session: &Session,
        problem: &Substructures,
        stiffness: &Stiffness,
        preconditioner: &Preconditioner,
        wanted: ProjectorKind,
        prefix: &str,
    ) -> Result<NaturalCoarse> {
        let comm = session.comm();
        let space = &stiffness.space;
        let r = *space
            .kernel_start
            .last()
            .expect("one start per body and the end");
        let local = problem.local.iter().zip(&stiffness.locals).enumerate();
        let kernels: Vec<Dense> = local
            .map(|(j, (sub, local))| space.kernel_on_interface(j, sub.body, local))
            .collect();
        let first_column: Vec<usize> = problem
            .local
            .iter()
            .map(|s| space.kernel_start[s.body])
            .collect();
        let mut natural = NaturalCoarse {
            r,
            projector: ProjectorKind::Identity,
            kernels,
            first_column,
            g: Rows::from_triplets(stiffness.jump.n_owned, Vec::new()),
            qg: None,
            gtqg: None,
        };
        if r == 0 {
            return Ok(natural);
        }
        natural.g = natural.assemble_g(comm, stiffness);
        natural.projector = choose(comm, problem, stiffness, preconditioner, wanted);
        natural.qg = match natural.projector {
            ProjectorKind::Diagonal => Some(natural.superlumped(session, problem, stiffness)?),
            ProjectorKind::Preconditioner => {
                Some(natural.probe(session, stiffness, preconditioner)?)
            }
            _ => None,
        };
        natural.gtqg = Some(natural.factor(session, prefix)?);
        Ok(natural)
    }

    /// G = Z B R; rows of B_loc are left out, kernels are continuous inside a body.
    fn assemble_g(&self, comm: &SimpleCommunicator, stiffness: &Stiffness) -> Rows {
        let jump = &stiffness.jump;
        let starts: Vec<u32> = gather_all(comm, &[jump.first as u64])
            .iter()
            .map(|w| w[0] as u32)
            .collect();
        let mut outgoing: Vec<Vec<PrimalEntry>> = vec![Vec::new(); comm.size() as usize];
        for (j, kernel) in self.kernels.iter().enumerate() {
            let columns = &jump.columns[j];
            for (e, (&ghost, &at)) in columns.row.iter().zip(&columns.at).enumerate() {
                if !jump.ghost_is_contact[ghost as usize] || columns.b[e] == 0.0 {
                    continue;
                }
                let row = jump.ghosts[ghost as usize];
                // The last rank that starts at or before the row: ranks without rows start where the next one does.
                let to = starts.partition_point(|&s| s <= row) - 1;
                for c in 0..kernel.cols {
                    outgoing[to].push(PrimalEntry {
                        row,
                        col: (self.first_column[j] + c) as u32,
                        value: columns.b[e] * kernel.get(at as usize, c),
                    });
                }
            }
        }
        let entries = exchange(comm, &outgoing)
            .concat()
            .iter()
            .map(|e| (e.row - jump.first as u32, e.col, e.value))
            .filter(|e| jump.active[e.0 as usize])
            .collect();
        Rows::from_triplets(jump.n_owned, entries)
    }

    /// Q G with Q = diag(B_D diag(K) B_Dᵀ).
    fn superlumped(
        &self,
        session: &Session,
        problem: &Substructures,
        stiffness: &Stiffness,
    ) -> Result<Rows> {
        let jump = &stiffness.jump;
        let mut ghost = vec![0.0; jump.ghosts.len()];
        for (j, columns) in jump.columns.iter().enumerate() {
            let k = &problem.local[j].k;
            for ((&row, &at), bd) in columns.row.iter().zip(&columns.at).zip(&columns.bd) {
                let dof = stiffness.locals[j].interface[at as usize] as usize;
                ghost[row as usize] += bd * bd * k.get(dof, dof);
            }
        }
        let q = PetscVec::mpi(session, jump.n_owned)?;
        stiffness.dual_halo.sum(&ghost, &q)?;
        let q = q.array()?;
        let mut qg = self.g.clone();
        for i in 0..qg.n() {
            for k in qg.start[i]..qg.start[i + 1] {
                qg.val[k] *= q[i];
            }
        }
        Ok(qg)
    }

    /// M⁻¹ G, one column after the other.
    fn probe(
        &self,
        session: &Session,
        stiffness: &Stiffness,
        preconditioner: &Preconditioner,
    ) -> Result<Rows> {
        let n = stiffness.jump.n_owned;
        let column = PetscVec::mpi(session, n)?;
        let image = column.duplicate()?;
        let mut entries = Vec::new();
        for c in 0..self.r {
            {
                let mut values = column.array_mut()?;
                for (i, v) in values.iter_mut().enumerate() {
                    *v = self.g.row(i).find(|e| e.0 == c).map_or(0.0, |e| e.1);
                }
            }
            preconditioner.apply(stiffness, &column, &image)?;
            let values = image.array()?;
            let rows = values.iter().enumerate().filter(|(_, v)| **v != 0.0);
            entries.extend(rows.map(|(i, &v)| (i as u32, c as u32, v)));
        }
        Ok(Rows::from_triplets(n, entries))
    }

    fn factor(&self, session: &Session, prefix: &str) -> Result<Solver> {
        let r = self.r;
        let qg = self.qg.as_ref().unwrap_or(&self.g);
        let mut a = Dense::zeros(r, r);
        for i in 0..self.g.n() {
            for (p, gp) in self.g.row(i) {
                for (q, gq) in qg.row(i) {
                    a.data[p + q * r] += gp * gq;
                }
            }
        }
        sum_all(session.comm(), &mut a.data);
        let diagonal = |i: usize| match a.get(i, i) {
            d if d > 0.0 => 1.0 / d.sqrt(),
            _ => 1.0,
        };
        let scale: Vec<f64> = (0..r).map(diagonal).collect();
        for j in 0..r {
            for i in 0..r {
                a.set(i, j, a.get(i, j) * scale[i] * scale[j]);
            }
        }
        let factor = Semidefinite::new(&a);
        let unheld: Vec<Vec<f64>> = null_vectors(&a, &factor)
            .into_iter()
            .map(|v| v.iter().zip(&scale).map(|(v, s)| v * s).collect())
            .collect();
        // Holding one dependent column of each unheld motion makes the matrix regular without changing what it does to
        // right-hand sides in its range.
        for i in factor.dropped() {
            a.set(i, i, a.get(i, i) + 1.0);
        }
        let triplets: Vec<(i32, i32, f64)> = (0..r)
            .flat_map(|i| (0..r).map(move |j| (i, j)))
            .map(|(i, j)| (i as i32, j as i32, a.get(i, j)))
            .filter(|&(i, j, v)| v != 0.0 || i == j)
            .collect();
        let matrix = Mat::from_triplets(session, Comm::Own, r, r, &triplets)?;
        let ksp = Ksp::new(session, Comm::Own)?;
        ksp.set_operators(&matrix, &matrix)?;
        ksp.set_options_prefix(prefix)?;
        ksp.set_type("preonly")?;
        // With Q = M⁻¹ and extreme jumps, Q G carries rounding that makes Gᵀ Q G unsymmetric. P is a projection all the same as
        // long as it is this very matrix that is inverted: hence LU, and the transpose for Pᵀ.
        ksp.pc()?.set_type("lu")?;
        ksp.set_from_options()?;
        ksp.setup()?;
        Ok(Solver {
            ksp,
            scale,
            rhs: PetscVec::seq(session, r)?,
            solution: PetscVec::seq(session, r)?,
            unheld,
            scratch: RefCell::new(vec![0.0; r]),
        })
    }

    /// x ← (Gᵀ Q G)⁻¹ x or (Gᵀ Q G)⁻ᵀ x, the same on every rank.
    fn solve(&self, x: &mut [f64], side: Side) -> Result<()> {
        let Some(s) = &self.gtqg else { return Ok(()) };
        x.iter_mut().zip(&s.scale).for_each(|(x, s)| *x *= s);
        s.rhs.array_mut()?.copy_from_slice(x);
        match side {
            Side::Plain => s.ksp.solve(&s.rhs, &s.solution)?,
            Side::Transposed => s.ksp.solve_transpose(&s.rhs, &s.solution)?,
        }
        let reason = s.ksp.converged_reason()?;
        if reason.code < 0 {
            return Err(Error::NotConverged(format!(
                "the natural coarse problem was not solved ({}): change the -fetifeti_gtg_ options",
                reason.name
            )));
        }
        x.copy_from_slice(&s.solution.array()?);
        x.iter_mut().zip(&s.scale).for_each(|(x, s)| *x *= s);
        Ok(())
    }

    /// λ ← P λ. Collective.
    pub fn project(&self, comm: &SimpleCommunicator, lambda: &PetscVec) -> Result<()> {
        let qg = self.qg.as_ref().unwrap_or(&self.g);
        self.remove(comm, lambda, &self.g, qg, Side::Plain) /*  λ − Q G (Gᵀ Q G)⁻¹ Gᵀ λ */
    }

    /// r ← Pᵀ r. Collective.
    pub fn project_transpose(&self, comm: &SimpleCommunicator, residual: &PetscVec) -> Result<()> {
        let qg = self.qg.as_ref().unwrap_or(&self.g);
        self.remove(comm, residual, qg, &self.g, Side::Transposed) /* r − G (Gᵀ Q G)⁻ᵀ (Q G)ᵀ r */
    }

    fn remove(
        &self,
        comm: &SimpleCommunicator,
        x: &PetscVec,
        from: &Rows,
        along: &Rows,
        side: Side,
    ) -> Result<()> {
        let Some(s) = &self.gtqg else { return Ok(()) };
        let mut c = s.scratch.borrow_mut();
        c.fill(0.0);
        from.add_transpose(&x.array()?, &mut c);
        sum_all(comm, &mut c);
        self.solve(&mut c, side)?;
        along.add(-1.0, &c, &mut x.array_mut()?);
        Ok(())
    }

    /// λ₀ = Q G (Gᵀ Q G)⁻¹ e, and an error if e is not in range: a load on a body that nothing holds. Collective.
    pub fn initial(
        &self,
        session: &Session,
        problem: &Substructures,
        stiffness: &Stiffness,
        g: &[Vec<f64>],
        lambda: &PetscVec,
    ) -> Result<()> {
        lambda.set(0.0)?;
        let Some(solver) = &self.gtqg else {
            return Ok(());
        };
        // e = Rᵀ g, and the size of the terms in it
        let mut e = vec![0.0; 2 * self.r];
        for (j, kernel) in self.kernels.iter().enumerate() {
            for c in 0..kernel.cols {
                let products = kernel.col(c).iter().zip(&g[j]).map(|(r, g)| r * g);
                let at = self.first_column[j] + c;
                e[at] += products.clone().sum::<f64>();
                e[self.r + at] += products.map(f64::abs).sum::<f64>();
            }
        }
        sum_all(session.comm(), &mut e);
        let (e, size) = e.split_at_mut(self.r);
        for motion in &solver.unheld {
            let work: f64 = motion.iter().zip(&*e).map(|(m, e)| m * e).sum();
            let scale: f64 = motion.iter().zip(&*size).map(|(m, s)| (m * s).abs()).sum();
            if work.abs() > 1e-10 * scale {
                return Err(not_held(problem, &stiffness.space.kernel_start, motion));
            }
        }
        self.solve(e, Side::Plain)?;
        let qg = self.qg.as_ref().unwrap_or(&self.g);
        qg.add(1.0, e, &mut lambda.array_mut()?);
        Ok(())
    }

    /// α = −(Gᵀ Q G)⁻¹ (Q G)ᵀ jump: the rigid motions that close the jump left by S̃⁺(g − Bᵀ λ). Collective.
    pub fn alpha(&self, comm: &SimpleCommunicator, jump: &PetscVec) -> Result<Vec<f64>> {
        let mut c = vec![0.0; self.r];
        let qg = self.qg.as_ref().unwrap_or(&self.g);
        qg.add_transpose(&jump.array()?, &mut c);
        sum_all(comm, &mut c);
        self.solve(&mut c, Side::Transposed)?;
        c.iter_mut().for_each(|v| *v = -*v);
        Ok(c)
    }

    /// y ← y + R α on local subdomain `j`.
    pub fn add_kernel(&self, j: usize, alpha: &[f64], y: &mut [f64]) {
        let kernel = &self.kernels[j];
        kernel.add_mul(&alpha[self.first_column[j]..][..kernel.cols], y);
    }

    /// Number of rigid motions that no row sees.
    pub fn n_unheld(&self) -> usize {
        self.gtqg.as_ref().map_or(0, |s| s.unheld.len())
    }

    /// The solver of Gᵀ Q G, where a body floats.
    pub fn ksp(&self) -> Option<&Ksp> {
        self.gtqg.as_ref().map(|s| &s.ksp)
    }
}

/// Vectors v with A v = 0, one per dropped column.
fn null_vectors(a: &Dense, factor: &Semidefinite) -> Vec<Vec<f64>> {
    let column = |&k: &usize| {
        let mut v: Vec<f64> = a.col(k).iter().map(|x| -x).collect();
        factor.solve(&mut v);
        v[k] = 1.0;
        v
    };
    factor.dropped().iter().map(column).collect()
}

fn not_held(problem: &Substructures, kernel_start: &[usize], motion: &[f64]) -> Error {
    let largest = motion.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let moves = |b: &usize| {
        let columns = &motion[kernel_start[*b]..kernel_start[*b + 1]];
        columns.iter().any(|c| c.abs() > 1e-8 * largest)
    };
    let names: Vec<String> = (0..problem.n_bodies)
        .filter(moves)
        .map(|b| format!("\"{}\"", problem.body_names[b]))
        .collect();
    let who = match names.len() {
        1 => format!("body {} is", names[0]),
        n if n > 4 => format!("bodies {} and {} more are", names[..3].join(", "), n - 3),
        _ => format!("bodies {} are", names.join(", ")),
    };
    Error::input(format!(
        "{who} held by nothing (no Dirichlet side and no tie to a held body) and the load does not balance, expected a Dirichlet side or a tie"
    ))
}

/// Resolves `Auto`: Q = M⁻¹ where a floating body or a neighbour of one differs in stiffness from the others.
fn choose(
    comm: &SimpleCommunicator,
    problem: &Substructures,
    stiffness: &Stiffness,
    preconditioner: &Preconditioner,
    wanted: ProjectorKind,
) -> ProjectorKind {
    if wanted != ProjectorKind::Auto {
        return match (wanted, preconditioner.kind()) {
            // Q = M⁻¹ of no preconditioner is the identity.
            (ProjectorKind::Preconditioner, PcType::None) => ProjectorKind::Identity,
            _ => wanted,
        };
    }
    // Mean diagonal of S over each body's interface; with Q = I the rows of stiff and soft bodies are weighed alike.
    let n = problem.n_bodies;
    let mut sums = vec![0.0; 2 * n];
    for (sub, local) in problem.local.iter().zip(&stiffness.locals) {
        for &i in &local.interface {
            sums[sub.body] += sub.k.get(i as usize, i as usize);
            sums[n + sub.body] += 1.0;
        }
    }
    sum_all(comm, &mut sums);
    let means = (0..n)
        .filter(|&b| sums[n + b] > 0.0)
        .map(|b| sums[b] / sums[n + b]);
    let (low, high) = means.fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), m| {
        (l.min(m), h.max(m))
    });
    // A factor of two comes from corners and mesh sizes alone.
    match (high > 3.0 * low, preconditioner.kind()) {
        (false, _) => ProjectorKind::Identity,
        (true, PcType::None) => ProjectorKind::Diagonal,
        (true, _) => ProjectorKind::Preconditioner,
    }
}
