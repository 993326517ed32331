//! Unit tests of `crates/elements/src/cell/reference.rs`.

use super::*;

/// ∫ x^p y^q z^r over the unit cell by the rule, the point recovered from the shape functions.
fn moment<const D: usize, const N: usize>(element: Element, rule: Rule, powers: [i32; D]) -> f64 {
    let mut sum = 0.0;
    for_each::<D, N>(element, rule, |point| {
        let mut value = point.weight;
        for (i, &p) in powers.iter().enumerate() {
            let s: f64 = (0..N)
                .filter(|a| a >> i & 1 == 1)
                .map(|a| point.shape[a])
                .sum();
            value *= s.powi(p);
        }
        sum += value;
    });
    sum
}

fn exact_up_to<const D: usize, const N: usize>(element: Element, rule: Rule, degree: i32) {
    for k in 0..(degree + 1).pow(D as u32) {
        let powers: [i32; D] =
            std::array::from_fn(|i| k / (degree + 1).pow(i as u32) % (degree + 1));
        // Simplex rules are exact by total degree, tensor rules by the degree in every coordinate.
        if element == Element::P1 && powers.iter().sum::<i32>() > degree {
            continue;
        }
        let exact: f64 = powers.iter().map(|&p| 1.0 / (p + 1) as f64).product();
        let got = moment::<D, N>(element, rule, powers);
        assert!(
            (got - exact).abs() < 1e-14,
            "{element:?} {rule:?} {powers:?}: {got} {exact}"
        );
    }
}

#[test]
fn rules_are_exact_to_the_degree_they_state() {
    exact_up_to::<1, 2>(Element::Q1, Rule::Load, 3);
    exact_up_to::<2, 4>(Element::Q1, Rule::Stiffness, 3);
    exact_up_to::<3, 8>(Element::Q1, Rule::Error, 7);
    exact_up_to::<1, 2>(Element::P1, Rule::Load, 3);
    exact_up_to::<2, 4>(Element::P1, Rule::Stiffness, 1);
    exact_up_to::<2, 4>(Element::P1, Rule::Load, 2);
    exact_up_to::<2, 4>(Element::P1, Rule::Error, 6);
    exact_up_to::<3, 8>(Element::P1, Rule::Stiffness, 1);
    exact_up_to::<3, 8>(Element::P1, Rule::Load, 2);
    exact_up_to::<3, 8>(Element::P1, Rule::Error, 5);
    // The rules are not exact for more than they should be: the comparison can fail.
    let beyond = moment::<3, 8>(Element::P1, Rule::Load, [4, 0, 0]);
    assert!((beyond - 0.2).abs() > 1e-6);
}

#[test]
fn shape_functions_are_a_partition_of_unity_and_slopes_their_derivatives() {
    for element in [Element::Q1, Element::P1] {
        for rule in [Rule::Stiffness, Rule::Load, Rule::Error] {
            for_each::<3, 8>(element, rule, |point| {
                assert!((point.shape.iter().sum::<f64>() - 1.0).abs() < 1e-15);
                for (j, row) in point.slope.iter().enumerate() {
                    assert!(row.iter().sum::<f64>().abs() < 1e-15);
                    // Linear functions are reproduced: Σ ∂N_a/∂s_j s_i(a) = δ_ij.
                    for i in 0..3 {
                        let slope: f64 = (0..8).filter(|a| a >> i & 1 == 1).map(|a| row[a]).sum();
                        assert!((slope - f64::from(i == j)).abs() < 1e-15);
                    }
                }
            });
        }
    }
}
