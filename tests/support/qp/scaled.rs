//! The problem with unit diagonal, unit rows and data of size one, for the algorithm.

use super::{Qp, Row};
use base::linalg::csr::Csr;

/// A point of the scaled problem.
#[derive(Debug, Clone)]
pub struct Point {
    pub u: Vec<f64>,
    pub equal: Vec<f64>,
    pub below: Vec<f64>,
    /// The slack c − B u of the inequality rows, as a separate variable.
    pub slack: Vec<f64>,
    pub closed: Vec<usize>,
}

/// u = size · d · û, λ = size · λ̂ / norm.
pub struct Scales {
    size: f64,
    d: Vec<f64>,
    equal: Vec<f64>,
    below: Vec<f64>,
}

/// diag(K)^(−1/2); zero diagonal entries are replaced by the mean of the others.
pub fn weights(qp: &Qp) -> Vec<f64> {
    let diagonal: Vec<f64> = (0..qp.f.len()).map(|i| qp.k.get(i, i)).collect();
    let positive: Vec<f64> = diagonal.iter().copied().filter(|&v| v > 0.0).collect();
    let mean = if positive.is_empty() {
        1.0
    } else {
        positive.iter().sum::<f64>() / positive.len() as f64
    };
    let weight = |v: f64| if v > 0.0 { v } else { mean }.powf(-0.5);
    diagonal.into_iter().map(weight).collect()
}

pub fn scale(qp: &Qp) -> (Qp, Scales) {
    let d = weights(qp);
    let rows = |rows: &[Row]| -> (Vec<Row>, Vec<f64>) {
        let scaled = |row: &Row| {
            let terms: Vec<_> = row.terms.iter().map(|&(i, b)| (i, b * d[i])).collect();
            let norm = Row::new(terms.clone(), 0.0).norm();
            let terms: Vec<_> = terms.into_iter().map(|(i, b)| (i, b / norm)).collect();
            (Row::new(terms, row.rhs / norm), norm)
        };
        rows.iter().map(scaled).unzip()
    };
    let (mut equal, equal_norms) = rows(&qp.equal);
    let (mut below, below_norms) = rows(&qp.below);
    let mut f: Vec<f64> = qp.f.iter().zip(&d).map(|(f, d)| f * d).collect();
    let all = equal.iter().chain(&below).map(|r| r.rhs.abs());
    let size = f.iter().map(|f| f.abs()).chain(all).fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    f.iter_mut().for_each(|f| *f /= size);
    let divide = |row: &mut Row| row.rhs /= size;
    equal.iter_mut().for_each(divide);
    below.iter_mut().for_each(divide);
    let mut k: Csr = qp.k.clone();
    for i in 0..d.len() {
        for at in k.row_ptr[i]..k.row_ptr[i + 1] {
            k.val[at] *= d[i] * d[k.col[at] as usize];
        }
    }
    let scaled = Qp {
        k,
        f,
        equal,
        below,
        kernel: Vec::new(),
    };
    let scales = Scales {
        size,
        d,
        equal: equal_norms,
        below: below_norms,
    };
    (scaled, scales)
}

impl Scales {
    /// The point of the scaled problem `qp` that is u, λ_E and λ_I in the units of the problem.
    pub fn to(&self, qp: &Qp, u: &[f64], equal: &[f64], below: &[f64]) -> Point {
        let over = |(v, d): (&f64, &f64)| v / d / self.size;
        let times = |(v, norm): (&f64, &f64)| v * norm / self.size;
        let u: Vec<f64> = u.iter().zip(&self.d).map(over).collect();
        Point {
            equal: equal.iter().zip(&self.equal).map(times).collect(),
            below: below.iter().zip(&self.below).map(times).collect(),
            slack: qp.below.iter().map(|r| r.rhs - r.times(&u)).collect(),
            closed: Vec::new(),
            u,
        }
    }

    /// u, λ_E and λ_I in the units of the problem.
    pub fn back(&self, point: &Point) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let times = |(v, d): (&f64, &f64)| self.size * v * d;
        let over = |(v, norm): (&f64, &f64)| self.size * v / norm;
        (
            point.u.iter().zip(&self.d).map(times).collect(),
            point.equal.iter().zip(&self.equal).map(over).collect(),
            point.below.iter().zip(&self.below).map(over).collect(),
        )
    }
}
