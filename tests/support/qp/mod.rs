//! A reference for contact problems: quadratic programs with a semidefinite matrix and dependent rows, solved and
//! certified.
//!
//! ```text
//!     min ½ uᵀKu − fᵀu    subject to    B_E u = c_E,   B_I u ≤ c_I
//! ```
//!
//! A solution exists if and only if the rows can be satisfied and no motion in the kernel of K lowers the energy
//! without bound. Both questions are decided first, each by a quadratic program that always has a solution; this
//! solution is the proof that rows contradict each other, or that there is an unbounded motion. The problem itself is
//! then solved by an interior point method. Its active set is identified, and the equations on it are solved to
//! rounding. Every result satisfies its own KKT conditions.

pub mod certificate;
mod cone;
mod interior;
mod kkt;
mod polish;
pub mod scaled;

use base::linalg::csr::Csr;
use faer::{Mat, Side};

pub use certificate::Kkt;

/// Limit of all KKT residuals of a reference.
pub const CERTIFIED: f64 = 1e-11;

/// Residuals with which no other regularisation is tried. What bodies hardly resist is not yet in place with residuals
/// above it.
const ROUNDING: f64 = 1e-14;

/// The regularisation on the diagonal of singular systems, relative to the problem's own diagonal. Where a soft body
/// holds a stiff one, the loads on the latter are small compared with it; then a smaller value is tried, at the cost of
/// digits in the factorisation.
const EPSILON: [f64; 3] = [1e-7, 1e-9, 1e-11];

/// Σ coefficient · u(index), and the right-hand side.
#[derive(Debug, Clone, Default)]
pub struct Row {
    pub terms: Vec<(usize, f64)>,
    pub rhs: f64,
}

impl Row {
    pub fn new(terms: impl Into<Vec<(usize, f64)>>, rhs: f64) -> Row {
        Row {
            terms: terms.into(),
            rhs,
        }
    }

    /// (B u)_r.
    pub fn times(&self, u: &[f64]) -> f64 {
        self.terms.iter().map(|&(i, b)| b * u[i]).sum()
    }

    pub fn norm(&self) -> f64 {
        self.terms.iter().map(|&(_, b)| b * b).sum::<f64>().sqrt()
    }
}

/// The problem. Rows may depend on each other.
#[derive(Debug, Clone)]
pub struct Qp {
    /// K, symmetric positive semidefinite.
    pub k: Csr,
    pub f: Vec<f64>,
    /// Equations, then inequalities.
    pub equal: Vec<Row>,
    pub below: Vec<Row>,
    /// Columns that span the kernel of K, sparse.
    pub kernel: Vec<Vec<(usize, f64)>>,
}

/// A certified solution.
#[derive(Debug, Clone)]
pub struct Solved {
    pub u: Vec<f64>,
    /// Multipliers with K u + B_Eᵀ λ_E + B_Iᵀ λ_I = f; they are not unique where rows are dependent.
    pub equal: Vec<f64>,
    pub below: Vec<f64>,
    /// Inequality rows on which the equations were solved: (B u)_r = c_r.
    pub closed: Vec<usize>,
    pub energy: f64,
    pub kkt: Kkt,
}

/// The outcome of a problem, with its proof.
#[derive(Debug, Clone)]
pub enum Outcome {
    Solved(Solved),
    /// A motion z with K z = 0, B_E z = 0, B_I z ≤ 0 and fᵀz > 0, largest entry 1.
    Unbounded(Vec<f64>),
    /// Weights y, y_I ≥ 0, with Bᵀy = 0 and cᵀy < 0: equations, then inequalities.
    Infeasible(Vec<f64>),
}

impl Outcome {
    pub fn solved(self) -> Solved {
        match self {
            Outcome::Solved(solved) => solved,
            Outcome::Unbounded(_) => panic!("the energy has no lower bound"),
            Outcome::Infeasible(_) => panic!("the rows contradict each other"),
        }
    }
}

