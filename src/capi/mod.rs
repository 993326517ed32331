//! The C interface: the registration of the plug-in, the functions behind KSPFETIFETI, and the functions of
//! `wrappers/fetifeti.h` ([`life`], [`bodies`], [`conditions`], [`surfaces`], [`friction`],
//! [`results`]).
//!
//! No panic unwinds into C. An error is one sentence: [`plugin`] stores it for the C side, which passes it to the
//! host's error handler.

mod bodies;
mod changed;
mod conditions;
mod coordinates;
mod error;
mod friction;
mod handle;
mod laws;
mod life;
mod monitor;
mod mortar;
mod mortar_results;
mod mortar_rows;
mod nested;
mod numbering;
mod object;
mod plugin;
mod plugin_together;
mod plugin_view;
mod results;
mod rows;
mod set_up;
mod solving;
mod stack;
mod surface;
mod surfaces;
mod tangential;
mod update;

pub use handle::{alone, create, destroy, put, together, Held, Pointer};

use petsc::raw;
use std::ffi::{c_char, c_int};

extern "C" {
    fn ff_plugin_register(avx2: c_int) -> c_int;
    fn ff_processor(avx2: c_int) -> c_int;
    fn ff_processor_suits() -> c_int;
    fn ff_plugin_set_body(ksp: raw::KSP, body: raw::PetscInt) -> c_int;
    fn ff_plugin_set_body_is(ksp: raw::KSP, bodies: raw::IS) -> c_int;
    fn ff_plugin_set_body_label(ksp: raw::KSP, name: *const c_char) -> c_int;
    fn ff_plugin_set_primal(ksp: raw::KSP, dofs: raw::IS) -> c_int;
    fn ff_plugin_get_inner(ksp: raw::KSP, inner: *mut raw::KSP) -> c_int;
    fn ff_plugin_get_ksp(pc: raw::PC, ksp: *mut raw::KSP) -> c_int;
}

/// Whether this build has instructions of processors with AVX2 and FMA (.cargo/config.toml). What runs before the
/// processor is asked is C, or hands over to C at once.
const AVX2: c_int = cfg!(target_feature = "avx2") as c_int;

/// Raises an error of PETSc if this processor lacks instructions of this build.
pub fn processor() -> c_int {
    // SAFETY: it has no arguments to be wrong.
    unsafe { ff_processor(AVX2) }
}

/// Whether this processor has all instructions of this build.
pub fn suits() -> bool {
    // SAFETY: without arguments.
    AVX2 == 0 || unsafe { ff_processor_suits() } != 0
}

/// Called by PETSc when it loads the library (`-dll_append /path/libfetifeti.so`): registers "fetifeti" as a type of
/// KSP and of PC.
#[no_mangle]
pub extern "C" fn PetscDLLibraryRegister_fetifeti() -> c_int {
    // SAFETY: PETSc is initialised, or it would not load libraries.
    unsafe { ff_plugin_register(AVX2) }
}

/// Registers "fetifeti" as a type of KSP and of PC for programs that link with the library: they call it once after
/// PetscInitialize.
#[no_mangle]
pub extern "C" fn FetiFetiInitializePackage() -> c_int {
    // SAFETY: the caller has initialised PETSc.
    unsafe { ff_plugin_register(AVX2) }
}

/// Sets the body of this rank's subdomain: ranks with the same number form a body. The number takes effect at the next
/// set-up; other types of KSP ignore it.
///
/// # Safety
/// `ksp` is a KSP.
#[no_mangle]
pub unsafe extern "C" fn KSPFETIFETISetBody(ksp: raw::KSP, body: raw::PetscInt) -> c_int {
    // SAFETY: handed on.
    unsafe { ff_plugin_set_body(ksp, body) }
}

/// Sets the body of each row of the operator. The index set has one number for each row that this rank owns, as
/// MatPartitioningApply returns it. A subdomain belongs to the body that most of its unknowns name.
///
/// # Safety
/// `ksp` is a KSP, `bodies` an index set.
#[no_mangle]
pub unsafe extern "C" fn KSPFETIFETISetBodyIS(ksp: raw::KSP, bodies: raw::IS) -> c_int {
    // SAFETY: handed on.
    unsafe { ff_plugin_set_body_is(ksp, bodies) }
}

/// Sets the label of the mesh's cells (DMPlex) that names the bodies. A rank's subdomain belongs to the value that most
/// of its cells have.
///
/// # Safety
/// `ksp` is a KSP, `name` a string.
#[no_mangle]
pub unsafe extern "C" fn KSPFETIFETISetBodyLabel(ksp: raw::KSP, name: *const c_char) -> c_int {
    // SAFETY: handed on.
    unsafe { ff_plugin_set_body_label(ksp, name) }
}

/// Makes unknowns primal where subdomains of one body share them; any rank may list any, and NULL names none. Takes
/// effect at the next set-up; other types of KSP ignore it.
///
/// # Safety
/// `ksp` is a KSP, `dofs` NULL or an index set.
#[no_mangle]
pub unsafe extern "C" fn KSPFETIFETISetPrimalDofs(ksp: raw::KSP, dofs: raw::IS) -> c_int {
    // SAFETY: handed on.
    unsafe { ff_plugin_set_primal(ksp, dofs) }
}

/// The KSP that iterates on the multipliers, after KSPSetUp.
///
/// # Safety
/// `ksp` is a KSP of type fetifeti, and `inner` can be written to.
#[no_mangle]
pub unsafe extern "C" fn KSPFETIFETIGetInnerKSP(ksp: raw::KSP, inner: *mut raw::KSP) -> c_int {
    // SAFETY: handed on.
    unsafe { ff_plugin_get_inner(ksp, inner) }
}

/// The KSP of a PC, which is of type fetifeti, too: for its bodies and tolerances.
///
/// # Safety
/// `pc` is a PC of type fetifeti, and `ksp` can be written to.
#[no_mangle]
pub unsafe extern "C" fn PCFETIFETIGetKSP(pc: raw::PC, ksp: *mut raw::KSP) -> c_int {
    // SAFETY: handed on.
    unsafe { ff_plugin_get_ksp(pc, ksp) }
}
