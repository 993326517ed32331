//! Operators written in Rust that PETSc calls: MatShell, PCShell and STSHELL.
//!
//! PETSc owns the boxed operator and drops it with the object (or when another is set). The operator must not borrow
//! from its surroundings, because PETSc may keep the object longer:
//!
//! ```compile_fail
//! use fetifeti_petsc::{Mat, Session, ShellMat, Vec};
//! struct Scaled<'a>(&'a f64);
//! impl ShellMat for Scaled<'_> {
//!     fn mult(&self, x: &Vec, y: &Vec) -> base::Result<()> {
//!         y.copy_from(x)?;
//!         y.scale(*self.0)
//!     }
//! }
//! fn shell(session: &Session) -> base::Result<Mat> {
//!     let factor = 2.0;
//!     Mat::shell(session, 3, 3, Box::new(Scaled(&factor))) // `factor` does not live long enough
//! }
//! ```
//!
//! An operator that owns its factor is fine:
//!
//! ```
//! use fetifeti_petsc::{Mat, Session, ShellMat, Vec};
//! struct Scaled(f64);
//! impl ShellMat for Scaled {
//!     fn mult(&self, x: &Vec, y: &Vec) -> base::Result<()> {
//!         y.copy_from(x)?;
//!         y.scale(self.0)
//!     }
//! }
//! fn shell(session: &Session) -> base::Result<Mat> {
//!     Mat::shell(session, 3, 3, Box::new(Scaled(2.0)))
//! }
//! ```

use super::error::{c_string, guard};
use super::mat::count;
use super::{Comm, Eps, Mat, MatFlag, Pc, Session, Vec};
use base::{Error, Result};
use petsc_sys as sys;
use std::ffi::{c_int, c_void, CStr};
use std::panic::{catch_unwind, AssertUnwindSafe};

/// A matrix defined by its action.
pub trait ShellMat {
    /// y ← A x.
    fn mult(&self, x: &Vec, y: &Vec) -> Result<()>;

    /// y ← Aᵀ x; by default A x if the operator is symmetric, otherwise an error.
    fn mult_transpose(&self, x: &Vec, y: &Vec) -> Result<()> {
        if self.symmetric() {
            return self.mult(x, y);
        }
        Err(Error::environment(
            "This shell matrix provides no transposed product.",
        ))
    }

    /// Whether Aᵀ = A.
    fn symmetric(&self) -> bool {
        false
    }

    /// d ← diagonal of A; by default an error.
    fn diagonal(&self, _d: &Vec) -> Result<()> {
        Err(Error::environment(
            "This shell matrix does not provide its diagonal.",
        ))
    }

    /// The description of the operator for `-ksp_view`.
    fn view(&self) -> String {
        String::new()
    }
}

/// A preconditioner defined by its action.
pub trait ShellPc {
    /// y ← M⁻¹ x.
    fn apply(&self, x: &Vec, y: &Vec) -> Result<()>;

    /// y ← M⁻ᵀ x; by default M⁻¹ is assumed symmetric.
    fn apply_transpose(&self, x: &Vec, y: &Vec) -> Result<()> {
        self.apply(x, y)
    }

    /// The description of the preconditioner for `-ksp_view`.
    fn view(&self) -> String {
        String::new()
    }
}

/// The operator of a spectral transformation (STSHELL).
pub trait ShellOp {
    /// y ← OP x.
    fn apply(&self, x: &Vec, y: &Vec) -> Result<()>;
}

/// The name under which a context is composed with its object.
const KEY: &CStr = c"fetifeti_shell";

struct Context<T: ?Sized> {
    op: Box<T>,
    session: Session,
}

fn attach<T: ?Sized + 'static>(
    object: sys::PetscObject,
    session: &Session,
    op: Box<T>,
) -> Result<()> {
    let session = session.clone();
    let context = Box::into_raw(Box::new(Context { op, session }));
    petsc!(ff_attach(
        object,
        KEY.as_ptr(),
        context as *mut c_void,
        Some(release::<T>)
    ))
}

