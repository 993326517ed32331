//! The method that the loop falls back on where its sets wander: the proximal method of multipliers (Rockafellar 1976)
//! with damped Newton steps.
//!
//! ```text
//!     ψ(u) = ½ uᵀK u − fᵀu + ½ Σ_j (s_j)₊² / κ_j + ½ (u − z)ᵀ D (u − z),      s_j = μ_j + κ_j (B u − c)_j
//!     H d = −∇ψ(u),   H = K + B_Aᵀ κ_A B_A + D,   A = { s > 0 },              u ← u + t d
//!     after a minimisation   μ ← (s)₊,   z ← u,   κ ← 3 κ
//! ```
//!
//! Springs κ stand for the rows. D is small and diagonal, on the unknowns in rows; it holds what K and the springs
//! leave free. Around cycles of rows, μ moves to the cheapest multipliers with the same forces (see
//! [`descend_around_cycles`](super::cycles::descend_around_cycles)). [`DampedNewton::round`] minimises ψ once and
//! returns { μ > 0 }. The loop tries this set as it tries its own.
//!
//! *A minimisation ends.* A motion without energy moves an unknown in some row, or a support of the layout holds it.
//! So K + D is positive definite, and ψ is strictly convex. ψ is continuously differentiable and consists of finitely
//! many quadratic pieces, each with one of finitely many H. d leads downwards, and ψ falls by a given part of what the
//! best t in (0, 1] brings: u converges to the only minimiser. Every piece that touches the minimiser has its own
//! minimum there: a step from nearby arrives.
//!
//! *The rounds end.* With κ bounded, μ converges to multipliers of a solution and u to a solution, if there is one. κ
//! and D limit the speed only. A row with λ > 0 has s > 0 from some round on, and a row with B u < c has s < 0. What A
//! has beyond the rows with λ > 0 are then rows with B u = c. The solution satisfies the equations of A, and the trial
//! finds it. Where rows depend on each other, the trial looks for multipliers that do not pull. Moves around cycles
//! only help: forces stay, and the dual energy falls.

use super::course::Solvers;
use super::cycles::descend_around_cycles;
use super::groups::ActiveGroups;
use super::reduced::Reduced;
use super::rows::{GapInequality, Inequalities};
use base::Result;
use fetifeti::inside::line_minimum;
use fetifeti::settings::Tuning;
use parallel::meter::timed;
use petsc::{Session, Vec as PetscVec};

/// κ in the first round, relative to the stiffness of the nodes of a row.
const STIFFNESS: f64 = 30.0;

/// The factor of κ from one round to the next, and the largest κ: H loses digits to stiffer springs.
const STIFFER: f64 = 3.0;
const STIFFEST: f64 = 1e7;

/// D relative to the diagonal of K. Rounds hardly move a stiff body that soft ones hold, where D is as stiff as those:
/// with jumps of 10⁶ and 1e-8 each round leaves 0.4 of the error.
const PROXIMAL: f64 = 1e-10;

/// Reduction of the residual by an iterative solver. Any reduction gives a direction in which ψ falls.
const REDUCTION: f64 = 1e-8;

/// A step is long enough if ψ falls by this part of what the best length brings.
const ENOUGH: f64 = 0.1;

/// Maximal number of steps in a round. In exact arithmetic none is needed, in practice a round takes 2 to 20.
const STEPS: usize = 100;

/// Maximal number of rounds. A problem without a solution takes as many.
const ROUNDS: usize = 20;

/// The state of the method.
pub(super) struct DampedNewton<'a> {
    session: Session,
    rows: &'a Inequalities,
    reduced: &'a Reduced,
    /// The groups of the empty set: with them the reduced problem is K u = f.
    free: ActiveGroups,
    /// Stiffness of the nodes of every row; 0 for rows between one unknown and itself.
    nodes: Vec<f64>,
    /// D.
    proximal: Vec<f64>,
    /// κ over the stiffness of the nodes.
    stiffness: f64,
    multiplier: Vec<f64>,
    /// z at the unknowns in rows.
    center: Vec<f64>,
    rounds: usize,
    /// The present u.
    pub u: PetscVec,
}

/// The result of a minimisation.
#[derive(Default)]
pub(super) struct NewtonResult {
    /// The set to be tried: the rows with μ > 0, and rows that hold what these leave free.
    pub active: Vec<bool>,
    /// The order in which rows are made to hold: by μ, then by B u − c.
    pub priority: Vec<usize>,
    /// Number of Newton steps.
    pub steps: usize,
    /// Iterations of their solvers.
    pub iterations: usize,
    /// Seconds for matrices and preconditioners.
    pub setup: f64,
}

