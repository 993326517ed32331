use super::*;
use std::collections::BTreeSet;

fn factorial(n: usize) -> f64 {
    (1..=n).product::<usize>() as f64
}

/// ∫ s^n over \[−1, 1\].
fn line(n: usize) -> f64 {
    if n % 2 == 0 {
        2.0 / (n + 1) as f64
    } else {
        0.0
    }
}

/// ∫ x^i y^j z^k over the reference cell, in closed form.
fn exact(kind: CellKind, [i, j, k]: [usize; 3]) -> f64 {
    match kind.linear() {
        CellKind::Line2 => line(i),
        CellKind::Quad4 => line(i) * line(j),
        CellKind::Hex8 => line(i) * line(j) * line(k),
        CellKind::Triangle3 => factorial(i) * factorial(j) / factorial(i + j + 2),
        CellKind::Tet4 => factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3),
        CellKind::Wedge6 => factorial(i) * factorial(j) / factorial(i + j + 2) * line(k),
        // ∫ (1 − z)^m z^k = m! k!/(m + k + 1)!.
        _ => {
            let m = i + j + 2;
            line(i) * line(j) * factorial(m) * factorial(k) / factorial(m + k + 1)
        }
    }
}

/// The degree to which the rule is meant to be exact: in all coordinates together, or in each where `each`.
fn degree(kind: CellKind, purpose: Purpose) -> (usize, bool) {
    let second = kind.order() == 2;
    let gauss = |n: usize| (2 * n - 1, true);
    match (kind.linear(), purpose) {
        (CellKind::Triangle3 | CellKind::Tet4, Purpose::Full | Purpose::Reduced) => {
            (1 + usize::from(second), false)
        }
        (CellKind::Triangle3, Purpose::Load) => (if second { 4 } else { 2 }, false),
        (CellKind::Tet4, Purpose::Load) => (if second { 5 } else { 2 }, false),
        (CellKind::Triangle3, Purpose::Error) => (if second { 8 } else { 6 }, false),
        (CellKind::Tet4, Purpose::Error) => (if second { 7 } else { 5 }, false),
        (CellKind::Wedge6, Purpose::Reduced) => (1 + usize::from(second), false),
        (CellKind::Wedge6, Purpose::Full | Purpose::Load) => (if second { 4 } else { 2 }, false),
        (CellKind::Wedge6, Purpose::Error) => (if second { 8 } else { 6 }, false),
        (CellKind::Pyramid5, Purpose::Error) => (5, false),
        (CellKind::Pyramid5, _) => (1, false),
        (_, Purpose::Centre) => (1, false),
        (_, Purpose::Full | Purpose::Load) => gauss(if second { 3 } else { 2 }),
        (_, Purpose::Reduced) => gauss(if second { 2 } else { 1 }),
        (_, Purpose::Error) => gauss(if second { 5 } else { 4 }),
        (_, Purpose::Nodes) => unreachable!(),
    }
}

#[test]
fn rules_integrate_polynomials_of_their_degree() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 0) {
        for purpose in Purpose::ALL.into_iter().filter(|p| *p != Purpose::Nodes) {
            let (degree, each) = degree(kind, purpose);
            let rule = rule(kind, purpose);
            let most = |d: usize| if d < kind.dim() { degree } else { 0 };
            for i in 0..=most(0) {
                for j in 0..=most(1) {
                    for k in 0..=most(2) {
                        if !each && i + j + k > degree {
                            continue;
                        }
                        let power = |at: &[f64; 3]| {
                            at[0].powi(i as i32) * at[1].powi(j as i32) * at[2].powi(k as i32)
                        };
                        let sum: f64 = rule.iter().map(|(at, w)| w * power(at)).sum();
                        let exact = exact(kind, [i, j, k]);
                        assert!(
                            (sum - exact).abs() < 3e-15 * (1.0 + exact.abs()) * 2.0,
                            "{kind:?} {purpose:?} x^{i} y^{j} z^{k}: {sum} {exact}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn one_degree_more_is_not_exact() {
    // So that the test above can fail.
    let sum = |kind, purpose, n| -> f64 {
        rule(kind, purpose)
            .iter()
            .map(|(at, w)| w * at[0].powi(n))
            .sum()
    };
    for (kind, purpose, n) in [
        (CellKind::Triangle6, Purpose::Load, 5),
        (CellKind::Tet10, Purpose::Load, 6),
        (CellKind::Tet10, Purpose::Full, 3),
        (CellKind::Hex8, Purpose::Full, 4),
        (CellKind::Hex27, Purpose::Error, 10),
    ] {
        let exact = exact(kind, [n as usize, 0, 0]);
        assert!((sum(kind, purpose, n) - exact).abs() > 1e-9, "{kind:?}");
    }
}

#[test]
fn points_lie_inside_and_weights_are_positive() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 0) {
        for purpose in Purpose::ALL.into_iter().filter(|p| *p != Purpose::Nodes) {
            for (at, weight) in rule(kind, purpose) {
                assert!(weight > 0.0);
                // Functions of first order are positive inside.
                let values = super::super::shape_functions::shape(kind.linear(), at).value;
                assert!(
                    values[..kind.corners()].iter().all(|&n| n > 0.0),
                    "{kind:?} {purpose:?} {at:?}"
                );
            }
        }
    }
}

#[test]
fn rules_have_the_points_of_the_documentation() {
    let count = |kind, purpose| rule(kind, purpose).len();
    let full: Vec<usize> = CellKind::ALL
        .map(|kind| count(kind, Purpose::Full))
        .to_vec();
    assert_eq!(full, [1, 2, 3, 1, 3, 4, 9, 9, 1, 4, 4, 6, 18, 8, 27, 27]);
    let load: Vec<usize> = CellKind::ALL
        .map(|kind| count(kind, Purpose::Load))
        .to_vec();
    assert_eq!(load, [1, 2, 3, 3, 6, 4, 9, 9, 4, 14, 8, 6, 18, 8, 27, 27]);
    assert_eq!(count(CellKind::Wedge6, Purpose::Reduced), 2);
    assert_eq!(count(CellKind::Wedge15, Purpose::Reduced), 9);
    assert_eq!(count(CellKind::Hex20, Purpose::Reduced), 8);
}

#[test]
fn gauss_points_are_symmetric() {
    for n in 1..=6 {
        let rule = gauss(n);
        let points: BTreeSet<u64> = rule.iter().map(|(x, _)| x.abs().to_bits()).collect();
        assert_eq!(points.len(), n.div_ceil(2));
    }
}

#[test]
fn rules_of_triangles_are_exact_for_their_degree() {
    for (degree, points) in [(4, 6), (8, 16), (14, 64)] {
        let rule = triangle_rule(degree);
        assert_eq!(rule.len(), points);
        for i in 0..=degree {
            for j in 0..=degree - i {
                let terms = rule
                    .iter()
                    .map(|([r, s], w)| w * r.powi(i as i32) * s.powi(j as i32));
                let expected = exact(CellKind::Triangle3, [i, j, 0]);
                let error = terms.sum::<f64>() - expected;
                assert!(error.abs() < 1e-15, "{degree} {i} {j}: {error:e}");
            }
        }
        let inside =
            |([r, s], w): &([f64; 2], f64)| *r > 0.0 && *s > 0.0 && r + s < 1.0 && *w > 0.0;
        assert!(rule.iter().all(inside));
    }
}
