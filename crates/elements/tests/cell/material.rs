//! Unit tests of `crates/elements/src/cell/material.rs`.

use super::*;
use crate::law::Law;

fn elastic(young: f64, poisson: f64, plane: Plane, cure: Cure) -> Material {
    Material::Elastic {
        law: Law::Isotropic { young, poisson },
        plane,
        cure,
    }
}

#[test]
fn the_constants_give_back_young_and_poisson() {
    for poisson in [-0.5, 0.0, 0.3, 0.4999] {
        // 3D: a bar under tension has E = μ(3λ + 2μ)/(λ + μ), ν = λ/(2(λ + μ)).
        let (l, m) = elastic(7.0, poisson, Plane::Strain, Cure::None).lame(3);
        assert!((m * (3.0 * l + 2.0 * m) / (l + m) - 7.0).abs() < 1e-10);
        assert!((l / (2.0 * (l + m)) - poisson).abs() < 1e-12);
        // A sheet under tension in x: σ_xx = (λ + 2μ) ε_x + λ ε_y = 1, σ_yy = 0.
        let (l, m) = elastic(7.0, poisson, Plane::Stress, Cure::None).lame(2);
        let ratio = l / (l + 2.0 * m);
        assert!((ratio - poisson).abs() < 1e-14);
        assert!((l + 2.0 * m - l * ratio - 7.0).abs() < 1e-12);
    }
}

#[test]
fn bad_materials_are_refused_with_what_was_found() {
    let good = elastic(1.0, 0.4999, Plane::Strain, Cure::BBar);
    assert_eq!(good.check(2, Element::Q1), Ok(()));
    assert_eq!(good.check(3, Element::Q1), Ok(()));
    assert!(good.check(3, Element::P1).unwrap_err().contains("P1"));
    for (material, word) in [
        (Material::Scalar { rho: -2.0 }, "-2"),
        (Material::Scalar { rho: f64::NAN }, "NaN"),
        (elastic(0.0, 0.3, Plane::Strain, Cure::None), "Young"),
        (elastic(1.0, 0.5, Plane::Strain, Cure::None), "0.5"),
        (elastic(1.0, f64::NAN, Plane::Strain, Cure::None), "NaN"),
        (
            elastic(1.0, 0.3, Plane::Stress, Cure::BBar),
            "does not lock",
        ),
    ] {
        let text = material.check(2, Element::Q1).unwrap_err();
        assert!(text.contains(word), "{text}");
    }
    // In 3D the plane is ignored.
    let solid = elastic(1.0, 0.3, Plane::Stress, Cure::BBar);
    assert_eq!(solid.check(3, Element::Q1), Ok(()));
}
