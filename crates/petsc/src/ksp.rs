//! Krylov solvers.

use super::error::{c_string, copied, got, refused_option, text};
use super::handle::Handle;
use super::{Comm, Mat, Pc, Session, Vec};
use base::{Error, Result};
use petsc_sys as sys;
use petsc_sys::Flag;
use petsc_sys::PetscInt;

/// The residual norm of the convergence test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NormType {
    /// None: run a fixed number of iterations.
    None,
    /// ‖M⁻¹ r‖.
    Preconditioned,
    /// ‖r‖.
    Unpreconditioned,
    /// √(rᵀ M⁻¹ r).
    Natural,
}

/// Why a solver stopped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConvergedReason {
    /// PETSc's number: positive for convergence, negative for divergence, 0 while iterating.
    pub code: i32,
    /// PETSc's name, such as `CONVERGED_RTOL`.
    pub name: String,
}

impl ConvergedReason {
    /// The relative tolerance was reached.
    pub const RTOL: i32 = sys::KSP_CONVERGED_RTOL;
    /// The absolute tolerance was reached.
    pub const ATOL: i32 = sys::KSP_CONVERGED_ATOL;
    /// The maximum number of iterations was reached.
    pub const ITS: i32 = sys::KSP_DIVERGED_ITS;
    /// The method cannot go on.
    pub const BREAKDOWN: i32 = sys::KSP_DIVERGED_BREAKDOWN;
    /// The preconditioner cannot be used.
    pub const PC_FAILED: i32 = sys::KSP_DIVERGED_PC_FAILED;

    /// The reason of a run that reached its largest number of iterations.
    pub fn its() -> ConvergedReason {
        ConvergedReason {
            code: ConvergedReason::ITS,
            name: "DIVERGED_ITS".into(),
        }
    }

    /// The reason of a run that reached its tolerance.
    pub fn rtol() -> ConvergedReason {
        ConvergedReason {
            code: ConvergedReason::RTOL,
            name: "CONVERGED_RTOL".into(),
        }
    }

    /// Whether the solver converged.
    pub fn converged(&self) -> bool {
        self.code > 0
    }

    /// Whether the solver met numbers that cannot occur in exact arithmetic.
    pub fn broke_down(&self) -> bool {
        [
            sys::KSP_DIVERGED_BREAKDOWN,
            sys::KSP_DIVERGED_INDEFINITE_PC,
            sys::KSP_DIVERGED_INDEFINITE_MAT,
        ]
        .contains(&self.code)
    }
}

/// A linear solver. Clones are handles to the same solver.
pub type Ksp = Handle<sys::_p_KSP>;

impl Ksp {
    /// A solver without operators. Collective.
    pub fn new(session: &Session, comm: Comm) -> Result<Ksp> {
        Ksp::made(session, |raw| {
            petsc!(KSPCreate(session.raw_comm(comm), raw))
        })
    }

    /// The operator of the system and the matrix that the preconditioner is built from.
    pub fn set_operators(&self, a: &Mat, p: &Mat) -> Result<()> {
        petsc!(KSPSetOperators(self.raw(), a.raw(), p.raw()))
    }

    /// The operator of the system.
    pub fn operator(&self) -> Result<Mat> {
        Mat::borrowed(self.session(), |a| {
            petsc!(KSPGetOperators(self.raw(), a, std::ptr::null_mut()))
        })
    }

    /// Sets the type by PETSc's name (`"cg"`, `"preonly"`, `"fetidp"`, …).
    pub fn set_type(&self, name: &str) -> Result<()> {
        petsc!(KSPSetType(self.raw(), c_string(name).as_ptr()))
    }

    /// The type's name; empty if none is set.
    pub fn type_name(&self) -> Result<String> {
        text(|name| petsc!(KSPGetType(self.raw(), name)))
    }

    /// Relative, absolute and divergence tolerance and the maximum number of iterations; `None` keeps the current
    /// value.
    pub fn set_tolerances(
        &self,
        rtol: Option<f64>,
        atol: Option<f64>,
        dtol: Option<f64>,
        max_it: Option<PetscInt>,
    ) -> Result<()> {
        let or = |value: Option<f64>| value.unwrap_or(sys::PETSC_CURRENT as f64);
        petsc!(KSPSetTolerances(
            self.raw(),
            or(rtol),
            or(atol),
            or(dtol),
            max_it.unwrap_or(sys::PETSC_CURRENT)
        ))
    }

