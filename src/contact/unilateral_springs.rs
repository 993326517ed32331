//! The balance of the load by rigid bodies on unilateral springs: whether the rows can carry the load at all, for many
//! rigid motions.
//!
//! ```text
//!     min_α  ½ Σ_I (g_iᵀα − c_i)₊² + ½ Σ_E (g_iᵀα − c_i)² + ½ ε ‖α − a‖²_D − eᵀα,        D = diag Gᵀ G
//! ```
//!
//! At the minimum λ_i = (g_iᵀα − c_i)₊ is a force that the rows can exert, and e − Gᵀλ = ε D (α − a) is what they
//! do not carry. The function is convex and piecewise quadratic: Newton's method with the sparse factor of
//! G_Aᵀ G_A + ε D ends after some steps. Then a ← α, which takes the rest to zero if the rows can carry the load. If
//! they cannot, α − a tends to a motion that all rows allow and the load drives.
//!
//! To the question whether the rows can carry the load neither the stiffness of the springs nor c matters: it is 1, and
//! c = −λ₊ for the λ of the loop that asks. Its springs carry at α = 0 what the loop has found, and a few Newton steps
//! take the rest from rows that pull to others.

use mpi::topology::SimpleCommunicator;

use super::line_minimum::line_minimum;
use crate::feti::jump::operator::Jump;
use crate::feti::projector::gram::Gram;
use crate::feti::projector::kernel_motion::KernelMotion;
use crate::feti::projector::natural::NaturalCoarse;
use parallel::exchange::{any, sum_all};

/// The last ε. Rounding of the factor is 1e-16, the softest motions of a thousand bodies in a row are 1e-6.
const WEAK: f64 = 1e-8;

/// ε of the first round relative to its last value, and its ratio from round to round. Newton's directions are long
/// where rows let a body loose, and steps short. A large ε first keeps bodies near each other: 8³ blocks take 42 Newton
/// steps, not 48, a wall of 954 bricks 27, and the sets are nearly right after two rounds. From forces of the loop the
/// last ε is right at once: 20³ blocks of one element take 8 steps, with a first ε of 1e4 times the last 19.
const FIRST: f64 = 1e8;
const FALL: f64 = 1e-2;

/// Largest number of times that a follows α.
const ROUNDS: usize = 10;

/// Largest number of Newton steps in each.
const STEPS: usize = 60;

/// A row stands against a motion if its work is above this, relative to the largest that it could be.
const AGAINST: f64 = 1e-6;

/// The part of `e` that the rows cannot carry: none if it is below `enough` everywhere. `None` if this is not decided.
/// `lambda` has forces on the owned rows that carry much of it, or zeros. The same on every rank. Collective.
pub fn uncarried_load(
    comm: &SimpleCommunicator,
    natural: &NaturalCoarse,
    jump: &Jump,
    (e, enough): (&[f64], f64),
    lambda: &[f64],
) -> Option<KernelMotion> {
    let pre = lambda.iter().zip(&jump.law);
    let pre: Vec<f64> = pre.map(|(&l, law)| -law.project(l)).collect();
    let begun = any(comm, pre.iter().any(|c| *c != 0.0));
    let mut springs = UnilateralSprings::new(comm, natural, jump, e, &pre);
    match springs.carry_load(enough, begun) {
        LoadBalance::Carried => Some(KernelMotion::default()),
        LoadBalance::Driven(away) => Some(away),
        LoadBalance::Undecided => None,
    }
}

/// Whether springs carry a load.
enum LoadBalance {
    /// They do.
    Carried,
    /// They do not: this part of the load drives a motion that no row stands against.
    Driven(KernelMotion),
    Undecided,
}

struct UnilateralSprings<'a> {
    comm: &'a SimpleCommunicator,
    natural: &'a NaturalCoarse,
    jump: &'a Jump,
    /// The owned rows that may hold.
    rows: Vec<usize>,
    /// The gaps of the owned rows, c.
    gap: &'a [f64],
    e: &'a [f64],
    /// ε D.
    weak: Vec<f64>,
}

