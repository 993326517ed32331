//! The functions behind KSPFETIFETI (wrappers/kspfetifeti.h).

use super::error::{remark, status, SENTENCE, UNFIT};
use super::handle::lent;
use crate::embed::torn::marked;
use crate::embed::{Embedded, Local, SetUp, SetUpWork, Torn};
use crate::feti::krylov::together::Begun;
use crate::feti::krylov::verdict::{JudgeTiming, Verdict};
use crate::settings::MethodSettings;
use crate::status::Status;
use crate::{Error, Result};
use base::ErrorKind;
use petsc::{raw, Is, Mat, Options, Session, Vec as PetscVec};
use std::borrow::Cow;
use std::cell::{Cell, RefCell};
use std::ffi::{c_char, c_int, c_void, CStr};

/// The requests of the outer KSP.
#[repr(C)]
pub struct Wishes {
    body: c_int,
    bodies: raw::IS,
    primal: raw::IS,
    goal: f64,
    rtol: f64,
    abstol: f64,
    divtol: f64,
    max_it: c_int,
    /// The number of the right-hand side among those of the last `fetifeti_plugin_together`, or -1.
    begun: c_int,
}

/// The solver behind a KSP.
pub struct PluginSolver {
    pub(super) embedded: Embedded,
    pub(super) work: SetUpWork,
    /// Iterations that have been run for several right-hand sides together.
    pub(super) begun: RefCell<Vec<Option<Begun>>>,
}

/// The result of a solve.
#[repr(C)]
pub struct PluginReport {
    iterations: c_int,
    /// KSPConvergedReason.
    reason: c_int,
    largest: f64,
    smallest: f64,
    /// Whether the last message explains the reason.
    explained: c_int,
}

/// Residuals that are this many times the tolerance at most have reached it: the judge and the host sum in other
/// orders.
const REACHED: f64 = 1.01;

/// Makes a solver for a MATIS. If there is one already, it is brought up to date where the matrix has the same
/// structure, and replaced otherwise; NULL after an error. Collective.
///
/// # Safety
/// `comm` is the communicator of `a`, which is a matrix of the host; `prefix` is NULL or a string; `wishes` and
/// `solver` are valid, and the latter has NULL or a solver of this function for the same communicator.
#[no_mangle]
pub unsafe extern "C" fn fetifeti_plugin_setup(
    comm: raw::MPI_Comm,
    a: raw::Mat,
    prefix: *const c_char,
    wishes: *const Wishes,
    solver: *mut *mut c_void,
) -> c_int {
    let mut unfit = false;
    let code = status("KSPSetUp_FETIFETI", |at_work| {
        // SAFETY: by the caller; the KSP that owns the solver keeps the communicator.
        let session = unsafe { Session::borrowed(comm) }?;
        *at_work = Some(session.clone());
        let a = lent(a, &session)?;
        // SAFETY: by the caller.
        let (wishes, prefix) = unsafe { (&*wishes, text(prefix)) };
        // SAFETY: by the caller; NULL takes its place.
        let old = unsafe { std::mem::replace(&mut *solver, std::ptr::null_mut()) };
        // SAFETY: by the caller.
        let old = (!old.is_null()).then(|| unsafe { Box::from_raw(old.cast::<PluginSolver>()) });
        let made = setup(&session, &a, &prefix, wishes, old.map(|old| *old));
        // A wrong input stops the host with an error. A matrix that turns out to be no stiffness matrix is reported by
        // KSPGetConvergedReason.
        unfit = matches!(&made, Err(error) if error.kind() == ErrorKind::Unfit);
        // SAFETY: by the caller.
        unsafe { *solver = Box::into_raw(Box::new(made?)).cast() };
        Ok(())
    });
    if code != 0 && unfit {
        UNFIT
    } else {
        code
    }
}

/// The jumps have to fall by this factor more where the residual of the host's equations has not been halved, for so
/// many times in a row.
const FURTHER: f64 = 0.1;
const MOST_SLOW: i32 = 2;

/// Number of search directions that a solve keeps for the next one with the same matrix.
const DIRECTIONS: usize = 30;

fn setup(
    session: &Session,
    a: &Mat,
    prefix: &str,
    wishes: &Wishes,
    old: Option<PluginSolver>,
) -> Result<PluginSolver> {
    let (old, mut work) = old.map_or((None, SetUpWork::default()), |o| (Some(o.embedded), o.work));
    let make = || match old.map(|old| renewed(old, a)).transpose()?.flatten() {
        Some(embedded) => Ok((embedded, SetUp::Numbers)),
        None => Ok((whole(session, a, prefix, wishes)?, SetUp::Whole)),
    };
    let (embedded, _) = work.count(session, make, |made| Some(made.1))?;
    Ok(PluginSolver {
        embedded,
        work,
        begun: RefCell::default(),
    })
}

