//! A guaranteed bound of the distance from the exact discrete solution, contact included (docs/theory.md, section 8).
//!
//! ```text
//!     ũ  admissible:  continuous inside bodies,  B_E ũ = c_E,  B_I ũ ≤ c_I
//!     λ̃  feasible:    λ̃_I ≥ 0,  Gᵀ λ̃ = e
//!     r = f − K ũ − Bᵀ λ̃,      ρ² = rᵀ E_loc S̃⁺ E_locᵀ r,      E_loc = I − B_D,locᵀ B_loc
//!
//!     ‖ũ − u*‖²_K  ≤  2 (J(ũ) − J*(λ̃))  ≤  ρ² + 2 λ̃ᵀ (c − B ũ)
//! ```
//!
//! J and J* are the primal and the dual energy. The gap between them is written as a sum of terms that are not
//! negative, so that no digits cancel in it. ρ bounds the norm of r over displacements that are continuous inside
//! bodies, because such displacements are in W̃ and E_loc leaves them as they are: the smallest eigenvalue is one.
//!
//! A pair (ũ, λ̃) that is some iterations better bounds the error of the given u from both sides:
//!
//! ```text
//!     ‖u − ũ‖_K − ‖ũ − u*‖_K  ≤  ‖u − u*‖_K  ≤  ‖u − ũ‖_K + ‖ũ − u*‖_K
//! ```

use std::time::Instant;

use super::admissible::{admissible, feasible};
use super::error::work_inside;
use super::loads::Loads;
use super::recovery::LinearSolution;
use super::refinement::remainder;
use super::residual::Iterate;
use crate::feti::method::LinearMethod;
use crate::Result;
use parallel::exchange::{any, max_all, sum_all};

/// Better pairs are made until the upper bound is at most this many times the lower one.
const CLOSE: f64 = 2.0;

/// A better pair has its residual reduced by this factor.
const BETTER: f64 = 0.1;

/// Better pairs at most.
const STEPS: usize = 4;

/// Displacements and forces are known to this part of the terms that they are formed from.
const ROUNDING: f64 = 1e-15;

/// Forces on a floating body that are this part of their terms are rounding.
const BALANCED: f64 = 1e-10;

/// A bound of ‖u − u*‖_K, u* the exact solution of the discrete problem.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Certified {
    /// ‖u − u*‖_K is not larger than this.
    pub most: f64,
    /// ‖u − u*‖_K is not smaller than this.
    pub least: f64,
    /// ‖u‖_K, of the unknowns.
    pub size: f64,
    /// The part of `most` that rounding may add to the bounds.
    pub rounding: f64,
    /// Krylov iterations of the better pairs.
    pub iterations: usize,
    /// Seconds.
    pub seconds: f64,
}

/// The reason why there is no bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uncertified {
    /// No displacements near the solution satisfy all rows.
    Rows,
    /// No multipliers near those of the solution push everywhere and balance the loads.
    Multipliers,
    /// The Krylov method has no displacements, or they are not finite.
    Solution,
    /// Some rows give way.
    Compliant,
}

impl Uncertified {
    /// The reason in words.
    pub fn text(self) -> &'static str {
        match self {
            Uncertified::Compliant => "the bound is one for rows that do not give way",
            Uncertified::Rows => "no displacements near the solution satisfy all rows",
            Uncertified::Multipliers => {
                "no multipliers near the solution push everywhere and balance the loads"
            }
            Uncertified::Solution => "the displacements are not finite",
        }
    }
}

/// A bound, or the reason why there is none.
pub type CertificationResult = std::result::Result<Certified, Uncertified>;

/// Displacements that satisfy all rows, and how far they are from a given u and from u* at most.
struct FeasibleBound {
    /// ‖u − ũ‖_K.
    away: f64,
    /// A bound of ‖ũ − u*‖_K.
    error: f64,
}

impl LinearMethod {
    /// A bound of the error of `solution`, whose rows must be those that hold now. Costs some iterations. Collective.
    pub(crate) fn certified(&self, solution: &LinearSolution) -> Result<CertificationResult> {
        self.certified_by(solution, STEPS)
    }

    /// The bound of the pair of `solution` alone, without iterations, and mostly without a lower bound. Collective.
    pub(crate) fn bounded(&self, solution: &LinearSolution) -> Result<CertificationResult> {
        self.certified_by(solution, 0)
    }

    /// The bound with this many better pairs at most. Collective.
    fn certified_by(&self, solution: &LinearSolution, steps: usize) -> Result<CertificationResult> {
        let clock = Instant::now();
        let finite = solution.u.iter().flatten().all(|u| u.is_finite());
        let mut broken = [f64::from(u8::from(!finite))];
        max_all(self.session.comm(), &mut broken);
        if broken[0] > 0.0 {
            return Ok(Err(Uncertified::Solution));
        }
        if self.dual().stiffness.jump.soft {
            return Ok(Err(Uncertified::Compliant));
        }
        let mut out = Certified {
            most: f64::INFINITY,
            size: solution.left.size,
            rounding: ROUNDING * solution.left.terms,
            ..Certified::default()
        };
        let mut at = solution.clone();
        let mut refused = None;
        for step in 0..=steps {
            match self.pair(&solution.u, &at)? {
                Ok(pair) => {
                    out.most = out.most.min(pair.away + pair.error);
                    out.least = out.least.max(pair.away - pair.error);
                }
                Err(why) => refused = Some(why),
            }
            let close = out.most <= CLOSE * out.least || out.most <= out.rounding;
            if close || step == steps {
                break;
            }
            let next = self.corrected(&at, BETTER)?;
            let reduced = next.converged && next.solution.left.size.is_finite();
            out.iterations = next.solution.iterations - solution.iterations;
            if !reduced {
                break;
            }
            at = next.solution;
        }
        out.seconds = clock.elapsed().as_secs_f64();
        if !out.most.is_finite() {
            return Ok(Err(refused.unwrap_or(Uncertified::Solution)));
        }
        // Bounds of several pairs contradict each other where rounding is larger than that.
        out.rounding = out.rounding.max(out.least - out.most);
        out.most += out.rounding;
        out.least = (out.least - out.rounding).max(0.0);
        Ok(Ok(out))
    }

