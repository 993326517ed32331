//! (GᵀQG)⁻¹ by a solver of the user's choice: a PETSc KSP over all ranks, which own the columns in equal parts.
//!
//! A factorisation solves to rounding. Everything else, such as CG with multigrid, is the preconditioner of FGMRES,
//! which iterates to [`EXACT`]: floating bodies cannot carry forces that are not balanced, so that P has to be a
//! projector to rounding whatever solves. The matrix has a near-null space, the motions in which all bodies move as
//! one; multigrid that aggregates the bodies then treats groups of bodies as bodies (docs/theory.md, section 6).

use std::cell::Cell;
use std::ops::Range;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::coarse_solver::{CoarseSolver, CoarseSolves, InverseSide};
use super::column_map::ColumnMap;
use super::pattern::BlockPattern;
use super::refined::probe;
use super::rows::KernelRows;
use super::scaled_ksp::direct;
use crate::{Error, Result};
use base::linalg::csr::Csr;
use base::linalg::sorted::distinct;
use parallel::clock::{self, Phase};
use parallel::exchange::sum_all;
use parallel::halo::Halo;
use petsc::{Comm, Ksp, Mat, MatFlag, PetscInt, Session, ShellPc, Vec as PetscVec};

/// Largest residual of a solution, relative to the right-hand side, both in the scaled matrix. A factorisation that is
/// worse is iterated upon as well.
pub const EXACT: f64 = 1e-13;

/// Largest number of iterations around a solver that is no factorisation.
const ITERATIONS: PetscInt = 1000;

/// The scaled matrix D⁻¹ GᵀQG D⁻¹, D² its diagonal, and its solver.
pub struct Distributed {
    session: Session,
    /// The user's solver.
    ksp: Ksp,
    /// FGMRES around it.
    around: Option<Ksp>,
    /// Whether the transposed matrix is another one.
    unsymmetric: bool,
    matrix: Mat,
    /// Columns that this rank owns, and 1/D there.
    own: Range<usize>,
    scale: Vec<f64>,
    /// Columns with entries in this rank's rows, increasing, and the way to their owners.
    needed: Vec<u32>,
    halo: Halo,
    rhs: PetscVec,
    solution: PetscVec,
    /// The relative error of a vector after multiplication with the matrix and its inverse.
    defect: f64,
    solves: Cell<usize>,
    iterations: Cell<usize>,
}

/// The user's solver as a preconditioner.
struct InnerSolver(Ksp);

impl ShellPc for InnerSolver {
    fn apply(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        // It need not converge, only help.
        self.0.solve(x, y)
    }

    fn apply_transpose(&self, x: &PetscVec, y: &PetscVec) -> Result<()> {
        self.0.solve_transpose(x, y)
    }
}