/// The solver for other entries of its matrix, or another one of the same structure; `None` if the structure is
/// another one. Collective.
fn renewed(old: Embedded, a: &Mat) -> Result<Option<Embedded>> {
    if !old.fits(a)? || a.is_repeated()? {
        return Ok(None);
    }
    let (k, map) = old.session().agree(a.local_part())?;
    let local = Local {
        k: Cow::Owned(k),
        dofs: Cow::Owned(map),
    };
    old.renewed(&[local], None)
}

fn whole(session: &Session, a: &Mat, prefix: &str, wishes: &Wishes) -> Result<Embedded> {
    let prefix = format!("{prefix}fetifeti_");
    let settings = MethodSettings {
        prefix: prefix.clone(),
        recycle: DIRECTIONS,
        keeps_analyses: true,
        ..MethodSettings::default()
    };
    let options = Options::new(session, &prefix);
    let help = "bodies to group the ranks into; 0: one for every connected piece";
    let bodies = options.usize("bodies", 0, help)?;
    let mut torn = Torn::from_matis(session, a, u64::try_from(wishes.body).ok())?;
    if !wishes.bodies.is_null() {
        torn.named = Some(numbers(
            session,
            &torn.layout,
            &lent(wishes.bodies, session)?,
        )?);
    }
    if !wishes.primal.is_null() {
        let list = lent(wishes.primal, session)?.indices()?;
        let n = torn.n_global as raw::PetscInt;
        let wrong = list.iter().find(|dof| !(0..n).contains(*dof));
        session.agree(wrong.map_or(Ok(()), |dof| {
            Err(Error::input(format!(
                "unknown {dof} is to be primal, expected numbers from 0 to below {n}"
            )))
        }))?;
        let (ghosts, halo) = torn.halo(session)?;
        torn.primal = marked(session, &torn.layout, &list, (&ghosts, &halo))?;
    }
    Embedded::new(session, &torn, bodies, settings)
}

/// An index set, as long as this rank's part of the layout, converted to a vector.
fn numbers(session: &Session, layout: &PetscVec, is: &Is) -> Result<PetscVec> {
    let (found, wanted) = (is.indices()?, layout.local_len());
    session.agree(if found.len() == wanted {
        Ok(())
    } else {
        Err(Error::input(format!(
            "the bodies' index set has {} entries on rank {}, \
             expected one for each of the {wanted} rows of the operator there",
            found.len(),
            session.rank()
        )))
    })?;
    let vector = layout.duplicate()?;
    for (to, from) in vector.array_mut()?.iter_mut().zip(found) {
        *to = from as f64;
    }
    Ok(vector)
}

