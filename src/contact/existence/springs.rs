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
//!
//! The rows of a node with friction exert forces in its set K together: its term is ½ |Π_K s|², s = g α − c. It is
//! convex and smooth, and no longer piecewise quadratic; each round then ends at what Newton's steps reach.

use mpi::topology::SimpleCommunicator;

use super::carriers::Carriers;
use super::cone::{FrictionCone, NodeForce};
use crate::contact::piecewise_quadratic::{minimise, PiecewiseQuadratic};
use crate::contact::tuning::Tuning;
use crate::feti::jump::operator::Jump;
use crate::feti::projector::gram::Gram;
use crate::feti::projector::kernel_motion::KernelMotion;
use crate::feti::projector::natural::NaturalCoarse;
use crate::feti::projector::rows::KernelRows;
use parallel::exchange::{any, sum_all};

/// The part of `e` that the rows cannot carry: none if it is below `enough` everywhere. `None` if this is not decided.
/// `lambda` has forces on the owned rows that carry much of it, or zeros; `cones` are the nodes with friction. The same
/// on every rank. Collective.
pub fn uncarried_load(
    comm: &SimpleCommunicator,
    natural: &NaturalCoarse,
    (jump, cones): (&Jump, &[FrictionCone]),
    ((e, enough), lambda): ((&[f64], f64), &[f64]),
    tuning: &Tuning,
) -> Option<KernelMotion> {
    let pre = lambda.iter().zip(&jump.law);
    let pre: Vec<f64> = pre.map(|(&l, law)| -law.project(l)).collect();
    let begun = any(comm, pre.iter().any(|c| *c != 0.0));
    let carriers = Carriers::new(jump, cones);
    let mut springs =
        UnilateralSprings::new(comm, natural, (jump, carriers), ((e, enough), &pre), tuning);
    match springs.carry_load(begun) {
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
    carriers: Carriers<'a>,
    /// The gaps of the owned rows, c.
    gap: &'a [f64],
    e: &'a [f64],
    /// ε D.
    weak: Vec<f64>,
    /// A part of the load below this counts as carried.
    enough: f64,
    tuning: &'a Tuning,
}

impl<'a> UnilateralSprings<'a> {
    fn new(
        comm: &'a SimpleCommunicator,
        natural: &'a NaturalCoarse,
        (jump, carriers): (&'a Jump, Carriers<'a>),
        ((e, enough), gap): ((&'a [f64], f64), &'a [f64]),
        tuning: &'a Tuning,
    ) -> UnilateralSprings<'a> {
        let known = natural.known();
        let mut weak = vec![0.0; known.n()];
        for &i in &carriers.rows {
            let (columns, values) = natural.all.entries(i);
            for (&c, g) in columns.iter().zip(values) {
                weak[c as usize] += tuning.springs_weak * g * g;
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
            carriers,
            gap,
            e,
            weak,
            enough,
            tuning,
        }
    }

    /// Whether springs carry the load up to what is nothing. `begun` says that they nearly do at α = 0. Collective.
    fn carry_load(&mut self, begun: bool) -> LoadBalance {
        let (known, tuning) = (self.natural.known(), self.tuning);
        let (mut alpha, mut anchor) = (vec![0.0; known.n()], vec![0.0; known.n()]);
        let weak = self.weak.clone();
        let first = if begun { 1.0 } else { tuning.springs_first };
        for round in 0..tuning.springs_rounds {
            let softer = (first * tuning.springs_fall.powi(round as i32)).max(1.0);
            self.weak = weak.iter().map(|w| softer * w).collect();
            let mut springs = Stretched::new(self, alpha, &anchor, begun || round > 0);
            minimise(&mut springs, tuning.springs_steps, tuning);
            alpha = springs.alpha;
            let along: Vec<f64> = alpha.iter().zip(&anchor).map(|(a, b)| a - b).collect();
            let rest: Vec<f64> = along.iter().zip(&self.weak).map(|(a, w)| a * w).collect();
            let is_little = rest.iter().all(|v| v.abs() <= self.enough);
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
        let gaps = self.carriers.rows.iter().map(|&i| self.gap[i]);
        along.iter().zip(gaps).map(|(s, c)| s - c).collect()
    }

    /// g_iᵀα of the rows that may hold.
    fn along(&self, alpha: &[f64]) -> Vec<f64> {
        let of = |&i: &usize| {
            let (columns, values) = self.natural.all.entries(i);
            let terms = columns.iter().zip(values);
            terms.map(|(&c, g)| g * alpha[c as usize]).sum()
        };
        self.carriers.rows.iter().map(of).collect()
    }

    /// Whether a row is alone, and its spring pulls where it is stretched by `s`.
    fn pulls(&self, k: usize, s: f64) -> bool {
        self.carriers.alone[k] && self.jump.law[self.carriers.rows[k]].bears(s)
    }

    /// The forces of the springs.
    fn forces(&self, stretch: &[f64]) -> Vec<f64> {
        let alone = stretch.iter().enumerate();
        let alone = alone.map(|(k, &s)| if self.pulls(k, s) { s } else { 0.0 });
        let mut out: Vec<f64> = alone.collect();
        for (cone, places, s) in self.carriers.nodes(stretch) {
            let force = cone.project(s);
            places.iter().zip(force).for_each(|(&k, f)| out[k] = f);
        }
        out
    }

    /// The rows as the derivatives of the forces have them: those whose springs are `on`, and of nodes the combinations
    /// by the derivative of Π_K.
    fn tangent(&self, on: &[bool], stretch: &[f64]) -> KernelRows {
        let (all, rows) = (&self.natural.all, &self.carriers.rows);
        let mut entries = Vec::new();
        let mut add = |k: usize, of: usize, by: f64| {
            let (columns, values) = all.entries(rows[of]);
            let terms = columns.iter().zip(values);
            entries.extend(terms.map(|(&c, g)| (rows[k] as u32, c, by * g)));
        };
        (0..rows.len())
            .filter(|&k| on[k])
            .for_each(|k| add(k, k, 1.0));
        for (cone, places, s) in self.carriers.nodes(stretch) {
            for (j, &of) in places.iter().enumerate() {
                let mut unit = [0.0; 3];
                unit[j] = 1.0;
                let column = cone.derivative(s, unit);
                let parts = places.iter().zip(column).filter(|p| p.1 != 0.0);
                parts.for_each(|(&k, by)| add(k, of, by));
            }
        }
        KernelRows::from_triplets(all.n(), entries)
    }

    /// The part of the load along `motion`, if the load drives it and no row stands against it. Collective.
    fn allowed(&self, motion: &[f64]) -> Option<KernelMotion> {
        let known = self.natural.known();
        let (largest, against) = (
            known.largest(self.comm, motion),
            self.tuning.springs_against,
        );
        let cut = |a: &f64| if a.abs() > against * largest { *a } else { 0.0 };
        let mut alpha: Vec<f64> = motion.iter().map(cut).collect();
        let along = self.along(&alpha);
        let rows = &self.carriers.rows;
        let size = |k: usize| -> f64 {
            let values = self.natural.all.entries(rows[k]).1;
            values.iter().map(|g| g.abs()).sum()
        };
        let beyond = |k: usize, s: f64| s > 10.0 * against * size(k) * largest;
        let mut stands = (0..rows.len()).filter(|&k| self.carriers.alone[k]);
        let stands = stands.any(|k| beyond(k, self.jump.law[rows[k]].resistance(along[k])));
        let mut nodes = self.carriers.nodes(&along);
        let stands = stands || nodes.any(|(cone, places, w)| beyond(places[0], cone.support(w)[1]));
        let nodes = self.carriers.nodes(&along);
        let mut bounded = [nodes.map(|(cone, _, w)| cone.support(w)[0]).sum::<f64>()];
        sum_all(self.comm, &mut bounded);
        let terms = |c: usize| [alpha[c] * self.e[c], alpha[c] * alpha[c]];
        let [work, square] = known.total(self.comm, terms);
        // Forces that are bounded do work against it, too.
        if any(self.comm, stands) || work <= (1.0 + against) * bounded[0] {
            return None;
        }
        alpha.iter_mut().for_each(|a| *a *= work / square);
        Some(known.motion(self.comm, &alpha, 0.0))
    }
}

/// The springs at α, and a direction from there.
struct Stretched<'a> {
    of: &'a UnilateralSprings<'a>,
    alpha: Vec<f64>,
    anchor: &'a [f64],
    /// g_iᵀα − c_i of the rows that may hold, and the springs among them of the last direction.
    stretch: Vec<f64>,
    on: Vec<bool>,
    /// Whether the first direction has the springs that pull at its α, not all.
    begun: bool,
    steps: usize,
    /// d, g_iᵀd, and φ' and φ'' without the springs.
    d: Vec<f64>,
    along: Vec<f64>,
    constant: [f64; 2],
}

impl<'a> Stretched<'a> {
    fn new(
        of: &'a UnilateralSprings<'a>,
        alpha: Vec<f64>,
        anchor: &'a [f64],
        begun: bool,
    ) -> Stretched<'a> {
        Stretched {
            stretch: of.stretch(&alpha),
            on: of.carriers.alone.clone(),
            of,
            alpha,
            anchor,
            begun,
            steps: 0,
            d: Vec::new(),
            along: Vec::new(),
            constant: [0.0; 2],
        }
    }

    /// e − Gᵀλ − ε D (α − a).
    fn downhill(&self) -> Vec<f64> {
        let (of, alpha) = (self.of, &self.alpha);
        let mut force = vec![0.0; alpha.len()];
        for (&i, f) in of.carriers.rows.iter().zip(of.forces(&self.stretch)) {
            let (columns, values) = of.natural.all.entries(i);
            for (&c, g) in columns.iter().zip(values) {
                force[c as usize] += g * f;
            }
        }
        of.natural.known().sum(of.comm, &mut force);
        (0..alpha.len())
            .map(|c| of.e[c] - force[c] - of.weak[c] * (alpha[c] - self.anchor[c]))
            .collect()
    }
}

/// The methods are collective.
impl PiecewiseQuadratic for Stretched<'_> {
    fn direct(&mut self) -> bool {
        let of = self.of;
        let shape = of.natural.shape.as_ref().expect("a body floats");
        let all = &of.natural.all;
        if self.steps > 0 || self.begun {
            let pulls = |k: usize| of.pulls(k, self.stretch[k]);
            let now: Vec<bool> = (0..self.on.len()).map(pulls).collect();
            // The minimum for the springs that pulled is that of those which pull now.
            let changed = now != self.on || !of.carriers.cones.is_empty();
            if !any(of.comm, changed) && self.steps > 0 {
                return false;
            }
            self.on = now;
        }
        self.steps += 1;
        let mut chosen = vec![false; all.n()];
        for (k, &i) in of.carriers.rows.iter().enumerate() {
            chosen[i] = self.on[k] || !of.carriers.alone[k];
        }
        self.d = self.downhill();
        let cones = any(of.comm, !of.carriers.cones.is_empty());
        if cones && of.natural.known().largest(of.comm, &self.d) <= 0.1 * of.enough {
            return false;
        }
        let mut a = match cones {
            true => shape.product(of.comm, all, &of.tangent(&self.on, &self.stretch), |i| {
                chosen[i]
            }),
            false => shape.product(of.comm, all, all, |i| chosen[i]),
        };
        for c in (0..a.n()).filter(|&c| shape.has(c)) {
            a.set_diagonal(c, a.get(c, c) + of.weak[c]);
        }
        Gram::new(shape, a).solve(&mut self.d);
        self.along = of.along(&self.d);
        let (d, alpha) = (&self.d, &self.alpha);
        self.constant = of.natural.known().total(of.comm, |c| {
            [
                d[c] * (of.weak[c] * (alpha[c] - self.anchor[c]) - of.e[c]),
                d[c] * d[c] * of.weak[c],
            ]
        });
        true
    }

    fn slope(&self, t: f64) -> [f64; 2] {
        let (of, along) = (self.of, &self.along);
        let mut sums = [0.0, 0.0];
        let there = self.stretch.iter().zip(along).map(|(s, a)| s + t * a);
        let there: Vec<f64> = there.collect();
        for (k, (s, along)) in there.iter().zip(along).enumerate() {
            if of.pulls(k, *s) {
                sums[0] += s * along;
                sums[1] += along * along;
            }
        }
        let nodes = of.carriers.nodes(&there).zip(of.carriers.nodes(along));
        for ((cone, _, s), (_, _, along)) in nodes {
            sums[0] += dot(cone.project(s), along);
            sums[1] += dot(cone.derivative(s, along), along);
        }
        sum_all(of.comm, &mut sums);
        let [first, second] = self.constant;
        [sums[0] + first + t * second, sums[1] + second]
    }

    fn go(&mut self, t: f64) -> bool {
        let alpha = self.alpha.iter_mut().zip(&self.d);
        alpha.for_each(|(a, d)| *a += t * d);
        let stretch = self.stretch.iter_mut().zip(&self.along);
        stretch.for_each(|(s, d)| *s += t * d);
        let known = self.of.natural.known();
        let moved = known.largest(self.of.comm, &self.d) * t;
        let size = known.largest(self.of.comm, &self.alpha);
        moved > 1e-14 * size
    }
}

fn dot(a: NodeForce, b: NodeForce) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
