//! MPRGP: modified proportioning with reduced gradient projections, for min ½ xᵀA x − bᵀx over half-lines x ≥ l (Dostál
//! 2009, chapter 5) and discs (Dostál and Kozubek 2012), with a preconditioner in the free face.
//!
//! Conjugate gradients run inside a face. They end if the next step would leave the feasible set, and an expansion step
//! follows (gradient projection with a fixed length). They also end if the gradient says that the face is wrong, and a
//! proportioning step leaves the face, or goes along the edges of discs.
//!
//! Half-lines leave along β, as far as the function falls. With discs the entries that are not free take a projected
//! step d = Π(x − τ g) − x: on an edge it has the curvature of the edge in it. By the projection gᵀd ≤ −‖d‖²/τ, so that
//! the function falls for κ τ < 2 with the curvature κ = dᵀA d/‖d‖² along d. This is so for τ = ᾱ < 2/‖A‖, as in the
//! proof, and mostly for the far longer τ = 1/κ with κ of the last step (Barzilai and Borwein 1988), which is tried.

use mpi::topology::SimpleCommunicator;

use super::feasible_set::FeasibleSet;
use super::tuning::Tuning;
use crate::Result;
use parallel::exchange::{any, lowest, total};

/// Projected steps of length τ are short enough if the curvature is at most this over τ.
const SHORT: f64 = 1.9;

/// The quadratic function; vectors are this rank's part.
pub trait BoundedQuadratic {
    /// y ← A x.
    fn apply(&mut self, x: &[f64], y: &mut [f64]) -> Result<()>;
    /// Enters a face: `free` marks the entries that may move.
    fn enter(&mut self, free: &[bool]) -> Result<()>;
    /// z ← an approximation of A⁻¹ v inside the face that was entered last; v and z vanish outside the face.
    fn precondition(&mut self, v: &[f64], z: &mut [f64]) -> Result<()>;
}

/// The ranks, the feasible set and the step length: data that do not change.
pub struct Setting<'a> {
    /// The ranks.
    pub comm: &'a SimpleCommunicator,
    /// Ω.
    pub set: &'a FeasibleSet,
    /// ᾱ: length of the expansion step, at most 2/‖A‖.
    pub length: f64,
    /// Γ, and which curvature is none.
    pub tuning: &'a Tuning,
}

/// The result of a run.
pub struct MprgpResult {
    /// The minimiser so far.
    pub x: Vec<f64>,
    /// A x − b.
    pub g: Vec<f64>,
    /// Products with A.
    pub products: usize,
}

impl MprgpResult {
    /// x ← x − t p inside the set, and the gradient with it; `ap` is A p.
    fn go(&mut self, set: &FeasibleSet, p: &[f64], ap: &[f64], t: f64) {
        set.go(&mut self.x, p, t);
        let rows = self.g.iter_mut().zip(ap);
        rows.for_each(|(g, ap)| *g -= t * ap);
    }
}

