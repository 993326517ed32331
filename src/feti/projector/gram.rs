//! GᵀG for a choice of rows: which rigid motions the rows hold.
//!
//! It is sparse: two bodies have common entries if they meet in a row. Few columns are factored densely, where pivots
//! may be chosen; many by the crate's sparse Cholesky factorisation, whose order of elimination is that of the graph of
//! all candidate rows and is found once.

use std::cell::Cell;
use std::rc::Rc;

use super::alone::{alone, null_vector};
use super::column_map::ColumnMap;
use super::gram_pattern::GramPattern;
use super::kernel_motion::{KernelMotion, NOTHING, NOTHING_SOLVED};
use super::weak::weak_columns;
use super::woodbury::WoodburyFactor;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::{Semidefinite, DEPENDENT};
use cholesky::shared::SharedCholesky;
use cholesky::team::FactorTeam;

/// Largest number of rigid motions for dense algebra.
pub const FEW: usize = 150;

/// If a step of inverse iteration magnifies by less than the inverse of this, the matrix is regular: of a null vector
/// that is magnified by 1e13 and more the start would have less than 1e-6.
pub(super) const REGULAR: f64 = 1e-7;

/// The smallest pivot of a weighted product, relative to its diagonal entry. Below it a factor has less than three
/// digits.
const WEIGHTED: f64 = 1e-13;

/// The diagonal entry of a column that is left out: its root divides what other columns have in common with it.
const OUT: f64 = 1e300;

/// A factor of A = GᵀG, scaled to a unit diagonal.
pub(super) enum GramFactor {
    Dense(Semidefinite),
    Sparse {
        factor: SharedCholesky,
        /// Zero for columns that are left out.
        scale: Vec<f64>,
    },
    /// That of fewer rows, and some more rows.
    Raised(Box<WoodburyFactor>),
}

/// GᵀG, factored; dependent columns are left out. Answers are the same on every rank.
pub struct Gram {
    pub(super) factor: GramFactor,
    pub(super) known: Rc<ColumnMap>,
    /// The names of columns that are left out, increasing.
    pub dropped: Vec<u32>,
    /// A basis of the motions on which the rows vanish: one for each column that is left out, in their order.
    pub unheld: Vec<KernelMotion>,
    /// Smallest eigenvalue of the scaled matrix by inverse iteration; zero before that, and where it is tiny.
    pub(super) smallest: Cell<f64>,
}

impl Gram {
    /// Factors `a`, a GᵀG of this shape. A rank needs the rows that it has in the factor, and all of few columns.
    /// Collective.
    pub fn new(shape: &GramPattern, a: Csr) -> Gram {
        Gram::without(shape, a, (&[], &[]))
    }

    /// Factors `a`, a GᵀG of this shape. If it has many columns, those in `hidden`, given by name, are left out as
    /// well: each depends on the others though its pivot does not show it. Single bodies are free to move where the
    /// rows do no more than `noise`, given for each column of their body; it is empty where directions are exact.
    /// Collective.
    pub fn without(shape: &GramPattern, a: Csr, (hidden, noise): (&[u32], &[f64])) -> Gram {
        match shape.team() {
            None => Gram::few(shape, &a, noise),
            Some(team) => Gram::many(shape, team, a, (hidden, noise)),
        }
    }

    fn few(shape: &GramPattern, a: &Csr, noise: &[f64]) -> Gram {
        let mut dense = Dense::zeros(a.n(), a.n());
        for i in 0..a.n() {
            let (col, val) = a.row(i);
            for (&j, &v) in col.iter().zip(val) {
                dense.set(i, j as usize, v);
            }
        }
        let factor = Semidefinite::new(&without_weak(shape, &dense, noise));
        let dropped = factor.dropped();
        let vector = |&k: &usize| {
            let v = null_vector(&dense, &factor, k);
            KernelMotion::above(NOTHING, (0..).zip(v.iter().copied()))
        };
        Gram {
            unheld: dropped.iter().map(vector).collect(),
            dropped: dropped.iter().map(|&k| k as u32).collect(),
            factor: GramFactor::Dense(factor),
            known: shape.known.clone(),
            smallest: Cell::new(0.0),
        }
    }

