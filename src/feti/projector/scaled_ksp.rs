//! (GᵀQG)⁻¹ by PETSc on each rank alone: an LU factorisation, for few columns and for weights that no symmetric factor
//! stands.

use std::rc::Rc;

use super::coarse_solver::{CoarseSolver, InverseSide};
use super::column_map::ColumnMap;
use super::gram::{scale_to_unit_diagonal, Gram};
use super::refined::probe;
use crate::{Error, Result};
use base::linalg::csr::Csr;
use petsc::{Comm, Ksp, Mat, PetscInt, Session, Vec as PetscVec};

/// (Gᵀ Q G)⁻¹ as D⁻¹ (D⁻¹ Gᵀ Q G D⁻¹)⁻¹ D⁻¹; D² is the diagonal of Gᵀ Q G. The scaling is needed with Q = M⁻¹: the rows
/// of stiff and soft bodies differ by the square of the jump in ρ.
pub struct ScaledKsp {
    session: Session,
    known: Rc<ColumnMap>,
    /// The solver, on this rank alone.
    ksp: Ksp,
    /// 1/D.
    scale: Vec<f64>,
    rhs: PetscVec,
    solution: PetscVec,
    /// The matrix, scaled.
    matrix: Mat,
}

/// PETSc's solver for GᵀQG: an LU factorisation, if options with this prefix do not choose another one. Collective.
pub(super) fn direct(session: &Session, comm: Comm, matrix: &Mat, prefix: &str) -> Result<Ksp> {
    let ksp = Ksp::new(session, comm)?;
    ksp.set_operators(matrix, matrix)?;
    ksp.set_options_prefix(prefix)?;
    ksp.set_type("preonly")?;
    // With Q = M⁻¹ and extreme jumps, Q G carries rounding that makes Gᵀ Q G unsymmetric. P is a projection all the
    // same if this very matrix is inverted. That is why it is factored by LU and Pᵀ uses the transpose.
    ksp.pc()?.set_type("lu")?;
    // G alone has decided what is held. With Q = M⁻¹ pivots are as small as the square of a jump.
    ksp.pc()?.set_zero_pivot(f64::MIN_POSITIVE)?;
    ksp.set_from_options()?;
    // Matrices of this rank alone are equal on all ranks, but their machines need not be.
    session.agree(ksp.setup())?;
    Ok(ksp)
}

impl ScaledKsp {
    /// Factors the whole matrix `a`, GᵀQG; `gram` says what the rows hold. Collective.
    pub fn new(session: &Session, gram: &Gram, mut a: Csr, prefix: &str) -> Result<ScaledKsp> {
        let r = a.n();
        let scale = scale_to_unit_diagonal(&mut a);
        // G alone decides which bodies are held: with Q = M⁻¹ two stiff bodies that soft ones hold would look unheld.
        // One dependent column of each unheld motion is held. This makes the matrix regular and does not change the
        // solution for right-hand sides in its range.
        // So is a column of which nothing but rounding was left.
        let nothing: Vec<bool> = a.diagonal().iter().map(|d| *d == 0.0).collect();
        let held = |i: usize, j: u32| {
            i == j as usize && (nothing[i] || gram.dropped.binary_search(&j).is_ok())
        };
        let mut triplets: Vec<(PetscInt, PetscInt, f64)> = Vec::with_capacity(a.nnz());
        for i in 0..r {
            let (col, val) = a.row(i);
            for (&j, &v) in col.iter().zip(val) {
                let v = if held(i, j) { v + 1.0 } else { v };
                if v != 0.0 || i == j as usize {
                    triplets.push((i as PetscInt, j as PetscInt, v));
                }
            }
        }
        let matrix = Mat::from_triplets(session, Comm::Own, r, r, &triplets)?;
        let ksp = direct(session, Comm::Own, &matrix, prefix)?;
        Ok(ScaledKsp {
            session: session.clone(),
            known: gram.known().clone(),
            ksp,
            scale,
            rhs: PetscVec::seq(session, r)?,
            solution: PetscVec::seq(session, r)?,
            matrix,
        })
    }
}

impl CoarseSolver for ScaledKsp {
    fn solve(&self, x: &mut [f64], side: InverseSide) -> Result<()> {
        let mut whole = self.known.whole(self.session.comm(), x);
        let scale = |x: &mut [f64]| x.iter_mut().zip(&self.scale).for_each(|(x, s)| *x *= s);
        scale(&mut whole);
        self.rhs.array_mut()?.copy_from_slice(&whole);
        match side {
            InverseSide::Plain => self.ksp.solve(&self.rhs, &self.solution)?,
            InverseSide::Transposed => self.ksp.solve_transpose(&self.rhs, &self.solution)?,
        }
        let reason = self.ksp.converged_reason()?;
        if reason.code < 0 {
            return Err(Error::not_converged(format!(
                "the natural coarse problem was not solved ({}): change the -fetifeti_gtg_ options",
                reason.name
            )));
        }
        whole.copy_from_slice(&self.solution.array()?);
        scale(&mut whole);
        x.copy_from_slice(&self.known.part_of(&whole));
        Ok(())
    }

    fn defect(&self) -> Result<f64> {
        let x = self.rhs.duplicate()?;
        x.array_mut()?
            .iter_mut()
            .enumerate()
            .for_each(|(i, x)| *x = probe(i));
        self.matrix.mult(&x, &self.rhs)?;
        self.ksp.solve(&self.rhs, &self.solution)?;
        self.solution.axpy(-1.0, &x)?;
        Ok(self.solution.norm_inf()? / x.norm_inf()?)
    }

    fn describe(&self) -> Result<String> {
        Ok("G^T Q G by PETSc".into())
    }

    fn ksp(&self) -> Option<&Ksp> {
        Some(&self.ksp)
    }
}
