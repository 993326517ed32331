//! Nested vectors (VECNEST) of host programs.

use super::{Session, Vec};
use base::{Error, Result};
use petsc_sys::Flag;

impl Vec {
    /// The parts of a nested vector in order; the parts of nested parts replace them. `None` for any other vector.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a part that does not exist yet.
    pub fn parts(&self) -> Result<Option<std::vec::Vec<Vec>>> {
        let mut nested = Flag::of(false);
        petsc!(PetscObjectTypeCompare(
            self.object(),
            c"nest".as_ptr(),
            &mut nested
        ))?;
        if !nested.get() {
            return Ok(None);
        }
        let mut parts = std::vec::Vec::new();
        self.collect(self.session(), &mut parts)?;
        Ok(Some(parts))
    }

    fn collect(&self, session: &Session, into: &mut std::vec::Vec<Vec>) -> Result<()> {
        let (mut n, mut list) = (0, std::ptr::null_mut());
        petsc!(VecNestGetSubVecs(self.raw(), &mut n, &mut list))?;
        for i in 0..n as usize {
            // SAFETY: PETSc lends `n` pointers.
            let part = unsafe { *list.add(i) };
            if part.is_null() {
                return Err(Error::input(format!(
                    "part {i} of a nested vector is NULL, expected a vector"
                )));
            }
            let part = Vec::share(part, session)?;
            match part.parts()? {
                Some(inner) => into.extend(inner),
                None => into.push(part),
            }
        }
        Ok(())
    }

    /// Tells PETSc that the entries of a nested vector have changed through its parts, which invalidates cached norms.
    /// Collective.
    pub fn parts_changed(&self) -> Result<()> {
        petsc!(VecAssemblyBegin(self.raw()))?;
        petsc!(VecAssemblyEnd(self.raw()))
    }
}
