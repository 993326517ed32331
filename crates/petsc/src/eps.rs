//! Eigenvalue solvers (SLEPc).

use super::eigen_search::EigenSearch;
use super::error::{c_string, got, guard, rust_string};
use super::handle::Handle;
use super::{Comm, ConvergedReason, Ksp, Mat, Session, Vec};
use base::Result;
use petsc_sys as sys;
use petsc_sys::Flag;
use petsc_sys::PetscInt;
use std::ffi::{c_int, c_void};
use std::time::Instant;

/// The kind of eigenvalue problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProblemType {
    /// A x = θ x with symmetric A.
    Hep,
    /// A x = θ B x with symmetric A and symmetric positive (semi)definite B.
    Ghep,
    /// A x = θ x with general A.
    Nhep,
    /// A x = θ B x with symmetric A and indefinite symmetric B.
    Ghiep,
}

/// The end of the spectrum that is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Which {
    /// Largest |θ|.
    LargestMagnitude,
    /// Smallest |θ|.
    SmallestMagnitude,
    /// Largest θ.
    LargestReal,
    /// Smallest θ.
    SmallestReal,
}

/// The conditions under which the search for an eigenvalue ends before its residual is small.
#[derive(Debug, Clone, Copy)]
pub struct Settled {
    /// No eigenvalue is below this; the search for the smallest one ends within the tolerance of it. NaN: not known.
    pub floor: f64,
    /// Restarts before the value may count as settled.
    pub first: usize,
    /// Number of restarts over which it then hardly changes, at most 64.
    pub patience: usize,
    /// The largest residual beside this, relative to the eigenvalue.
    pub loose: f64,
}

/// An eigenvalue at an end of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// The eigenvalue.
    pub value: f64,
    /// Where the search ended because the value had settled: its residual, relative to it. Of a self-adjoint operator
    /// an eigenvalue lies within the residual. `None` where the tolerance was reached.
    pub settled: Option<f64>,
}

/// An eigenvalue solver. Clones are handles to the same solver.
pub type Eps = Handle<sys::_p_EPS>;

impl Eps {
    /// A solver without operators. The first one initialises SLEPc. Collective.
    pub fn new(session: &Session, comm: Comm) -> Result<Eps> {
        session.need_slepc()?;
        Eps::made(session, |raw| {
            petsc!(EPSCreate(session.raw_comm(comm), raw))
        })
    }

    /// A, and B for a generalised problem.
    pub fn set_operators(&self, a: &Mat, b: Option<&Mat>) -> Result<()> {
        let b = b.map_or(std::ptr::null_mut(), Mat::raw);
        petsc!(EPSSetOperators(self.raw(), a.raw(), b))
    }

    /// The kind of problem.
    pub fn set_problem_type(&self, kind: ProblemType) -> Result<()> {
        let kind = match kind {
            ProblemType::Hep => sys::EPS_HEP,
            ProblemType::Ghep => sys::EPS_GHEP,
            ProblemType::Nhep => sys::EPS_NHEP,
            ProblemType::Ghiep => sys::EPS_GHIEP,
        };
        petsc!(EPSSetProblemType(self.raw(), kind))
    }

    /// The method by SLEPc's name (`"krylovschur"` is the default).
    pub fn set_type(&self, name: &str) -> Result<()> {
        petsc!(EPSSetType(self.raw(), c_string(name).as_ptr()))
    }

    /// The end of the spectrum that is wanted.
    pub fn set_which(&self, which: Which) -> Result<()> {
        let which = match which {
            Which::LargestMagnitude => sys::EPS_LARGEST_MAGNITUDE,
            Which::SmallestMagnitude => sys::EPS_SMALLEST_MAGNITUDE,
            Which::LargestReal => sys::EPS_LARGEST_REAL,
            Which::SmallestReal => sys::EPS_SMALLEST_REAL,
        };
        petsc!(EPSSetWhichEigenpairs(self.raw(), which))
    }

    /// Number of wanted eigenvalues and, if given, the size of the search space.
    pub fn set_dimensions(&self, nev: usize, ncv: Option<usize>) -> Result<()> {
        petsc!(EPSSetDimensions(
            self.raw(),
            nev as PetscInt,
            ncv.map_or(sys::PETSC_CURRENT, |n| n as PetscInt),
            sys::PETSC_CURRENT
        ))
    }

    /// Relative tolerance, and the largest number of restarts if given.
    pub fn set_tolerances(&self, tol: f64, max_it: Option<usize>) -> Result<()> {
        petsc!(EPSSetTolerances(
            self.raw(),
            tol,
            max_it.map_or(sys::PETSC_CURRENT, |n| n as PetscInt)
        ))
    }

    /// Starts the search from these vectors.
    pub fn set_initial_space(&self, vectors: &[Vec]) -> Result<()> {
        let raw: Result<std::vec::Vec<sys::Vec>> = vectors.iter().map(Vec::read).collect();
        let mut raw = raw?;
        petsc!(EPSSetInitialSpace(
            self.raw(),
            raw.len() as PetscInt,
            raw.as_mut_ptr()
        ))
    }

