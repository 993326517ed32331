//! The functions that return the results of a load step.

use petsc::PetscInt;
use std::ffi::{c_char, c_int};

use base::{Fault, Result};
use fetifeti::inside::c::{alone, put, together};

use crate::life::Pointer;
use crate::rows::ContactRow;

#[no_mangle]
unsafe extern "C" fn FetiFetiStepGetNumber(step: Pointer, number: *mut PetscInt) -> c_int {
    alone(step, c"FetiFetiStepGetNumber", |o| {
        put(number, o.solved()?.step as PetscInt);
        Ok(())
    })
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepGetTime(step: Pointer, time: *mut f64) -> c_int {
    alone(step, c"FetiFetiStepGetTime", |o| {
        put(time, o.solved()?.time.unwrap_or(1.0));
        Ok(())
    })
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepGetEnergy(step: Pointer, energy: *mut f64) -> c_int {
    alone(step, c"FetiFetiStepGetEnergy", |o| {
        put(energy, o.solved()?.energy);
        Ok(())
    })
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepGetIterations(step: Pointer, its: *mut PetscInt) -> c_int {
    alone(step, c"FetiFetiStepGetIterations", |o| {
        put(its, o.solved()?.solution.iterations as PetscInt);
        Ok(())
    })
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepGetConvergedReason(
    step: Pointer,
    reason: *mut c_int,
    name: *mut *const c_char,
) -> c_int {
    alone(step, c"FetiFetiStepGetConvergedReason", |o| {
        put(reason, o.solved()?.solution.status.number());
        put(name, o.reason.as_ptr());
        Ok(())
    })
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepGetBodies(step: Pointer, n: *mut PetscInt) -> c_int {
    alone(step, c"FetiFetiStepGetBodies", |o| {
        put(n, o.names.len() as PetscInt);
        Ok(())
    })
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepGetBody(
    step: Pointer,
    body: PetscInt,
    name: *mut *const c_char,
    nodes: *mut PetscInt,
    components: *mut PetscInt,
) -> c_int {
    alone(step, c"FetiFetiStepGetBody", |o| {
        let (number, body) = o.body(body)?;
        put(name, o.names[number].as_ptr());
        put(nodes, body.mesh().n_nodes() as PetscInt);
        put(components, body.components as PetscInt);
        Ok(())
    })
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepGetCoordinates(
    step: Pointer,
    body: PetscInt,
    n: PetscInt,
    x: *mut f64,
) -> c_int {
    alone(step, c"FetiFetiStepGetCoordinates", |o| {
        let (_, body) = o.body(body)?;
        let mesh = body.mesh();
        let all = (0..mesh.n_nodes()).flat_map(|node| mesh.position(node));
        fill(&all.collect::<Vec<f64>>(), n, x, "coordinates")
    })
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepGetDisplacements(
    step: Pointer,
    body: PetscInt,
    n: PetscInt,
    u: *mut f64,
) -> c_int {
    together(step, c"FetiFetiStepGetDisplacements", |o| {
        let values = o.displacements(body)?;
        fill(&values, n, u, "displacements")
    })
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepGetContact(
    step: Pointer,
    n: *mut PetscInt,
    rows: *mut *const ContactRow,
) -> c_int {
    together(step, c"FetiFetiStepGetContact", |o| {
        let found = o.rows()?;
        put(n, found.len() as PetscInt);
        put(rows, found.as_ptr());
        Ok(())
    })
}

/// Copies values to an array of C with room for `n` numbers.
fn fill(values: &[f64], n: PetscInt, to: *mut f64, what: &str) -> Result<()> {
    if n as usize != values.len() || (to.is_null() && n > 0) {
        return Err(Fault::Sizes.error(format!(
            "there is room for {n} {what}, expected {}",
            values.len()
        )));
    }
    for (i, &value) in values.iter().enumerate() {
        // SAFETY: room for n numbers.
        put(unsafe { to.add(i) }, value);
    }
    Ok(())
}
