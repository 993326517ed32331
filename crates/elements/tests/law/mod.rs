//! Unit tests of `crates/elements/src/law/mod.rs` and of the laws beside it.

use super::*;
use crate::cell::{Cure, Material, Plane};
use crate::element::{self, Integration};
use crate::kind::CellKind;

const WOOD: Orthotropic = Orthotropic {
    young: [12.0, 0.9, 0.5],
    poisson: [0.35, 0.45, 0.6],
    shear: [0.8, 0.7, 0.05],
};

/// The strain of a stress, by elimination.
fn strain(tangent: &Tangent, stress: [f64; 6]) -> [f64; 6] {
    let a = faer::Mat::from_fn(6, 6, |i, j| tangent.0[i][j]);
    let b = faer::Mat::from_fn(6, 1, |i, _| stress[i]);
    let x = faer::linalg::solvers::Solve::solve(&a.partial_piv_lu(), &b);
    std::array::from_fn(|i| x[(i, 0)])
}

fn close(found: [f64; 6], expected: [f64; 6]) {
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-13, "{found:?} {expected:?}");
    }
}

#[test]
fn orthotropic_laws_answer_a_pull_and_a_shear_as_their_constants_say() {
    let law = WOOD.tangent().expect("a sound law");
    let mut pull = [0.0; 6];
    pull[0] = 1.0;
    close(
        strain(&law, pull),
        [1.0 / 12.0, -0.35 / 12.0, -0.45 / 12.0, 0.0, 0.0, 0.0],
    );
    let second = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    close(
        strain(&law, second),
        [-0.35 / 12.0, 1.0 / 0.9, -0.6 / 0.9, 0.0, 0.0, 0.0],
    );
    // Shear xy, yz, xz: G_12, G_23, G_13.
    let shear = [0.0, 0.0, 0.0, 0.8, 0.05, 0.7];
    close(strain(&law, shear), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
}

#[test]
fn along_fibres_and_across_them() {
    let law = Transverse {
        young: [140.0, 10.0],
        poisson: [0.3, 0.4],
        shear: 5.0,
    };
    let law = law.tangent().expect("a sound law");
    close(
        strain(&law, [140.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        [1.0, -0.3, -0.3, 0.0, 0.0, 0.0],
    );
    close(
        strain(&law, [0.0, 10.0, 0.0, 0.0, 0.0, 0.0]),
        [-0.3 / 14.0, 1.0, -0.4, 0.0, 0.0, 0.0],
    );
    // The same in all directions about the fibres.
    let about = [[1.0, 0.0, 0.0], [0.0, 0.6, 0.8], [0.0, -0.8, 0.6]];
    let turned = law.along(&about);
    for (a, b) in law.0.iter().flatten().zip(turned.0.iter().flatten()) {
        assert!((a - b).abs() < 1e-12);
    }
}

#[test]
fn twenty_one_constants_have_the_order_of_decks() {
    let law = Anisotropic(std::array::from_fn(|k| 1.0 + k as f64));
    let c = law.tangent().expect("finite numbers").0;
    // D_1111, D_2222, D_3333; D_1212, D_1313, D_2323 at xy, xz, yz; D_1112; D_1323.
    assert_eq!([c[0][0], c[1][1], c[2][2]], [1.0, 3.0, 6.0]);
    assert_eq!([c[3][3], c[5][5], c[4][4]], [10.0, 15.0, 21.0]);
    assert_eq!([c[0][3], c[3][0], c[5][4]], [7.0, 7.0, 20.0]);
}

#[test]
fn an_orthotropic_law_with_equal_constants_is_isotropic() {
    let (young, poisson) = (3.0, 0.3);
    let same = Orthotropic {
        young: [young; 3],
        poisson: [poisson; 3],
        shear: [young / (2.0 * (1.0 + poisson)); 3],
    };
    let (a, b) = (
        same.tangent().expect("a sound law"),
        Tangent::isotropic(young, poisson),
    );
    for (a, b) in a.0.iter().flatten().zip(b.0.iter().flatten()) {
        assert!((a - b).abs() < 1e-14);
    }
}

#[test]
fn constants_that_make_no_sense_are_refused_with_what_was_found() {
    let refused = Orthotropic {
        young: [1.0, -2.0, 1.0],
        ..WOOD
    };
    let clause = refused.tangent().expect_err("a negative modulus");
    assert_eq!(clause, "young is -2, expected a positive number");
    let refused = Orthotropic {
        shear: [1.0, 1.0, f64::NAN],
        ..WOOD
    };
    assert!(refused.tangent().is_err());
    let stretched = Orthotropic {
        poisson: [5.0, 0.0, 0.0],
        ..WOOD
    };
    let law = Law::General(stretched.tangent().expect("finite numbers"));
    assert!(law
        .check()
        .expect_err("no energy")
        .contains("positive energy"));
    let sound = Law::General(WOOD.tangent().expect("a sound law"));
    assert_eq!(sound.check(), Ok(()));
}

/// The general path of every element has the matrix and the stresses of the isotropic one.
#[test]
fn elements_take_an_isotropic_law_by_its_matrix() {
    let (young, poisson) = (3.0, 0.3);
    let laws = [
        Law::Isotropic { young, poisson },
        Law::General(Tangent::isotropic(young, poisson)),
    ];
    let rules = [
        Integration::Full,
        Integration::Reduced,
        Integration::Incompatible,
    ];
    let mut count = 0;
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() >= 2) {
        let dim = kind.dim();
        let points = element::testing::distorted(kind, 3);
        let points: Vec<[f64; 3]> = points.iter().map(|[x, y, z]| [x + 4.0, *y, *z]).collect();
        for plane in [Plane::Strain, Plane::Stress, Plane::Axial] {
            for rule in rules {
                let materials = laws.map(|law| Material::Elastic {
                    law,
                    plane,
                    cure: Cure::None,
                });
                if element::check(kind, dim, &materials[0], rule).is_err() {
                    continue;
                }
                let n = dim * kind.nodes();
                let nodal: Vec<f64> = (0..n).map(|k| (k as f64 * 1.7).sin()).collect();
                let found = materials.map(|material| {
                    let mut k = vec![0.0; n * n];
                    element::stiffness(kind, dim, &points, &material, rule, &mut k);
                    let mut at = vec![element::NodeStress::default(); kind.nodes()];
                    element::stress_at_nodes(kind, dim, &points, &material, rule, &nodal, &mut at);
                    let exact = |p: [f64; 3]| {
                        (
                            [p[0] * p[1], p[1], 0.0],
                            [[p[1], p[0], 0.0], [0.0, 1.0, 0.0], [0.0; 3]],
                        )
                    };
                    let norms =
                        element::error_squares(kind, dim, &points, &material, &nodal, exact);
                    let stress: Vec<f64> = at
                        .iter()
                        .flat_map(|s| [s.strain, s.stress].concat())
                        .collect();
                    [k, stress, norms.to_vec()]
                });
                let [a, b] = found;
                for (a, b) in a.iter().zip(&b) {
                    let size = a.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
                    let apart = a
                        .iter()
                        .zip(b)
                        .fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
                    assert!(
                        apart < 1e-13 * size,
                        "{kind:?} {plane:?} {rule:?} {apart:e} of {size:e}"
                    );
                }
                count += 1;
            }
        }
    }
    assert!(count > 30, "{count}");
}
