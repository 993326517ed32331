//! A sparse factor, and steps of iterative refinement that make up for what it lacks.
//!
//! With Q = M⁻¹ rounding makes GᵀQG unsymmetric. P is a projection all the same if this very matrix is inverted, not
//! its symmetric part, which is what is factored. A factor that leaves out columns without a choice of pivots may keep
//! small ones. A solution for a known vector tells how many steps are needed; as a rule it is none.

use std::rc::Rc;

use super::coarse_solver::{CoarseSolver, InverseSide};
use super::column_map::ColumnMap;
use super::gram::{diagonal_of_own_rows, Gram};
use super::gram_pattern::GramPattern;
use crate::Result;
use base::linalg::csr::Csr;
use cholesky::team::FactorTeam;

/// Largest residual of a solution, relative to the right-hand side, both in the scaled matrix: that of an LU
/// factorisation.
const EXACT: f64 = 1e-14;

/// Largest number of refinement steps.
const STEPS: usize = 3;

/// Entry `i` of a test vector that is neither smooth nor orthogonal to anything in particular.
pub fn probe(i: usize) -> f64 {
    1.0 + ((i * 7919) % 13) as f64 / 13.0
}

/// A matrix A, and a factor of it or of its symmetric part. A rank has the rows that it has in the factor.
pub struct RefinedFactor {
    factor: Gram,
    /// The ranks that share them; `None` if this rank has all.
    team: Option<Rc<FactorTeam>>,
    known: Rc<ColumnMap>,
    matrix: Csr,
    /// Aᵀ, if A is not symmetric and steps are needed.
    transpose: Option<Csr>,
    /// Number of refinement steps.
    steps: usize,
    /// The relative error of a vector after multiplication with the scaled matrix and its inverse.
    pub defect: f64,
}

impl RefinedFactor {
    /// Factors A = GᵀQG, which has the pattern of `shape` and is given with its transpose; `plain` says what the rows
    /// hold. Gives A back if the factor is not as good as one with pivots would be, or columns are few. Collective.
    pub fn weighted(
        shape: &GramPattern,
        [a, transpose]: [Csr; 2],
        plain: &Gram,
    ) -> std::result::Result<RefinedFactor, Csr> {
        let mut symmetric = a.clone();
        let both = symmetric.val.iter_mut().zip(&transpose.val);
        both.for_each(|(s, t)| *s = 0.5 * (*s + t));
        let Some(factor) = Gram::weighted(shape, symmetric, plain) else {
            return Err(a);
        };
        match RefinedFactor::of(shape, factor, a, Some(transpose)) {
            (refined, true) => Ok(refined),
            (refined, false) => Err(refined.matrix),
        }
    }

    /// With the factor of a symmetric matrix of this shape. Collective.
    pub fn symmetric(shape: &GramPattern, factor: Gram, matrix: Csr) -> RefinedFactor {
        RefinedFactor::of(shape, factor, matrix, None).0
    }

    /// With as many steps as are needed, and whether so many do.
    fn of(
        shape: &GramPattern,
        factor: Gram,
        matrix: Csr,
        transpose: Option<Csr>,
    ) -> (RefinedFactor, bool) {
        let mut refined = RefinedFactor {
            factor,
            team: shape.team().cloned(),
            known: shape.known.clone(),
            matrix,
            transpose,
            steps: 0,
            defect: f64::INFINITY,
        };
        let enough = refined.enough();
        (refined, enough)
    }

    /// Number of columns that are not left out.
    pub fn rank(&self) -> usize {
        self.factor.r() - self.factor.dropped.len()
    }

