//! The functions of `wrappers/fetifeti.h` that return the results of a solve.

use super::handle::{alone, put, HandlePointer};
use base::Fault;
use petsc::{raw, PetscInt};
use std::ffi::c_int;

#[no_mangle]
pub unsafe extern "C" fn FetiFetiGetIterations(ff: HandlePointer, its: *mut PetscInt) -> c_int {
    alone(ff, c"FetiFetiGetIterations", |o| {
        put(its, o.outcome()?.iterations as PetscInt);
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiGetConvergedReason(
    ff: HandlePointer,
    reason: *mut c_int,
) -> c_int {
    alone(ff, c"FetiFetiGetConvergedReason", |o| {
        put(reason, o.outcome()?.status.number());
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiGetContactSteps(ff: HandlePointer, steps: *mut PetscInt) -> c_int {
    alone(ff, c"FetiFetiGetContactSteps", |o| {
        put(steps, o.outcome()?.steps as PetscInt);
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiGetSpectrum(
    ff: HandlePointer,
    min: *mut f64,
    max: *mut f64,
) -> c_int {
    alone(ff, c"FetiFetiGetSpectrum", |o| {
        let (largest, smallest) = o.outcome()?.spectrum.unwrap_or_default();
        put(min, smallest);
        put(max, largest);
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiGetKKT(ff: HandlePointer, kkt: *mut f64) -> c_int {
    alone(ff, c"FetiFetiGetKKT", |o| {
        let k = o.outcome()?.kkt;
        put(
            kkt.cast::<[f64; 4]>(),
            [
                k.stationarity,
                k.feasibility,
                k.complementarity,
                k.min_multiplier,
            ],
        );
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiGetMultipliers(
    ff: HandlePointer,
    n: PetscInt,
    lambda: *mut f64,
) -> c_int {
    alone(ff, c"FetiFetiGetMultipliers", |o| {
        o.outcome()?;
        let mut found = o.solver()?.given().unwrap_or_default().multipliers;
        // Those of mortars and of friction come last.
        found.truncate(found.len() - o.mortar_rows.placed.len() - o.tangential.len());
        if n as usize != found.len() || (lambda.is_null() && n > 0) {
            return Err(Fault::Sizes.error(format!(
                "there is room for {n} multipliers, expected {}: as many as this rank gave rows",
                found.len()
            )));
        }
        for (i, value) in found.into_iter().enumerate() {
            // SAFETY: room for n numbers.
            put(unsafe { lambda.add(i) }, value);
        }
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiGetInnerKSP(ff: HandlePointer, ksp: *mut raw::KSP) -> c_int {
    alone(ff, c"FetiFetiGetInnerKSP", |o| {
        put(ksp, o.solver()?.solver().ksp().raw());
        Ok(())
    })
}
