//! W, F W and Wᵀ F W for the rows that hold, and P_2 built from them.
//!
//! Without floating bodies P = I, and E = Wᵀ F W is sparse: two bodies have common entries if F leads from the columns
//! of one to the rows of the other. With floating bodies X makes E dense.

use mpi::topology::SimpleCommunicator;

use super::balanced_operator::BalancedOperator;
use super::panels::Panels;
use super::sparse::Sparse;
use crate::feti::deflation::sparse;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::graph::BodyGraph;
use crate::feti::projector::rows::KernelRows;
use crate::feti::projector::sweep::{self, MultiplierColumn};
use crate::feti::settings::ProjectorKind;
use crate::Result;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use parallel::exchange::sum_all;
use petsc::{Session, Vec as PetscVec};

/// Vectors of neighbouring bodies may contain the same mode. A vector counts as independent if the part of it that is
/// orthogonal to the others is larger than this, relative to the vector and squared in the F-norm. The rounding of F W
/// is divided by this number.
const DEPENDENT: f64 = 1e-10;

/// Largest number of columns for which E is factored as a dense matrix. That may choose its pivots and leaves P_2 two
/// more digits; a sparse factor is what more columns can afford.
const FEW: usize = 1000;

/// Columns with their kernel part removed: Y − Q X.
struct SplitColumns {
    y: Panels,
    q: Panels,
}

/// E, factored.
enum Inverse {
    Dense(Semidefinite),
    Sparse(Box<Sparse>),
}

impl Inverse {
    /// c ← E⁺ c, the same on every rank. Collective.
    fn solve(&self, c: &mut [f64]) {
        match self {
            Inverse::Dense(factor) => factor.solve(c),
            Inverse::Sparse(sparse) => sparse.solve(c),
        }
    }
}

/// P_2 in terms of P W = W − Q G X.
pub struct DeflationMatrices {
    session: Session,
    /// P W and F P W.
    w: SplitColumns,
    fw: SplitColumns,
    /// X, r × the number of columns.
    x: Dense,
    /// E = Wᵀ Pᵀ F P W.
    e: Inverse,
    /// F-norms of the columns of W.
    norms: Vec<f64>,
}

impl DeflationMatrices {
    /// Applies F to the columns and builds the matrices. The pattern of `before` is taken over where it suffices.
    /// Collective.
    pub fn new(
        dual: &Dual,
        graph: &BodyGraph,
        balance: &BalancedOperator,
        columns: &[MultiplierColumn],
        before: Option<&DeflationMatrices>,
    ) -> Result<DeflationMatrices> {
        let (k, r) = (columns.len(), dual.natural.r);
        let like = dual.multipliers()?;
        let f = |x: &[PetscVec], y: &[PetscVec]| balance.f(dual, x, y);
        let w = Panels::new(columns);
        let fw = Panels::new(&sweep::images(&like, graph, columns, f)?);
        let mut x = Dense::zeros(r, k);
        let (mut qg, mut fqg) = Default::default();
        if r > 0 && k > 0 {
            let natural = &dual.natural;
            let start = natural.columns.start();
            let near = |b: usize| graph.near[b].clone();
            let named = |rows: &KernelRows| rows.named(natural.known());
            let g = Panels::new(&sweep::kernel_columns(&named(&natural.g), start, near));
            g.add_product(&w, &mut x, (0, 0));
            sum_all(dual.comm(), &mut x.data);
            for c in 0..k {
                natural.solve_gtg(dual.comm(), x.col_mut(c))?;
            }
            // Q = M⁻¹ leads to the rows of neighbours.
            let wide = natural.projector == ProjectorKind::Preconditioner;
            let reach = |b: usize| {
                if wide {
                    graph.around(&graph.near[b])
                } else {
                    near(b)
                }
            };
            let columns = sweep::kernel_columns(&named(natural.qg()), start, reach);
            fqg = Panels::new(&sweep::images(&like, graph, &columns, f)?);
            qg = Panels::new(&columns);
        }
        let (w, fw) = (SplitColumns { y: w, q: qg }, SplitColumns { y: fw, q: fqg });
        let (e, diagonal) = match r {
            0 if k > FEW => {
                let known = before.and_then(|b| match &b.e {
                    Inverse::Sparse(sparse) => Some(sparse.shape.clone()),
                    Inverse::Dense(_) => None,
                });
                let at = graph.at.as_ref().map(|at| positions(columns, at));
                let (shape, e) = sparse::product(dual.comm(), [&w.y, &fw.y], at.as_deref(), known);
                let diagonal = e.diagonal();
                (Inverse::Sparse(Sparse::new(shape, e).into()), diagonal)
            }
            _ => {
                let e = dense(dual.comm(), &w, &fw, &x);
                let diagonal = (0..k).map(|i| e.get(i, i)).collect();
                let factor = Semidefinite::above(&e, DEPENDENT);
                (Inverse::Dense(factor), diagonal)
            }
        };
        Ok(DeflationMatrices {
            session: dual.stiffness.session.clone(),
            w,
            fw,
            x,
            norms: diagonal.iter().map(|e| e.max(0.0).sqrt()).collect(),
            e,
        })
    }

