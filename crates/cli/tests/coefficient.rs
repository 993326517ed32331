//! Unit tests of `crates/cli/src/coefficient.rs`.

use super::*;

#[test]
fn ranges_are_said_in_words() {
    let text = |rho: &str| {
        let text = format!(
            "[grid]\nbodies = [2, 1]\nelements = 4\nsubdomains = 2\ndirichlet = [\"left\"]\nrho = {rho}\n"
        );
        let scene = Scene::parse("s.toml", &text).unwrap();
        let bodies = scene.coefficient_ranges(&|_| true).unwrap();
        Coefficient { bodies }.text(&scene)
    };
    assert_eq!(text("2"), "ρ = 2");
    assert_eq!(
        text("[[1e-5, 4]]"),
        "ρ from 1e-5 to 4, constant inside bodies"
    );
    assert_eq!(
        text("{ per_subdomain = [[1, 2], [1, 1e6]] }"),
        "ρ from 1 to 1e6, inside a body by a factor of up to 1e6"
    );
    assert_eq!(
        text("[{ x = [0, 0.5], value = \"1 + 8*x\" }, { x = [0.5, 1], value = 100 }]"),
        "ρ from 1.5 to 100, inside a body by a factor of up to 3"
    );
}

#[test]
fn numbers_have_four_digits() {
    let all = [1.0, 1e-3, 2.0 / 3.0, 123456.7, 1e6, 1e-5, 12345.6].map(number);
    assert_eq!(
        all,
        ["1", "0.001", "0.6667", "1.235e5", "1e6", "1e-5", "12350"]
    );
}