unsafe extern "C" fn release<T: ?Sized>(context: *mut c_void) {
    // SAFETY: `attach` made the pointer from a box of this very type, and PETSc calls this once.
    let context = unsafe { Box::from_raw(context as *mut Context<T>) };
    // A destructor that panics must not unwind into C; the object is gone either way.
    let _ = catch_unwind(AssertUnwindSafe(move || drop(context)));
}

/// Runs `body` with the context of a shell object.
///
/// # Safety
/// `object` is alive and, if it has a context under [`KEY`], that is a `Context<T>`.
unsafe fn with_context<T: ?Sized>(
    what: &'static str,
    object: sys::PetscObject,
    body: impl FnOnce(&Context<T>) -> Result<()>,
) -> c_int {
    guard(what, || {
        // SAFETY: the object is alive.
        let context = unsafe { sys::ff_attached(object, KEY.as_ptr()) } as *const Context<T>;
        // SAFETY: by the caller's promise; PETSc keeps the object alive during the callback.
        match unsafe { context.as_ref() } {
            Some(context) => body(context),
            None => Err(Error::environment(
                "Internal error: a shell object has lost its context.",
            )),
        }
    })
}

/// Common code of all products: borrows both vectors and calls the operator.
///
/// # Safety
/// As for [`with_context`]; `x` and `y` are alive.
unsafe fn product<T: ?Sized>(
    what: &'static str,
    object: sys::PetscObject,
    x: sys::Vec,
    y: sys::Vec,
    apply: impl FnOnce(&T, &Vec, &Vec) -> Result<()>,
) -> c_int {
    // SAFETY: by the caller's promise.
    unsafe {
        with_context::<T>(what, object, |context| {
            let x = Vec::share(x, &context.session)?;
            let y = Vec::share(y, &context.session)?;
            apply(&context.op, &x, &y)
        })
    }
}

/// # Safety
/// As for [`with_context`]; `viewer` is alive.
unsafe fn view<T: ?Sized>(
    object: sys::PetscObject,
    viewer: sys::PetscViewer,
    text: impl FnOnce(&T) -> String,
) -> c_int {
    let print = |context: &Context<T>| {
        let text = text(&context.op);
        let mut ascii = 0;
        petsc!(ff_viewer_is_ascii(viewer, &mut ascii))?;
        if ascii == 0 {
            return Ok(());
        }
        for line in text.lines() {
            petsc!(ff_viewer_print(
                viewer,
                c_string(&format!("  {line}\n")).as_ptr()
            ))?;
        }
        Ok(())
    };
    // SAFETY: by the caller's promise.
    unsafe { with_context("a shell's view", object, print) }
}

unsafe extern "C" fn mat_mult(a: sys::Mat, x: sys::Vec, y: sys::Vec) -> c_int {
    // SAFETY: called by PETSc with live objects for a matrix made by `Mat::shell`.
    unsafe { product::<dyn ShellMat>("a matrix product", a as _, x, y, |op, x, y| op.mult(x, y)) }
}

unsafe extern "C" fn mat_mult_transpose(a: sys::Mat, x: sys::Vec, y: sys::Vec) -> c_int {
    // SAFETY: as above.
    unsafe {
        product::<dyn ShellMat>("a transposed matrix product", a as _, x, y, |op, x, y| {
            op.mult_transpose(x, y)
        })
    }
}

unsafe extern "C" fn mat_diagonal(a: sys::Mat, d: sys::Vec) -> c_int {
    // SAFETY: as above.
    unsafe {
        with_context::<dyn ShellMat>("a matrix diagonal", a as _, |context| {
            context.op.diagonal(&Vec::share(d, &context.session)?)
        })
    }
}

unsafe extern "C" fn mat_view(a: sys::Mat, viewer: sys::PetscViewer) -> c_int {
    // SAFETY: as above.
    unsafe { view::<dyn ShellMat>(a as _, viewer, |op| op.view()) }
}

unsafe extern "C" fn pc_apply(pc: sys::PC, x: sys::Vec, y: sys::Vec) -> c_int {
    // SAFETY: called by PETSc with live objects for a preconditioner prepared by `Pc::set_shell`.
    unsafe { product::<dyn ShellPc>("a preconditioner", pc as _, x, y, |op, x, y| op.apply(x, y)) }
}

