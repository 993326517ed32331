//! Gᵀ Q G behind a PETSc KSP (prefix `fetifeti_gtg_`), the same on every rank.

use std::cell::RefCell;

use mpi::topology::SimpleCommunicator;

use super::rows::Rows;
use crate::linalg::dense::Dense;
use crate::linalg::semidefinite::Semidefinite;
use crate::parallel::clock::{self, Phase};
use crate::parallel::exchange::sum_all;
use crate::petsc::{Comm, Ksp, Mat, Session, Vec as PetscVec};
use crate::{Error, Result};

/// The inverse or its transpose.
#[derive(Clone, Copy)]
pub enum Side {
    /// (Gᵀ Q G)⁻¹
    Plain,
    /// (Gᵀ Q G)⁻ᵀ
    Transposed,
}

/// (Gᵀ Q G)⁻¹ as D⁻¹ (D⁻¹ Gᵀ Q G D⁻¹)⁻¹ D⁻¹; D² is the diagonal of Gᵀ Q G. The scaling is needed with Q = M⁻¹: the rows
/// of stiff and soft bodies differ by the square of the jump in ρ.
pub struct Gtg {
    /// The solver, on this rank alone.
    pub ksp: Ksp,
    /// 1/D.
    scale: Vec<f64>,
    rhs: PetscVec,
    solution: PetscVec,
    /// Combinations of kernel vectors on which all rows vanish: rigid motions that nothing holds.
    pub unheld: Vec<Vec<f64>>,
    /// The matrix, scaled.
    matrix: Mat,
    scratch: RefCell<Vec<f64>>,
}

impl Gtg {
    /// Assembles and factors the r × r matrix Gᵀ (Q G). Collective.
    pub fn new(session: &Session, r: usize, g: &Rows, qg: &Rows, prefix: &str) -> Result<Gtg> {
        let mut a = g.product(session.comm(), qg, r, |_| true);
        let scale = a.scale_to_unit_diagonal();
        // G alone decides which bodies are held. With Q = M⁻¹ two stiff bodies that soft ones hold would look unheld.
        let gtg = g.product(session.comm(), g, r, |_| true);
        let factor = Semidefinite::new(&gtg);
        // One dependent column of each unheld motion is held. This makes the matrix regular and does not change the
        // solution for right-hand sides in its range.
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
        // With Q = M⁻¹ and extreme jumps, Q G carries rounding that makes Gᵀ Q G unsymmetric. P is a projection all the
        // same if this very matrix is inverted. That is why it is factored by LU and Pᵀ uses the transpose.
        ksp.pc()?.set_type("lu")?;
        // G alone has decided what is held. With Q = M⁻¹ pivots are as small as the square of a jump.
        ksp.pc()?.set_zero_pivot(f64::MIN_POSITIVE)?;
        ksp.set_from_options()?;
        // The matrices of the ranks are equal, but their machines need not be.
        session.agree(ksp.setup())?;
        Ok(Gtg {
            ksp,
            scale,
            rhs: PetscVec::seq(session, r)?,
            solution: PetscVec::seq(session, r)?,
            unheld: null_vectors(&gtg, &factor),
            matrix,
            scratch: RefCell::new(vec![0.0; r]),
        })
    }

    /// The relative error of a vector after multiplication with the scaled matrix and its inverse. It is about the
    /// condition number times rounding, and it is the accuracy that P loses.
    pub fn defect(&self) -> Result<f64> {
        let x = self.rhs.duplicate()?;
        // A test vector that is neither smooth nor orthogonal to anything in particular.
        for (i, x) in x.array_mut()?.iter_mut().enumerate() {
            *x = 1.0 + ((i * 7919) % 13) as f64 / 13.0;
        }
        self.matrix.mult(&x, &self.rhs)?;
        self.ksp.solve(&self.rhs, &self.solution)?;
        self.solution.axpy(-1.0, &x)?;
        Ok(self.solution.norm_inf()? / x.norm_inf()?)
    }

    /// x ← (Gᵀ Q G)⁻¹ x or (Gᵀ Q G)⁻ᵀ x, the same on every rank.
    pub fn solve(&self, x: &mut [f64], side: Side) -> Result<()> {
        x.iter_mut().zip(&self.scale).for_each(|(x, s)| *x *= s);
        self.rhs.array_mut()?.copy_from_slice(x);
        match side {
            Side::Plain => self.ksp.solve(&self.rhs, &self.solution)?,
            Side::Transposed => self.ksp.solve_transpose(&self.rhs, &self.solution)?,
        }
        let reason = self.ksp.converged_reason()?;
        if reason.code < 0 {
            return Err(Error::NotConverged(format!(
                "the natural coarse problem was not solved ({}): change the -fetifeti_gtg_ options",
                reason.name
            )));
        }
        x.copy_from_slice(&self.solution.array()?);
        x.iter_mut().zip(&self.scale).for_each(|(x, s)| *x *= s);
        Ok(())
    }

    /// x ← x − along (Gᵀ Q G)⁻¹ fromᵀ x (or with the transposed inverse). Collective.
    pub fn remove(
        &self,
        comm: &SimpleCommunicator,
        x: &PetscVec,
        from: &Rows,
        along: &Rows,
        side: Side,
    ) -> Result<()> {
        let mut c = self.scratch.borrow_mut();
        c.fill(0.0);
        from.add_transpose(&x.array()?, &mut c);
        clock::timed(Phase::Reduction, || sum_all(comm, &mut c));
        clock::timed(Phase::Natural, || self.solve(&mut c, side))?;
        along.add(-1.0, &c, &mut x.array_mut()?);
        Ok(())
    }
}

/// Vectors v with A v = 0, one per dropped column.
pub fn null_vectors(a: &Dense, factor: &Semidefinite) -> Vec<Vec<f64>> {
    let column = |&k: &usize| {
        let mut v: Vec<f64> = a.col(k).iter().map(|x| -x).collect();
        factor.solve(&mut v);
        v[k] = 1.0;
        v
    };
    factor.dropped().iter().map(column).collect()
}