    /// `solution` with its residual reduced further by `factor`, certified. Collective.
    pub(crate) fn further(&self, solution: &LinearSolution, factor: f64) -> Result<LinearSolution> {
        let clock = Instant::now();
        let next = self.corrected(solution, factor)?;
        let mut next = if next.converged {
            next.solution
        } else {
            solution.clone()
        };
        next.solve_seconds += clock.elapsed().as_secs_f64();
        self.certify(next)
    }

    /// The pair that the displacements and multipliers of `at` lead to. Collective.
    fn pair(
        &self,
        u: &[Vec<f64>],
        at: &LinearSolution,
    ) -> Result<std::result::Result<FeasibleBound, Uncertified>> {
        let Some(lambda) = feasible(self, &at.lambda)? else {
            return Ok(Err(Uncertified::Multipliers));
        };
        let Some(moved) = admissible(self, &at.u)? else {
            return Ok(Err(Uncertified::Rows));
        };
        let (problem, dual) = (&self.problem, &*self.dual());
        let multipliers = dual.multipliers()?;
        multipliers.array_mut()?.copy_from_slice(&lambda);
        let (forces, _) = remainder(problem, dual, &moved.u, &multipliers)?;
        let forces: Vec<&[f64]> = forces.iter().map(Vec::as_slice).collect();
        let loads = Loads::of(dual, &forces, None);
        // The size of the terms that cancel in the forces on bodies: those of the loads and of the multipliers.
        let kernel = loads.kernel.e.iter().zip(self.kernel_size(&lambda)?);
        let pushed = kernel.clone().any(|(e, size)| e.abs() > BALANCED * size);
        if any(dual.comm(), pushed) {
            return Ok(Err(Uncertified::Multipliers));
        }
        let inside = work_inside(dual, &loads, &forces);
        let (square, open) = (self.residual_norm(loads)?, moved.work(&lambda));
        let mut sums = [square, inside, open];
        sum_all(dual.comm(), &mut sums);
        let [square, inside, open] = sums;
        let apart: Vec<Vec<f64>> = u
            .iter()
            .zip(&moved.u)
            .map(|(a, b)| difference(a, b))
            .collect();
        Ok(Ok(FeasibleBound {
            away: self.energy_norm(&apart),
            error: (square.max(0.0) + inside.max(0.0) + 2.0 * open).sqrt(),
        }))
    }

    /// This rank's part of gᵀ E_loc S̃⁺ E_locᵀ g. Collective.
    fn residual_norm(&self, loads: Loads) -> Result<f64> {
        let dual = &*self.dual();
        let stiffness = &dual.stiffness;
        let columns = &stiffness.jump.columns;
        let inside = stiffness.jump.rows_between_bodies().start;
        let closed = vec![0.0; stiffness.jump.n_owned];
        let loads = Loads {
            jumps: Some(closed),
            ..loads
        };
        let mut at = Iterate::new(dual, loads)?;
        let mut ghost = stiffness.scaled_ghosts();
        for (columns, g) in columns.iter().zip(&at.loads.g) {
            columns.add_bd(g, &mut ghost); /*                       λ ← B_D g                 */
        }
        stiffness.sum_scaled(&ghost, &at.lambda)?;
        at.lambda.array_mut()?[inside..].fill(0.0); /*              λ ← B_D,loc g             */
        at.evaluate(dual)?; /*                                      y ← S̃⁺(g − B_locᵀ λ)      */
        stiffness.jump_of(&at.residual.work, &at.residual.r)?;
        at.residual.r.array_mut()?[inside..].fill(0.0);
        stiffness.fetch_scaled(&at.residual.r, &mut ghost)?;
        stiffness.team.for_each(&mut at.residual.work, |j, w| {
            columns.of(j).bd_transpose(&ghost, &mut w.v);
            w.y.iter_mut().zip(&w.v).for_each(|(y, v)| *y -= v); /* z ← y − B_D,locᵀ B_loc y  */
        });
        let pairs = at.loads.g.iter().zip(&at.residual.work);
        let works = pairs.map(|(g, w)| g.iter().zip(&w.y).map(|(g, z)| g * z).sum::<f64>());
        Ok(works.sum())
    }

    /// The size of the terms that cancel in the forces on floating bodies, for each of their motions that is
    /// known here. Collective.
    fn kernel_size(&self, lambda: &[f64]) -> Result<Vec<f64>> {
        let dual = &*self.dual();
        let loads: Vec<&[f64]> = self.problem.local.iter().map(|s| &s.f[..]).collect();
        let gamma = |j: usize| dual.stiffness.locals[j].gamma().n_gamma();
        let still: Vec<Vec<f64>> = (0..loads.len()).map(|j| vec![0.0; gamma(j)]).collect();
        let mut size = dual.natural.kernel_load(dual.comm(), &loads, &still).size;
        let mut pulls = vec![0.0; size.len()];
        for (r, l) in lambda.iter().enumerate() {
            for (c, g) in dual.natural.g.row(r) {
                pulls[c] += (g * l).abs();
            }
        }
        dual.natural.known().sum(dual.comm(), &mut pulls);
        size.iter_mut().zip(pulls).for_each(|(s, p)| *s += p);
        Ok(size)
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
