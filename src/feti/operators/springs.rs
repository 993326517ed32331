//! Springs in the rows: the compliance C in F + C, and what it changes in the preconditioner.
//!
//! Rows of a block that depend on each other have multipliers N without forces: Bᵀ N = 0, so F N = 0 and M⁻¹ N = 0.
//! On them F + C is C alone. With
//!
//! ```text
//!     X = N (Nᵀ C N)⁻¹ Nᵀ          Π = I − X C
//! ```
//!
//! every λ is Π λ + X C λ, and the two parts are orthogonal in F + C. The first is the cheapest of all multipliers with
//! the same forces, so that C is small beside F there and M⁻¹ fits; on the second X is the inverse:
//!
//! ```text
//!     (F + C)⁻¹ ≈ Π M⁻¹ Πᵀ + X
//! ```
//!
//! With the orthogonal projection R onto range B, R + X C (I − R) is a projection, too. It takes out the multipliers on
//! which F + C is zero and no others: those without forces that no spring feels.
//!
//! Multipliers with small forces beside their C are of that kind, too: those of rows that nearly depend on each other,
//! of rows that are much softer than their nodes, and, where a stiff body meets soft ones, those that load the stiff
//! body alone. At a point where bodies meet, N are the eigenvectors of F_b n = θ (F_b + C) n with θ < 0.1. F_b = B D⁻¹
//! Bᵀ, of the size that the diagonal of K has, stands for F: nodes that give way alone. The eigenvectors are orthogonal
//! in F_b and in C, as those without forces are in F and in C.

use crate::feti::jump::operator::Jump;
use crate::feti::jump::scaling;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;

/// C, and X for the rows that hold.
pub struct Springs {
    /// The diagonal of C on the owned rows; zero where a row is rigid.
    compliance: Vec<f64>,
    /// X of each block of dependent rows, with the rows.
    dependent: Vec<(Vec<usize>, Dense)>,
}

impl Springs {
    /// Springs of this compliance; [`renew`](Self::renew) completes them for the rows that hold.
    ///
    /// # Panics
    /// If there is not one entry for each owned row.
    pub fn new(jump: &Jump, compliance: Vec<f64>) -> Springs {
        assert_eq!(compliance.len(), jump.n_owned);
        Springs {
            compliance,
            dependent: Vec::new(),
        }
    }

    /// Computes X again for the rows that hold now. `nodes` says how far nodes give way, by owned row; without it only
    /// multipliers without forces count.
    pub fn renew(&mut self, jump: &Jump, nodes: Option<&[f64]>) {
        self.dependent.clear();
        for block in &jump.blocks {
            let start = block.rows.start;
            let Some((members, b)) = block.dependent(&jump.active[block.rows.clone()]) else {
                continue;
            };
            let held = |&i: &usize| jump.active[start + members[i]];
            let own: Vec<usize> = (0..members.len()).filter(held).collect();
            let rows: Vec<usize> = own.iter().map(|&i| start + members[i]).collect();
            let c: Vec<f64> = rows.iter().map(|&r| self.compliance[r]).collect();
            // Rigid rows need no X. Most are, in most steps.
            if c.iter().all(|c| *c == 0.0) {
                continue;
            }
            let n = match block.weights().zip(nodes) {
                Some((weights, nodes)) => {
                    let give: f64 = rows.iter().map(|&r| nodes[r]).sum();
                    let f = compliance_of_nodes(&b, &own, &weights, give);
                    soft(&f, &c)
                }
                None if rows.len() < 2 => continue,
                None => forceless(&b, &own),
            };
            if n.cols > 0 {
                self.dependent.push((rows, inverse(&n, &c)));
            }
        }
    }

    /// out ← out + α C λ, on the rows that hold.
    pub fn add(&self, jump: &Jump, alpha: f64, lambda: &[f64], out: &mut [f64]) {
        for i in (0..out.len()).filter(|&i| jump.active[i]) {
            out[i] += alpha * self.compliance[i] * lambda[i];
        }
    }

    /// q ← (q⁻¹ + C)⁻¹, row by row.
    pub fn soften(&self, q: &mut [f64]) {
        for (q, c) in q.iter_mut().zip(&self.compliance) {
            *q /= 1.0 + *q * c;
        }
    }

    /// r ← Πᵀ r.
    pub fn reduce(&self, r: &mut [f64]) {
        for (rows, x) in &self.dependent {
            let image = product(x, rows, |i| r[i]);
            for (&i, v) in rows.iter().zip(&image) {
                r[i] -= self.compliance[i] * v;
            }
        }
    }

    /// z ← Π z + X r.
    pub fn complete(&self, r: &[f64], z: &mut [f64]) {
        for (rows, x) in &self.dependent {
            let image = product(x, rows, |i| r[i] - self.compliance[i] * z[i]);
            for (&i, v) in rows.iter().zip(&image) {
                z[i] += v;
            }
        }
    }

    /// y ← y + X C (λ − y).
    pub fn put_back(&self, lambda: &[f64], y: &mut [f64]) {
        for (rows, x) in &self.dependent {
            let image = product(x, rows, |i| self.compliance[i] * (lambda[i] - y[i]));
            for (&i, v) in rows.iter().zip(&image) {
                y[i] += v;
            }
        }
    }

    /// out ← C X λ.
    pub fn felt(&self, lambda: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (rows, x) in &self.dependent {
            let image = product(x, rows, |i| lambda[i]);
            for (&i, v) in rows.iter().zip(&image) {
                out[i] = self.compliance[i] * v;
            }
        }
    }
}

