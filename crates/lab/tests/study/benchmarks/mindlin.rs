//! Unit tests of `crates/lab/src/study/benchmarks/friction/mindlin.rs`.

use super::Mindlin;
use std::f64::consts::PI;

fn theory(spheres: bool) -> Mindlin {
    Mindlin {
        modulus: 100.0,
        radius: 4.0,
        friction: 0.3,
        spheres,
    }
}

/// ∫ q over the contact, over μ P.
fn total(theory: &Mindlin, turn: f64, back: Option<f64>) -> f64 {
    let n = 20_000;
    let mut sum = 0.0;
    for k in 0..n {
        let x = (k as f64 + 0.5) / n as f64;
        // p₀ is 2P/(π a), or 3P/(2π a²).
        let weight = if theory.spheres { 3.0 * x } else { 4.0 / PI };
        sum += weight * theory.shear(x, turn, back) / n as f64;
    }
    sum
}

#[test]
fn shear_stresses_add_up_to_the_load() {
    for spheres in [false, true] {
        let theory = theory(spheres);
        for (turn, back) in [
            (0.2, None),
            (0.75, None),
            (0.75, Some(0.1)),
            (0.75, Some(-0.5)),
        ] {
            let load = back.unwrap_or(turn);
            let found = total(&theory, turn, back);
            assert!(
                (found - load).abs() < 1e-5,
                "{spheres} {turn} {back:?}: {found}"
            );
        }
    }
}

#[test]
fn a_load_that_is_fully_reversed_is_the_first_one_with_another_sign() {
    let theory = theory(false);
    for x in [0.1, 0.4, 0.8] {
        let [to, fro] = [None, Some(-0.6)].map(|back| theory.shear(x, 0.6, back));
        assert!((to + fro).abs() < 1e-14);
    }
}

#[test]
fn pressures_add_up_to_the_normal_force() {
    let cylinders = theory(false).under(7.0);
    assert!((0.5 * PI * cylinders.p0 * cylinders.a - 7.0).abs() < 1e-13);
    let spheres = theory(true).under(7.0);
    assert!((2.0 / 3.0 * PI * spheres.p0 * spheres.a.powi(2) - 7.0).abs() < 1e-13);
    // p₀ = E* a/(2 R), and 2 E* a/(π R) for spheres.
    assert!((cylinders.p0 - 100.0 * cylinders.a / 8.0).abs() < 1e-12);
    assert!((spheres.p0 - 2.0 * 100.0 * spheres.a / (PI * 4.0)).abs() < 1e-12);
}
