//! The line search of a Newton step on the augmented Lagrangian, from φ along the step.
//!
//! ```text
//!     φ(u) = ½ uᵀK u − fᵀu + ½ Σ_j C_j (s_j)₊²,           s_j = μ_j + (B u − c)_j / C_j
//! ```
//!
//! Nodes with friction add the terms of their discs ([`Disc`]).
//!
//! Displacements of the loop satisfy K u = f − Bᵀλ with some multipliers λ, between two of them both are interpolated,
//! and along the segment
//!
//! ```text
//!     φ'(t) = Σ_j (B du)_j ((s_j(t))₊ − λ_j(t))
//! ```
//!
//! needs gaps and multipliers of the rows only. φ is convex, φ' piecewise linear.

use mpi::topology::SimpleCommunicator;

use super::anchors::Anchors;
use super::disc::Disc;
use super::piecewise_quadratic::line_minimum;
use super::tuning::Tuning;
use crate::substructures::Law;
use parallel::exchange::sum_all;

/// Displacements as the rows see them, one entry for each owned row.
#[derive(Debug, Clone, PartialEq)]
pub struct LineSearchPoint {
    /// B u − c.
    pub gap: Vec<f64>,
    /// λ with K u = f − Bᵀλ, less the forces of anchors.
    pub force: Vec<f64>,
    /// α and y = e − Gᵀλ where there are anchors ([`Anchors`]); else empty.
    pub motion: [Vec<f64>; 2],
}

impl LineSearchPoint {
    /// The point at `t` on the way to `end`.
    pub fn towards(&self, end: &LineSearchPoint, t: f64) -> LineSearchPoint {
        let between = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| a + t * (b - a)).collect()
        };
        LineSearchPoint {
            gap: between(&self.gap, &end.gap),
            force: between(&self.force, &end.force),
            motion: [0, 1].map(|i| between(&self.motion[i], &end.motion[i])),
        }
    }
}

/// The penalty terms of φ, one entry for each owned row.
pub struct Penalty<'a> {
    /// The law of the row; equations do not count.
    pub law: &'a [Law],
    /// μ.
    pub multiplier: &'a [f64],
    /// C.
    pub compliance: &'a [f64],
    /// Nodes with friction, and the bounds of their forces.
    pub discs: &'a [Disc],
    /// The anchors of bodies, if there are any.
    pub anchors: Option<&'a Anchors>,
    /// How exact the length of a step is.
    pub tuning: &'a Tuning,
}

