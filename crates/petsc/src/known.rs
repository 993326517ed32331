//! The names of options that PETSc's objects know: what `-help` lists.

use super::error::{c_string, rust_string};
use super::Session;
use base::Result;
use std::collections::BTreeSet;
use std::ptr::null_mut;

/// The names, with their dash, that `-help` lists while `work` makes its objects. It does so with options of its own:
/// those of `set`, and none of the user's, so that no viewer of theirs is opened and no file written again.
///
/// # Errors
/// Those of `work`.
pub fn known(
    _session: &Session,
    set: &[(String, String)],
    work: impl FnOnce() -> Result<()>,
) -> Result<BTreeSet<String>> {
    let mut own = null_mut();
    petsc!(PetscOptionsCreate(&mut own))?;
    petsc!(PetscOptionsPush(own))?;
    let done = listed(set, work);
    petsc!(PetscOptionsPop())?;
    petsc!(PetscOptionsDestroy(&mut own))?;
    Ok(names(&done?))
}

impl Session {
    /// The options that our own code has asked for so far, with their dash.
    pub fn asked(&self) -> BTreeSet<String> {
        self.0.asked.borrow().clone()
    }
}

/// The text that is listed.
fn listed(set: &[(String, String)], work: impl FnOnce() -> Result<()>) -> Result<String> {
    petsc!(PetscOptionsSetValue(
        null_mut(),
        c"-help".as_ptr(),
        c"".as_ptr()
    ))?;
    for (name, value) in set {
        let (name, value) = (c_string(name), c_string(value));
        petsc!(PetscOptionsSetValue(
            null_mut(),
            name.as_ptr(),
            value.as_ptr()
        ))?;
    }
    // SAFETY: PETSc is initialised and prints from this thread alone; its stream is put back before this one returns.
    if unsafe { petsc_sys::ff_print_keep() } == 0 {
        return Ok(String::new());
    }
    let done = work();
    // SAFETY: the text was closed with a zero byte, is ours, and is freed once.
    let text = unsafe {
        let kept = petsc_sys::ff_print_kept();
        let text = if kept.is_null() {
            String::new()
        } else {
            rust_string(kept)
        };
        petsc_sys::ff_print_free(kept);
        text
    };
    done.map(|()| text)
}

/// The first words of lines such as `  -ksp_rtol <1e-05 : 1e-05>: Relative decrease in residual norm`.
fn names(text: &str) -> BTreeSet<String> {
    let lines = text.lines().map(str::trim_start);
    let options = lines.filter(|line| line.starts_with('-'));
    let name = |line: &str| {
        let end = line.find([':', ' ', '<', '[']).unwrap_or(line.len());
        line[..end].to_string()
    };
    options
        .map(name)
        .filter(|name| name.len() > 1 && !name.starts_with("--"))
        .collect()
}
