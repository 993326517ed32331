//! The admissible multipliers of a bound-constrained problem: a product of half-lines and discs.
//!
//! ```text
//!     Ω = { x : x_i ≥ l_i,  |x_t + shift_t| ≤ r }        Π: the nearest point of Ω
//!     φ = g at free entries            free: inside its half-line or disc
//!     β = (x − Π(x − ᾱ g))/ᾱ at the others, the part of g that points into Ω
//! ```
//!
//! Everything is done part by part: the constraints are separable (Dostál and Kozubek 2012). In the plane discs are
//! intervals.

use super::disc::Disc;

/// The set; vectors are this rank's part.
#[derive(Debug, Clone)]
pub struct FeasibleSet {
    /// l: −∞ for entries without a bound.
    pub lower: Vec<f64>,
    /// Entries that do not change.
    pub fixed: Vec<bool>,
    /// The discs. Their entries have no other bound.
    pub discs: Vec<Disc>,
    /// A vector that is added to x before it is compared with the discs.
    pub shift: Vec<f64>,
}

/// An entry is on the edge of its disc up to this, relative to the radius and the shift.
const EDGE: f64 = 1e-12;

impl FeasibleSet {
    /// x + shift of a disc.
    fn inside(&self, disc: &Disc, x: &[f64]) -> [f64; 2] {
        let (x, shift) = (disc.of(x), disc.of(&self.shift));
        [x[0] + shift[0], x[1] + shift[1]]
    }

    /// Whether x is on the edge of a disc.
    fn on_edge(&self, disc: &Disc, x: &[f64]) -> bool {
        let size = |v: [f64; 2]| v[0].hypot(v[1]);
        let near = EDGE * (disc.radius + size(disc.of(&self.shift)));
        size(self.inside(disc, x)) >= disc.radius - near
    }

    /// Gives the entries of a disc the values for which x + shift is `y`.
    fn put(&self, disc: &Disc, y: [f64; 2], x: &mut [f64]) {
        for (&i, y) in disc.rows.iter().zip(y) {
            x[i] = y - self.shift[i];
        }
    }

    /// (x − Π(x − α v))/α of a disc.
    fn reduced_on(&self, disc: &Disc, x: &[f64], v: &[f64], alpha: f64) -> [f64; 2] {
        let (y, v) = (self.inside(disc, x), disc.of(v));
        let to = disc.project([0, 1].map(|k| y[k] - alpha * v[k]));
        match disc.radius {
            radius if radius.is_finite() => [0, 1].map(|k| (y[k] - to[k]) / alpha),
            _ => v,
        }
    }

    /// The entries that may move either way.
    pub fn free(&self, x: &[f64]) -> Vec<bool> {
        let rows = x.iter().zip(&self.lower).zip(&self.fixed);
        let mut free: Vec<bool> = rows.map(|((x, l), fixed)| !fixed && x > l).collect();
        for disc in self.discs.iter().filter(|disc| self.on_edge(disc, x)) {
            disc.rows.iter().for_each(|&i| free[i] = false);
        }
        free
    }

    /// φ and β; `alpha` is ᾱ.
    pub fn split(&self, x: &[f64], g: &[f64], alpha: f64) -> [Vec<f64>; 2] {
        let free = self.free(x);
        let part = |keep: &dyn Fn(usize) -> f64| (0..g.len()).map(keep).collect::<Vec<f64>>();
        let phi = part(&|i| if free[i] { g[i] } else { 0.0 });
        let mut beta = part(&|i| {
            if free[i] || self.fixed[i] {
                0.0
            } else {
                g[i].min(0.0)
            }
        });
        for disc in self.discs.iter().filter(|disc| !free[disc.rows[0]]) {
            let reduced = self.reduced_on(disc, x, g, alpha);
            let pairs = disc.rows.iter().zip(reduced);
            pairs.for_each(|(&i, v)| beta[i] = v);
        }
        [phi, beta]
    }