unsafe extern "C" fn pc_apply_transpose(pc: sys::PC, x: sys::Vec, y: sys::Vec) -> c_int {
    // SAFETY: as above.
    unsafe {
        product::<dyn ShellPc>("a transposed preconditioner", pc as _, x, y, |op, x, y| {
            op.apply_transpose(x, y)
        })
    }
}

unsafe extern "C" fn pc_view(pc: sys::PC, viewer: sys::PetscViewer) -> c_int {
    // SAFETY: as above.
    unsafe { view::<dyn ShellPc>(pc as _, viewer, |op| op.view()) }
}

unsafe extern "C" fn st_apply(st: sys::ST, x: sys::Vec, y: sys::Vec) -> c_int {
    // SAFETY: called by SLEPc with live objects for a transformation prepared by `Eps::set_st_shell`.
    unsafe {
        product::<dyn ShellOp>("a spectral transformation", st as _, x, y, |op, x, y| {
            op.apply(x, y)
        })
    }
}

impl Mat {
    /// A matrix with `rows` rows and `cols` columns on this rank whose products are `op`'s. Collective.
    pub fn shell(
        session: &Session,
        rows: usize,
        cols: usize,
        op: Box<dyn ShellMat>,
    ) -> Result<Mat> {
        let (rows, cols) = (count(rows)?, count(cols)?);
        let mat = Mat::made(session, |raw| {
            petsc!(MatCreateShell(
                session.raw_comm(Comm::World),
                rows,
                cols,
                sys::PETSC_DETERMINE,
                sys::PETSC_DETERMINE,
                std::ptr::null_mut(),
                raw
            ))
        })?;
        let raw = mat.raw();
        let symmetric = op.symmetric();
        attach::<dyn ShellMat>(raw as _, session, op)?;
        petsc!(ff_mat_shell_set_mult(raw, Some(mat_mult)))?;
        petsc!(ff_mat_shell_set_mult_transpose(
            raw,
            Some(mat_mult_transpose)
        ))?;
        petsc!(ff_mat_shell_set_diagonal(raw, Some(mat_diagonal)))?;
        petsc!(ff_mat_shell_set_view(raw, Some(mat_view)))?;
        if symmetric {
            mat.set_flag(MatFlag::Symmetric)?;
        }
        Ok(mat)
    }
}

impl Pc {
    /// Makes this a preconditioner written in Rust; `name` is what `-ksp_view` shows.
    pub fn set_shell(&self, name: &str, op: Box<dyn ShellPc>) -> Result<()> {
        self.set_type("shell")?;
        attach::<dyn ShellPc>(self.object(), self.session(), op)?;
        let raw = self.raw();
        petsc!(PCShellSetName(raw, c_string(name).as_ptr()))?;
        petsc!(ff_pc_shell_set_apply(raw, Some(pc_apply)))?;
        petsc!(ff_pc_shell_set_apply_transpose(
            raw,
            Some(pc_apply_transpose)
        ))?;
        petsc!(ff_pc_shell_set_view(raw, Some(pc_view)))
    }
}

impl Eps {
    /// Makes the spectral transformation an operator OP written in Rust.
    ///
    /// The search space is built with OP, and [`Eps::set_which`] refers to eigenvalues of OP; the eigenvalues returned
    /// are the Rayleigh quotients of A. STSHELL of PETSc 3.18 does not support generalised problems (it has no bilinear
    /// form); see `extreme_eigenvalues` for a workaround.
    pub fn set_st_shell(&self, op: Box<dyn ShellOp>) -> Result<()> {
        let mut st = std::ptr::null_mut();
        petsc!(EPSGetST(self.raw(), &mut st))?;
        petsc!(STSetType(st, c"shell".as_ptr()))?;
        attach::<dyn ShellOp>(st as _, self.session(), op)?;
        petsc!(ff_st_shell_set_apply(st, Some(st_apply)))
    }
}