    /// Apply the operator once more to computed eigenvectors (SLEPc does so for generalised problems by default).
    pub fn set_purify(&self, on: bool) -> Result<()> {
        petsc!(EPSSetPurify(self.raw(), Flag::of(on)))
    }

    /// The prefix of this solver's options, without a dash.
    pub fn set_options_prefix(&self, prefix: &str) -> Result<()> {
        petsc!(EPSSetOptionsPrefix(self.raw(), c_string(prefix).as_ptr()))
    }

    /// Reads the options of this solver.
    pub fn set_from_options(&self) -> Result<()> {
        petsc!(EPSSetFromOptions(self.raw()))
    }

    /// Solves the eigenvalue problem; [`Eps::converged`] has the number of converged eigenvalues. Collective.
    ///
    /// # Errors
    /// The error of a shell operator if one failed; otherwise SLEPc's.
    pub fn solve(&self) -> Result<()> {
        petsc!(EPSSolve(self.raw()))
    }

    /// Solves for one eigenvalue, at the end `which`, and ends also where it has settled. `None` where neither happens.
    /// Who listens to the session is told at every restart. Collective.
    ///
    /// # Errors
    /// As [`Eps::solve`].
    pub fn solve_settled(&self, when: Settled, which: Which) -> Result<Option<End>> {
        let (mut tolerance, mut most) = (0.0, 0);
        petsc!(EPSGetTolerances(self.raw(), &mut tolerance, &mut most))?;
        let told = MonitorContext {
            session: self.session(),
            largest: which == Which::LargestReal,
            tolerance,
            start: Instant::now(),
        };
        let (mut value, mut residual) = (f64::NAN, f64::NAN);
        let found = got(|found| {
            petsc!(ff_eps_solve_settled(
                self.raw(),
                when.floor,
                when.first as i32,
                when.patience as i32,
                when.loose,
                Some(restarted as _),
                &told as *const MonitorContext as *mut c_void,
                &mut value,
                &mut residual,
                found
            ))
        })?;
        self.session().tell(None);
        let settled = (found == 2).then_some(residual);
        Ok((found != 0).then_some(End { value, settled }))
    }

    /// Number of converged eigenvalues.
    pub fn converged(&self) -> Result<usize> {
        Ok(got(|n| petsc!(EPSGetConverged(self.raw(), n)))? as usize)
    }

    /// Why the last solve stopped.
    pub fn converged_reason(&self) -> Result<ConvergedReason> {
        let code = got(|code| petsc!(EPSGetConvergedReason(self.raw(), code)))?;
        // SAFETY: SLEPc's table is indexed by the code, from the smallest (negative) one up.
        let name = unsafe { rust_string(*sys::EPSConvergedReasons.offset(code as isize)) };
        Ok(ConvergedReason { code, name })
    }

    /// Number of restarts of the last solve.
    pub fn iterations(&self) -> Result<usize> {
        Ok(got(|n| petsc!(EPSGetIterationNumber(self.raw(), n)))? as usize)
    }

    /// Real part of the i-th converged eigenvalue, the most wanted first.
    pub fn eigenvalue(&self, i: usize) -> Result<f64> {
        let (mut re, mut im) = (0.0, 0.0);
        petsc!(EPSGetEigenvalue(
            self.raw(),
            i as PetscInt,
            &mut re,
            &mut im
        ))?;
        Ok(re)
    }

    /// Writes the (real part of the) i-th eigenvector.
    pub fn eigenvector(&self, i: usize, x: &Vec) -> Result<()> {
        let x = x.write()?;
        petsc!(EPSGetEigenvector(
            self.raw(),
            i as PetscInt,
            x,
            std::ptr::null_mut()
        ))
    }

    /// SLEPc's estimate of the relative error of the i-th eigenvalue.
    pub fn error_estimate(&self, i: usize) -> Result<f64> {
        got(|error| petsc!(EPSGetErrorEstimate(self.raw(), i as PetscInt, error)))
    }

    /// The solver for B in the spectral transformation.
    pub fn st_ksp(&self) -> Result<Ksp> {
        let mut st = std::ptr::null_mut();
        petsc!(EPSGetST(self.raw(), &mut st))?;
        Ksp::borrowed(self.session(), |ksp| petsc!(STGetKSP(st, ksp)))
    }
}

/// A search that tells of its course.
struct MonitorContext<'a> {
    session: &'a Session,
    largest: bool,
    tolerance: f64,
    start: Instant,
}

/// Called at every restart.
unsafe extern "C" fn restarted(who: *mut c_void, restarts: c_int, residual: f64) -> c_int {
    guard("what is told of a search", || {
        // SAFETY: `solve_settled` passes the address of its own value, which lives until the solve returns.
        let told = unsafe { &*(who as *const MonitorContext) };
        told.session.tell(Some(&EigenSearch {
            largest: told.largest,
            restarts: restarts.max(0) as usize,
            residual,
            tolerance: told.tolerance,
            elapsed: told.start.elapsed(),
        }));
        Ok(())
    })
}
