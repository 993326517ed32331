//! Iterative refinement with residuals in twice the working precision.
//!
//! ```text
//!     r = Tᵀ (f − K u) in twice the precision,   Tᵀ K T d = r,   v ← v + d,   u = T v + u₀
//! ```
//!
//! A few rounds remove the error that a factor in working precision leaves in u: then u is the solution of the
//! assembled problem, rounded once.

use super::groups::ActiveGroups;
use super::system::AssembledSystem;
use super::unknowns::Trace;
use base::linalg::twice::Twice;
use base::Result;
use petsc::{Ksp, PetscInt, Scatter, Session, Vec as PetscVec};

/// Maximal number of rounds.
const ROUNDS: usize = 60;

/// A correction below this is rounding.
const ROUNDING: f64 = 1e-13;

/// A round has gained nothing unless it brings the correction below this part of the smallest one so far.
const GAIN: f64 = 0.5;

/// The data for products with K in twice the precision.
pub struct Refiner<'a> {
    session: Session,
    system: &'a AssembledSystem,
    trace: &'a Trace,
    /// Columns of this rank's rows that other ranks own, increasing, and the plan that communicates u there.
    ghosts: Vec<PetscInt>,
    scatter: Scatter,
    near: PetscVec,
}

/// The result of a refinement.
pub struct Refined {
    /// ‖r‖₂ of the last round.
    pub residual: f64,
    /// The last correction relative to the solution, in the energy norm or by the largest entry, whichever is larger.
    pub correction: f64,
    /// Number of rounds.
    pub rounds: usize,
    /// PETSc's name for the reason why the last solve ended, and whether it failed.
    pub reason: (String, bool),
}

impl<'a> Refiner<'a> {
    /// Prepares refinement for an assembled system; `trace` gives access to its unknowns in rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(
        session: &Session,
        system: &'a AssembledSystem,
        trace: &'a Trace,
    ) -> Result<Refiner<'a>> {
        let range = system.a.ownership_range()?;
        let mut ghosts: Vec<PetscInt> = Vec::new();
        for row in range.clone() {
            let cols = system.a.row(row)?.0;
            ghosts.extend(cols.iter().filter(|&&c| !range.contains(&(c as usize))));
        }
        ghosts.sort_unstable();
        ghosts.dedup();
        let near = PetscVec::seq(session, ghosts.len())?;
        Ok(Refiner {
            session: session.clone(),
            system,
            trace,
            scatter: Scatter::new(&system.b, &ghosts, &near)?,
            ghosts,
            near,
        })
    }

    /// f − K u at the entries of this rank. Collective.
    fn residual(&self, u: &PetscVec) -> Result<Vec<Twice>> {
        self.scatter.forward(u, &self.near)?;
        let (own, near, f) = (u.array()?, self.near.array()?, self.system.b.array()?);
        let range = self.system.a.ownership_range()?;
        let mut out = Vec::with_capacity(range.len());
        for row in range.clone() {
            let (cols, vals) = self.system.a.row(row)?;
            let mut sum = Twice::default();
            sum.add(f[row - range.start]);
            for (&c, &v) in cols.iter().zip(&vals) {
                let u = if range.contains(&(c as usize)) {
                    own[c as usize - range.start]
                } else {
                    near[self.ghosts.binary_search(&c).expect("columns were listed")]
                };
                sum.add_product(-v, u);
            }
            out.push(sum);
        }
        Ok(out)
    }

    /// Sets r to the residual, rounded, and returns its high and low halves at the unknowns in rows. Collective.
    fn halves(&self, u: &PetscVec, r: &PetscVec) -> Result<[Vec<f64>; 2]> {
        let sums = self.residual(u)?;
        let half = |part: fn(&Twice) -> f64| -> Result<Vec<f64>> {
            for (r, sum) in r.array_mut()?.iter_mut().zip(&sums) {
                *r = part(sum);
            }
            self.trace.get(self.session.comm(), r)
        };
        let halves = [half(|s| s.high)?, half(|s| s.low)?];
        for (r, sum) in r.array_mut()?.iter_mut().zip(&sums) {
            *r = sum.value();
        }
        Ok(halves)
    }

    /// f − K u at the unknowns in rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn forces(&self, u: &PetscVec) -> Result<Vec<f64>> {
        let [high, low] = self.halves(u, &u.duplicate()?)?;
        Ok(high.iter().zip(&low).map(|(h, l)| h + l).collect())
    }

    /// Refines v; `ksp` solves with Tᵀ K T, and `exerted` are forces at the unknowns in rows, from w there. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn refine(
        &self,
        groups: &ActiveGroups,
        ksp: &Ksp,
        v: &PetscVec,
        exerted: &dyn Fn(&[f64]) -> Vec<f64>,
    ) -> Result<Refined> {
        let (u, r, d) = (v.duplicate()?, v.duplicate()?, v.duplicate()?);
        let mut out = Refined {
            residual: 0.0,
            correction: f64::INFINITY,
            rounds: 0,
            reason: (String::new(), false),
        };
        let (mut least, mut idle) = (f64::INFINITY, 0);
        while out.rounds < ROUNDS {
            self.trace.spread(self.session.comm(), groups, v, &u)?;
            let [mut high, low] = self.halves(&u, &r)?;
            let at = self.trace.get(self.session.comm(), &u)?;
            high.iter_mut().zip(exerted(&at)).for_each(|(h, y)| *h -= y);
            // The forces on the two ends of a row cancel: their high and low halves are summed separately.
            let [high, low] = [groups.fold(&high), groups.fold(&low)];
            let both: Vec<f64> = high.iter().zip(&low).map(|(h, l)| h + l).collect();
            self.trace.set(&r, &both)?;
            out.residual = r.norm2()?;
            ksp.solve(&r, &d)?;
            out.rounds += 1;
            let why = ksp.converged_reason()?;
            out.reason = (why.name.clone(), !why.converged());
            if out.reason.1 {
                break;
            }
            v.axpy(1.0, &d)?;
            self.trace.spread(self.session.comm(), groups, v, &u)?;
            // rᵀ d is the energy of the correction.
            let energy = r.dot(&d)?.max(0.0).sqrt();
            let whole = self.system.energy_norm(&u)?;
            out.correction = over(energy, whole).max(over(d.norm_inf()?, u.norm_inf()?));
            if out.rounds > 1 && out.correction < ROUNDING {
                break;
            }
            idle = if out.correction > GAIN * least {
                idle + 1
            } else {
                0
            };
            if idle > 1 {
                break;
            }
            least = least.min(out.correction);
        }
        Ok(out)
    }
}

/// `x` relative to `size`; `x` itself where `size` is zero.
pub fn over(x: f64, size: f64) -> f64 {
    if size > 0.0 {
        x / size
    } else {
        x
    }
}