impl Distributed {
    /// The solver for the sum over the ranks of `here`, which has this pattern; `rows` are G and QG, `dropped` the
    /// columns that G leaves out, and `unsymmetric` says whether rounding makes the matrix so. `motions` gives the
    /// columns of the near-null space, laid out like a vector of columns, from that and the columns of this rank.
    /// Collective.
    pub fn new(
        session: &Session,
        (pattern, here): (&BlockPattern, &Csr),
        rows: [&KernelRows; 2],
        (dropped, unsymmetric): (&[u32], bool),
        prefix: &str,
        motions: impl FnOnce(&PetscVec, &Range<usize>) -> Result<Vec<PetscVec>>,
    ) -> Result<Distributed> {
        let comm = session.comm();
        let (size, rank) = (comm.size() as usize, comm.rank() as usize);
        // Bodies stay whole, so that their columns are blocks.
        let first = |rank: usize| {
            let body = rank * pattern.n_bodies() / size;
            pattern.start_of(body)
        };
        let own = first(rank)..first(rank + 1);
        let needed = distinct(rows.iter().flat_map(|r| r.columns().iter().copied()));
        let solution = PetscVec::mpi(session, own.len())?;
        let rhs = solution.duplicate()?;
        let halo = Halo::new(session, &rhs, &needed)?;
        let mut of_needed: Vec<f64> = (needed.iter())
            .map(|&c| here.get(c as usize, c as usize))
            .collect();
        halo.sum(&of_needed, &rhs)?;
        let inverse_root = |d: &f64| if *d > 0.0 { 1.0 / d.sqrt() } else { 1.0 };
        let scale: Vec<f64> = rhs.array()?.iter().map(inverse_root).collect();
        rhs.array_mut()?.copy_from_slice(&scale);
        halo.fetch(&rhs, &mut of_needed)?;
        let scale_of = |c: u32| {
            let at = needed.binary_search(&c);
            of_needed[at.expect("entries are in columns of rows")]
        };
        let mut triplets: Vec<(PetscInt, PetscInt, f64)> = Vec::new();
        for &i in &needed {
            let (col, val) = here.row(i as usize);
            let entries = col.iter().zip(val).filter(|e| *e.1 != 0.0);
            let left = scale_of(i);
            triplets.extend(
                entries.map(|(&j, v)| (i as PetscInt, j as PetscInt, v * left * scale_of(j))),
            );
        }
        for c in own.clone() {
            // One column of each motion that nothing holds is held, which does not change the solution for right-hand
            // sides in the range of the matrix.
            let held = dropped.binary_search(&(c as u32)).is_ok();
            triplets.push((c as PetscInt, c as PetscInt, f64::from(u8::from(held))));
        }
        let matrix = Mat::from_triplets(session, Comm::World, own.len(), own.len(), &triplets)?;
        matrix.set_flag(MatFlag::Symmetric)?;
        matrix.set_near_null_space(false, &scaled(motions(&rhs, &own)?, &scale)?)?;
        let ksp = direct(session, Comm::World, &matrix, prefix)?;
        let mut new = Distributed {
            session: session.clone(),
            ksp,
            around: None,
            unsymmetric,
            matrix,
            own,
            scale,
            needed,
            halo,
            rhs,
            solution,
            defect: f64::INFINITY,
            solves: Cell::new(0),
            iterations: Cell::new(0),
        };
        let (residual, defect) = new.tried()?;
        new.defect = defect;
        // Not every solver has a transpose.
        let transposed = !unsymmetric || session.agree(new.apply(InverseSide::Transposed)).is_ok();
        if !transposed {
            // The failed solve has left its right-hand side locked.
            new.rhs = new.rhs.duplicate()?;
        }
        let exact = new.ksp.type_name()? == "preonly" && residual <= EXACT;
        if !exact || !transposed {
            let around = Ksp::new(session, Comm::World)?;
            around.set_operators(&new.matrix, &new.matrix)?;
            around.set_type("fgmres")?;
            around.set_tolerances(Some(EXACT), Some(0.0), None, Some(ITERATIONS))?;
            let inner = InnerSolver(new.ksp.clone());
            around
                .pc()?
                .set_shell("the solver that was chosen", Box::new(inner))?;
            session.agree(around.setup())?;
            new.around = Some(around);
            new.defect = new.tried()?.1;
        }
        new.solves.set(0);
        new.iterations.set(0);
        Ok(new)
    }

    /// KSP and PC that the user has chosen.
    fn name(&self) -> Result<String> {
        let pc = self.ksp.pc()?;
        Ok(format!(
            "{} with {}",
            self.ksp.type_name()?,
            pc.type_name()?
        ))
    }

    /// Solves for a known vector: the residual relative to the right-hand side, and the error relative to the vector.
    fn tried(&self) -> Result<(f64, f64)> {
        let x = self.rhs.duplicate()?;
        let entries = self.own.clone().map(probe);
        x.array_mut()?
            .iter_mut()
            .zip(entries)
            .for_each(|(x, v)| *x = v);
        self.matrix.mult(&x, &self.rhs)?;
        let b = self.rhs.norm2()?;
        self.apply(InverseSide::Plain)?;
        let rest = x.duplicate()?;
        self.matrix.mult(&self.solution, &rest)?;
        rest.axpy(-1.0, &self.rhs)?;
        self.solution.axpy(-1.0, &x)?;
        Ok((rest.norm2()? / b, self.solution.norm_inf()? / x.norm_inf()?))
    }

