//! MPRGP: modified proportioning with reduced gradient projections, for min ½ xᵀA x − bᵀx with x ≥ l (Dostál 2009,
//! chapter 5), with a preconditioner in the free face.
//!
//! Conjugate gradients run inside a face. They end if the next step would leave the feasible set, and an expansion step
//! follows (gradient projection with a fixed length). They also end if the gradient says that the face is wrong, and a
//! proportioning step leaves the face.

use mpi::topology::SimpleCommunicator;

use super::tuning::Tuning;
use crate::Result;
use parallel::exchange::{lowest, total};

/// The quadratic function and its bounds; vectors are this rank's part.
pub trait BoundedQuadratic {
    /// y ← A x.
    fn apply(&mut self, x: &[f64], y: &mut [f64]) -> Result<()>;
    /// Enters a face: `free` marks the entries that may move.
    fn enter(&mut self, free: &[bool]) -> Result<()>;
    /// z ← an approximation of A⁻¹ v inside the face that was entered last; v and z vanish outside the face.
    fn precondition(&mut self, v: &[f64], z: &mut [f64]) -> Result<()>;
}

/// The ranks, the bounds and the step length: data that do not change.
pub struct Setting<'a> {
    /// The ranks.
    pub comm: &'a SimpleCommunicator,
    /// l: −∞ for entries without a bound.
    pub lower: &'a [f64],
    /// Entries that do not change.
    pub fixed: &'a [bool],
    /// Length of the expansion step, at most 2/‖A‖.
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

impl Setting<'_> {
    fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        total(self.comm, a.iter().zip(b).map(|(a, b)| a * b).sum())
    }

    fn free(&self, x: &[f64]) -> Vec<bool> {
        let rows = x.iter().zip(self.lower).zip(self.fixed);
        rows.map(|((x, l), fixed)| !fixed && x > l).collect()
    }

    /// Free and chopped gradient: the gradient at free entries, and its part that points into the feasible set at the
    /// other entries.
    fn split(&self, x: &[f64], g: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let free = self.free(x);
        let part = |keep: &dyn Fn(usize) -> f64| (0..g.len()).map(keep).collect::<Vec<f64>>();
        let phi = part(&|i| if free[i] { g[i] } else { 0.0 });
        let beta = part(&|i| {
            if free[i] || self.fixed[i] {
                0.0
            } else {
                g[i].min(0.0)
            }
        });
        (phi, beta)
    }

    /// Norm of the projected gradient.
    pub fn projected_gradient(&self, x: &[f64], g: &[f64]) -> f64 {
        let (phi, beta) = self.split(x, g);
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
        let n = x.len();
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
        let (mut phi, mut beta) = self.split(&run.x, &run.g);
        let mut p = self.restart(a, &run.x, &phi, &mut z)?;
        while run.products < max {
            let gradient = (self.dot(&phi, &phi) + self.dot(&beta, &beta)).sqrt();
            if gradient == 0.0 || stop(&run.x, gradient) {
                break;
            }
            let reduced: Vec<f64> = (0..n)
                .map(|i| ((run.x[i] - self.lower[i]) / self.length).min(phi[i]))
                .collect();
            if self.dot(&beta, &beta) <= gamma * gamma * self.dot(&reduced, &phi) {
                a.apply(&p, &mut ap)?;
                run.products += 1;
                let (curvature, along) = (self.dot(&p, &ap), self.dot(&run.g, &p));
                let (pp, gg) = (self.dot(&p, &p), self.dot(&run.g, &run.g));
                // Dependent rows have directions without curvature. Their computed curvature is rounding and must not
                // set the step: x goes to a bound along such a direction if that lowers the function, and does not move
                // otherwise.
                let flat = curvature <= flatness * pp / self.length;
                if flat && along <= flatness.sqrt() * (pp * gg).sqrt() {
                    break;
                }
                let wish = along / curvature;
                let bounded = (0..n).filter(|&i| p[i] > 0.0);
                let room = bounded.map(|i| (run.x[i] - self.lower[i]) / p[i]);
                let room = lowest(self.comm, room.fold(f64::INFINITY, f64::min));
                let inside = !flat && wish <= room;
                let step = if inside { wish } else { room };
                if !step.is_finite() {
                    break;
                }
                for i in 0..n {
                    // An entry that the step takes to its bound is set to the bound exactly.
                    let reach = p[i] > 0.0 && (run.x[i] - self.lower[i]) <= step * p[i];
                    run.x[i] -= step * p[i];
                    run.g[i] -= step * ap[i];
                    run.x[i] = if reach { self.lower[i] } else { run.x[i] };
                }
                if inside {
                    (phi, beta) = self.split(&run.x, &run.g);
                    a.precondition(&phi, &mut z)?;
                    let along = self.dot(&z, &ap) / curvature;
                    p.iter_mut().zip(&z).for_each(|(p, z)| *p = z - along * *p);
                } else {
                    let (phi_half, _) = self.split(&run.x, &run.g);
                    for i in (0..n).filter(|&i| !self.fixed[i]) {
                        run.x[i] = (run.x[i] - self.length * phi_half[i]).max(self.lower[i]);
                    }
                    residual(a, &run.x, &mut run.g)?;
                    run.products += 1;
                    (phi, beta) = self.split(&run.x, &run.g);
                    p = self.restart(a, &run.x, &phi, &mut z)?;
                }
            } else {
                a.apply(&beta, &mut ap)?;
                run.products += 1;
                let step = self.dot(&run.g, &beta) / self.dot(&beta, &ap);
                for i in 0..n {
                    run.x[i] -= step * beta[i];
                    run.g[i] -= step * ap[i];
                }
                (phi, beta) = self.split(&run.x, &run.g);
                p = self.restart(a, &run.x, &phi, &mut z)?;
            }
        }
        Ok(run)
    }

    /// The first direction in a face.
    fn restart(
        &self,
        a: &mut dyn BoundedQuadratic,
        x: &[f64],
        phi: &[f64],
        z: &mut [f64],
    ) -> Result<Vec<f64>> {
        a.enter(&self.free(x))?;
        a.precondition(phi, z)?;
        Ok(z.to_vec())
    }
}

#[cfg(test)]
#[path = "../../tests/inside/contact/mprgp.rs"]
mod tests;