impl Setting<'_> {
    fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        total(self.comm, a.iter().zip(b).map(|(a, b)| a * b).sum())
    }

    /// Norm of the projected gradient.
    pub fn projected_gradient(&self, x: &[f64], g: &[f64]) -> f64 {
        let [phi, beta] = self.set.split(x, g, self.length);
        (self.dot(&phi, &phi) + self.dot(&beta, &beta)).sqrt()
    }

    /// Minimises from `x` until `stop(x, ‖gᴾ‖)` is true or `max` products are spent. Collective.
    pub fn minimise(
        &self,
        a: &mut dyn BoundedQuadratic,
        b: &[f64],
        x: Vec<f64>,
        stop: &mut dyn FnMut(&[f64], f64) -> bool,
        max: usize,
    ) -> Result<MprgpResult> {
        let (gamma, flatness) = (self.tuning.gamma, self.tuning.flat);
        let (set, length, n) = (self.set, self.length, x.len());
        let has_discs = any(self.comm, !set.discs.is_empty());
        let mut tau = length;
        let mut run = MprgpResult {
            x,
            g: vec![0.0; n],
            products: 1,
        };
        let residual = |a: &mut dyn BoundedQuadratic, x: &[f64], g: &mut Vec<f64>| -> Result<()> {
            a.apply(x, g)?;
            g.iter_mut().zip(b).for_each(|(g, b)| *g -= b);
            Ok(())
        };
        residual(a, &run.x, &mut run.g)?;
        let (mut ap, mut z) = (vec![0.0; n], vec![0.0; n]);
        let [mut phi, mut beta] = set.split(&run.x, &run.g, length);
        let mut p = self.restart(a, &run.x, &phi, &mut z)?;
        while run.products < max {
            let gradient = (self.dot(&phi, &phi) + self.dot(&beta, &beta)).sqrt();
            if gradient == 0.0 || stop(&run.x, gradient) {
                break;
            }
            let reduced = set.reduced(&run.x, &phi, length);
            if self.dot(&beta, &beta) <= gamma * gamma * self.dot(&reduced, &phi) {
                a.apply(&p, &mut ap)?;
                run.products += 1;
                let (curvature, along) = (self.dot(&p, &ap), self.dot(&run.g, &p));
                let (pp, gg) = (self.dot(&p, &p), self.dot(&run.g, &run.g));
                // Dependent rows have directions without curvature. Their computed curvature is rounding and must not
                // set the step: x goes to a bound along such a direction if that lowers the function, and does not move
                // otherwise.
                let flat = curvature <= flatness * pp / length;
                if flat && along <= flatness.sqrt() * (pp * gg).sqrt() {
                    break;
                }
                let wish = along / curvature;
                let room = lowest(self.comm, set.room(&run.x, &p));
                let inside = !flat && wish <= room;
                let step = if inside { wish } else { room };
                if !step.is_finite() {
                    break;
                }
                run.go(set, &p, &ap, step);
                if inside {
                    [phi, beta] = set.split(&run.x, &run.g, length);
                    a.precondition(&phi, &mut z)?;
                    let along = self.dot(&z, &ap) / curvature;
                    p.iter_mut().zip(&z).for_each(|(p, z)| *p = z - along * *p);
                } else {
                    let [phi_half, _] = set.split(&run.x, &run.g, length);
                    set.project(&mut run.x, &phi_half, length);
                    residual(a, &run.x, &mut run.g)?;
                    run.products += 1;
                    [phi, beta] = set.split(&run.x, &run.g, length);
                    p = self.restart(a, &run.x, &phi, &mut z)?;
                }
            } else if has_discs {
                let Some(next) = self.project(a, &mut run, tau)? else {
                    break;
                };
                tau = next;
                [phi, beta] = set.split(&run.x, &run.g, length);
                p = self.restart(a, &run.x, &phi, &mut z)?;
            } else {
                a.apply(&beta, &mut ap)?;
                run.products += 1;
                let step = self.dot(&run.g, &beta) / self.dot(&beta, &ap);
                run.go(set, &beta, &ap, step);
                [phi, beta] = set.split(&run.x, &run.g, length);
                p = self.restart(a, &run.x, &phi, &mut z)?;
            }
        }
        Ok(run)
    }

    /// A projected step of the entries that are not free, of length `tau` or shorter. Returns the length of the next
    /// one; `None` where no entry moves by more than rounding. Collective.
    fn project(
        &self,
        a: &mut dyn BoundedQuadratic,
        run: &mut MprgpResult,
        mut tau: f64,
    ) -> Result<Option<f64>> {
        let free = self.set.free(&run.x);
        let outside = |(g, free): (&f64, &bool)| if *free { 0.0 } else { *g };
        let g: Vec<f64> = run.g.iter().zip(&free).map(outside).collect();
        let mut image = vec![0.0; g.len()];
        loop {
            let mut to = run.x.clone();
            self.set.project(&mut to, &g, tau);
            let d: Vec<f64> = to.iter().zip(&run.x).map(|(to, x)| to - x).collect();
            let square = self.dot(&d, &d);
            if square == 0.0 {
                return Ok(None);
            }
            a.apply(&d, &mut image)?;
            run.products += 1;
            let curvature = self.dot(&d, &image) / square;
            let longest = self.tuning.friction.longer * self.length;
            if curvature * tau > SHORT && tau > self.length {
                tau = (1.0 / curvature).max(self.length);
                continue;
            }
            run.x = to;
            run.g.iter_mut().zip(&image).for_each(|(g, a)| *g += a);
            return Ok(Some(match curvature > 0.0 {
                true => longest.min(1.0 / curvature),
                false => longest,
            }));
        }
    }

    /// The first direction in a face.
    fn restart(
        &self,
        a: &mut dyn BoundedQuadratic,
        x: &[f64],
        phi: &[f64],
        z: &mut [f64],
    ) -> Result<Vec<f64>> {
        a.enter(&self.set.free(x))?;
        a.precondition(phi, z)?;
        Ok(z.to_vec())
    }
}

#[cfg(test)]
#[path = "../../tests/inside/contact/mprgp.rs"]
mod tests;
