//! Unit tests of `crates/lab/src/study/benchmarks/friction/arch_statics.rs`.

use super::Arch;

fn arch(voussoirs: usize, parts: usize) -> Arch {
    Arch {
        thickness: 0.2,
        voussoirs,
        parts,
    }
}

#[test]
fn many_voussoirs_have_the_least_thickness_of_milankovitch() {
    let least = arch(200, 1).least_thickness(0.6);
    assert!((least - 0.1075).abs() < 1e-4, "{least}");
    // Fewer joints leave fewer ways to fall.
    assert!(arch(16, 2).least_thickness(0.6) < least);
}

#[test]
fn weights_are_those_of_polygons() {
    let arch = arch(6, 1);
    let [inner, outer] = arch.radii();
    // Half of a regular polygon of twelve sides in another one.
    let polygon = |r: f64| 3.0 * r * r * (std::f64::consts::PI / 6.0).sin();
    assert!((arch.weight() - (polygon(outer) - polygon(inner))).abs() < 1e-14);
}

#[test]
fn odd_and_even_numbers_of_voussoirs_agree_where_there_are_many() {
    // An odd number has half of a voussoir beside the crown.
    let [even, odd] = [200, 201].map(|n| arch(n, 1).least_thickness(0.6));
    assert!((even / odd - 1.0).abs() < 2e-3, "{even} {odd}");
    let [even, odd] = [200, 201].map(|n| arch(n, 1).least_friction());
    assert!(
        (even - 0.309).abs() < 1e-3 && (odd - 0.309).abs() < 1e-3,
        "{even} {odd}"
    );
}

#[test]
fn halves_in_friction_and_thickness_are_both_sides_of_a_limit() {
    let arch = arch(16, 1);
    let least = arch.least_friction();
    assert!(arch.stands(1.001 * least) && !arch.stands(0.999 * least));
}