/// Solves A x = b with initial guess zero. Collective.
///
/// # Safety
/// `solver` comes from [`fetifeti_plugin_setup`] for `a`; `b` and `x` are vectors of `a`, `wishes` and `report` are
/// valid.
#[no_mangle]
pub unsafe extern "C" fn fetifeti_plugin_solve(
    solver: *mut c_void,
    a: raw::Mat,
    wishes: *const Wishes,
    b: raw::Vec,
    x: raw::Vec,
    report: *mut PluginReport,
) -> c_int {
    let mut infinite = false;
    let code = status("KSPSolve_FETIFETI", |at_work| {
        // A monitor may ask for the present solution while this runs: hence no unique reference.
        // SAFETY: by the caller.
        let (plugin, wishes) = unsafe { (&*solver.cast::<PluginSolver>(), &*wishes) };
        let solver = &plugin.embedded;
        *at_work = Some(solver.session().clone());
        let begun = usize::try_from(wishes.begun).ok();
        let begun = begun.and_then(|c| plugin.begun.borrow_mut().get_mut(c)?.take());
        let (b, x) = (lent(b, solver.session())?, lent(x, solver.session())?);
        infinite = !b.norm2()?.is_finite();
        forward(solver, wishes)?;
        let (a, r) = (lent(a, solver.session())?, b.duplicate()?);
        let (before, slow) = (Cell::new(f64::INFINITY), Cell::new(0));
        let mut outcome = solver.solve(begun, &b, &x, &|x, look| {
            if wishes.goal < 0.0 {
                // The host asked for the test of the jumps alone, which has not been made before the first iteration.
                return Ok(match look {
                    JudgeTiming::Before => Verdict::Further(1.0),
                    JudgeTiming::After => Verdict::Enough,
                });
            }
            a.mult(x, &r)?;
            r.aypx(-1.0, &b)?;
            let norm = r.norm2()?;
            if norm <= wishes.goal {
                return Ok(Verdict::Satisfied);
            }
            if look == JudgeTiming::Before {
                return Ok(Verdict::Further(1.0));
            }
            // It may lag behind the jumps, from which it follows: these then have to fall further. A residual that is
            // still not halved by that has reached the rounding errors.
            let halved = norm <= 0.5 * before.replace(norm);
            slow.set(if halved { 0 } else { slow.get() + 1 });
            if slow.get() > MOST_SLOW || !norm.is_finite() {
                return Ok(Verdict::Enough);
            }
            let factor = 0.5 * wishes.goal.max(1e-4 * norm) / norm;
            Ok(Verdict::Further(factor * FURTHER.powi(slow.get())))
        })?;
        let mut why = outcome.status.remedy().map(String::from);
        if outcome.status.converged() && wishes.goal >= 0.0 && !outcome.satisfied {
            a.mult(&x, &r)?;
            r.aypx(-1.0, &b)?;
            let norm = r.norm2()?;
            // The jumps are as small as was asked for, and the host's equations are not satisfied: it has to know. NaN
            // is no small residual.
            let reached = norm <= REACHED * wishes.goal;
            if !reached {
                outcome.status = Status::Stagnation;
                why = Some(format!(
                    "the residual b - A x no longer falls at {norm:.2e}, expected {:.2e}: rounding holds it up; \
                     ask for no more than that (-ksp_rtol), or leave the residual out of the test \
                     (-fetifeti_true_residual 0)",
                    wishes.goal
                ));
            }
        }
        if let Some(why) = &why {
            remark(why);
        }
        let (largest, smallest) = outcome.spectrum.unwrap_or_default();
        // SAFETY: by the caller.
        unsafe {
            *report = PluginReport {
                largest,
                smallest,
                iterations: outcome.iterations as c_int,
                reason: outcome.status.number(),
                explained: why.is_some().into(),
            }
        };
        Ok(())
    });
    // Another KSP may have failed before, which says so by such a load: PETSc has a reason for it.
    if code == SENTENCE && infinite {
        UNFIT
    } else {
        code
    }
}

/// Applies the outer KSP's tolerances, unless options of the inner KSP override them.
pub(super) fn forward(solver: &Embedded, wishes: &Wishes) -> Result<()> {
    let ksp = solver.solver().ksp().clone();
    let options = Options::new(solver.session(), &solver.solver().settings().method.prefix);
    let now = ksp.tolerances()?;
    let f64_of = |name, outer| Ok::<f64, Error>(options.get_f64(name)?.unwrap_or(outer));
    let max_it = match options.get_usize("ksp_max_it")? {
        Some(_) => now.3,
        None => wishes.max_it.max(0) as raw::PetscInt,
    };
    ksp.set_tolerances(
        Some(f64_of("ksp_rtol", wishes.rtol)?),
        Some(f64_of("ksp_atol", wishes.abstol)?),
        Some(f64_of("ksp_divtol", wishes.divtol)?),
        Some(max_it),
    )
}

/// x ← the current iterate, if an iteration is running. Collective.
///
/// # Safety
/// As above; `there` is valid.
#[no_mangle]
pub unsafe extern "C" fn fetifeti_plugin_solution(
    solver: *mut c_void,
    x: raw::Vec,
    there: *mut c_int,
) -> c_int {
    status("KSPBuildSolution_FETIFETI", |_| {
        // SAFETY: by the caller.
        let solver = unsafe { &(*solver.cast::<PluginSolver>()).embedded };
        let x = lent(x, solver.session())?;
        // SAFETY: by the caller.
        unsafe { *there = solver.current(&x)?.into() };
        Ok(())
    })
}

/// The KSP that iterates on the multipliers, as a borrowed reference.
///
/// # Safety
/// As above.
#[no_mangle]
pub unsafe extern "C" fn fetifeti_plugin_inner(solver: *mut c_void) -> raw::KSP {
    // SAFETY: by the caller.
    unsafe { &(*solver.cast::<PluginSolver>()).embedded }
        .solver()
        .ksp()
        .raw()
}

/// Destroys a solver. Collective.
///
/// # Safety
/// `solver` comes from [`fetifeti_plugin_setup`] and is not used any more.
#[no_mangle]
pub unsafe extern "C" fn fetifeti_plugin_free(solver: *mut c_void) {
    status("KSPReset_FETIFETI", |_| {
        // SAFETY: by the caller.
        drop(unsafe { Box::from_raw(solver.cast::<PluginSolver>()) });
        Ok(())
    });
}

/// # Safety
/// `text` is NULL or a string.
unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: by the caller.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into()
}