impl Qp {
    /// A problem with a dense K, whose kernel is found from its eigenvalues.
    pub fn dense(k: &Mat<f64>, f: &[f64], equal: Vec<Row>, below: Vec<Row>) -> Qp {
        let n = k.nrows();
        assert_eq!((k.ncols(), f.len()), (n, n));
        let mut triplets = Vec::new();
        for i in 0..n {
            for j in 0..n {
                assert!((k[(i, j)] - k[(j, i)]).abs() <= 1e-14 * k.norm_max());
                if k[(i, j)] != 0.0 {
                    triplets.push((i as u32, j as u32, 0.5 * (k[(i, j)] + k[(j, i)])));
                }
            }
        }
        let qp = Qp {
            k: Csr::from_triplets(n, &triplets),
            f: f.to_vec(),
            equal,
            below,
            kernel: Vec::new(),
        };
        // Coefficients of different size must not be mistaken for a kernel: the eigenvalues are those of the matrix
        // with unit diagonal.
        let d = scaled::weights(&qp);
        let unit = Mat::from_fn(n, n, |i, j| 0.5 * d[i] * (k[(i, j)] + k[(j, i)]) * d[j]);
        let eigen = unit.self_adjoint_eigen(Side::Lower).expect("eigenvalues");
        let values = eigen.S().column_vector();
        let kernel = (0..n).filter(|&j| {
            assert!(values[j] > -1e-12, "K has the eigenvalue {}", values[j]);
            assert!(
                !(1e-12..1e-9).contains(&values[j]),
                "whether K is singular cannot be told: eigenvalue {}",
                values[j]
            );
            values[j] < 1e-12
        });
        let column = |j: usize| (0..n).map(|i| (i, d[i] * eigen.U()[(i, j)])).collect();
        let kernel = kernel.map(column).collect();
        Qp { kernel, ..qp }
    }

    pub fn energy(&self, u: &[f64]) -> f64 {
        let mut ku = vec![0.0; u.len()];
        self.k.mul(u, &mut ku);
        let half = |i: usize| (0.5 * ku[i] - self.f[i]) * u[i];
        (0..u.len()).map(half).sum()
    }

    /// The energy of a solution, −½ (fᵀu + λᵀc). What it loses to rounding does not grow with motions of bodies that
    /// nothing loads, as ½ uᵀKu does.
    fn minimal_energy(&self, u: &[f64], equal: &[f64], below: &[f64]) -> f64 {
        let work: f64 = self.f.iter().zip(u).map(|(f, u)| f * u).sum();
        let rows = self.equal.iter().chain(&self.below);
        let forces = rows.zip(equal.iter().chain(below));
        -0.5 * (work + forces.map(|(row, l)| row.rhs * l).sum::<f64>())
    }

    /// A bound of the rounding of [`Qp::energy`].
    pub fn rounding(&self, u: &[f64]) -> f64 {
        let terms = |i: usize| -> f64 {
            let (col, val) = self.k.row(i);
            let row = col.iter().zip(val);
            let row: f64 = row.map(|(&j, v)| (v * u[j as usize]).abs()).sum();
            (row + self.f[i].abs()) * u[i].abs()
        };
        4.0 * f64::EPSILON * (0..u.len()).map(terms).sum::<f64>()
    }

    /// Solves the problem, or proves that it has no solution.
    ///
    /// # Panics
    /// Where neither a solution nor its absence can be certified.
    pub fn solve(&self) -> Outcome {
        if let Some(y) = self.contradiction() {
            return Outcome::Infeasible(y);
        }
        if let Some(z) = self.descent() {
            return Outcome::Unbounded(z);
        }
        Outcome::Solved(self.minimum())
    }

    /// The minimum of a problem that is known to have one.
    fn minimum(&self) -> Solved {
        let mut sides = self.equal.iter().chain(&self.below).map(|r| r.rhs);
        if sides.all(|c| c == 0.0) && self.f.iter().all(|&f| f == 0.0) {
            return Solved {
                u: vec![0.0; self.f.len()],
                equal: vec![0.0; self.equal.len()],
                below: vec![0.0; self.below.len()],
                closed: (0..self.below.len()).collect(),
                energy: 0.0,
                kkt: Kkt::default(),
            };
        }
        self.polished(&|problem, _, epsilon| interior::solve(problem, epsilon))
    }

