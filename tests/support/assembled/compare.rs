//! Decides whether an answer is a solution: it must have the energy, the closed rows and the u of the reference, as far
//! as the problem determines them.

use super::super::qp::certificate::{self, largest, relative, Kkt};
use super::super::qp::Row;
use super::{Assembled, Place, Reference};
use faer::prelude::Solve;
use faer::Mat;

/// Limits, all relative.
#[derive(Debug, Clone, Copy)]
pub struct Tolerances {
    pub energy: f64,
    pub kkt: f64,
    /// Largest entry of the difference of u, up to free motions.
    pub u: f64,
    /// Threshold beyond which a row counts as closed with force, or as open.
    pub strict: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Tolerances {
            energy: 1e-8,
            kkt: 1e-8,
            u: 1e-6,
            strict: 1e-6,
        }
    }
}

/// Rows stop a motion that moves them by more than this, relative to others.
const FREE: f64 = 1e-8;

/// The answer of a solver.
pub struct Candidate<'a> {
    /// By unknown, as [`Assembled::dofs`].
    pub u: &'a [f64],
    /// By row, as [`Assembled::rows`], with K u + Bᵀ λ = f.
    pub lambda: &'a [f64],
    pub energy: f64,
}

/// The agreement of an answer with the reference.
#[derive(Debug, Clone, Copy, Default)]
pub struct Agreement {
    pub energy: f64,
    pub u: f64,
    pub kkt: Kkt,
    /// Rows that carry force in the reference or in the answer, rows that are open in either, and rows that are
    /// neither: closed without force, where either set is right.
    pub closed: usize,
    pub open: usize,
    pub degenerate: usize,
    /// Dimension of the motions that change neither the energy nor the rows with force: u is unique where it is 0.
    pub free_motions: usize,
}

/// Compares `answer` with the reference; an error lists all disagreements.
///
/// Every multiplier of a convex problem is complementary to every solution. So rows are compared crosswise: a row that
/// carries force in one answer must be closed in the other. Where the problem determines the closed sets, this means
/// that they are equal; rows that touch without force, or share their force with dependent rows, are not constrained.
pub fn compare(
    problem: &Assembled,
    reference: &Reference,
    answer: &Candidate<'_>,
    tolerances: &Tolerances,
) -> Result<Agreement, String> {
    let qp = &problem.qp;
    assert_eq!(answer.u.len(), problem.dofs.len());
    assert_eq!(answer.lambda.len(), problem.rows.len());
    let mut wrong = Vec::new();
    let mut out = Agreement::default();
    let mut limit = |what: &str, value: f64, limit: f64| {
        if value.is_nan() || value > limit {
            wrong.push(format!("{what} {value:.2e} (at most {limit:.0e})"));
        }
    };

    let (mut equal, mut below) = (vec![0.0; qp.equal.len()], vec![0.0; qp.below.len()]);
    let mut idle = 0.0f64;
    for (place, &l) in problem.place.iter().zip(answer.lambda) {
        match *place {
            Place::Equal(k) => equal[k] = l,
            Place::Below(k) => below[k] = l,
            Place::Nowhere => idle = idle.max(l.abs()),
        }
    }
    let scale = energy_scale(problem, reference);
    out.energy = relative((answer.energy - reference.energy).abs(), scale);
    // A body that nothing holds may lie far away, where energies are rounding.
    let rounding = relative(qp.rounding(answer.u), scale);
    limit("energy", out.energy, tolerances.energy + rounding);
    let own = relative((qp.energy(answer.u) - answer.energy).abs(), scale);
    limit(
        "energy of the answer's own u",
        own,
        tolerances.energy + rounding,
    );

    limit("multiplier of a row that does not hold", idle, 0.0);
    let (length, force) = certificate::sizes(qp, answer.u, &equal, &below);
    out.kkt = certificate::kkt(qp, answer.u, &equal, &below);
    limit("stationarity", out.kkt.stationarity, tolerances.kkt);
    limit("feasibility", out.kkt.feasibility, tolerances.kkt);
    limit("sign", out.kkt.sign, tolerances.kkt);
    limit("complementarity", out.kkt.complementarity, tolerances.kkt);

    let mut mixed = Vec::new();
    for (k, row) in qp.below.iter().enumerate() {
        let gap = |u: &[f64]| (row.rhs - row.times(u)) / row.norm();
        let opens = [gap(&reference.u), gap(answer.u)].map(|g| g > tolerances.strict * length);
        let carries = [reference.solved.below[k], below[k]].map(|l| l > tolerances.strict * force);
        if (carries[0] && opens[1]) || (carries[1] && opens[0]) {
            mixed.push(k);
        }
        match (carries.contains(&true), opens.contains(&true)) {
            (true, _) => out.closed += 1,
            (_, true) => out.open += 1,
            _ => out.degenerate += 1,
        }
    }

    let strict = |k: usize| reference.solved.below[k] > tolerances.strict * force;
    let (motions, distance) = distance(problem, &reference.u, answer.u, &strict);
    out.free_motions = motions;
    out.u = relative(distance, length);
    // Motions that bodies hardly resist are not known to so many digits. If the displacements of the answer satisfy all
    // conditions with the multipliers of the reference, too, then both are solutions.
    let (equal, below) = (&reference.solved.equal, &reference.solved.below);
    let crossed = certificate::kkt(qp, answer.u, equal, below).largest();
    if crossed.is_nan() || crossed > tolerances.kkt {
        limit("u", out.u, tolerances.u);
    }
    if !mixed.is_empty() {
        wrong.push(format!(
            "rows closed in one and open in the other: {}",
            mixed.len()
        ));
    }
    if wrong.is_empty() {
        Ok(out)
    } else {
        Err(format!("{}; {out:?}", wrong.join("; ")))
    }
}