impl<'a> DampedNewton<'a> {
    /// Starts from zero. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(
        session: &Session,
        rows: &'a Inequalities,
        reduced: &'a Reduced,
    ) -> Result<DampedNewton<'a>> {
        let diagonal = reduced.diagonal();
        let compliance = |k: usize| diagonal.get(k).map_or(0.0, |stiffness| 1.0 / stiffness);
        let stiffness = |r: &GapInequality| {
            if r.plus == r.minus {
                0.0
            } else {
                1.0 / (compliance(r.plus) + compliance(r.minus))
            }
        };
        Ok(DampedNewton {
            session: session.clone(),
            free: ActiveGroups::new(rows, &mut vec![false; rows.len()], &[]),
            nodes: rows.rows.iter().map(stiffness).collect(),
            proximal: diagonal.iter().map(|k| PROXIMAL * k).collect(),
            stiffness: STIFFNESS,
            multiplier: vec![0.0; rows.len()],
            center: vec![0.0; rows.unknowns.len()],
            rounds: 0,
            u: reduced.vector()?,
            rows,
            reduced,
        })
    }

    /// Whether all rounds have been made.
    pub fn is_exhausted(&self) -> bool {
        self.rounds == ROUNDS
    }

    /// κ.
    fn springs(&self) -> Vec<f64> {
        self.nodes.iter().map(|k| self.stiffness * k).collect()
    }

    /// u at the unknowns in rows, and s.
    fn evaluate_point(&self) -> Result<(Vec<f64>, Vec<f64>)> {
        let at = self.reduced.trace.get(self.session.comm(), &self.u)?;
        let terms = self.rows.gaps(&at).into_iter().zip(self.springs());
        let s = terms.zip(&self.multiplier).map(|((g, k), mu)| mu + k * g);
        let s = s.collect();
        Ok((at, s))
    }

    /// Minimises ψ, after the first time with stiffer springs, and updates μ and z. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn round(&mut self, solvers: &mut Solvers) -> Result<NewtonResult> {
        if self.rounds > 0 {
            self.stiffness = (STIFFER * self.stiffness).min(STIFFEST);
        }
        self.rounds += 1;
        let mut out = NewtonResult::default();
        let (mut at, mut s) = self.evaluate_point()?;
        while out.steps < STEPS {
            let was = set(&s);
            let t = self.step(solvers, &s, &mut out)?;
            out.steps += 1;
            (at, s) = self.evaluate_point()?;
            let arrived = |t: f64| t == 1.0 && set(&s) == was;
            if t.is_none_or(arrived) {
                break;
            }
        }
        let gaps = self.rows.gaps(&at);
        self.multiplier = s.iter().map(|s| s.max(0.0)).collect();
        descend_around_cycles(self.rows, &mut self.multiplier);
        self.center = at;
        let score = |(mu, gap): (&f64, f64)| if *mu > 0.0 { *mu } else { gap };
        let score: Vec<f64> = self.multiplier.iter().zip(gaps).map(score).collect();
        out.active = set(&self.multiplier);
        self.rows.restore(&mut out.active, &score, []);
        out.priority = (0..score.len()).collect();
        out.priority.sort_by(|a, b| score[*b].total_cmp(&score[*a]));
        Ok(out)
    }

    /// One Newton step; its length, or `None` if ψ does not fall. Collective.
    fn step(
        &self,
        solvers: &mut Solvers,
        s: &[f64],
        out: &mut NewtonResult,
    ) -> Result<Option<f64>> {
        let (comm, a) = (self.session.comm(), &self.reduced.a);
        let springs = self.springs();
        let (ksp, seconds) = timed(&self.session, || {
            let ksp = solvers()?;
            ksp.set_reuse_preconditioner(false)?;
            self.reduced
                .update(&self.free, &self.entries(&springs, s))?;
            ksp.set_operators(a, a)?;
            ksp.setup()?;
            Ok(ksp)
        })?;
        out.setup += seconds;
        let b = self.reduced.rhs(&self.free, &[])?;
        let loads = self.reduced.trace.get(comm, &b)?;
        self.reduced
            .trace
            .set(&b, &self.loaded(loads, &springs, s))?;
        let (r, d) = (b.duplicate()?, b.duplicate()?);
        a.mult(&self.u, &r)?;
        r.aypx(-1.0, &b)?;
        ksp.set_tolerances(Some(REDUCTION), Some(0.0), None, None)?;
        ksp.solve(&r, &d)?;
        out.iterations += ksp.iterations()?;
        a.mult(&d, &b)?;
        let line = LineSearch {
            fall: r.dot(&d)?,
            bend: b.dot(&d)?,
            pull: s.to_vec(),
            opening: self.jumps(&self.reduced.trace.get(comm, &d)?),
            springs,
        };
        let t = line.length();
        if let Some(t) = t {
            self.u.axpy(t, &d)?;
        }
        Ok(t)
    }

    /// A: the rows with s > 0.
    fn pulled<'b>(&'b self, s: &'b [f64]) -> impl Iterator<Item = (usize, &'b GapInequality)> {
        let rows = self.rows.rows.iter().enumerate();
        rows.filter(|(r, _)| s[*r] > 0.0)
    }

    /// H − K as entries at the unknowns in rows.
    fn entries(&self, springs: &[f64], s: &[f64]) -> Vec<(usize, usize, f64)> {
        let diagonal = self.proximal.iter().enumerate();
        let mut out: Vec<(usize, usize, f64)> = diagonal.map(|(k, d)| (k, k, *d)).collect();
        let ground = self.rows.ground();
        for (r, row) in self.pulled(s) {
            for (k, its) in [(row.plus, 1.0), (row.minus, -1.0)] {
                for (l, other) in [(row.plus, 1.0), (row.minus, -1.0)] {
                    if k.max(l) < ground {
                        out.push((k, l, its * other * springs[r]));
                    }
                }
            }
        }
        out
    }

    /// f + D z + B_Aᵀ (κ c − μ) at the unknowns in rows, where f is given.
    fn loaded(&self, mut f: Vec<f64>, springs: &[f64], s: &[f64]) -> Vec<f64> {
        for (k, f) in f.iter_mut().enumerate() {
            *f += self.proximal[k] * self.center[k];
        }
        for (r, row) in self.pulled(s) {
            let force = springs[r] * row.gap - self.multiplier[r];
            for (end, sign) in [(row.plus, 1.0), (row.minus, -1.0)] {
                if let Some(f) = f.get_mut(end) {
                    *f += sign * force;
                }
            }
        }
        f
    }

    /// B x from x at the unknowns in rows.
    fn jumps(&self, x: &[f64]) -> Vec<f64> {
        let at = |k: usize| x.get(k).copied().unwrap_or(0.0);
        let jump = |r: &GapInequality| at(r.plus) - at(r.minus);
        self.rows.rows.iter().map(jump).collect()
    }
}

