//! A direct solution that shares nothing with the method but the matrices of the subdomains: the assembled problem, sparse Cholesky
//! factors, refinement with residuals in twice the working precision, and for inequalities an active set around them.
//!
//! Rows of the active set are held by the method of multipliers: K + BᵀΓB is factored, with Γ far above the stiffness at the row, and
//! λ ← λ + Γ(Bu − c) repeated until nothing changes. Redundant rows do no harm, and the factor exists exactly where the rows hold every body.

use faer::prelude::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

use crate::scene::{Numbering, Scene};
use crate::substructures::RowKind;
use crate::{Error, Result};

/// An inequality on the assembled unknowns: Σ coefficient · u ≤ gap.
struct Row {
    terms: Vec<(usize, f64)>,
    gap: f64,
}

/// The assembled problem and its solution.
pub struct Direct {
    numbering: Numbering,
    /// Entries of K by row: (column, value), sorted.
    k: Vec<Vec<(usize, f64)>>,
    /// The solution by unknown.
    pub u: Vec<f64>,
    /// How well it satisfies the conditions of optimality.
    pub certificate: Certificate,
    /// Which inequalities hold, in the order of the scene's rows.
    pub active: Vec<bool>,
}

/// How well the conditions of optimality hold, each relative to the size of its terms.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Certificate {
    /// The last correction of the refinement over the solution, in the energy norm and by the largest displacement, whichever is larger:
    /// what residuals of the assembled problem mean for u, also where they are small against the terms that make them up.
    pub correction: f64,
    /// Largest violation over the largest |u|.
    pub feasibility: f64,
    /// Largest pull, over the largest multiplier.
    pub pull: f64,
}

impl Certificate {
    /// The largest of them.
    pub fn largest(&self) -> f64 {
        self.correction.max(self.feasibility).max(self.pull)
    }
}

/// What a direct solution must satisfy.
const CERTIFIED: f64 = 1e-9;

/// Γ over the stiffness at a row.
const PENALTY: f64 = 1e4;

impl Direct {
    /// Solves the scene at its last load step.
    ///
    /// # Errors
    /// Those of the scene; [`Error::NotConverged`] where no solution satisfies the conditions, such as where nothing holds a body.
    pub fn new(scene: &Scene) -> Result<Direct> {
        let numbering = Numbering::new(scene);
        let n = numbering.len() as usize;
        let mut k: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
        let mut f = vec![0.0; n];
        for s in 0..scene.n_subdomains() {
            let sub = scene.subdomain(s)?;
            let place: Vec<usize> = sub
                .dofs
                .iter()
                .map(|&d| numbering.global(d) as usize)
                .collect();
            for (i, &row) in place.iter().enumerate() {
                f[row] += sub.f[i];
                let (col, val) = sub.k.row(i);
                k[row].extend(col.iter().zip(val).map(|(&j, &v)| (place[j as usize], v)));
            }
        }
        for row in &mut k {
            row.sort_by_key(|e| e.0);
            row.dedup_by(|later, first| {
                let same = later.0 == first.0;
                if same {
                    first.1 += later.1;
                }
                same
            });
        }
        let inequality = |r: &crate::substructures::InterfaceRow| r.kind == RowKind::Inequality;
        let rows = scene.rows(&|_| true);
        let rows: Vec<Row> = rows
            .iter()
            .filter(|r| inequality(r))
            .map(|r| Row {
                terms: r
                    .terms
                    .iter()
                    .map(|&(d, c)| (numbering.global(d) as usize, c))
                    .collect(),
                gap: r.gap,
            })
            .collect();
        let (u, certificate, active) = solve(&k, &f, &rows)?;
        Ok(Direct {
            numbering,
            k,
            u,
            certificate,
            active,
        })
    }

    /// The unknown of a body dof.
    pub fn unknown(&self, dof: u64) -> usize {
        self.numbering.global(dof) as usize
    }

    /// ‖v‖² in the energy norm, as differences against the diagonal so that constants lose little.
    pub fn energy(&self, v: &[f64]) -> f64 {
        let row = |(i, row): (usize, &Vec<(usize, f64)>)| {
            v[i] * row.iter().map(|&(j, k)| k * v[j]).sum::<f64>()
        };
        self.k.iter().enumerate().map(row).sum()
    }
}

/// A sum with the rounding errors of its terms.
#[derive(Clone, Copy, Default)]
struct Twice(f64, f64);

impl Twice {
    fn add(&mut self, value: f64) {
        let sum = self.0 + value;
        let part = sum - self.0;
        self.1 += (self.0 - (sum - part)) + (value - part);
        self.0 = sum;
    }

    fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        self.add(product);
        self.1 += a.mul_add(b, -product);
    }

    fn value(self) -> f64 {
        self.0 + self.1
    }
}

/// B u − c of a row.
fn jump(row: &Row, u: &[f64]) -> f64 {
    let mut sum = Twice::default();
    row.terms
        .iter()
        .for_each(|&(i, c)| sum.add_product(c, u[i]));
    sum.add(-row.gap);
    sum.value()
}

/// f − K u − Bᵀ λ.
fn residual(
    k: &[Vec<(usize, f64)>],
    f: &[f64],
    u: &[f64],
    rows: &[Row],
    lambda: &[f64],
) -> Vec<f64> {
    let mut r: Vec<Twice> = f.iter().map(|&f| Twice(f, 0.0)).collect();
    for (sum, row) in r.iter_mut().zip(k) {
        row.iter().for_each(|&(j, v)| sum.add_product(-v, u[j]));
    }
    for (row, &l) in rows.iter().zip(lambda).filter(|(_, l)| **l != 0.0) {
        row.terms.iter().for_each(|&(i, c)| r[i].add_product(-c, l));
    }
    r.into_iter().map(Twice::value).collect()
}

