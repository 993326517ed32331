//! Unit tests of `crates/lab/src/study/hertz/theory.rs`.

use super::*;

/// The pressure adds up to the force, and p0 = E* a/(2R) for cylinders, 2 E* a/(πR) for spheres.
#[test]
fn pressure_and_force_belong_together() {
    let soft = Elastic {
        young: 2.0,
        poisson: 0.3,
        radius: 1.5,
    };
    for spheres in [false, true] {
        let pair = HertzPair::new([soft, Elastic::PLANE], spheres);
        assert!((pair.modulus - 2.0 / 0.91).abs() < 1e-14 && (pair.radius - 1.5).abs() < 1e-14);
        let found = pair.under(0.01);
        let n = 100_000;
        let sum: f64 = (0..n)
            .map(|k| {
                let x = (f64::from(k) + 0.5) / f64::from(n) * found.a;
                let ring = if spheres {
                    std::f64::consts::TAU * x
                } else {
                    2.0
                };
                found.pressure(x) * ring * found.a / f64::from(n)
            })
            .sum();
        assert!((sum / 0.01 - 1.0).abs() < 1e-5, "{sum}");
        let stiffness = pair.modulus * found.a / pair.radius;
        let factor = if spheres {
            2.0 / std::f64::consts::PI
        } else {
            0.5
        };
        assert!((found.p0 / (factor * stiffness) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn two_equal_bodies_are_half_as_stiff_and_half_as_wide() {
    let body = Elastic {
        young: 1.0,
        poisson: 0.25,
        radius: 1.0,
    };
    let pair = HertzPair::new([body, body], false);
    let plane = HertzPair::new([body, Elastic::PLANE], false);
    assert!((pair.modulus - 0.5 * plane.modulus).abs() < 1e-15);
    assert!((pair.radius - 0.5).abs() < 1e-15);
}
