//! Deflation of what coefficients that jump inside bodies leave above τ (method section 5b).
//!
//! ```text
//!     W = P M⁻¹ [ P_iᵀ F_i μ ],    P_2 = I − W (Wᵀ F W)⁺ Wᵀ F
//! ```
//!
//! The columns μ are the top of the pencils of the bodies, one body after the other ([`pencil`], [`search`]); they are found once, with the rows that
//! hold to begin with. M⁻¹ becomes P_2 M⁻¹ P_2ᵀ, and λ₀ gets the part of the solution in range W: every Krylov method then works in
//! the F-orthogonal complement of W without knowing of it.
//!
//! W without P is sparse: a column lives on its body and those next to it. P = I − Q G (Gᵀ Q G)⁻¹ Gᵀ stays a factor, and so it does in F P W:
//!
//! ```text
//!     P W = W − Q G X,    F P W = F W − F Q G X,    X = (Gᵀ Q G)⁻¹ Gᵀ W
//! ```

pub mod balance;
pub mod graph;
pub mod pencil;
pub mod search;
pub mod sweep;
pub mod whole;

use std::time::Instant;

use mpi::topology::SimpleCommunicator;

use self::balance::Balance;
use self::graph::BodyGraph;
use self::pencil::Pencil;
use self::sweep::Column;
use self::whole::Whole;
use super::dual::Dual;
use super::exchange::{max_all, sum_all};
use super::local::dense::Dense;
use super::local::semidefinite::Semidefinite;
use super::rows::Rows;
use super::settings::Adaptive;
use super::spectrum::Spectrum;
use crate::petsc::{Session, Vec as PetscVec};
use crate::substructures::Substructures;
use crate::Result;

/// What was found and what it cost; the same on every rank except for the seconds.
#[derive(Debug, Clone, Default)]
pub struct Cost {
    /// τ.
    pub tau: f64,
    /// Vectors of every body.
    pub vectors: Vec<usize>,
    /// Vectors that bodies share, found afterwards.
    pub shared: usize,
    /// Bodies with more vectors above τ than the cap allows, or whose vectors did not settle.
    pub capped: Vec<usize>,
    /// The largest Ritz value of all bodies that is deflated; 0 where none is.
    pub largest: f64,
    /// Vectors that depended on others.
    pub dependent: usize,
    /// The spectrum that the iterations saw before the search.
    pub before: Option<Spectrum>,
    /// Seconds of the search and of the matrices.
    pub seconds: f64,
}

/// Vectors of neighbours may show the same mode. What is left of one after the others, relative to it and squared in the F-norm, must be
/// more than this to count: it carries the rounding of F W divided by it.
const DEPENDENT: f64 = 1e-10;

/// Coefficients of a body whose largest is more than this many times the smallest jump.
pub const JUMPS: f64 = 1e2;

/// The largest ratio of two scaling weights in one body. Collective.
pub fn varies(comm: &SimpleCommunicator, problem: &Substructures) -> f64 {
    let n = problem.n_bodies;
    // −smallest beside the largest, so that one reduction does.
    let mut ends = vec![f64::NEG_INFINITY; 2 * n];
    for sub in &problem.local {
        for &rho in &sub.rho {
            ends[sub.body] = ends[sub.body].max(rho);
            ends[n + sub.body] = ends[n + sub.body].max(-rho);
        }
    }
    max_all(comm, &mut ends);
    let ratio = |b: usize| ends[b] / -ends[n + b];
    (0..n)
        .map(ratio)
        .filter(|r| r.is_finite())
        .fold(1.0, f64::max)
}

/// The eigenvalue at which an iteration is broken off so that those above τ are deflated; `varies` is the largest ratio of coefficients
/// inside a body.
///
/// Where coefficients do not vary, κ is what the mesh makes it, and `auto` leaves it alone unless it is far off.
pub fn watch(adaptive: Adaptive, varies: f64) -> Option<f64> {
    match adaptive {
        Adaptive::Off => None,
        Adaptive::Auto if varies > JUMPS => Some(1.5 * Adaptive::USUAL),
        Adaptive::Auto => Some(20.0 * Adaptive::USUAL),
        Adaptive::Below(tau) => Some(1.2 * tau),
    }
}

/// Rows Y without the kernel part: Y − Q X with sparse Y, Q.
struct Split {
    y: Rows,
    q: Option<Rows>,
}

/// P_2 for the rows that hold.
pub struct Deflation {
    /// What it cost.
    pub cost: Cost,
    graph: BodyGraph,
    balance: Balance,
    /// M⁻¹ P_iᵀ F_i μ with all rows that the search knew.
    columns: Vec<Column>,
    /// P W and F P W.
    w: Split,
    fw: Split,
    /// X, r × the number of columns.
    x: Dense,
    /// Wᵀ Pᵀ F P W.
    e: Semidefinite,
}

