//! Mehrotra's predictor-corrector method from an infeasible start, to the limits of double precision.

use super::certificate::add_transposed;
use super::kkt::System;
use super::scaled::Point;
use super::{Qp, Row};

const MOST_STEPS: usize = 100;

struct Residual {
    dual: Vec<f64>,
    equal: Vec<f64>,
    below: Vec<f64>,
    /// Mean of λ_r s_r.
    mu: f64,
}

/// A direction: increments of the unknowns (u, λ_E, λ_I) and of s.
struct Direction {
    x: Vec<f64>,
    slack: Vec<f64>,
}

fn residual(qp: &Qp, p: &Point) -> Residual {
    let mut dual = vec![0.0; p.u.len()];
    qp.k.mul(&p.u, &mut dual);
    add_transposed(&qp.equal, &p.equal, &mut dual);
    add_transposed(&qp.below, &p.below, &mut dual);
    dual.iter_mut().zip(&qp.f).for_each(|(r, f)| *r -= f);
    let over = |row: &Row| row.times(&p.u) - row.rhs;
    let below = qp.below.iter().zip(&p.slack);
    let products = p.below.iter().zip(&p.slack).map(|(l, s)| l * s);
    Residual {
        dual,
        equal: qp.equal.iter().map(over).collect(),
        below: below.map(|(row, s)| over(row) + s).collect(),
        mu: products.sum::<f64>() / qp.below.len().max(1) as f64,
    }
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// Distance from the end: residuals and μ, in the units that the polish needs.
fn distance(p: &Point, r: &Residual) -> f64 {
    let length = 1.0 + largest(&p.u);
    let force = 1.0 + largest(&p.below).max(largest(&p.equal));
    let primal = largest(&r.equal).max(largest(&r.below)) / length;
    let dual = largest(&r.dual) / force;
    primal.max(dual).max(r.mu.abs() / (length * force))
}

/// A point close to the solution of the scaled problem; if there are many solutions, in the interior of their set.
/// `epsilon` is that of [`System`].
pub fn solve(qp: &Qp, epsilon: f64) -> Point {
    let (n, ne, ni) = (qp.f.len(), qp.equal.len(), qp.below.len());
    let rows: Vec<&Row> = qp.equal.iter().chain(&qp.below).collect();
    let mut system = System::new(qp, rows, epsilon);
    let mut t = vec![0.0; ne + ni];

    // Start: the problem with s = −λ, then both are made positive.
    t[ne..].fill(1.0);
    assert!(
        system.factor(&t),
        "a diagonal of one leaves no pivot of zero"
    );
    let sides = qp.equal.iter().chain(&qp.below).map(|row| row.rhs);
    let b: Vec<f64> = qp.f.iter().copied().chain(sides).collect();
    let mut x = vec![0.0; n + ne + ni];
    system.refine(&b, &mut x, 3);
    let lambda = &x[n + ne..];
    let lift = |least: f64| if least > 1e-3 { 0.0 } else { 1.0 - least };
    let up = lift(lambda.iter().copied().fold(f64::INFINITY, f64::min));
    let down = lift(lambda.iter().map(|l| -l).fold(f64::INFINITY, f64::min));
    let mut p = Point {
        u: x[..n].to_vec(),
        equal: x[n..n + ne].to_vec(),
        below: lambda.iter().map(|l| l + up).collect(),
        slack: lambda.iter().map(|l| -l + down).collect(),
        closed: Vec::new(),
    };

    let mut best = (f64::INFINITY, p.clone(), 0);
    for step in 0..MOST_STEPS {
        let r = residual(qp, &p);
        let far = distance(&p, &r);
        if far < best.0 {
            best = (far, p.clone(), step);
        }
        if far < 1e-15 || step > best.2 + 15 {
            break;
        }
        for k in 0..ni {
            t[ne + k] = p.slack[k] / p.below[k];
        }
        if !system.factor(&t) {
            break;
        }
        let newton = |products: &[f64]| -> Direction {
            // w δλ + λ δs = −products, eliminated: δs = −(products + s δλ)/λ.
            let b: Vec<f64> = r
                .dual
                .iter()
                .chain(&r.equal)
                .map(|v| -v)
                .chain((0..ni).map(|k| -r.below[k] + products[k] / p.below[k]))
                .collect();
            let mut x = vec![0.0; n + ne + ni];
            system.refine(&b, &mut x, 3);
            let slack = (0..ni)
                .map(|k| -(products[k] + p.slack[k] * x[n + ne + k]) / p.below[k])
                .collect();
            Direction { x, slack }
        };
        // The longest step that keeps λ and s positive.
        let reach = |d: &Direction| -> f64 {
            let ratio = |v: f64, dv: f64| if dv < 0.0 { -v / dv } else { f64::INFINITY };
            (0..ni)
                .map(|k| ratio(p.below[k], d.x[n + ne + k]).min(ratio(p.slack[k], d.slack[k])))
                .fold(1.0, f64::min)
        };
        let products: Vec<f64> = p.below.iter().zip(&p.slack).map(|(l, s)| l * s).collect();
        let mut d = newton(&products);
        if ni > 0 {
            let a = reach(&d);
            let after =
                (0..ni).map(|k| (p.below[k] + a * d.x[n + ne + k]) * (p.slack[k] + a * d.slack[k]));
            let sigma = (after.sum::<f64>() / ni as f64 / r.mu).max(0.0).powi(3);
            let corrected: Vec<f64> = (0..ni)
                .map(|k| products[k] + d.x[n + ne + k] * d.slack[k] - sigma * r.mu)
                .collect();
            d = newton(&corrected);
        }
        let a = match reach(&d) {
            a if a < 1.0 => 0.995 * a,
            _ if ni > 0 => 0.995,
            _ => 1.0,
        };
        let add = |v: &mut [f64], d: &[f64]| v.iter_mut().zip(d).for_each(|(v, d)| *v += a * d);
        add(&mut p.u, &d.x[..n]);
        add(&mut p.equal, &d.x[n..n + ne]);
        add(&mut p.below, &d.x[n + ne..]);
        add(&mut p.slack, &d.slack);
        let fine = |v: &[f64]| v.iter().all(|v| v.is_finite() && *v > 0.0);
        if !(fine(&p.below) && fine(&p.slack) && p.u.iter().all(|v| v.is_finite())) {
            break; // as far as double precision goes
        }
    }
    best.1
}
