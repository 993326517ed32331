//! λ with its displacements and the remaining jumps.
//!
//! ```text
//!     y = S̃⁺(g − Bᵀ λ),      r = B y − C λ − c            C: compliance of the rows, zero as a rule
//! ```

use super::loads::Loads;
use crate::feti::jump::turn::Turn;
use crate::feti::operators::dual::Dual;
use crate::feti::operators::work::InterfaceBuffers;
use crate::Result;
use parallel::exchange::{highest, total};
use petsc::Vec as PetscVec;

/// A residual below this fraction of the displacements it was formed from is rounding; there is nothing left to iterate
/// on.
pub const ROUNDING: f64 = 1e-14;

/// The displacements of a λ and the remaining jumps.
pub struct Residual {
    /// y = S̃⁺(g − Bᵀ λ) on every local subdomain.
    pub work: Vec<InterfaceBuffers>,
    /// B y − C λ − c on the rows that hold, zero on the others.
    pub r: PetscVec,
    /// ‖y‖₂ over all ranks.
    pub size: f64,
}

impl Residual {
    /// Allocates the vectors.
    pub fn new(dual: &Dual) -> Result<Residual> {
        Ok(Residual {
            work: dual.stiffness.work(),
            r: dual.multipliers()?,
            size: 0.0,
        })
    }

    /// Computes y and r for `lambda`. Collective.
    pub fn evaluate(&mut self, dual: &Dual, loads: &Loads, lambda: &PetscVec) -> Result<()> {
        let _event = dual.timed_residual()?;
        let stiffness = &dual.stiffness;
        let mut ghost = vec![0.0; stiffness.jump.ghosts.len()];
        stiffness.dual_halo.fetch(lambda, &mut ghost)?;
        let columns = &stiffness.jump.columns;
        stiffness.team.for_each(&mut self.work, |j, w| {
            columns.of(j).b_transpose(&ghost, &mut w.v); /*   v ← Bᵀ λ          */
            for (v, g) in w.v.iter_mut().zip(&loads.g[j]) {
                *v = g - *v; /*                               v ← g − v         */
            }
        });
        stiffness.s_plus(&mut self.work)?; /*                 y ← S̃⁺ v          */
        stiffness.jump_of(&self.work, &self.r)?; /*           r ← B y − C λ − c */
        stiffness.add_compliance(-1.0, lambda, &self.r)?;
        {
            let jump = &stiffness.jump;
            let c = loads.jumps.as_ref().unwrap_or(&jump.held);
            let mut r = self.r.array_mut()?;
            for (r, (c, on)) in r.iter_mut().zip(c.iter().zip(&jump.active)) {
                *r -= if *on { *c } else { 0.0 };
            }
        }
        let square = self.work.iter().flat_map(|w| &w.y).map(|y| y * y).sum();
        self.size = total(dual.comm(), square).sqrt();
        Ok(())
    }

    /// Largest |y| on this rank.
    pub fn largest(&self) -> f64 {
        let y = self.work.iter().flat_map(|w| &w.y);
        y.fold(0.0, |a, y| a.max(y.abs()))
    }

    /// Largest |y| over all ranks. Collective.
    pub fn length(&self, dual: &Dual) -> f64 {
        highest(dual.comm(), self.largest())
    }

    /// y ← y + R α for given α.
    pub fn shift(&mut self, dual: &Dual, alpha: &[f64]) {
        for (j, w) in self.work.iter_mut().enumerate() {
            dual.natural.add_kernel(j, alpha, &mut w.y);
        }
    }

    /// y ← y + R α with the rigid motions α that close the jumps of the holding rows as far as possible. Collective.
    pub fn add_rigid_motion(&mut self, dual: &Dual) -> Result<()> {
        let alpha = dual.natural.alpha(dual.comm(), &self.r)?;
        self.shift(dual, &alpha); /*                          y ← y + R α       */
        Ok(())
    }
}

/// The multipliers λ during the solution for one load.
pub struct Iterate {
    /// The load.
    pub loads: Loads,
    /// λ.
    pub lambda: PetscVec,
    /// Displacements and jumps. The last call says whether they belong to the present λ.
    pub residual: Residual,
}

impl Iterate {
    /// λ = 0 for these loads.
    pub fn new(dual: &Dual, loads: Loads) -> Result<Iterate> {
        Ok(Iterate {
            loads,
            lambda: dual.multipliers()?,
            residual: Residual::new(dual)?,
        })
    }

    /// Turns λ along with rows.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn turn(&self, turns: &[Turn]) -> Result<()> {
        let mut lambda = self.lambda.array_mut()?;
        for turn in turns {
            let [a, b] = turn.rows;
            [lambda[a], lambda[b]] = turn.of([lambda[a], lambda[b]]);
        }
        Ok(())
    }

    /// λ ← λ + Q G (Gᵀ Q G)⁻¹ (e − Gᵀ λ): balances the forces on every floating body. From λ = 0 the result is λ₀.
    /// Collective.
    pub fn balance(&self, dual: &Dual) -> Result<()> {
        let load = &self.loads.kernel;
        dual.natural.balance(dual.comm(), load, &self.lambda)
    }

    /// λ ← λ + Q G (Gᵀ Q G)⁻¹ (e − Gᵀ λ), to begin an iteration with: balances the forces on every floating body by no
    /// forces that the iteration would have to take back. Collective.
    pub fn begin(&self, dual: &Dual) -> Result<()> {
        let load = &self.loads.kernel;
        dual.natural.begin(dual.comm(), load, &self.lambda)
    }

    /// Computes y and r of λ. Collective.
    pub fn evaluate(&mut self, dual: &Dual) -> Result<()> {
        self.residual.evaluate(dual, &self.loads, &self.lambda)
    }

    /// Computes y of λ and Pᵀ r; returns the norm of Pᵀ r. Collective.
    pub fn evaluate_projected(&mut self, dual: &Dual) -> Result<f64> {
        self.evaluate(dual)?;
        dual.p_transpose(&self.residual.r)?;
        self.residual.r.norm2()
    }

    /// Computes y of λ with the rigid motions that close the jumps, and r without these motions. Collective.
    pub fn place(&mut self, dual: &Dual) -> Result<()> {
        self.evaluate(dual)?;
        self.residual.add_rigid_motion(dual)
    }
}