    fn many(
        shape: &GramPattern,
        team: &Rc<FactorTeam>,
        mut a: Csr,
        (hidden, noise): (&[u32], &[f64]),
    ) -> Gram {
        let known = &shape.known;
        let mut scale = scale_own_rows(shape, team, &mut a);
        // Most motions that nothing holds are of one body alone. They are found in its block.
        let mut alone = alone((&shape.pattern, known), team, &a, (&scale, noise));
        let minus = hidden.iter().map(|&k| minus_column(known, team, &a, k));
        let minus: Vec<Vec<f64>> = minus.collect();
        for k in alone.iter().map(|m| &m.0).chain(hidden) {
            if let Some(k) = known.here(*k) {
                leave_out(team, &mut a, k);
            }
        }
        let (factor, together) = SharedCholesky::semidefinite(&a, team.clone(), DEPENDENT);
        let mut dropped: Vec<u32> = alone.iter().map(|m| m.0).collect();
        dropped.extend(together.iter().chain(hidden));
        dropped.sort_unstable();
        let vectors = factor.null_vectors(&together, &scale).into_iter();
        alone.extend(
            together
                .iter()
                .zip(vectors)
                .map(|(&k, v)| (k, KernelMotion::above(NOTHING_SOLVED, v.iter().copied()))),
        );
        let left_out: Vec<u32> = dropped.iter().filter_map(|&k| known.here(k)).collect();
        alone.extend(hidden.iter().zip(minus).map(|(&k, mut v)| {
            solve(&factor, known, &mut v); /*                   v ← −A_JJ⁻¹ A_Jk, v_k = 1 */
            left_out.iter().for_each(|&k| v[k as usize] = 0.0);
            if let Some(k) = known.here(k) {
                v[k as usize] = 1.0;
            }
            v.iter_mut().zip(&scale).for_each(|(v, s)| *v *= s);
            (k, known.motion(team.comm(), &v, NOTHING_SOLVED))
        }));
        alone.sort_by_key(|m| m.0);
        left_out.iter().for_each(|&k| scale[k as usize] = 0.0);
        Gram {
            factor: GramFactor::Sparse { factor, scale },
            known: known.clone(),
            dropped,
            unheld: alone.into_iter().map(|m| m.1).collect(),
            smallest: Cell::new(0.0),
        }
    }

    /// The factor of a weighted product GᵀQG, Q positive definite, that leaves out the columns that `plain` leaves out:
    /// weights do not change what rows hold, but hide it where they differ by many orders. `None` if the columns are
    /// few, or dependent beyond that after rounding. Collective.
    pub fn weighted(shape: &GramPattern, mut a: Csr, plain: &Gram) -> Option<Gram> {
        let team = shape.team()?;
        let mut scale = scale_own_rows(shape, team, &mut a);
        for k in plain.dropped.iter().filter_map(|&k| shape.known.here(k)) {
            leave_out(team, &mut a, k);
            scale[k as usize] = 0.0;
        }
        let (factor, more) = SharedCholesky::semidefinite(&a, team.clone(), WEIGHTED);
        more.is_empty().then(|| Gram {
            factor: GramFactor::Sparse { factor, scale },
            known: shape.known.clone(),
            dropped: plain.dropped.clone(),
            unheld: Vec::new(),
            smallest: Cell::new(0.0),
        })
    }

    /// x ← A⁺ x for a vector of columns that is the same wherever they are known, zero in those that are left out.
    /// Collective.
    pub fn solve(&self, x: &mut [f64]) {
        match &self.factor {
            GramFactor::Dense(factor) => factor.solve(x),
            GramFactor::Sparse { factor, scale } => {
                x.iter_mut().zip(scale).for_each(|(x, s)| *x *= s);
                solve(factor, &self.known, x);
                x.iter_mut().zip(scale).for_each(|(x, s)| *x *= s);
            }
            GramFactor::Raised(raised) => raised.solve(x),
        }
    }

    /// A⁺ b for a vector b that no rank has whole ([`SharedCholesky::solve_shares`]), of many columns. Collective.
    ///
    /// # Panics
    /// If the columns are few.
    pub fn solve_shares(&self, x: &mut [f64]) {
        let (factor, scale) = match &self.factor {
            GramFactor::Sparse { factor, scale } => (factor, scale),
            GramFactor::Raised(raised) => return raised.solve_shares(x),
            GramFactor::Dense(_) => unreachable!("few columns are not shared"),
        };
        let scaled = |x: &mut [f64]| {
            let pairs = x.iter_mut().zip(factor.team().dofs());
            pairs.for_each(|(v, c)| *v *= scale[c as usize]);
        };
        scaled(x);
        factor.solve_shares(x);
        scaled(x);
    }

    /// Number of columns, r.
    pub fn r(&self) -> usize {
        self.known.r()
    }

    /// The columns that this rank knows.
    pub fn known(&self) -> &Rc<ColumnMap> {
        &self.known
    }

