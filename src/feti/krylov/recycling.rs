//! Recycling: search directions of earlier iterations are used for the next load.
//!
//! CG's search directions p and A p = Pᵀ F P p are kept, where A is the operator of the dual problem. For another load
//! with the same active rows, the iteration begins at the Galerkin solution on the span W of the directions:
//!
//! ```text
//!     x₀ = W (Wᵀ A W)⁺ Wᵀ r,      r ← r − A W (Wᵀ A W)⁺ Wᵀ r
//! ```
//!
//! This costs m products of vectors for W and for A W each, and no application of F. For loads in proportion to earlier
//! ones x₀ is the solution; in general it is the part that the loads have in common. A and A W change with the active
//! set. The directions are then forgotten: to compute A W again would take an application of F for each direction, as
//! many as the iteration itself.
//!
//! Solves to a loose tolerance are parts of another iteration, which takes them for one and the same linear map. With
//! CG they nearly are, and with a W that stays. Their errors in a W that changes from load to load hold it up: FGMRES
//! around the velocities of a Stokes problem takes 334 iterations in place of 222, GMRES breaks down. So W is filled by
//! the first loads then, and no direction is replaced.

use mpi::topology::SimpleCommunicator;

use crate::Result;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use parallel::exchange::{any, sum_all};
use petsc::Vec as PetscVec;

/// Tolerances above this one are loose.
pub(super) const LOOSE: f64 = 1e-7;

/// A direction is dropped if the others represent it up to this relative error.
const DEPENDENT: f64 = 1e-12;

/// The directions that are kept from load to load.
#[derive(Default)]
pub struct Recycle {
    most: usize,
    /// This rank's entries of the directions, by columns.
    w: Vec<Vec<f64>>,
    aw: Vec<Vec<f64>>,
    /// The active rows of this rank when the directions were computed.
    active: Vec<bool>,
    /// Wᵀ A W, factored.
    gram: Option<Semidefinite>,
    /// The direction that the next one replaces when the space is full.
    next: usize,
}

impl Recycle {
    /// Keeps at most `most` directions.
    pub fn new(most: usize) -> Recycle {
        Recycle {
            most,
            ..Recycle::default()
        }
    }

    /// Whether anything is to be kept.
    pub fn is_on(&self) -> bool {
        self.most > 0
    }

    /// Whether there are no directions.
    pub fn is_empty(&self) -> bool {
        self.w.is_empty()
    }

    /// Forgets all directions.
    pub fn forget(&mut self) {
        *self = Recycle {
            active: std::mem::take(&mut self.active),
            ..Recycle::new(self.most)
        };
    }

    /// Forgets the directions if they belong to other active rows; all ranks decide alike. Collective.
    pub fn fit(&mut self, comm: &SimpleCommunicator, active: &[bool]) {
        if !self.is_on() {
            return;
        }
        if any(comm, self.active != active) {
            *self = Recycle::new(self.most);
            self.active = active.to_vec();
        }
    }

    /// Keeps a direction x and its image A x. When the space is full, it `replaces` the oldest one or is dropped.
    pub fn keep(&mut self, x: &PetscVec, ax: &PetscVec, replaces: bool) -> Result<()> {
        if !self.is_on() {
            return Ok(());
        }
        let (x, ax) = (x.array()?.to_vec(), ax.array()?.to_vec());
        if self.w.len() < self.most {
            self.w.push(x);
            self.aw.push(ax);
        } else if !replaces {
            return Ok(());
        } else {
            (self.w[self.next], self.aw[self.next]) = (x, ax);
            self.next = (self.next + 1) % self.most;
        }
        self.gram = None;
        Ok(())
    }

    /// λ ← λ + x₀ and r ← r − A x₀. Collective.
    pub fn begin(
        &mut self,
        comm: &SimpleCommunicator,
        residual: &PetscVec,
        lambda: &PetscVec,
    ) -> Result<()> {
        if self.w.is_empty() {
            return Ok(());
        }
        let m = self.w.len();
        if self.gram.is_none() {
            let mut a = Dense::zeros(m, m);
            for j in 0..m {
                for i in j..m {
                    a.set(i, j, dot(&self.w[i], &self.aw[j]));
                }
            }
            sum_all(comm, &mut a.data);
            self.gram = Some(Semidefinite::above(&a, DEPENDENT));
        }
        let Some(gram) = &self.gram else {
            return Ok(());
        };
        let mut c: Vec<f64> = {
            let r = residual.array()?;
            self.w.iter().map(|w| dot(w, &r)).collect()
        };
        sum_all(comm, &mut c);
        gram.solve(&mut c);
        add(&self.w, &c, 1.0, &mut lambda.array_mut()?);
        add(&self.aw, &c, -1.0, &mut residual.array_mut()?);
        Ok(())
    }
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    base::linalg::dense::dot(x, y)
}

fn add(columns: &[Vec<f64>], c: &[f64], factor: f64, y: &mut [f64]) {
    for (column, c) in columns.iter().zip(c) {
        for (y, v) in y.iter_mut().zip(column) {
            *y += factor * c * v;
        }
    }
}