    /// Number of independent vectors.
    pub fn rank(&self) -> usize {
        match &self.e {
            Inverse::Dense(factor) => factor.rank(),
            Inverse::Sparse(sparse) => sparse.rank(),
        }
    }

    /// λ ← P_2 λ for λ in V. Collective.
    pub fn project(&self, lambda: &PetscVec) -> Result<()> {
        let mut c = self.transpose(&self.fw, lambda)?; /* c ← (F P W)ᵀ λ     */
        self.e.solve(&mut c); /*                                    c ← E⁺ c           */
        self.add(-1.0, &self.w, &c, lambda) /*                      λ ← λ − P W c      */
    }

    /// r ← P_2ᵀ r. Collective.
    pub fn project_transpose(&self, residual: &PetscVec) -> Result<()> {
        let mut c = self.transpose(&self.w, residual)?; /* c ← (P W)ᵀ r       */
        self.e.solve(&mut c); /*                                    c ← E⁺ c           */
        self.add(-1.0, &self.fw, &c, residual) /*                   r ← r − F P W c    */
    }

    /// out ← out + W (Wᵀ F W)⁺ Wᵀ r: the part of the solution in range W. Collective.
    pub fn solve(&self, residual: &PetscVec, out: &PetscVec) -> Result<()> {
        let mut c = self.transpose(&self.w, residual)?;
        self.e.solve(&mut c);
        self.add(1.0, &self.w, &c, out)
    }

    /// The size of Wᵀ r; each entry is relative to the F-norm of its vector. Collective.
    pub fn part_of(&self, residual: &PetscVec) -> Result<f64> {
        let c = self.transpose(&self.w, residual)?;
        let of = |(c, norm): (&f64, &f64)| if *norm > 0.0 { (c / norm).abs() } else { 0.0 };
        Ok(c.iter().zip(&self.norms).map(of).fold(0.0, f64::max))
    }

    /// (Y − Q X)ᵀ v.
    fn transpose(&self, of: &SplitColumns, v: &PetscVec) -> Result<Vec<f64>> {
        let (k, r) = (self.x.cols, self.x.rows);
        let mut c = vec![0.0; k + r];
        {
            let v = v.array()?;
            let (columns, kernels) = c.split_at_mut(k);
            of.y.add_transpose(&v, columns);
            of.q.add_transpose(&v, kernels);
        }
        sum_all(self.session.comm(), &mut c);
        let mut kernels = c.split_off(k);
        kernels.iter_mut().for_each(|v| *v = -*v);
        self.x.add_mul_transpose(&kernels, &mut c);
        Ok(c)
    }

    /// v ← v + α (Y − Q X) c.
    fn add(&self, alpha: f64, of: &SplitColumns, c: &[f64], v: &PetscVec) -> Result<()> {
        let mut v = v.array_mut()?;
        of.y.add(alpha, c, &mut v);
        let mut kernels = vec![0.0; self.x.rows];
        self.x.add_mul(c, &mut kernels);
        of.q.add(-alpha, &kernels, &mut v);
        Ok(())
    }
}

/// Where the panels of these columns are, from the positions of the bodies: in the middle of those that they reach.
fn positions(columns: &[MultiplierColumn], at: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let middle = |panel: &[MultiplierColumn]| {
        let bodies = &panel[0].reach;
        let sum = |d: usize| bodies.iter().map(|&b| at[b as usize][d]).sum::<f64>();
        [0, 1, 2].map(|d| sum(d) / bodies.len().max(1) as f64)
    };
    let panels = columns.chunk_by(|a, b| a.reach == b.reach);
    panels.map(middle).collect()
}

/// (Y_w − Q_w X)ᵀ (Y_f − Q_f X). Collective.
fn dense(comm: &SimpleCommunicator, w: &SplitColumns, f: &SplitColumns, x: &Dense) -> Dense {
    let k = x.cols;
    // The products of all columns, the kernel columns last: [Y Q]ᵀ F [Y Q].
    let m = k + w.q.cols;
    let mut a = Dense::zeros(m, m);
    w.y.add_product(&f.y, &mut a, (0, 0));
    w.y.add_product(&f.q, &mut a, (0, k));
    w.q.add_product(&f.y, &mut a, (k, 0));
    w.q.add_product(&f.q, &mut a, (k, k));
    sum_all(comm, &mut a.data);
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