impl Penalty<'_> {
    /// The rows that count.
    fn inequalities(&self) -> impl Iterator<Item = (usize, Law)> + '_ {
        let rows = self.law.iter().copied().enumerate();
        rows.filter(|(_, law)| law.is_inequality())
    }

    /// s at a point; zero for rows that do not count.
    pub fn pull(&self, at: &LineSearchPoint) -> Vec<f64> {
        let of = |i: usize| self.multiplier[i] + at.gap[i] / self.compliance[i];
        let mut out = vec![0.0; at.gap.len()];
        for (i, _) in self.inequalities() {
            out[i] = of(i);
        }
        for &i in self.discs.iter().flat_map(|d| &d.rows) {
            out[i] = of(i);
        }
        out
    }

    /// The forces of a pull s: those that rows bear, and projections onto discs.
    pub fn forces(&self, pull: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; pull.len()];
        for (i, law) in self.inequalities() {
            out[i] = law.project(pull[i]);
        }
        for disc in self.discs {
            let force = disc.project(disc.of(pull));
            disc.rows.iter().zip(force).for_each(|(&i, f)| out[i] = f);
        }
        out
    }

    /// At `t` on the way from one point to another: the change of w along all of it, s, the forces λ, and their change
    /// along all of it.
    fn on_disc(&self, disc: &Disc, [from, to]: [&LineSearchPoint; 2], t: f64) -> [[f64; 2]; 4] {
        let mut out = [[0.0; 2]; 4];
        for (k, &i) in disc.rows.iter().enumerate() {
            let (gap, force) = (to.gap[i] - from.gap[i], to.force[i] - from.force[i]);
            out[0][k] = gap;
            out[1][k] = self.multiplier[i] + (from.gap[i] + t * gap) / self.compliance[i];
            out[2][k] = from.force[i] + t * force;
            out[3][k] = force;
        }
        out
    }

    /// φ'(t) and φ''(t) on the way from one point to another. Collective.
    fn slope(
        &self,
        comm: &SimpleCommunicator,
        from: &LineSearchPoint,
        to: &LineSearchPoint,
        t: f64,
    ) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (i, law) in self.inequalities() {
            let (gap, force) = (to.gap[i] - from.gap[i], to.force[i] - from.force[i]);
            let s = self.multiplier[i] + (from.gap[i] + t * gap) / self.compliance[i];
            sums[0] += gap * (law.project(s) - (from.force[i] + t * force));
            sums[1] += gap * (f64::from(u8::from(law.bears(s))) * gap / self.compliance[i] - force);
        }
        for disc in self.discs {
            let [gap, s, now, force] = self.on_disc(disc, [from, to], t);
            let given = disc.project(s);
            let change = disc.derivative(s, gap.map(|w| w / self.compliance[disc.rows[0]]));
            for k in 0..2 {
                sums[0] += gap[k] * (given[k] - now[k]);
                sums[1] += gap[k] * (change[k] - force[k]);
            }
        }
        sum_all(comm, &mut sums);
        let [a, b] = self.slope_of_anchors(comm, from, to, t);
        [sums[0] + a, sums[1] + b]
    }

    fn slope_of_anchors(
        &self,
        comm: &SimpleCommunicator,
        from: &LineSearchPoint,
        to: &LineSearchPoint,
        t: f64,
    ) -> [f64; 2] {
        let ends = [&from.motion, &to.motion];
        let slope = |anchors: &Anchors| anchors.slope(comm, ends, t);
        self.anchors.map_or([0.0; 2], slope)
    }

    /// φ at t on the way from one point to another, minus φ at its beginning. Collective.
    pub fn change(
        &self,
        comm: &SimpleCommunicator,
        [from, to]: [&LineSearchPoint; 2],
        t: f64,
    ) -> f64 {
        let mut sum = [0.0];
        for (i, law) in self.inequalities() {
            let (gap, force) = (to.gap[i] - from.gap[i], to.force[i] - from.force[i]);
            let (mu, c) = (self.multiplier[i], self.compliance[i]);
            let [was, is] = [0.0, t].map(|t| law.project(mu + (from.gap[i] + t * gap) / c));
            sum[0] += 0.5 * c * (is - was) * (is + was);
            sum[0] -= t * gap * (from.force[i] + 0.5 * t * force);
        }
        for disc in self.discs {
            let [_, was, now, _] = self.on_disc(disc, [from, to], 0.0);
            let [gap, is, _, force] = self.on_disc(disc, [from, to], t);
            sum[0] += self.compliance[disc.rows[0]] * (disc.value(is) - disc.value(was));
            for k in 0..2 {
                sum[0] -= t * gap[k] * (now[k] + 0.5 * t * force[k]);
            }
        }
        sum_all(comm, &mut sum);
        // It is a parabola along the way.
        let [slope, curvature] = self.slope_of_anchors(comm, from, to, 0.0);
        sum[0] + t * (slope + 0.5 * t * curvature)
    }

    /// How far to go from one point to another; `None` if φ does not fall. With `beyond` this is the t in (0, ∞) that
    /// minimises φ. Else it is the first of 1, ½, ¼, … at which φ falls by [`Tuning::line_enough`] of what the minimum
    /// in (0, 1] has: the minimum lies at a kink, where rows neither hold nor leave, and Newton steps from kink to kink
    /// are short. Collective.
    pub fn length(
        &self,
        comm: &SimpleCommunicator,
        ends: [&LineSearchPoint; 2],
        beyond: bool,
    ) -> Option<f64> {
        let least = self.minimum(comm, ends, beyond)?;
        if beyond {
            return Some(least);
        }
        let fall = self.change(comm, ends, least);
        let mut t = 1.0;
        while t > least && self.change(comm, ends, t) > self.tuning.line_enough * fall {
            t *= 0.5;
        }
        Some(f64::max(t, least))
    }

    /// The t in (0, 1], or in (0, ∞), that minimises φ. Collective.
    fn minimum(
        &self,
        comm: &SimpleCommunicator,
        [from, to]: [&LineSearchPoint; 2],
        beyond: bool,
    ) -> Option<f64> {
        line_minimum(|t| self.slope(comm, from, to, t), beyond, self.tuning)
    }
}

#[cfg(test)]
#[path = "../../tests/inside/contact/line_search.rs"]
mod tests;
