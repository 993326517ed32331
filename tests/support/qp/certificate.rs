//! The conditions for a solution, or for a proof that there is none. All functions work on the original, unscaled
//! problem.

use super::{scaled, Qp, Row};

/// KKT residuals, relative to the size of their terms; 0 where all terms vanish.
#[derive(Debug, Clone, Copy, Default)]
pub struct Kkt {
    /// K u + Bᵀλ = f, in the scale of diag(K).
    pub stationarity: f64,
    /// B_E u = c_E and B_I u ≤ c_I, relative to the largest value of u and c.
    pub feasibility: f64,
    /// λ_I ≥ 0, relative to the largest multiplier.
    pub sign: f64,
    /// λ_r (c − B u)_r = 0, relative to both.
    pub complementarity: f64,
}

impl Kkt {
    pub fn largest(&self) -> f64 {
        largest([
            self.stationarity,
            self.feasibility,
            self.sign,
            self.complementarity,
        ])
    }
}

/// The largest magnitude; NaN if there is one.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |m: f64, v: f64| {
        if v.abs() <= m || m.is_nan() {
            m
        } else {
            v.abs()
        }
    };
    values.into_iter().fold(0.0, larger)
}

/// part/whole, 0 for 0/0.
pub fn relative(part: f64, whole: f64) -> f64 {
    if part == 0.0 {
        0.0
    } else {
        part / whole
    }
}

/// y ← y + Bᵀ λ.
pub fn add_transposed(rows: &[Row], lambda: &[f64], y: &mut [f64]) {
    for (row, l) in rows.iter().zip(lambda) {
        row.terms.iter().for_each(|&(i, b)| y[i] += b * l);
    }
}

/// The scales of u and λ: the largest entry of u and c, and the largest multiplier of a row of unit length.
///
/// Where u or λ vanish, the scale is the value that the data could cause: f on the diagonal of K, c times its smallest
/// entry.
pub fn sizes(qp: &Qp, u: &[f64], equal: &[f64], below: &[f64]) -> (f64, f64) {
    let d = scaled::weights(qp);
    let rows = || qp.equal.iter().chain(&qp.below);
    let given = rows().map(|r| r.rhs / r.norm());
    let caused = qp.f.iter().zip(&d).map(|(f, d)| f * d * d);
    let length = largest(u.iter().copied().chain(given).chain(caused));
    let forces = rows().zip(equal.iter().chain(below));
    let softest = largest(d.iter().copied());
    let force = largest(forces.map(|(row, l)| l * row.norm()));
    (length, force.max(length / softest.powi(2)))
}

/// The KKT residuals of any u and λ.
pub fn kkt(qp: &Qp, u: &[f64], equal: &[f64], below: &[f64]) -> Kkt {
    assert_eq!(
        (u.len(), equal.len(), below.len()),
        (qp.f.len(), qp.equal.len(), qp.below.len())
    );
    let d = scaled::weights(qp);
    let mut ku = vec![0.0; u.len()];
    qp.k.mul(u, &mut ku);
    let mut forces = vec![0.0; u.len()];
    add_transposed(&qp.equal, equal, &mut forces);
    add_transposed(&qp.below, below, &mut forces);
    let softest = largest(d.iter().copied());
    let (length, force) = sizes(qp, u, equal, below);

    let residual = |i: usize| (ku[i] + forces[i] - qp.f[i]) * d[i];
    let size = |i: usize| largest([ku[i], forces[i], qp.f[i]]) * d[i];
    let stationarity = relative(
        largest((0..u.len()).map(residual)),
        largest((0..u.len()).map(size)).max(length / softest),
    );

    let over = |r: &Row| (r.times(u) - r.rhs) / r.norm();
    let violation = largest(
        qp.equal
            .iter()
            .map(over)
            .chain(qp.below.iter().map(|r| over(r).max(0.0))),
    );
    let of_below = || {
        let rows = qp.below.iter().zip(below);
        rows.map(|(row, l)| l * row.norm())
    };
    let products = of_below().zip(&qp.below).map(|(l, r)| l * over(r));
    Kkt {
        stationarity,
        feasibility: relative(violation, length),
        sign: relative(largest(of_below().map(|l| l.min(0.0))), force),
        complementarity: relative(largest(products), force * length),
    }
}