impl Deflation {
    /// Searches all bodies for vectors above `tau`, at most `most` in each. Collective.
    pub fn new(
        session: &Session,
        problem: &Substructures,
        dual: &Dual,
        tau: f64,
        most: usize,
    ) -> Result<Deflation> {
        let clock = Instant::now();
        let graph = BodyGraph::new(session.comm(), problem, &dual.stiffness);
        let bodies: Vec<u32> = (0..graph.n as u32).collect();
        let mut cost = Cost {
            tau,
            vectors: vec![0; graph.n],
            ..Cost::default()
        };
        let mut jumps: Vec<(u32, Column)> = Vec::new();
        let owners: Vec<usize> = problem.local.iter().map(|s| s.body).collect();
        let mut balance = Balance::new(dual, &owners, graph.n);
        for colour in graph.colours(&bodies) {
            let pencil = Pencil::new(session, problem, dual, &graph, &colour)?;
            balance.take(session, dual, &pencil)?;
            let found = search::top(&pencil, tau, most, |slot, _, image| {
                let entries = pencil.parts[slot]
                    .clone()
                    .map(|i| (pencil.rows[i], image[i]));
                let body = pencil.bodies[slot];
                let column = Column {
                    entries: entries.filter(|e| e.1 != 0.0).collect(),
                    reach: graph.near[body as usize].clone(),
                };
                jumps.push((body, column));
            })?;
            for (body, found) in colour.iter().zip(&found) {
                let body = *body as usize;
                cost.vectors[body] = found.theta.len();
                cost.largest = found.theta.iter().fold(cost.largest, |a, t| a.max(*t));
                if found.capped {
                    cost.capped.push(body);
                }
            }
        }
        cost.capped.sort_unstable();
        // By body, whatever the colours are.
        jumps.sort_by_key(|j| j.0);
        let jumps: Vec<Column> = jumps.into_iter().map(|j| j.1).collect();
        let columns = sweep::images(&dual.multipliers()?, &graph, &jumps, |x, y| dual.m(x, y))?;
        let (w, fw, x, e) = matrices(session, dual, &graph, &balance, &columns)?;
        cost.dependent = columns.len() - e.rank();
        cost.seconds = clock.elapsed().as_secs_f64();
        Ok(Deflation {
            cost,
            graph,
            balance,
            columns,
            w,
            fw,
            x,
            e,
        })
    }

    /// Deflates what is still above `bound` in the whole problem, at most `most` vectors; returns how many there were. Collective.
    pub fn polish(
        &mut self,
        session: &Session,
        dual: &Dual,
        bound: f64,
        most: usize,
    ) -> Result<usize> {
        let clock = Instant::now();
        let everywhere: Vec<u32> = (0..self.graph.n as u32).collect();
        let mut found = Vec::new();
        let whole = Whole::new(session, dual, self)?;
        search::top(&whole, bound, most, |_, vector, _| {
            let entries = vector.iter().enumerate().filter(|e| *e.1 != 0.0);
            found.push(Column {
                entries: entries.map(|(row, &v)| (row as u32, v)).collect(),
                reach: everywhere.clone(),
            });
        })?;
        let n = found.len();
        if n > 0 {
            self.columns.extend(found);
            (self.w, self.fw, self.x, self.e) =
                matrices(session, dual, &self.graph, &self.balance, &self.columns)?;
            self.cost.shared += n;
        }
        self.cost.seconds += clock.elapsed().as_secs_f64();
        Ok(n)
    }

    /// Number of vectors.
    pub fn n(&self) -> usize {
        self.columns.len()
    }

    /// Masks W by the rows that hold now and renews what follows from it. Collective.
    pub fn renew(&mut self, session: &Session, dual: &Dual) -> Result<()> {
        if self.columns.is_empty() {
            return Ok(());
        }
        let active = &dual.stiffness.jump.active;
        let mask = |column: &Column| Column {
            entries: column
                .entries
                .iter()
                .copied()
                .filter(|e| active[e.0 as usize])
                .collect(),
            reach: column.reach.clone(),
        };
        let columns: Vec<Column> = self.columns.iter().map(mask).collect();
        (self.w, self.fw, self.x, self.e) =
            matrices(session, dual, &self.graph, &self.balance, &columns)?;
        Ok(())
    }

    /// λ ← P_2 λ for λ in V. Collective.
    pub fn project(&self, session: &Session, lambda: &PetscVec) -> Result<()> {
        if self.columns.is_empty() {
            return Ok(());
        }
        let mut c = self.transpose(session, &self.fw, lambda)?; /* c ← (F P W)ᵀ λ     */
        self.e.solve(&mut c); /*                                    c ← E⁺ c           */
        self.add(-1.0, &self.w, &c, lambda) /*                      λ ← λ − P W c      */
    }

    /// r ← P_2ᵀ r. Collective.
    pub fn project_transpose(&self, session: &Session, residual: &PetscVec) -> Result<()> {
        if self.columns.is_empty() {
            return Ok(());
        }
        let mut c = self.transpose(session, &self.w, residual)?; /* c ← (P W)ᵀ r       */
        self.e.solve(&mut c); /*                                    c ← E⁺ c           */
        self.add(-1.0, &self.fw, &c, residual) /*                   r ← r − F P W c    */
    }

