//! Gᵀ Q G and its inverse.
//!
//! With Q = I and many rigid motions the factor of GᵀG that tells what the rows hold ([`Gram`]) is the inverse, too.
//! With other Q and many motions it is a factor of its own (`refined`). Ranks share both. The matrix of few motions
//! stands behind an LU factorisation of each rank. If an option with the prefix `fetifeti_gtg_` is set, other than
//! `redundancy`, it stands behind a PETSc KSP over all ranks (`distributed`).

use std::cell::RefCell;
use std::rc::Rc;

use mpi::topology::SimpleCommunicator;

use super::column_map::ColumnMap;
use super::distributed::{CoarseSolves, Distributed};
use super::gram::{scale_to_unit_diagonal, Gram, REGULAR};
use super::gram_pattern::GramPattern;
use super::refined::{probe, RefinedFactor};
use super::rows::KernelRows;
use super::team_factor::TeamFactor;
use crate::feti::settings::ProjectorKind;
use crate::{Error, Result};
use base::linalg::csr::Csr;
use parallel::clock::{self, Phase};
use petsc::{Comm, Ksp, Mat, Options, Session, Vec as PetscVec};

/// The inverse or its transpose.
#[derive(Clone, Copy)]
pub enum InverseSide {
    /// (Gᵀ Q G)⁻¹
    Plain,
    /// (Gᵀ Q G)⁻ᵀ
    Transposed,
}

/// A factor is exact if a vector loses less than this on its way through the matrix and back.
const EXACT: f64 = 1e-11;

/// A solve with it leaves nothing for another one if it loses less than this.
const WHOLE: f64 = 1e-13;

/// The smallest eigenvalue of GᵀG, after scaling to a unit diagonal, with which a solve leaves nothing for another one:
/// rounding is magnified by the inverse.
const STRONG: f64 = 1e-3;

/// (Gᵀ Q G)⁻¹.
pub struct Gtg {
    solver: GtgSolver,
    /// GᵀG of the rows that hold: what they hold.
    pub gram: Rc<Gram>,
    /// The way of distributed vectors to the factor, where ranks share it.
    spread: Option<Rc<TeamFactor>>,
    scratch: RefCell<Vec<f64>>,
}

enum GtgSolver {
    /// The factor of GᵀG, where Q = I.
    Own,
    /// The factor of GᵀQG.
    Weighted(Box<RefinedFactor>),
    /// LU of every rank.
    Petsc(ScaledKsp),
    /// The user's choice.
    Chosen(Box<Distributed>),
}

/// (Gᵀ Q G)⁻¹ as D⁻¹ (D⁻¹ Gᵀ Q G D⁻¹)⁻¹ D⁻¹; D² is the diagonal of Gᵀ Q G. The scaling is needed with Q = M⁻¹: the rows
/// of stiff and soft bodies differ by the square of the jump in ρ.
struct ScaledKsp {
    /// The solver, on this rank alone.
    ksp: Ksp,
    /// 1/D.
    scale: Vec<f64>,
    rhs: PetscVec,
    solution: PetscVec,
    /// The matrix, scaled.
    matrix: Mat,
}

impl Gtg {
    /// The inverse for the rows of `gram` and the weight `q`, not Auto, from G and QG; GᵀQG has the pattern of `shape`.
    /// `chosen` makes a solver of the user's choice. Collective.
    pub fn new(
        session: &Session,
        (shape, gram): (&GramPattern, Rc<Gram>),
        q: ProjectorKind,
        [g, qg]: [&KernelRows; 2],
        prefix: &str,
        chosen: impl FnOnce(&Gram) -> Result<Distributed>,
    ) -> Result<Gtg> {
        let comm = session.comm();
        let petsc = |a: Csr| ScaledKsp::new(session, &gram, a, prefix).map(GtgSolver::Petsc);
        let solver = match q {
            _ if Options::new(session, prefix).any()? => GtgSolver::Chosen(chosen(&gram)?.into()),
            ProjectorKind::Identity if gram.is_sparse() => GtgSolver::Own,
            _ if gram.is_sparse() => {
                let both = shape.product_and_transpose(comm, g, qg);
                match RefinedFactor::weighted(shape, both, &gram) {
                    Ok(factor) => GtgSolver::Weighted(factor.into()),
                    Err(a) => petsc(shape.gathered(comm, a))?,
                }
            }
            _ => petsc(shape.product(comm, g, qg, |_| true))?,
        };
        let n = gram.known().n();
        Ok(Gtg {
            solver,
            gram,
            spread: None,
            scratch: RefCell::new(vec![0.0; n]),
        })
    }

    /// Whether ranks share a factor that solves at once.
    pub fn is_shared(&self) -> bool {
        self.shared().is_some()
    }

    /// Whether a factor of many columns solves to nearly all digits.
    pub fn is_exact(&self) -> bool {
        self.loses_less(REGULAR, EXACT)
    }

    /// Whether another solve with a factor of many columns would not make a solution better.
    pub fn needs_no_second(&self) -> bool {
        self.loses_less(STRONG, WHOLE)
    }

    /// Whether a factor of many columns has no smaller eigenvalue, or no larger defect.
    fn loses_less(&self, eigenvalue: f64, defect: f64) -> bool {
        match &self.solver {
            GtgSolver::Own => self.gram.smallest_eigenvalue() > eigenvalue,
            GtgSolver::Weighted(factor) => factor.plain().is_some() && factor.defect <= defect,
            GtgSolver::Petsc(_) | GtgSolver::Chosen(_) => false,
        }
    }