/// Checks that every kernel column is in the kernel of K.
pub fn check_kernel(qp: &Qp) {
    let d = scaled::weights(qp);
    for column in &qp.kernel {
        let mut z = vec![0.0; qp.f.len()];
        column.iter().for_each(|&(i, v)| z[i] = v);
        let mut kz = vec![0.0; z.len()];
        qp.k.mul(&z, &mut kz);
        let off = largest(kz.iter().zip(&d).map(|(v, d)| v * d));
        let size = largest(z.iter().zip(&d).map(|(v, d)| v / d));
        assert!(off <= 1e-11 * size, "no kernel column: K z = {off:.1e}");
    }
}

/// Checks that y_I ≥ 0, Bᵀy = 0 and cᵀy < 0.
pub fn check_contradiction(qp: &Qp, y: &[f64]) {
    contradiction(qp, y).unwrap_or_else(|why| panic!("{why}"));
}

/// Whether y_I ≥ 0, Bᵀy = 0 and cᵀy < 0; an error says what is not.
pub fn contradiction(qp: &Qp, y: &[f64]) -> Result<(), String> {
    let (equal, below) = y.split_at(qp.equal.len());
    assert!(below.iter().all(|&y| y >= 0.0));
    let (mut sum, mut size) = (vec![0.0; qp.f.len()], 0.0f64);
    add_transposed(&qp.equal, equal, &mut sum);
    add_transposed(&qp.below, below, &mut sum);
    let (mut work, mut scale) = (0.0, 0.0f64);
    for (row, y) in qp.equal.iter().chain(&qp.below).zip(y) {
        work += row.rhs * y;
        scale = scale.max((row.rhs * y).abs());
        size = size.max(row.norm() * y.abs());
    }
    let off = largest(sum);
    if off <= 1e-9 * size && work < -1e-9 * scale {
        return Ok(());
    }
    Err(format!(
        "the rows seem to contradict each other, but there is no proof: Bᵀy = {off:.1e}, cᵀy = {work:.1e}"
    ))
}

/// Checks that K z = 0, B_E z = 0, B_I z ≤ 0 and fᵀz > 0.
pub fn check_descent(qp: &Qp, z: &[f64]) {
    descent(qp, z).unwrap_or_else(|why| panic!("{why}"));
}

/// Whether K z = 0, B_E z = 0, B_I z ≤ 0 and fᵀz > 0; an error says what is not.
pub fn descent(qp: &Qp, z: &[f64]) -> Result<(), String> {
    let d = scaled::weights(qp);
    let mut kz = vec![0.0; z.len()];
    qp.k.mul(z, &mut kz);
    let size = largest(z.iter().copied());
    let stiff = largest(kz.iter().zip(&d).map(|(v, d)| v * d));
    let scaled_size = largest(z.iter().zip(&d).map(|(v, d)| v / d));
    let stopped = largest(
        qp.equal
            .iter()
            .map(|r| r.times(z) / r.norm())
            .chain(qp.below.iter().map(|r| (r.times(z) / r.norm()).max(0.0))),
    );
    let work: f64 = qp.f.iter().zip(z).map(|(f, z)| f * z).sum();
    let scale: f64 = qp.f.iter().zip(z).map(|(f, z)| (f * z).abs()).sum();
    if stiff <= 1e-9 * scaled_size && stopped <= 1e-9 * size && work > 1e-9 * scale {
        return Ok(());
    }
    Err(format!(
        "the energy seems to have no lower bound, but there is no proof: \
         K z = {stiff:.1e}, B z = {stopped:.1e}, fᵀz = {work:.1e}"
    ))
}