/// X v with v given by row.
fn product(x: &Dense, rows: &[usize], v: impl Fn(usize) -> f64) -> Vec<f64> {
    let v: Vec<f64> = rows.iter().map(|&i| v(i)).collect();
    let mut out = vec![0.0; rows.len()];
    x.add_mul(&v, &mut out);
    out
}

/// M⁻¹ leaves multipliers to C for which the nodes have less than this share in F + C.
const NODES: f64 = 0.1;

/// Directions of F + C below this, relative to the largest one, are rounding.
const ROUNDING: f64 = 1e-14;

/// B D⁻¹ Bᵀ on these rows of a block `b`, of a size that the trace is `give`: how far the nodes give way alone.
fn compliance_of_nodes(b: &Dense, rows: &[usize], weights: &[f64], give: f64) -> Dense {
    let entry = |i: usize, j: usize| -> f64 {
        let (r, s) = (rows[i], rows[j]);
        let terms = weights.iter().enumerate();
        terms.map(|(k, w)| b.get(r, k) * b.get(s, k) / w).sum()
    };
    let n = rows.len();
    let trace: f64 = (0..n).map(|i| entry(i, i)).sum();
    // Rows between given values have no nodes that give way.
    let size = if trace > 0.0 { give / trace } else { 0.0 };
    Dense::from_fn(n, n, |i, j| size * entry(i, j))
}

/// N: the multipliers, orthogonal in `f` and C, to which the compliance `f` of the nodes adds little beside C.
fn soft(f: &Dense, c: &[f64]) -> Dense {
    let n = c.len();
    let none = Dense::zeros(n, 0);
    let both = faer::Mat::from_fn(n, n, |i, j| f.get(i, j) + if i == j { c[i] } else { 0.0 });
    let Ok(eigen) = both.self_adjoint_eigen(faer::Side::Lower) else {
        return none;
    };
    let (u, s) = (eigen.U(), eigen.S().column_vector());
    let most = s[n - 1];
    let kept: Vec<usize> = (0..n).filter(|&i| s[i] > ROUNDING * most).collect();
    let white = faer::Mat::from_fn(n, kept.len(), |i, k| u[(i, kept[k])] / s[kept[k]].sqrt());
    let f = faer::Mat::from_fn(n, n, |i, j| f.get(i, j));
    let inside = white.transpose() * f * &white;
    let Ok(eigen) = inside.self_adjoint_eigen(faer::Side::Lower) else {
        return none;
    };
    let share = eigen.S().column_vector();
    let count = (0..kept.len()).filter(|&k| share[k] < NODES).count();
    let vectors = &white * eigen.U().subcols(0, count);
    Dense::from_fn(n, count, |i, k| vectors[(i, k)])
}

/// N: an orthonormal basis of the multipliers without forces, BᵀN = 0, on these rows of a block `b`.
pub fn forceless(b: &Dense, rows: &[usize]) -> Dense {
    let part = faer::Mat::from_fn(rows.len(), b.cols, |i, j| b.get(rows[i], j));
    let range = scaling::range(&part);
    complement(&Dense::from_fn(rows.len(), range.ncols(), |i, j| {
        range[(i, j)]
    }))
}

/// Orthonormal columns that complete those of `range`.
fn complement(range: &Dense) -> Dense {
    let n = range.rows;
    let mut known: Vec<Vec<f64>> = (0..range.cols).map(|j| range.col(j).to_vec()).collect();
    while known.len() < n {
        // Of the parts of the unit vectors outside the span one has a square of at least 1/n.
        let rest = |k: usize| 1.0 - known.iter().map(|q| q[k] * q[k]).sum::<f64>();
        let k = (0..n).max_by(|&a, &b| rest(a).total_cmp(&rest(b)));
        let mut new = vec![0.0; n];
        new[k.expect("there are rows")] = 1.0;
        for _ in 0..2 {
            for q in &known {
                let along: f64 = q.iter().zip(&new).map(|(q, v)| q * v).sum();
                new.iter_mut().zip(q).for_each(|(v, q)| *v -= along * q);
            }
        }
        let size = new.iter().map(|v| v * v).sum::<f64>().sqrt();
        new.iter_mut().for_each(|v| *v /= size);
        known.push(new);
    }
    let columns = &known[range.cols..];
    Dense::from_fn(n, columns.len(), |i, j| columns[j][i])
}

/// A multiplier without forces has no compliance if it is below this, relative to the largest one of its rows: rigid
/// rows that depend on each other, after rounding.
const RIGID: f64 = 1e-20;

/// N (Nᵀ C N)⁺ Nᵀ.
fn inverse(n: &Dense, c: &[f64]) -> Dense {
    let p = n.cols;
    let weighted = |i: usize, j: usize| -> f64 {
        let terms = n.col(i).iter().zip(n.col(j)).zip(c);
        terms.map(|((a, b), c)| a * b * c).sum()
    };
    let least = RIGID * c.iter().fold(0.0f64, |a, c| a.max(*c));
    let soft = |i: usize| weighted(i, i) > least;
    let factor = Semidefinite::new(&Dense::from_fn(p, p, |i, j| {
        if soft(i) && soft(j) {
            weighted(i, j)
        } else {
            0.0
        }
    }));
    let mut x = Dense::zeros(n.rows, n.rows);
    for r in 0..n.rows {
        let mut column: Vec<f64> = (0..p).map(|j| n.get(r, j)).collect();
        factor.solve(&mut column);
        n.add_mul(&column, x.col_mut(r));
    }
    x
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/operators/springs.rs"]
mod tests;
