//! Unit tests of `crates/lab/src/study/benchmarks/punch.rs`.

use super::*;

const PUNCH: Rounded = Rounded {
    a: 1.25,
    flat: 1.0,
    radius: 50.0,
    modulus: 2.0,
};

/// The punch as a sum of flat punches of half-width s, b ≤ s ≤ a: dP = E*/R · s · acos(b/s) ds, and each has the
/// pressure dP/(π √(s² − x²)). With v² = s² − x² and v = v₀ + (v₁ − v₀) t² the integrand is smooth.
fn summed(punch: &Rounded, x: f64) -> f64 {
    let first = (punch.flat.powi(2) - x * x).max(0.0).sqrt();
    let last = (punch.a.powi(2) - x * x).sqrt();
    let n = 20_000;
    let each = (0..n).map(|k| {
        let t = (k as f64 + 0.5) / n as f64;
        let v = first + (last - first) * t * t;
        let ratio = punch.flat / x.hypot(v);
        ratio.min(1.0).acos() * 2.0 * t * (last - first) / n as f64
    });
    punch.modulus / (PI * punch.radius) * each.sum::<f64>()
}

#[test]
fn the_closed_form_is_the_sum_of_flat_punches() {
    for x in [0.0, 0.3, 0.9, 0.99, 1.01, 1.1, 1.24] {
        let (closed, sum) = (PUNCH.pressure(x), summed(&PUNCH, x));
        assert!((closed / sum - 1.0).abs() < 1e-5, "{x}: {closed} {sum}");
    }
    assert_eq!(PUNCH.pressure(1.3), 0.0);
}

#[test]
fn the_pressure_adds_up_to_the_force() {
    let n = 200_000;
    let at = |k: usize| -1.25 + 2.5 * (k as f64 + 0.5) / f64::from(n);
    let sum: f64 = (0..n as usize).map(|k| PUNCH.pressure(at(k))).sum();
    let force = sum * 2.5 / f64::from(n);
    assert!((force / PUNCH.force() - 1.0).abs() < 1e-5, "{force}");
    // The form in which the force is published.
    let phi = 0.8_f64.asin();
    let published = (PI - 2.0 * phi) / phi.sin().powi(2) - 2.0 / phi.tan();
    let ours = 4.0 * PUNCH.force() * PUNCH.radius / PUNCH.modulus;
    assert!((ours / published - 1.0).abs() < 1e-12);
}

/// Without a flat part it is Hertz's cylinder.
#[test]
fn without_a_flat_part_it_is_a_cylinder() {
    let punch = Rounded {
        flat: 1e-9,
        ..PUNCH
    };
    let hertz = PI * punch.modulus * punch.a.powi(2) / (4.0 * punch.radius);
    assert!((punch.force() / hertz - 1.0).abs() < 1e-6);
    let p = 2.0 * hertz / (PI * punch.a) * 0.6;
    assert!((punch.pressure(0.8 * punch.a) / p - 1.0).abs() < 1e-6);
}
