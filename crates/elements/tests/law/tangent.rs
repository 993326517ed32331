//! Unit tests of `crates/elements/src/law/tangent.rs`.

use super::*;
use crate::law::{Constants, Orthotropic};

/// Three orthonormal vectors along no axis.
const TURNED: [[f64; 3]; 3] = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];

fn wood() -> Tangent {
    let wood = Orthotropic {
        young: [12.0, 0.9, 0.5],
        poisson: [0.35, 0.45, 0.6],
        shear: [0.8, 0.7, 0.05],
    };
    wood.tangent().expect("a sound law")
}

fn largest_difference(a: &Tangent, b: &Tangent) -> f64 {
    let pairs = a.0.iter().flatten().zip(b.0.iter().flatten());
    pairs.fold(0.0, |sum: f64, (a, b)| sum.max((a - b).abs()))
}

#[test]
fn along_other_axes_it_is_the_turned_tensor() {
    let (own, turned) = (wood(), wood().along(&TURNED));
    for i in 0..3 {
        for j in 0..3 {
            for k in 0..3 {
                for l in 0..3 {
                    let mut sum = 0.0;
                    for p in 0..3 {
                        for q in 0..3 {
                            for r in 0..3 {
                                for s in 0..3 {
                                    sum += TURNED[p][i]
                                        * TURNED[q][j]
                                        * TURNED[r][k]
                                        * TURNED[s][l]
                                        * own.at(p, q, r, s);
                                }
                            }
                        }
                    }
                    assert!((sum - turned.at(i, j, k, l)).abs() < 1e-13);
                }
            }
        }
    }
}

#[test]
fn an_isotropic_law_is_the_same_along_all_axes_and_its_own_mean() {
    for (young, poisson) in [(3.0, 0.3), (2e11, 0.0), (1.0, 0.4999), (5.0, -0.4)] {
        let law = Tangent::isotropic(young, poisson);
        assert!(largest_difference(&law, &law.along(&TURNED)) < 1e-14 * law.0[0][0]);
        let (e, nu) = law.mean();
        assert!((e / young - 1.0).abs() < 1e-11 && (nu - poisson).abs() < 1e-11);
    }
    let (a, b) = (wood().mean(), wood().along(&TURNED).mean());
    assert!((a.0 - b.0).abs() < 1e-13 * a.0 && (a.1 - b.1).abs() < 1e-13);
}

#[test]
fn in_plane_stress_nothing_pulls_across() {
    let law = wood().along(&TURNED);
    let mut gamma = [0.3, -0.2, 0.0, 0.5, 0.0, 0.0];
    let in_plane = law.plane_stress().stress(&gamma);
    law.across(&mut gamma);
    let stress = law.stress(&gamma);
    for c in [2, 4, 5] {
        assert!(stress[c].abs() < 1e-14);
    }
    for c in [0, 1, 3] {
        assert!((stress[c] - in_plane[c]).abs() < 1e-13);
    }
    // A sheet of an isotropic law.
    let sheet = Tangent::isotropic(3.0, 0.3).plane_stress();
    assert!((sheet.0[0][1] - 3.0 * 0.3 / 0.91).abs() < 1e-14);
}

#[test]
fn which_laws_keep_the_plane() {
    let about_z = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]];
    assert!(wood().keeps_the_plane() && wood().along(&about_z).keeps_the_plane());
    assert!(!wood().along(&TURNED).keeps_the_plane());
}

#[test]
fn a_law_without_energy_is_seen() {
    assert!(wood().is_positive() && wood().along(&TURNED).scaled(1e12).is_positive());
    let with = |poisson| Orthotropic {
        young: [1.0; 3],
        poisson: [poisson; 3],
        shear: [1.0; 3],
    };
    for (poisson, sound) in [(0.4999, true), (0.51, false), (-0.99, true), (-1.1, false)] {
        let law = with(poisson).tangent().expect("finite numbers");
        assert_eq!(law.is_positive(), sound, "{poisson}");
    }
}