    /// (x − Π(x − α φ))/α for a free gradient φ.
    pub fn reduced(&self, x: &[f64], phi: &[f64], alpha: f64) -> Vec<f64> {
        let rows = x.iter().zip(&self.lower).zip(phi);
        let mut out: Vec<f64> = rows
            .map(|((x, l), phi)| ((x - l) / alpha).min(*phi))
            .collect();
        for disc in &self.discs {
            let reduced = self.reduced_on(disc, x, phi, alpha);
            let pairs = disc.rows.iter().zip(reduced);
            pairs.for_each(|(&i, v)| out[i] = v);
        }
        out
    }

    /// The largest t for which x − t p stays in the disc: the root of |y − t p|² = r².
    fn room_on(&self, disc: &Disc, x: &[f64], p: &[f64]) -> f64 {
        let (y, p) = (self.inside(disc, x), disc.of(p));
        let square = p[0] * p[0] + p[1] * p[1];
        if square == 0.0 {
            return f64::INFINITY;
        }
        let along = y[0] * p[0] + y[1] * p[1];
        let size = y[0].hypot(y[1]);
        let depth = (disc.radius - size).max(0.0) * (disc.radius + size);
        let root = (along * along + square * depth).sqrt();
        // Of a sum of different signs digits would be lost.
        match along {
            along if along < 0.0 => depth / (root - along),
            _ => (along + root) / square,
        }
    }

    /// The largest t for which x − t p stays in Ω; ∞ if there is none.
    pub fn room(&self, x: &[f64], p: &[f64]) -> f64 {
        let bounded = (0..x.len()).filter(|&i| p[i] > 0.0);
        let room = bounded.map(|i| (x[i] - self.lower[i]) / p[i]);
        let discs = self.discs.iter().map(|disc| self.room_on(disc, x, p));
        room.chain(discs).fold(f64::INFINITY, f64::min)
    }

    /// x ← x − t p. Entries that the step takes to their bounds are set to them exactly.
    pub fn go(&self, x: &mut [f64], p: &[f64], t: f64) {
        let rooms = self.discs.iter().map(|disc| self.room_on(disc, x, p));
        let rooms: Vec<f64> = rooms.collect();
        for (i, x) in x.iter_mut().enumerate() {
            let reach = p[i] > 0.0 && (*x - self.lower[i]) <= t * p[i];
            *x -= t * p[i];
            *x = if reach { self.lower[i] } else { *x };
        }
        for (disc, room) in self.discs.iter().zip(rooms) {
            let y = self.inside(disc, x);
            let size = y[0].hypot(y[1]);
            if room <= t && size > 0.0 {
                self.put(disc, y.map(|y| disc.radius * (y / size)), x);
            }
        }
    }

    /// x ← Π(x − α v).
    pub fn project(&self, x: &mut [f64], v: &[f64], alpha: f64) {
        let rows = x.iter_mut().zip(v).zip(self.lower.iter().zip(&self.fixed));
        for ((x, v), (l, _)) in rows.filter(|(_, (_, fixed))| !**fixed) {
            *x = (*x - alpha * v).max(*l);
        }
        self.enter_discs(x);
    }

    /// Moves x into the discs, to their nearest points.
    pub fn enter_discs(&self, x: &mut [f64]) {
        for disc in &self.discs {
            let y = self.inside(disc, x);
            if disc.direction(y).is_some() {
                self.put(disc, disc.project(y), x);
            }
        }
    }

    /// The nearest x of the set to that for which x + shift is `y`.
    pub fn nearest(&self, y: &[f64]) -> Vec<f64> {
        let rows = y.iter().zip(&self.shift).zip(&self.lower);
        let mut x: Vec<f64> = rows.map(|((y, s), l)| (y - s).max(*l)).collect();
        self.enter_discs(&mut x);
        x
    }
}

#[cfg(test)]
#[path = "../../tests/inside/contact/feasible_set.rs"]
mod tests;