    /// The current (rtol, atol, dtol, max_it), options included.
    pub fn tolerances(&self) -> Result<(f64, f64, f64, PetscInt)> {
        let (mut rtol, mut atol, mut dtol, mut max_it) = (0.0, 0.0, 0.0, 0);
        petsc!(KSPGetTolerances(
            self.raw(),
            &mut rtol,
            &mut atol,
            &mut dtol,
            &mut max_it
        ))?;
        Ok((rtol, atol, dtol, max_it))
    }

    /// Calls the monitors with the norm of a residual, for iterations that run outside the solver.
    pub fn monitor(&self, iteration: usize, norm: f64) -> Result<()> {
        petsc!(KSPMonitor(self.raw(), iteration as PetscInt, norm))
    }

    /// Sets the norm of the convergence test.
    pub fn set_norm_type(&self, norm: NormType) -> Result<()> {
        let norm = match norm {
            NormType::None => sys::KSP_NORM_NONE,
            NormType::Preconditioned => sys::KSP_NORM_PRECONDITIONED,
            NormType::Unpreconditioned => sys::KSP_NORM_UNPRECONDITIONED,
            NormType::Natural => sys::KSP_NORM_NATURAL,
        };
        petsc!(KSPSetNormType(self.raw(), norm))
    }

    /// Checks that the method supports the norm of the convergence test.
    ///
    /// # Errors
    /// PETSc's, if it does not.
    pub fn check_norm_type(&self) -> Result<()> {
        let mut norm = sys::KSP_NORM_NONE;
        petsc!(KSPGetNormType(self.raw(), &mut norm))
    }

    /// Stores the data that [`Ksp::eigenvalues`] needs.
    pub fn set_compute_eigenvalues(&self, on: bool) -> Result<()> {
        petsc!(KSPSetComputeEigenvalues(self.raw(), Flag::of(on)))
    }

    /// Stores the data that [`Ksp::extreme_singular_values`] needs.
    pub fn set_compute_singular_values(&self, on: bool) -> Result<()> {
        petsc!(KSPSetComputeSingularValues(self.raw(), Flag::of(on)))
    }

    /// Keeps the preconditioner although the matrix has changed.
    pub fn set_reuse_preconditioner(&self, on: bool) -> Result<()> {
        petsc!(KSPSetReusePreconditioner(self.raw(), Flag::of(on)))
    }

    /// The prefix of this solver's options, without a dash.
    pub fn set_options_prefix(&self, prefix: &str) -> Result<()> {
        petsc!(KSPSetOptionsPrefix(self.raw(), c_string(prefix).as_ptr()))
    }

    /// Appends to the prefix.
    pub fn append_options_prefix(&self, prefix: &str) -> Result<()> {
        petsc!(KSPAppendOptionsPrefix(
            self.raw(),
            c_string(prefix).as_ptr()
        ))
    }

    /// Reads the options of this solver and its preconditioner.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a value that PETSc refuses.
    pub fn set_from_options(&self) -> Result<()> {
        petsc!(KSPSetFromOptions(self.raw())).map_err(|e| {
            let prefix = text(|prefix| petsc!(PetscObjectGetOptionsPrefix(self.object(), prefix)));
            refused_option(e, &prefix.unwrap_or_default())
        })
    }

    /// Sets up the solver and its preconditioner. Collective.
    pub fn setup(&self) -> Result<()> {
        petsc!(KSPSetUp(self.raw()))
    }

    /// Solves A x = b; [`Ksp::converged_reason`] says whether it converged. Collective.
    ///
    /// # Errors
    /// The error of a shell operator or preconditioner if one failed; otherwise PETSc's. Divergence is no
    /// error.
    pub fn solve(&self, b: &Vec, x: &Vec) -> Result<()> {
        let (b, x) = (b.read()?, x.write()?);
        petsc!(KSPSolve(self.raw(), b, x))
    }

