//! The verdict of a solution on its active set: which rows are wrong, and which set follows.

use super::course::OuterCertificate;
use super::refine::over;
use super::rows::Inequalities;

/// A multiplier above minus this, relative to the largest one or to the loads, counts as not pulling; a gap below this,
/// relative to the largest u, counts as closed.
const ROUNDING: f64 = 1e-14;

/// The rows with multipliers or gaps of the wrong sign, and the set that follows.
pub(super) struct Judged {
    /// The multipliers.
    pub lambda: Vec<f64>,
    /// B u − c.
    pub gaps: Vec<f64>,
    /// The set that follows.
    pub next: Vec<bool>,
    /// How wrong each row is; 0 where it is right.
    pub wrong: Vec<f64>,
    /// λ + ρ (B u − c), with ρ such that both terms are of the same size.
    pub score: Vec<f64>,
    /// Largest |λ| and largest |u|.
    pub largest: [f64; 2],
    /// Multipliers below this are rounding beside the loads.
    none: f64,
    /// Whether each row is an inequality.
    bounds: Vec<bool>,
}

impl Judged {
    /// Judges the solution on `active`; `u_max` is the largest displacement, `load` the size of the loads.
    pub fn new(
        rows: &Inequalities,
        active: &[bool],
        lambda: Vec<f64>,
        gaps: Vec<f64>,
        (u_max, load): (f64, f64),
    ) -> Judged {
        let lambda_max = lambda.iter().fold(0.0f64, |a, l| a.max(l.abs()));
        let scale = |x: f64, largest: f64| if largest > 0.0 { x / largest } else { 0.0 };
        let mut out = Judged {
            next: active.to_vec(),
            wrong: vec![0.0; rows.len()],
            score: vec![0.0; rows.len()],
            largest: [lambda_max, u_max],
            none: ROUNDING * load,
            bounds: rows.tangential().iter().map(|t| !t).collect(),
            lambda,
            gaps,
        };
        for (r, &on) in active.iter().enumerate().filter(|(r, _)| out.bounds[*r]) {
            let (l, gap) = (scale(out.lambda[r], lambda_max), scale(out.gaps[r], u_max));
            out.score[r] = l + gap;
            if on && l < -ROUNDING && out.lambda[r] < -out.none {
                (out.next[r], out.wrong[r]) = (false, -l);
            } else if !on && gap > ROUNDING {
                (out.next[r], out.wrong[r]) = (true, gap);
            }
        }
        out
    }

    /// The certificate, given the last correction of u; rows of friction have none.
    pub fn certificate(&self, correction: f64) -> OuterCertificate {
        let most = |list: &[f64], sign: f64| {
            let each = list.iter().zip(&self.bounds).filter(|(_, bounds)| **bounds);
            each.fold(0.0f64, |a, (v, _)| a.max(sign * v))
        };
        let pull = Some(most(&self.lambda, -1.0)).filter(|pull| *pull > self.none);
        OuterCertificate {
            correction,
            feasibility: over(most(&self.gaps, 1.0), self.largest[1]),
            pull: over(pull.unwrap_or(0.0), self.largest[0]),
        }
    }

    /// Whether a row pulls by no more than this part of the largest multiplier, or than rounding.
    pub fn idle(&self, r: usize, part: f64) -> bool {
        self.lambda[r] >= -(part * self.largest[0]).max(self.none)
    }

    /// Number of wrong rows.
    pub fn count(&self) -> usize {
        self.wrong.iter().filter(|wrong| **wrong > 0.0).count()
    }

    /// Undoes all changes of the set but that of the worst row.
    pub fn keep_worst(&self, active: &[bool], next: &mut [bool]) {
        let by_size = |a: &usize, b: &usize| {
            let by_size = self.wrong[*a].total_cmp(&self.wrong[*b]);
            by_size.then(b.cmp(a))
        };
        let worst = (0..next.len()).max_by(by_size);
        for r in (0..next.len()).filter(|r| Some(*r) != worst) {
            next[r] = active[r];
        }
    }

    /// The order in which rows are made to hold: violated rows first, then by multiplier.
    pub fn priority(&self, active: &[bool], next: &[bool]) -> Vec<usize> {
        let mut order: Vec<usize> = (0..next.len()).collect();
        let entered = |r: usize| next[r] && !active[r];
        order.sort_by(|&a, &b| {
            let new = entered(b).cmp(&entered(a));
            new.then(self.score[b].total_cmp(&self.score[a]))
        });
        order
    }
}
