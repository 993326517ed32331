//! Other entries of the matrices that the host has added.

use super::object::Object;
use super::stack::HostMatrix;
use crate::embed::torn::unassembled;
use crate::Result;
use base::linalg::csr::Csr;
use base::Fault;
use petsc::{Mat, PetscInt};

impl Object {
    /// The entries of matrices have changed: `matrices` has those that were added, in their order; `None` for one that
    /// stays. Collective.
    ///
    /// # Errors
    /// Another number of matrices; a matrix with other rows; the same on all ranks.
    pub fn update_matrices(&mut self, matrices: &[Option<Mat>]) -> Result<()> {
        let session = self.session.clone();
        let stacked = self.stack.given();
        let of_matrices = self.subdomains.iter_mut().filter(|s| s.map.is_some());
        let all: Vec<&mut HostMatrix> = of_matrices.chain(stacked).collect();
        if matrices.len() != all.len() {
            return Err(Fault::Sizes.error(format!(
                "there are {} matrices, expected {}: as many as have been added",
                matrices.len(),
                all.len()
            )));
        }
        let mut entries = Vec::new();
        for (k, a) in matrices.iter().enumerate() {
            let part = |a: &Mat| {
                unassembled(a).map_err(|e| Fault::Unsupported.error(e.to_string()))?;
                let (k_now, map) = session.agree(a.local_part())?;
                let same = all[k].map.as_ref() == Some(&map);
                session.agree(if same { Ok(()) } else { Err(Fault::WrongState.error(format!(
                    "matrix {k} has another local-to-global map than when it was added, expected the same: \
                     call FetiFetiReset and add all again"
                ))) })?;
                Ok(k_now)
            };
            entries.push(a.as_ref().map(part).transpose()?);
        }
        // Only now, so that an error leaves all as they were.
        for (given, k) in all.into_iter().zip(entries) {
            if let Some(k) = k {
                given.k = k;
            }
        }
        self.changed.matrices = true;
        Ok(())
    }

    /// The entries of this rank's subdomain `s` of FetiFetiAddSubdomain have changed.
    ///
    /// # Errors
    /// A subdomain that there is not; a matrix of another size.
    pub fn update_subdomain(&mut self, s: PetscInt, k: Csr) -> Result<()> {
        let rank = self.session.rank();
        let mut arrays = self.subdomains.iter_mut().filter(|s| s.map.is_none());
        let count = arrays.by_ref().count();
        let mut arrays = self.subdomains.iter_mut().filter(|s| s.map.is_none());
        let found = usize::try_from(s).ok().and_then(|s| arrays.nth(s));
        let given = found.ok_or_else(|| {
            Fault::OutOfRange.error(format!(
                "subdomain {s} of rank {rank} is to be updated but the rank has added {count}, \
                 expected one of these (from 0)"
            ))
        })?;
        if k.n() != given.k.n() {
            return Err(Fault::Sizes.error(format!(
                "subdomain {s} of rank {rank} is to have {} rows, expected {} as before",
                k.n(),
                given.k.n()
            )));
        }
        given.k = k;
        self.changed.matrices = true;
        Ok(())
    }
}