impl<'a> UnilateralSprings<'a> {
    fn new(
        comm: &'a SimpleCommunicator,
        natural: &'a NaturalCoarse,
        jump: &'a Jump,
        e: &'a [f64],
        gap: &'a [f64],
    ) -> UnilateralSprings<'a> {
        let between = jump.rows_between_bodies();
        let rows: Vec<usize> = between.filter(|&i| jump.is_candidate(i)).collect();
        let known = natural.known();
        let mut weak = vec![0.0; known.n()];
        for &i in &rows {
            let (columns, values) = natural.all.entries(i);
            for (&c, g) in columns.iter().zip(values) {
                weak[c as usize] += WEAK * g * g;
            }
        }
        known.sum(comm, &mut weak);
        let [sum] = known.total(comm, |c| [weak[c]]);
        let mean = sum / natural.r as f64;
        // A motion that no row sees has a spring, too.
        for w in weak.iter_mut().filter(|w| **w == 0.0) {
            *w = if mean > 0.0 { mean } else { 1.0 };
        }
        UnilateralSprings {
            comm,
            natural,
            jump,
            rows,
            gap,
            e,
            weak,
        }
    }

    /// Whether springs carry the load up to `enough`. `begun` says that they nearly do at α = 0. Collective.
    fn carry_load(&mut self, enough: f64, begun: bool) -> LoadBalance {
        let known = self.natural.known();
        let (mut alpha, mut anchor) = (vec![0.0; known.n()], vec![0.0; known.n()]);
        let weak = self.weak.clone();
        let first = if begun { 1.0 } else { FIRST };
        for round in 0..ROUNDS {
            let softer = (first * FALL.powi(round as i32)).max(1.0);
            self.weak = weak.iter().map(|w| softer * w).collect();
            self.minimise(&mut alpha, &anchor, begun || round > 0);
            let along: Vec<f64> = alpha.iter().zip(&anchor).map(|(a, b)| a - b).collect();
            let rest: Vec<f64> = along.iter().zip(&self.weak).map(|(a, w)| a * w).collect();
            let is_little = rest.iter().all(|v| v.abs() <= enough);
            if !any(self.comm, !is_little) {
                return LoadBalance::Carried;
            }
            // While ε is large, bodies move that will come to rest.
            let away = (softer == 1.0).then(|| self.allowed(&along)).flatten();
            if let Some(away) = away {
                return LoadBalance::Driven(away);
            }
            anchor.clone_from(&alpha);
        }
        LoadBalance::Undecided
    }

    /// g_iᵀα − c_i of the rows that may hold.
    fn stretch(&self, alpha: &[f64]) -> Vec<f64> {
        let along = self.along(alpha);
        let gaps = self.rows.iter().map(|&i| self.gap[i]);
        along.iter().zip(gaps).map(|(s, c)| s - c).collect()
    }

    /// g_iᵀα of the rows that may hold.
    fn along(&self, alpha: &[f64]) -> Vec<f64> {
        let of = |&i: &usize| {
            let (columns, values) = self.natural.all.entries(i);
            let terms = columns.iter().zip(values);
            terms.map(|(&c, g)| g * alpha[c as usize]).sum()
        };
        self.rows.iter().map(of).collect()
    }

    /// Whether a spring that is stretched by `s` pulls.
    fn pulls(&self, k: usize, s: f64) -> bool {
        self.jump.law[self.rows[k]].bears(s)
    }

    /// Newton's method from `alpha`. It begins with the springs that pull there, or with all. Collective.
    fn minimise(&self, alpha: &mut [f64], anchor: &[f64], begun: bool) {
        let shape = self.natural.shape.as_ref().expect("a body floats");
        let all = &self.natural.all;
        let mut stretch = self.stretch(alpha);
        let mut on = vec![true; self.rows.len()];
        let mut chosen = vec![false; all.n()];
        for step in 0..STEPS {
            if step > 0 || begun {
                let now: Vec<bool> = (0..on.len()).map(|k| self.pulls(k, stretch[k])).collect();
                // The minimum for the springs that pulled is that of those which pull now.
                if !any(self.comm, now != on) && step > 0 {
                    return;
                }
                on = now;
            }
            self.rows
                .iter()
                .zip(&on)
                .for_each(|(&i, on)| chosen[i] = *on);
            let mut a = shape.product(self.comm, all, all, |i| chosen[i]);
            for c in (0..a.n()).filter(|&c| shape.has(c)) {
                a.set_diagonal(c, a.get(c, c) + self.weak[c]);
            }
            let mut d = self.downhill(alpha, anchor, &stretch);
            Gram::new(shape, a).solve(&mut d);
            let along = self.along(&d);
            let t = self.length(alpha, anchor, &d, (&stretch, &along));
            alpha.iter_mut().zip(&d).for_each(|(a, d)| *a += t * d);
            stretch
                .iter_mut()
                .zip(&along)
                .for_each(|(s, d)| *s += t * d);
            let known = self.natural.known();
            let moved = known.largest(self.comm, &d) * t;
            let size = known.largest(self.comm, alpha);
            if moved <= 1e-14 * size {
                return;
            }
        }
    }

    /// e − Gᵀλ − ε D (α − a).
    fn downhill(&self, alpha: &[f64], anchor: &[f64], stretch: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; alpha.len()];
        for (k, &i) in self.rows.iter().enumerate() {
            if self.pulls(k, stretch[k]) {
                let (columns, values) = self.natural.all.entries(i);
                for (&c, g) in columns.iter().zip(values) {
                    force[c as usize] += g * stretch[k];
                }
            }
        }
        self.natural.known().sum(self.comm, &mut force);
        (0..alpha.len())
            .map(|c| self.e[c] - force[c] - self.weak[c] * (alpha[c] - anchor[c]))
            .collect()
    }

    /// The t that minimises the function along α + t d; 0 if it does not fall.
    fn length(
        &self,
        alpha: &[f64],
        anchor: &[f64],
        d: &[f64],
        (stretch, along): (&[f64], &[f64]),
    ) -> f64 {
        let constant = self.natural.known().total(self.comm, |c| {
            [
                d[c] * (self.weak[c] * (alpha[c] - anchor[c]) - self.e[c]),
                d[c] * d[c] * self.weak[c],
            ]
        });
        let slope = |t: f64| {
            let mut sums = [0.0, 0.0];
            for k in 0..stretch.len() {
                let s = stretch[k] + t * along[k];
                if self.pulls(k, s) {
                    sums[0] += s * along[k];
                    sums[1] += along[k] * along[k];
                }
            }
            sum_all(self.comm, &mut sums);
            [
                sums[0] + constant[0] + t * constant[1],
                sums[1] + constant[1],
            ]
        };
        line_minimum(slope, true).unwrap_or(0.0)
    }

    /// The part of the load along `motion`, if the load drives it and no row stands against it. Collective.
    fn allowed(&self, motion: &[f64]) -> Option<KernelMotion> {
        let known = self.natural.known();
        let largest = known.largest(self.comm, motion);
        let cut = |a: &f64| if a.abs() > AGAINST * largest { *a } else { 0.0 };
        let mut alpha: Vec<f64> = motion.iter().map(cut).collect();
        let stands = self.along(&alpha).iter().zip(&self.rows).any(|(s, &i)| {
            let size: f64 = self.natural.all.entries(i).1.iter().map(|g| g.abs()).sum();
            self.jump.law[i].resistance(*s) > 10.0 * AGAINST * size * largest
        });
        let terms = |c: usize| [alpha[c] * self.e[c], alpha[c] * alpha[c]];
        let [work, square] = known.total(self.comm, terms);
        if any(self.comm, stands) || work <= 0.0 {
            return None;
        }
        alpha.iter_mut().for_each(|a| *a *= work / square);
        Some(known.motion(self.comm, &alpha, 0.0))
    }
}