    /// Finds out how many steps are needed. Returns whether so many do.
    fn enough(&mut self) -> bool {
        let diagonal = match &self.team {
            Some(team) => diagonal_of_own_rows(&self.known, team, &self.matrix),
            None => self.matrix.diagonal(),
        };
        let root: Vec<f64> = diagonal.iter().map(|d| d.sqrt()).collect();
        let mut x: Vec<f64> = (0..root.len())
            .map(|c| probe(self.known.name(c as u32) as usize))
            .zip(&root)
            .map(|(x, d)| if *d > 0.0 { x / d } else { 0.0 })
            .collect();
        self.without_dropped(&mut x);
        let mut b = self.product(&self.matrix, &x);
        self.without_dropped(&mut b);
        let (team, known) = (self.team.clone(), self.known.clone());
        let scaled = |v: &[f64], power: i32| {
            let entries = v.iter().zip(&root).filter(|e| *e.1 > 0.0);
            let most = entries.fold(0.0f64, |m, (v, d)| m.max((v * d.powi(power)).abs()));
            match &team {
                Some(team) => known.most(team.comm(), most),
                None => most,
            }
        };
        for steps in 0..=STEPS {
            self.steps = steps;
            let mut y = b.clone();
            self.solve(&mut y, InverseSide::Plain);
            let rest = self.rest(&y, &b, InverseSide::Plain);
            let error: Vec<f64> = y.iter().zip(&x).map(|(y, x)| y - x).collect();
            self.defect = scaled(&error, 1) / scaled(&x, 1);
            // What is not a number is no small residual.
            if scaled(&rest, -1) <= EXACT * scaled(&b, -1).max(scaled(&x, 1)) {
                if steps == 0 {
                    self.transpose = None;
                }
                return true;
            }
        }
        false
    }

    /// The factor, if it solves without refinement.
    pub fn plain(&self) -> Option<&Gram> {
        (self.steps == 0).then_some(&self.factor)
    }

    fn without_dropped(&self, x: &mut [f64]) {
        let dropped = self.factor.dropped.iter();
        let dropped = dropped.filter_map(|&k| self.known.here(k));
        dropped.for_each(|k| x[k as usize] = 0.0);
    }

    /// A x. Collective.
    fn product(&self, a: &Csr, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        match &self.team {
            Some(team) => {
                for row in team.own_dofs() {
                    let (col, val) = a.row(row as usize);
                    let products = col.iter().zip(val).map(|(&j, v)| v * x[j as usize]);
                    y[row as usize] = products.sum();
                }
                self.known.sum(team.comm(), &mut y);
            }
            None => a.mul(x, &mut y),
        }
        y
    }

    /// b − A x, or b − Aᵀ x. Collective.
    fn rest(&self, x: &[f64], b: &[f64], side: InverseSide) -> Vec<f64> {
        let a = match (side, &self.transpose) {
            (InverseSide::Transposed, Some(transpose)) => transpose,
            _ => &self.matrix,
        };
        let mut rest = self.product(a, x);
        rest.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
        self.without_dropped(&mut rest);
        rest
    }

    /// x ← A⁻¹ x or A⁻ᵀ x, zero in the columns that are left out. Collective.
    pub fn solve(&self, x: &mut [f64], side: InverseSide) {
        let b = x.to_vec();
        self.factor.solve(x);
        for _ in 0..self.steps {
            let mut rest = self.rest(x, &b, side);
            self.factor.solve(&mut rest);
            x.iter_mut().zip(&rest).for_each(|(x, r)| *x += r);
        }
    }
}

impl CoarseSolver for RefinedFactor {
    fn solve(&self, x: &mut [f64], side: InverseSide) -> Result<()> {
        RefinedFactor::solve(self, x, side);
        Ok(())
    }

    fn defect(&self) -> Result<f64> {
        Ok(self.defect)
    }

    fn describe(&self) -> Result<String> {
        Ok("G^T Q G by a sparse Cholesky factor".into())
    }

    fn loses_less(&self, _: f64, defect: f64) -> bool {
        self.plain().is_some() && self.defect <= defect
    }

    fn shared(&self) -> Option<&Gram> {
        self.plain()
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/projector/refined.rs"]
mod tests;