/// The Cholesky factor of K + BᵀΓB over the active rows; `None` where they do not hold every body.
fn factor(
    k: &[Vec<(usize, f64)>],
    rows: &[Row],
    gamma: &[f64],
    active: &[bool],
    shift: f64,
) -> Option<Llt<usize, f64>> {
    let mut triplets = Vec::new();
    for (i, row) in k.iter().enumerate() {
        let entries = row.iter().filter(|e| e.0 <= i);
        triplets.extend(
            entries.map(|&(j, v)| Triplet::new(i, j, if i == j { v * (1.0 + shift) } else { v })),
        );
    }
    for (r, row) in rows.iter().enumerate().filter(|(r, _)| active[*r]) {
        for &(i, a) in &row.terms {
            for &(j, b) in row.terms.iter().filter(|t| t.0 <= i) {
                triplets.push(Triplet::new(i, j, gamma[r] * a * b));
            }
        }
    }
    let matrix = SparseColMat::try_new_from_triplets(k.len(), k.len(), &triplets).ok()?;
    matrix.sp_cholesky(Side::Lower).ok()
}

/// The solution, its certificate, the number of rows that hold.
type Found = (Vec<f64>, Certificate, Vec<bool>);

fn solve(k: &[Vec<(usize, f64)>], f: &[f64], rows: &[Row]) -> Result<Found> {
    const MOST: usize = 100;
    let n = k.len();
    let diagonal: Vec<f64> = (0..n)
        .map(|i| k[i].iter().find(|e| e.0 == i).map_or(0.0, |e| e.1))
        .collect();
    let stiffness = |row: &Row| row.terms.iter().map(|t| diagonal[t.0]).fold(0.0, f64::max);
    let gamma: Vec<f64> = rows.iter().map(|r| PENALTY * stiffness(r)).collect();
    let (mut u, mut lambda) = (vec![0.0; n], vec![0.0; rows.len()]);
    let mut active = vec![true; rows.len()];
    let mut seen: Vec<Vec<bool>> = Vec::new();
    for _ in 0..MOST {
        // A set that does not hold a body is a stage on the way: a trace of stiffness holds it until contact does.
        let llt = factor(k, rows, &gamma, &active, 0.0)
            .or_else(|| factor(k, rows, &gamma, &active, 1e-10))
            .ok_or_else(|| {
                Error::NotConverged("the assembled matrix has no Cholesky factor".into())
            })?;
        lambda
            .iter_mut()
            .zip(&active)
            .for_each(|(l, on)| *l *= f64::from(*on));
        let mut correction = f64::INFINITY;
        for round in 0..60 {
            // (K + BᵀΓB) δ = f − K u − Bᵀ(λ + Γ(B u − c)), then λ ← λ + Γ(B(u + δ) − c).
            let pushed: Vec<f64> = (0..rows.len())
                .map(|r| {
                    if active[r] {
                        lambda[r] + gamma[r] * jump(&rows[r], &u)
                    } else {
                        0.0
                    }
                })
                .collect();
            let r = residual(k, f, &u, rows, &pushed);
            let delta = llt.solve(&Mat::from_fn(n, 1, |i, _| r[i]));
            u.iter_mut()
                .enumerate()
                .for_each(|(i, u)| *u += delta[(i, 0)]);
            for (r, row) in rows.iter().enumerate().filter(|(r, _)| active[*r]) {
                lambda[r] += gamma[r] * jump(row, &u);
            }
            // rᵀδ is the energy of the correction, (f + …)ᵀu that of the solution.
            let energy: f64 = (0..n).map(|i| r[i] * delta[(i, 0)]).sum();
            let whole: f64 = k
                .iter()
                .enumerate()
                .map(|(i, row)| u[i] * row.iter().map(|&(j, v)| v * u[j]).sum::<f64>())
                .sum();
            let size = largest(&u);
            let change = (0..n).fold(0.0_f64, |a, i| a.max(delta[(i, 0)].abs()));
            correction =
                over(energy.max(0.0).sqrt(), whole.max(0.0).sqrt()).max(over(change, size));
            if round > 0 && correction < 1e-13 {
                break;
            }
        }
        // A row pulls, or is violated, by more than rounding leaves of either.
        let jumps: Vec<f64> = rows.iter().map(|r| jump(r, &u)).collect();
        let next: Vec<bool> = (0..rows.len())
            .map(|r| {
                if active[r] {
                    lambda[r] > 0.0
                } else {
                    jumps[r] > 0.0
                }
            })
            .collect();
        let certificate = Certificate {
            correction,
            feasibility: over(jumps.iter().fold(0.0, |a: f64, j| a.max(*j)), largest(&u)),
            pull: over(
                lambda.iter().fold(0.0, |a: f64, l| a.max(-l)),
                largest(&lambda),
            ),
        };
        if next == active || certificate.largest() < CERTIFIED {
            if certificate.largest() >= CERTIFIED {
                return Err(Error::NotConverged(format!(
                    "the direct solution has a correction of {:.1e}, a violation of {:.1e} and a pull of {:.1e}",
                    certificate.correction, certificate.feasibility, certificate.pull
                )));
            }
            return Ok((u, certificate, active));
        }
        if seen.contains(&next) {
            return Err(Error::NotConverged(
                "the active sets of the direct solution repeat".into(),
            ));
        }
        seen.push(std::mem::replace(&mut active, next));
    }
    Err(Error::NotConverged(format!(
        "the direct solution needs more than {MOST} active sets"
    )))
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0_f64, |a, v| a.max(v.abs()))
}

fn over(x: f64, size: f64) -> f64 {
    if size > 0.0 {
        x / size
    } else {
        x
    }
}