    /// solution ← A⁻¹ rhs for the scaled matrix.
    fn apply(&self, side: InverseSide) -> Result<()> {
        self.solves.set(self.solves.get() + 1);
        let reason = match (&self.around, side) {
            // Rounding apart the matrix is symmetric, and preconditioners need not have a transpose.
            (Some(around), _) => {
                around.solve(&self.rhs, &self.solution)?;
                self.iterations
                    .set(self.iterations.get() + around.iterations()?);
                around.converged_reason()?
            }
            (None, InverseSide::Transposed) if self.unsymmetric => {
                return self.ksp.solve_transpose(&self.rhs, &self.solution);
            }
            (None, _) => return self.ksp.solve(&self.rhs, &self.solution),
        };
        if reason.code < 0 {
            return Err(Error::not_converged(format!(
                "the natural coarse problem was not solved to {EXACT:.0e} ({}): change the -fetifeti_gtg_ options",
                reason.name
            )));
        }
        Ok(())
    }

    fn scale(&self, v: &PetscVec) -> Result<()> {
        let mut v = v.array_mut()?;
        v.iter_mut().zip(&self.scale).for_each(|(v, s)| *v *= s);
        Ok(())
    }
}

impl CoarseSolver for Distributed {
    fn solve(&self, x: &mut [f64], side: InverseSide) -> Result<()> {
        // Every rank knows all columns here.
        self.rhs.array_mut()?.copy_from_slice(&x[self.own.clone()]);
        self.scale(&self.rhs)?;
        self.apply(side)?;
        self.scale(&self.solution)?;
        x.fill(0.0);
        x[self.own.clone()].copy_from_slice(&self.solution.array()?);
        sum_all(self.session.comm(), x);
        Ok(())
    }

    fn defect(&self) -> Result<f64> {
        Ok(self.defect)
    }

    fn describe(&self) -> Result<String> {
        let around = if self.around.is_some() {
            "FGMRES around "
        } else {
            ""
        };
        Ok(format!("G^T Q G by {around}{}", self.name()?))
    }

    fn ksp(&self) -> Option<&Ksp> {
        Some(&self.ksp)
    }

    fn work(&self) -> Result<Option<CoarseSolves>> {
        Ok(Some(CoarseSolves {
            solver: self.name()?,
            iterated: self.around.is_some(),
            solves: self.solves.get(),
            iterations: self.iterations.get(),
        }))
    }

    /// Columns go to their owners only, and back.
    fn remove(
        &self,
        _: (&SimpleCommunicator, &ColumnMap),
        x: &PetscVec,
        [from, along]: [&KernelRows; 2],
        c: &mut [f64],
        side: InverseSide,
    ) -> Result<()> {
        self.needed.iter().for_each(|&k| c[k as usize] = 0.0);
        from.add_transpose(&x.array()?, c);
        let mut ghosts: Vec<f64> = self.needed.iter().map(|&k| c[k as usize]).collect();
        self.halo.sum(&ghosts, &self.rhs)?;
        clock::timed(Phase::Natural, || {
            self.scale(&self.rhs)?;
            self.apply(side)?;
            self.scale(&self.solution)
        })?;
        self.halo.fetch(&self.solution, &mut ghosts)?;
        let of_needed = self.needed.iter().zip(&ghosts);
        of_needed.for_each(|(&k, v)| c[k as usize] = *v);
        along.add(-1.0, c, &mut x.array_mut()?);
        Ok(())
    }
}

/// The motions in terms of the scaled matrix, orthonormal; motions that depend on others are left out.
fn scaled(motions: Vec<PetscVec>, scale: &[f64]) -> Result<Vec<PetscVec>> {
    let mut out: Vec<PetscVec> = Vec::new();
    for motion in motions {
        for (v, s) in motion.array_mut()?.iter_mut().zip(scale) {
            *v /= s;
        }
        let before = motion.norm2()?;
        for _ in 0..2 {
            for known in &out {
                motion.axpy(-motion.dot(known)?, known)?;
            }
        }
        let left = motion.norm2()?;
        if left > 1e-8 * before {
            motion.scale(1.0 / left)?;
            out.push(motion);
        }
    }
    Ok(out)
}