/// The scale of errors of the energy: the energy and the work of the load; where both vanish, the energy that the data
/// could cause on the diagonal of K.
pub fn energy_scale(problem: &Assembled, reference: &Reference) -> f64 {
    let qp = &problem.qp;
    let stiffness = |i: usize| qp.k.get(i, i);
    let softest = (0..qp.f.len()).map(stiffness).fold(f64::INFINITY, f64::min);
    let alone = (0..qp.f.len()).map(|i| qp.f[i] * qp.f[i] / stiffness(i));
    let rows = qp.equal.iter().chain(&qp.below);
    let moved = rows.map(|r| (r.rhs / r.norm()).powi(2) * softest);
    let work = (0..qp.f.len()).map(|i| qp.f[i] * reference.u[i]);
    let scale = largest(alone.chain(moved).chain(work).chain([reference.energy]));
    if scale > 0.0 {
        scale
    } else {
        1.0
    }
}

/// The number of motions in the kernel of K that equations and rows with force leave free, and the largest entry of u −
/// v after its component in these motions is removed.
fn distance(
    problem: &Assembled,
    u: &[f64],
    v: &[f64],
    strict: &dyn Fn(usize) -> bool,
) -> (usize, f64) {
    let qp = &problem.qp;
    let mut d: Vec<f64> = u.iter().zip(v).map(|(a, b)| a - b).collect();
    let r = qp.kernel.len();
    let mut touching: Vec<Vec<(usize, f64)>> = vec![Vec::new(); d.len()];
    for (j, z) in qp.kernel.iter().enumerate() {
        z.iter().for_each(|&(i, v)| touching[i].push((j, v)));
    }
    if r == 0 {
        return (0, largest(d));
    }
    let held = (0..qp.below.len()).filter(|&k| strict(k));
    let rows = qp.equal.iter().chain(held.map(|k| &qp.below[k]));
    let moved = |row: &Row| {
        let mut g = vec![0.0; r];
        for &(i, b) in &row.terms {
            touching[i].iter().for_each(|&(j, v)| g[j] += b * v);
        }
        g
    };
    let rows: Vec<Vec<f64>> = rows.map(moved).collect();
    let matrix = Mat::from_fn(rows.len().max(r), r, |i, j| {
        rows.get(i).map_or(0.0, |g| g[j])
    });
    let svd = matrix.thin_svd().expect("singular values");
    let s = svd.S().column_vector();
    let top = (0..r).fold(1.0f64, |m, i| m.max(s[i]));
    let free: Vec<usize> = (0..r).filter(|&i| s[i] <= FREE * top).collect();
    if free.is_empty() {
        return (0, largest(d));
    }
    let basis = Mat::from_fn(r, free.len(), |i, j| svd.V()[(i, free[j])]);
    // Least squares in the coefficients of the free motions.
    let mut zz = Mat::<f64>::zeros(r, r);
    let mut zd = Mat::<f64>::zeros(r, 1);
    for (pairs, d) in touching.iter().zip(&d) {
        for &(a, va) in pairs {
            zd[(a, 0)] += va * d;
            pairs.iter().for_each(|&(b, vb)| zz[(a, b)] += va * vb);
        }
    }
    let normal = basis.transpose() * &zz * &basis;
    let right = basis.transpose() * &zd;
    let beta = normal.full_piv_lu().solve(&right);
    let alpha = &basis * beta;
    for (pairs, d) in touching.iter().zip(&mut d) {
        pairs.iter().for_each(|&(j, v)| *d -= v * alpha[(j, 0)]);
    }
    (free.len(), largest(d))
}