    /// x ← A⁻ᵀ b. Collective.
    pub fn solve_transpose(&self, b: &Vec, x: &Vec) -> Result<()> {
        let (b, x) = (b.read()?, x.write()?);
        petsc!(KSPSolveTranspose(self.raw(), b, x))
    }

    /// Why the last solve stopped.
    pub fn converged_reason(&self) -> Result<ConvergedReason> {
        Ok(ConvergedReason {
            code: got(|code| petsc!(KSPGetConvergedReason(self.raw(), code)))?,
            name: text(|name| petsc!(KSPGetConvergedReasonString(self.raw(), name)))?,
        })
    }

    /// x ← the current iterate, for monitors. Collective.
    pub fn current_solution(&self, x: &Vec) -> Result<()> {
        let mut same = std::ptr::null_mut();
        petsc!(KSPBuildSolution(self.raw(), x.write()?, &mut same))
    }

    /// Number of iterations of the last solve.
    pub fn iterations(&self) -> Result<usize> {
        Ok(got(|n| petsc!(KSPGetIterationNumber(self.raw(), n)))? as usize)
    }

    /// The last residual norm, in the norm of the convergence test.
    pub fn residual_norm(&self) -> Result<f64> {
        got(|norm| petsc!(KSPGetResidualNorm(self.raw(), norm)))
    }

    /// Record the residual norms of the next solve, up to `length` of them.
    pub fn record_residuals(&self, length: usize) -> Result<()> {
        petsc!(KSPSetResidualHistory(
            self.raw(),
            std::ptr::null_mut(),
            length as _,
            Flag::of(true)
        ))
    }

    /// The residual norms of the last solve, the initial one first; empty unless [`Ksp::record_residuals`] was called.
    pub fn residual_history(&self) -> Result<std::vec::Vec<f64>> {
        let (mut data, mut n) = (std::ptr::null(), 0);
        petsc!(KSPGetResidualHistory(self.raw(), &mut data, &mut n))?;
        let n = if data.is_null() { 0 } else { n };
        // SAFETY: PETSc keeps `n` norms until the next solve.
        Ok(unsafe { copied(data, n) })
    }

    /// (largest, smallest) singular value of the preconditioned operator, as estimated in the last solve.
    ///
    /// # Errors
    /// The method does not estimate them. (For fcg, PETSc passes its data to a routine that expects those of
    /// cg, and crashes.)
    pub fn extreme_singular_values(&self) -> Result<(f64, f64)> {
        if self.type_name()? == "fcg" {
            return Err(Error::environment("fcg keeps no estimate of the spectrum"));
        }
        let (mut large, mut small) = (0.0, 0.0);
        petsc!(KSPComputeExtremeSingularValues(
            self.raw(),
            &mut large,
            &mut small
        ))?;
        Ok((large, small))
    }

    /// Real parts of the eigenvalues of the preconditioned operator, as estimated in the last solve; ascending for CG.
    pub fn eigenvalues(&self) -> Result<std::vec::Vec<f64>> {
        let n = self.iterations()?;
        if n == 0 {
            return Ok(std::vec::Vec::new());
        }
        let (mut re, mut im, mut found) = (vec![0.0; n], vec![0.0; n], 0);
        petsc!(KSPComputeEigenvalues(
            self.raw(),
            n as PetscInt,
            re.as_mut_ptr(),
            im.as_mut_ptr(),
            &mut found
        ))?;
        re.truncate(found as usize);
        Ok(re)
    }

    /// The preconditioner.
    pub fn pc(&self) -> Result<Pc> {
        Pc::borrowed(self.session(), |raw| petsc!(KSPGetPC(self.raw(), raw)))
    }

    /// KSPFETIDP: the inner solver for the multipliers, which has the iteration count and the spectrum.
    pub fn fetidp_inner_ksp(&self) -> Result<Ksp> {
        Ksp::borrowed(self.session(), |raw| {
            petsc!(KSPFETIDPGetInnerKSP(self.raw(), raw))
        })
    }

    /// KSPFETIDP: its inner PCBDDC.
    pub fn fetidp_inner_bddc(&self) -> Result<Pc> {
        Pc::borrowed(self.session(), |raw| {
            petsc!(KSPFETIDPGetInnerBDDC(self.raw(), raw))
        })
    }
}