    /// Vectors go to the shared factor this way from now on.
    pub fn set_spread(&mut self, spread: Option<Rc<TeamFactor>>) {
        self.spread = spread;
    }

    fn shared(&self) -> Option<&Gram> {
        match &self.solver {
            GtgSolver::Own => Some(&self.gram),
            GtgSolver::Weighted(factor) => factor.plain(),
            GtgSolver::Petsc(_) | GtgSolver::Chosen(_) => None,
        }
    }

    /// PETSc's solver, if it is one.
    pub fn ksp(&self) -> Option<&Ksp> {
        match &self.solver {
            GtgSolver::Own | GtgSolver::Weighted(_) => None,
            GtgSolver::Petsc(scaled) => Some(&scaled.ksp),
            GtgSolver::Chosen(chosen) => Some(chosen.ksp()),
        }
    }

    /// How the user's solver works, if there is one.
    pub fn work(&self) -> Result<Option<CoarseSolves>> {
        match &self.solver {
            GtgSolver::Chosen(chosen) => chosen.work().map(Some),
            _ => Ok(None),
        }
    }

    /// The relative error of a vector after multiplication with the scaled matrix and its inverse. It is about the
    /// condition number times rounding, and it is the accuracy that P loses.
    pub fn defect(&self) -> Result<f64> {
        match &self.solver {
            // G alone has no jumps.
            GtgSolver::Own => Ok(0.0),
            GtgSolver::Weighted(factor) => Ok(factor.defect),
            GtgSolver::Petsc(scaled) => scaled.defect(),
            GtgSolver::Chosen(chosen) => Ok(chosen.defect),
        }
    }

    /// x ← (Gᵀ Q G)⁻¹ x or (Gᵀ Q G)⁻ᵀ x for a vector of columns that is the same wherever they are known. Collective.
    pub fn solve(&self, comm: &SimpleCommunicator, x: &mut [f64], side: InverseSide) -> Result<()> {
        match &self.solver {
            GtgSolver::Own => {
                self.gram.solve(x);
                Ok(())
            }
            GtgSolver::Weighted(factor) => {
                factor.solve(x, side);
                Ok(())
            }
            GtgSolver::Petsc(scaled) => {
                let mut whole = self.known().whole(comm, x);
                scaled.solve(&mut whole, side)?;
                x.copy_from_slice(&self.known().part_of(&whole));
                Ok(())
            }
            GtgSolver::Chosen(chosen) => chosen.solve(x, side),
        }
    }

    fn known(&self) -> &ColumnMap {
        self.gram.known()
    }

    /// c ← (Gᵀ Q G)⁻¹ (b + Σ c) (or with the transposed inverse), the sum over the ranks. A rank has the solution in
    /// the columns of its own rows and bodies; other entries are not to be read. `b` is the same wherever columns are
    /// known. Collective.
    pub fn solve_sum(
        &self,
        comm: &SimpleCommunicator,
        c: &mut [f64],
        b: Option<&[f64]>,
        side: InverseSide,
    ) -> Result<()> {
        if let (Some(factor), Some(spread)) = (self.shared(), &self.spread) {
            return spread.solve(factor, c, b);
        }
        self.known().sum(comm, c);
        if let Some(b) = b {
            c.iter_mut().zip(b).for_each(|(c, b)| *c += b);
        }
        self.solve(comm, c, side)
    }

    /// x ← x − along (Gᵀ Q G)⁻¹ fromᵀ x (or with the transposed inverse). Collective.
    pub fn remove(
        &self,
        comm: &SimpleCommunicator,
        x: &PetscVec,
        from: &KernelRows,
        along: &KernelRows,
        side: InverseSide,
    ) -> Result<()> {
        let mut c = self.scratch.borrow_mut();
        if let GtgSolver::Chosen(chosen) = &self.solver {
            return chosen.remove(x, (from, along), &mut c, side);
        }
        if let (Some(factor), Some(spread)) = (self.shared(), &self.spread) {
            return spread.remove(factor, x, from, along);
        }
        c.fill(0.0);
        from.add_transpose(&x.array()?, &mut c);
        clock::timed(Phase::Reduction, || self.known().sum(comm, &mut c));
        clock::timed(Phase::Natural, || self.solve(comm, &mut c, side))?;
        along.add(-1.0, &c, &mut x.array_mut()?);
        Ok(())
    }
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
    fn new(session: &Session, gram: &Gram, mut a: Csr, prefix: &str) -> Result<ScaledKsp> {
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
        let mut triplets: Vec<(i32, i32, f64)> = Vec::with_capacity(a.nnz());
        for i in 0..r {
            let (col, val) = a.row(i);
            for (&j, &v) in col.iter().zip(val) {
                let v = if held(i, j) { v + 1.0 } else { v };
                if v != 0.0 || i == j as usize {
                    triplets.push((i as i32, j as i32, v));
                }
            }
        }
        let matrix = Mat::from_triplets(session, Comm::Own, r, r, &triplets)?;
        let ksp = direct(session, Comm::Own, &matrix, prefix)?;
        Ok(ScaledKsp {
            ksp,
            scale,
            rhs: PetscVec::seq(session, r)?,
            solution: PetscVec::seq(session, r)?,
            matrix,
        })
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

    fn solve(&self, x: &mut [f64], side: InverseSide) -> Result<()> {
        x.iter_mut().zip(&self.scale).for_each(|(x, s)| *x *= s);
        self.rhs.array_mut()?.copy_from_slice(x);
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
        x.copy_from_slice(&self.solution.array()?);
        x.iter_mut().zip(&self.scale).for_each(|(x, s)| *x *= s);
        Ok(())
    }
}