    /// About the smallest eigenvalue of the matrix, scaled to a unit diagonal. Zero where it is tiny, or not known
    /// because [`weakest`](Gram::weakest) has not been asked.
    pub fn smallest_eigenvalue(&self) -> f64 {
        match &self.factor {
            GramFactor::Raised(raised) => raised.smallest_eigenvalue(),
            _ => self.smallest.get(),
        }
    }

    /// Whether the factor is a sparse one.
    pub fn is_sparse(&self) -> bool {
        !matches!(self.factor, GramFactor::Dense(_))
    }
}

/// Few columns without those of single bodies that are best left out: their motions count as free.
fn without_weak(shape: &GramPattern, a: &Dense, noise: &[f64]) -> Dense {
    let mut out = a.clone();
    if noise.is_empty() {
        return out;
    }
    for columns in (0..shape.pattern.n_bodies()).map(|b| shape.pattern.columns(b)) {
        let (first, n) = (columns.start, columns.len());
        let block = Dense::from_fn(n, n, |i, j| a.get(first + i, first + j));
        for k in weak_columns(&block, noise.get(first).copied().unwrap_or(0.0)) {
            for i in 0..a.rows {
                out.set(i, first + k, 0.0);
                out.set(first + k, i, 0.0);
            }
        }
    }
    out
}

/// x ← A⁺ x for the scaled matrix of this factor. Collective.
fn solve(factor: &SharedCholesky, known: &ColumnMap, x: &mut [f64]) {
    if !known.is_part() {
        return factor.solve(x);
    }
    let team = factor.team();
    let (n_own, n_ghosts) = team.sizes();
    let mut shares: Vec<f64> = team.own_dofs().map(|c| x[c as usize]).collect();
    shares.resize(n_own + n_ghosts, 0.0);
    factor.solve_shares(&mut shares);
    let own = team.own_dofs().zip(&shares);
    own.for_each(|(c, v)| x[c as usize] = *v);
    known.tell(team.comm(), x);
}

/// The column of −A with this name, without its diagonal entry. A rank has its own rows. Collective.
fn minus_column(known: &ColumnMap, team: &FactorTeam, a: &Csr, name: u32) -> Vec<f64> {
    let mut out = vec![0.0; a.n()];
    if let Some(k) = known.here(name).filter(|&k| team.has(k)) {
        let (col, val) = a.row(k as usize);
        for (&j, &v) in col.iter().zip(val).filter(|e| *e.0 != k) {
            out[j as usize] = -v;
        }
    }
    known.sum(team.comm(), &mut out);
    out
}

/// Leaves a column out.
fn leave_out(team: &FactorTeam, a: &mut Csr, column: u32) {
    if team.has(column) {
        a.set_diagonal(column as usize, OUT);
    }
}

/// The diagonal of a matrix of which each rank has its rows. Collective.
pub(super) fn diagonal_of_own_rows(known: &ColumnMap, team: &FactorTeam, a: &Csr) -> Vec<f64> {
    let mut diagonal = vec![0.0; a.n()];
    for dof in team.own_dofs() {
        diagonal[dof as usize] = a.get(dof as usize, dof as usize);
    }
    known.sum(team.comm(), &mut diagonal);
    diagonal
}

/// A ← D⁻¹ A D⁻¹ with D² the diagonal of A, in the rows that this rank has; returns 1/D, one where the diagonal
/// vanishes. Collective.
fn scale_own_rows(shape: &GramPattern, team: &FactorTeam, a: &mut Csr) -> Vec<f64> {
    let diagonal = diagonal_of_own_rows(&shape.known, team, a);
    scale(a, &diagonal, team.own_dofs().map(|dof| dof as usize))
}

/// A ← D⁻¹ A D⁻¹ with D² the diagonal of A; returns 1/D, one where the diagonal vanishes.
pub fn scale_to_unit_diagonal(a: &mut Csr) -> Vec<f64> {
    let (diagonal, all) = (a.diagonal(), 0..a.n());
    scale(a, &diagonal, all)
}

/// A ← D⁻¹ A D⁻¹ in these rows, with D² this diagonal; returns 1/D, one where the diagonal vanishes.
fn scale(a: &mut Csr, diagonal: &[f64], rows: impl Iterator<Item = usize>) -> Vec<f64> {
    let of = |&d: &f64| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 };
    let scale: Vec<f64> = diagonal.iter().map(of).collect();
    for i in rows {
        for k in a.row_ptr[i]..a.row_ptr[i + 1] {
            a.val[k] = a.val[k] * scale[i] * scale[a.col[k] as usize];
        }
    }
    scale
}
