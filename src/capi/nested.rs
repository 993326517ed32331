//! Vectors of the host in the layout of all unknowns: plain, or nested with a part for each matrix.

use super::stack::{fits, Stack};
use crate::Result;
use base::Fault;
use petsc::{Session, Vec as PetscVec};

/// A vector of the host with the right layout.
pub struct HostVector {
    whole: PetscVec,
    parts: Option<Vec<PetscVec>>,
}

impl HostVector {
    /// Checks a vector against `layout`; `what` is its name in messages.
    ///
    /// # Errors
    /// Another layout, or parts that do not fit the matrices; possibly on some ranks only.
    pub fn new(
        session: &Session,
        v: &PetscVec,
        what: &str,
        layout: &PetscVec,
        stack: &Stack,
    ) -> Result<HostVector> {
        let parts = v.parts()?;
        match &parts {
            None => fits(session, v, layout, what)?,
            Some(_) if stack.is_empty() => {
                return Err(Fault::Wrong.error(format!(
                    "{what} is a nested vector, expected a plain one: only matrices added without numbers have parts"
                )))
            }
            Some(parts) if parts.len() != stack.len() => {
                return Err(Fault::Sizes.error(format!(
                    "{what} is nested and has {} parts, expected {}: one for each matrix",
                    parts.len(),
                    stack.len()
                )))
            }
            Some(parts) => {
                for (k, (part, layout)) in parts.iter().zip(stack.layouts()).enumerate() {
                    fits(session, part, layout, &format!("part {k} of {what}"))?;
                }
            }
        }
        let whole = v.clone();
        Ok(HostVector { whole, parts })
    }

    /// A plain vector with the entries: the host's own vector, or `work`. Collective.
    pub fn plain(&self, work: impl FnOnce() -> Result<PetscVec>) -> Result<PetscVec> {
        let Some(parts) = &self.parts else {
            return Ok(self.whole.clone());
        };
        let work = work()?;
        {
            let mut entries = work.array_mut()?;
            let mut rest = &mut entries[..];
            for part in parts {
                let (mine, tail) = rest.split_at_mut(part.local_len());
                mine.copy_from_slice(&part.array()?);
                rest = tail;
            }
        }
        Ok(work)
    }

    /// Copies the entries back from the vector that [`HostVector::plain`] returned. Collective.
    pub fn take(&self, plain: &PetscVec) -> Result<()> {
        let Some(parts) = &self.parts else {
            return Ok(());
        };
        let entries = plain.array()?;
        let mut rest = &entries[..];
        for part in parts {
            let (mine, tail) = rest.split_at(part.local_len());
            part.array_mut()?.copy_from_slice(mine);
            rest = tail;
        }
        self.whole.parts_changed()
    }
}