    /// out ← out + W (Wᵀ F W)⁺ Wᵀ r: the part of the solution in range W. Collective.
    pub fn solve(&self, session: &Session, residual: &PetscVec, out: &PetscVec) -> Result<()> {
        let mut c = self.transpose(session, &self.w, residual)?;
        self.e.solve(&mut c);
        self.add(1.0, &self.w, &c, out)
    }

    /// (Y − Q X)ᵀ v.
    fn transpose(&self, session: &Session, of: &Split, v: &PetscVec) -> Result<Vec<f64>> {
        let (k, r) = (self.x.cols, self.x.rows);
        let mut c = vec![0.0; k + r];
        {
            let v = v.array()?;
            let (columns, kernels) = c.split_at_mut(k);
            of.y.add_transpose(&v, columns);
            if let Some(q) = &of.q {
                q.add_transpose(&v, kernels);
            }
        }
        sum_all(session.comm(), &mut c);
        let mut kernels = c.split_off(k);
        kernels.iter_mut().for_each(|v| *v = -*v);
        self.x.add_mul_transpose(&kernels, &mut c);
        Ok(c)
    }

    /// v ← v + α (Y − Q X) c.
    fn add(&self, alpha: f64, of: &Split, c: &[f64], v: &PetscVec) -> Result<()> {
        let mut v = v.array_mut()?;
        of.y.add(alpha, c, &mut v);
        if let Some(q) = &of.q {
            let mut kernels = vec![0.0; self.x.rows];
            self.x.add_mul(c, &mut kernels);
            q.add(-alpha, &kernels, &mut v);
        }
        Ok(())
    }
}

/// W, F W, X and Wᵀ F W of given columns. Collective.
fn matrices(
    session: &Session,
    dual: &Dual,
    graph: &BodyGraph,
    balance: &Balance,
    columns: &[Column],
) -> Result<(Split, Split, Dense, Semidefinite)> {
    let n = dual.stiffness.jump.n_owned;
    let (k, r) = (columns.len(), dual.natural.r);
    let like = dual.multipliers()?;
    let f = |x: &PetscVec, y: &PetscVec| balance.f(session, dual, x, y);
    let w = sweep::rows(n, columns);
    let fw = sweep::rows(n, &sweep::images(&like, graph, columns, f)?);
    let mut x = Dense::zeros(r, k);
    let mut kernels = None;
    if r > 0 && k > 0 {
        for i in 0..n {
            for (g, gv) in dual.natural.g().row(i) {
                w.row(i).for_each(|(c, wv)| x.data[g + c * r] += gv * wv);
            }
        }
        sum_all(session.comm(), &mut x.data);
        for c in 0..k {
            dual.natural.solve_gtg(x.col_mut(c))?;
        }
        let natural = &dual.natural;
        let qg = sweep::kernel_columns(natural.qg(), &dual.stiffness.space.kernel_start, |b| {
            graph.around(&graph.near[b])
        });
        let fqg = sweep::rows(n, &sweep::images(&like, graph, &qg, f)?);
        kernels = Some((sweep::rows(n, &qg), fqg));
    }
    let (qg, fqg) = kernels.unzip();
    let (w, fw) = (Split { y: w, q: qg }, Split { y: fw, q: fqg });
    let e = gram(session, &w, &fw, &x);
    Ok((w, fw, x, Semidefinite::above(&e, DEPENDENT)))
}

/// (Y_w − Q_w X)ᵀ (Y_f − Q_f X). Collective.
fn gram(session: &Session, w: &Split, f: &Split, x: &Dense) -> Dense {
    let (r, k) = (x.rows, x.cols);
    // The products of all columns, kernel ones after the others: [Y Q]ᵀ F [Y Q].
    let m = k + if w.q.is_some() { r } else { 0 };
    let mut a = Dense::zeros(m, m);
    let of = |s: &Split, i: usize, out: &mut Vec<(usize, f64)>| {
        out.clear();
        out.extend(s.y.row(i));
        out.extend(s.q.iter().flat_map(|q| q.row(i).map(|(c, v)| (k + c, v))));
    };
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for i in 0..w.y.n() {
        of(w, i, &mut left);
        of(f, i, &mut right);
        for &(p, pv) in &left {
            let column = a.col_mut(p);
            right.iter().for_each(|&(q, qv)| column[q] += pv * qv);
        }
    }
    sum_all(session.comm(), &mut a.data);
    let entry = |i: usize, j: usize| 0.5 * (a.get(i, j) + a.get(j, i));
    let mut e = Dense::zeros(k, k);
    let mut column = vec![0.0; m];
    for j in 0..k {
        for (i, c) in column.iter_mut().enumerate() {
            *c = entry(i, j);
            for g in k..m {
                *c -= entry(i, g) * x.get(g - k, j);
            }
        }
        for i in 0..k {
            let kernels = (k..m).map(|g| x.get(g - k, i) * column[g]);
            e.set(i, j, column[i] - kernels.sum::<f64>());
        }
    }
    e
}