/// { s > 0 }.
fn set(s: &[f64]) -> Vec<bool> {
    s.iter().map(|s| *s > 0.0).collect()
}

/// ψ along a step.
struct LineSearch {
    /// −∇ψᵀd at the start.
    fall: f64,
    /// dᵀH d.
    bend: f64,
    /// s at the start.
    pull: Vec<f64>,
    /// B d.
    opening: Vec<f64>,
    /// κ.
    springs: Vec<f64>,
}

impl LineSearch {
    /// s of a row at t.
    fn pull_at(&self, r: usize, t: f64) -> f64 {
        self.pull[r] + t * self.springs[r] * self.opening[r]
    }

    /// The derivatives of ψ at t.
    ///
    /// ```text
    ///     ψ'(t) = −fall + t bend + Σ_j (B d)_j ((s_j(t))₊ − [j ∈ A] s_j(t))
    /// ```
    fn slope(&self, t: f64) -> [f64; 2] {
        let mut sums = [t * self.bend - self.fall, self.bend];
        for (r, opening) in self.opening.iter().enumerate() {
            let s = self.pull_at(r, t);
            let more = f64::from(s > 0.0) - f64::from(self.pull[r] > 0.0);
            sums[0] += more * opening * s;
            sums[1] += more * opening * opening * self.springs[r];
        }
        sums
    }

    /// ψ at t minus ψ at the start.
    ///
    /// ```text
    ///     ψ(t) − ψ(0) = −fall t + ½ bend t² + ½ Σ_j ((s_j(t))₊² − [j ∈ A] s_j(t)²) / κ_j
    /// ```
    fn change(&self, t: f64) -> f64 {
        let mut sum = t * (0.5 * t * self.bend - self.fall);
        for (r, spring) in self.springs.iter().enumerate() {
            let s = self.pull_at(r, t);
            match [self.pull[r] > 0.0, s > 0.0] {
                [false, true] => sum += 0.5 * s * s / spring,
                [true, false] => sum -= 0.5 * s * s / spring,
                _ => (),
            }
        }
        sum
    }

    /// The first of t = 1, ½, ¼, … at which ψ falls by [`ENOUGH`] of what the best t in (0, 1] brings; `None` if ψ does
    /// not fall. The best t lies at a kink, where a row begins or ends to hold, and steps from kink to kink are short.
    fn length(&self) -> Option<f64> {
        let best = self.minimum()?;
        let fall = self.change(best);
        let mut t = 1.0;
        while t > best && self.change(t) > ENOUGH * fall {
            t *= 0.5;
        }
        Some(best.max(t))
    }

    /// The t in (0, 1] that minimises ψ; `None` if ψ does not fall.
    fn minimum(&self) -> Option<f64> {
        line_minimum(|t| self.slope(t), false, &Tuning::DEFAULT)
    }
}

#[cfg(test)]
#[path = "../../tests/assembled/damped_newton.rs"]
mod tests;