    /// As [`Qp::solve`] for a problem that has a solution, from a guess: the equations are solved on the rows that hold
    /// there, and rows exchanged until all signs are right. The guess decides nothing but the time: what comes out
    /// satisfies all conditions.
    ///
    /// # Panics
    /// Where no solution is certified.
    pub fn near(&self, u: &[f64], equal: &[f64], below: &[f64]) -> Solved {
        self.polished(&|problem, scales, _| scales.to(problem, u, equal, below))
    }

    /// The certified solution from starts that depend on ε.
    fn polished(&self, start: &dyn Fn(&Qp, &scaled::Scales, f64) -> scaled::Point) -> Solved {
        let (problem, scales) = scaled::scale(self);
        let solved = |point: &scaled::Point| {
            let (u, equal, below) = scales.back(point);
            Solved {
                energy: self.minimal_energy(&u, &equal, &below),
                kkt: certificate::kkt(self, &u, &equal, &below),
                closed: point.closed.clone(),
                u,
                equal,
                below,
            }
        };
        let mut failed = Vec::new();
        let mut best: Option<(Solved, scaled::Point)> = None;
        'tries: for epsilon in EPSILON {
            let start = start(&problem, &scales, epsilon);
            // Bodies that nothing holds stay near their places if nothing is in their way; an interior point method
            // leaves them far from all rows.
            let near = scaled::Point {
                u: vec![0.0; start.u.len()],
                ..start.clone()
            };
            for start in [near, start] {
                let Some(point) = polish::polish(&problem, start, epsilon) else {
                    failed.push("the active sets cycle".to_string());
                    continue;
                };
                let found = solved(&point);
                let residual = found.kkt.largest();
                failed.push(format!("{:?}", found.kkt));
                let better = |(s, _): &(Solved, _)| residual < s.kkt.largest();
                if residual <= CERTIFIED && best.as_ref().is_none_or(better) {
                    best = Some((found, point));
                }
                if residual <= ROUNDING {
                    break 'tries;
                }
                if residual <= CERTIFIED {
                    break;
                }
            }
        }
        if let Some((mut best, point)) = best {
            // Residuals hardly see a motion that bodies hardly resist: refinement with less regularisation places it.
            for epsilon in &EPSILON[1..] {
                let finer = polish::polish(&problem, point.clone(), *epsilon);
                let finer = finer.as_ref().map(solved);
                let limit = best.kkt.largest().max(ROUNDING);
                best = finer.filter(|f| f.kkt.largest() <= limit).unwrap_or(best);
            }
            return best;
        }
        panic!("the reference failed its own check: {failed:?}");
    }

    /// Minimises the violation of the rows, min ½|t|² with B_E u + t_E = c_E, B_I u + t_I ≤ c_I. If t is not zero, y =
    /// −t proves that no u satisfies all rows.
    fn contradiction(&self) -> Option<Vec<f64>> {
        let rows = self.equal.len() + self.below.len();
        if rows == 0 {
            return None;
        }
        let mut index = vec![usize::MAX; self.f.len()];
        let mut n = 0;
        let mut longer = Vec::with_capacity(rows);
        for row in self.equal.iter().chain(&self.below) {
            let norm = row.norm();
            assert!(norm > 0.0, "a row without terms");
            let mut terms = Vec::new();
            for &(i, b) in &row.terms {
                if index[i] == usize::MAX {
                    index[i] = n;
                    n += 1;
                }
                terms.push((index[i], b / norm));
            }
            longer.push(Row::new(terms, row.rhs / norm));
        }
        for (r, row) in longer.iter_mut().enumerate() {
            row.terms.push((n + r, 1.0));
        }
        let size = longer.iter().fold(0.0f64, |m, row| m.max(row.rhs.abs()));
        if size == 0.0 {
            return None; // u = 0 meets all rows
        }
        let unit: Vec<_> = (n..n + rows).map(|i| (i as u32, i as u32, 1.0)).collect();
        let below = longer.split_off(self.equal.len());
        let t = Qp {
            k: Csr::from_triplets(n + rows, &unit),
            f: vec![0.0; n + rows],
            equal: longer,
            below,
            kernel: Vec::new(),
        }
        .minimum()
        .u
        .split_off(n);
        let largest = t.iter().fold(0.0f64, |m, t| m.max(t.abs()));
        if largest <= 1e-10 * size {
            return None;
        }
        let all: Vec<&Row> = self.equal.iter().chain(&self.below).collect();
        let y: Vec<f64> = (0..rows)
            .map(|r| match -t[r] / largest {
                y if r < self.equal.len() => y / all[r].norm(),
                y => y.max(0.0) / all[r].norm(),
            })
            .collect();
        // What is no proof may be rounding: whether there is a solution is then said by the solution.
        certificate::contradiction(self, &y).ok()?;
        Some(y)
    }

    /// The projection of the load on the motions in the kernel of K that no row stops. If it is not zero, the energy
    /// decreases along it without bound.
    fn descent(&self) -> Option<Vec<f64>> {
        if self.kernel.is_empty() {
            return None;
        }
        certificate::check_kernel(self);
        let d = scaled::weights(self);
        // Columns of unit length in the scale of K.
        let columns: Vec<Vec<(usize, f64)>> = self
            .kernel
            .iter()
            .map(|z| {
                let norm = z.iter().map(|&(i, v)| (v / d[i]).powi(2)).sum::<f64>();
                z.iter().map(|&(i, v)| (i, v / norm.sqrt())).collect()
            })
            .collect();
        let e: Vec<f64> = columns
            .iter()
            .map(|z| z.iter().map(|&(i, v)| self.f[i] * v).sum())
            .collect();
        let load = (0..d.len()).map(|i| (self.f[i] * d[i]).powi(2));
        let load = load.sum::<f64>().sqrt();
        if e.iter().all(|e| e.abs() <= 1e-12 * load) {
            return None;
        }
        let mut touching: Vec<Vec<(usize, f64)>> = vec![Vec::new(); self.f.len()];
        for (j, z) in columns.iter().enumerate() {
            z.iter().for_each(|&(i, v)| touching[i].push((j, v)));
        }
        let project = |rows: &[Row]| -> Vec<Vec<f64>> {
            let mut out = Vec::new();
            for row in rows {
                let mut sums = vec![0.0; columns.len()];
                for &(i, b) in &row.terms {
                    touching[i].iter().for_each(|&(j, v)| sums[j] += b * v);
                }
                let norm = row.terms.iter().map(|&(i, b)| (b * d[i]).powi(2));
                let norm = norm.sum::<f64>().sqrt();
                let small = |sum: &mut f64| *sum *= f64::from(u8::from(sum.abs() > 1e-12 * norm));
                sums.iter_mut().for_each(small);
                let size = sums.iter().map(|s| s * s).sum::<f64>().sqrt();
                if size > 0.0 {
                    out.push(sums.iter().map(|s| s / size).collect());
                }
            }
            out
        };
        let alpha = cone::nearest(&e, &project(&self.equal), &project(&self.below));
        let largest = alpha.iter().fold(0.0f64, |m, a| m.max(a.abs()));
        if largest <= 1e-10 * load {
            return None;
        }
        let mut z = vec![0.0; self.f.len()];
        for (column, a) in columns.iter().zip(&alpha) {
            column.iter().for_each(|&(i, v)| z[i] += v * a);
        }
        let top = z.iter().fold(0.0f64, |m, z| m.max(z.abs()));
        z.iter_mut().for_each(|z| *z /= top);
        certificate::descent(self, &z).ok()?;
        Some(z)
    }
}
