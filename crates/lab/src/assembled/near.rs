//! The near-kernel for multigrid and domain decompositions: rigid motions, and the number of rows per node.

use super::unknowns::Unknowns;
use base::Result;
use elements::cell::rigid_count;
use petsc::{Mat, Vec as PetscVec};
use scene::Scene;

/// The rigid motions that a method is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Near {
    /// None.
    None,
    /// Rotations only: interpolation that treats every component by itself reproduces translations anyway.
    Rotations,
    /// All.
    Motions,
}

/// Rigid motions of the whole scene on the unknowns of a problem; empty for scalars.
pub struct NearKernel {
    vectors: Vec<PetscVec>,
    /// Rows per node, where all nodes have the same number.
    block: usize,
}

impl NearKernel {
    /// The motions on the unknowns `unknowns`, as vectors distributed like `like`. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(
        scene: &Scene,
        unknowns: &Unknowns,
        like: &PetscVec,
        near: Near,
    ) -> Result<NearKernel> {
        let layout = unknowns.layout;
        let dim = scene.dim();
        let whole = unknowns.len() == layout.len();
        let block = if whole { layout.components() } else { 1 };
        let mut vectors = Vec::new();
        let wanted = match near {
            _ if layout.components() == 1 => 0..0,
            Near::None => 0..0,
            Near::Rotations => dim..rigid_count(dim),
            Near::Motions => 0..rigid_count(dim),
        };
        let (centre, scale) = layout.ball();
        for _ in wanted.clone() {
            vectors.push(like.duplicate()?);
        }
        if !vectors.is_empty() {
            let places = unknowns.places(like.ownership_range());
            let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(places.len()); vectors.len()];
            for place in places {
                let void = layout.void().binary_search(&place).is_ok();
                let values = layout.motions_at(place, centre, scale);
                for (column, mode) in columns.iter_mut().zip(wanted.clone()) {
                    column.push(if void { 0.0 } else { values[mode] });
                }
            }
            for (vector, column) in vectors.iter().zip(&columns) {
                vector.array_mut()?.copy_from_slice(column);
            }
        }
        Ok(NearKernel { vectors, block })
    }

    /// Whether there are no vectors to attach.
    pub fn is_empty(&self) -> bool {
        self.vectors.is_empty()
    }

    /// Attaches the vectors and the block size to a matrix. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn attach(&self, a: &Mat) -> Result<()> {
        self.attach_where(a, |_| Ok(()))
    }

    /// As `attach`, with `clear` applied to every vector first. Collective.
    ///
    /// # Errors
    /// PETSc's, and those of `clear`.
    pub fn attach_where(&self, a: &Mat, clear: impl Fn(&PetscVec) -> Result<()>) -> Result<()> {
        if self.block > 1 {
            a.set_block_size(self.block)?;
        }
        if self.is_empty() {
            return Ok(());
        }
        let mut basis: Vec<PetscVec> = Vec::new();
        for vector in &self.vectors {
            let q = vector.duplicate()?;
            q.copy_from(vector)?;
            clear(&q)?;
            let size = q.norm2()?;
            // Twice: once leaves rounding.
            for other in basis.iter().chain(&basis) {
                q.axpy(-q.dot(other)?, other)?;
            }
            let left = q.norm2()?;
            // On few nodes some motions may coincide with others.
            if left > 1e-8 * size {
                q.scale(1.0 / left)?;
                basis.push(q);
            }
        }
        a.set_near_null_space(false, &basis)
    }
}
