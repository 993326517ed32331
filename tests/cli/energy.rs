//! The energy that `solve` reports: that of the whole problem, given displacements included.

use crate::support::checks::number;
use crate::support::{mpi, program};
use mpi::Scratch;
use program::run_fetifeti;
use serde_json::Value;

/// The energy that `solve` reports on this number of ranks.
fn energy_of(scratch: &Scratch, ranks: usize, body: &str) -> f64 {
    let text = format!("title = \"energy\"\n{body}");
    let scene = scratch.file("energy.toml", &text);
    let args = [
        "solve",
        &scene,
        "--quiet",
        "--json",
        "-",
        "-fetifeti_ksp_rtol",
        "1e-12",
    ];
    let out = run_fetifeti(ranks, &args);
    assert_eq!(out.code, 0, "{}", out.all());
    let report: Value = serde_json::from_str(&out.stdout).expect("JSON");
    number(&report["energy"])
}

#[test]
fn the_energy_holds_what_given_values_store() {
    let scratch = Scratch::new("given-energy");
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a}, not {b}");
    for (ranks, elements) in [(1, 4), (1, 16), (2, 8)] {
        let cells = format!("size = [1, 1]\nelements = {elements}\nsubdomains = [2, 2]\n");
        // u = 1 − x: ½ ∫ |∇u|² = ½. With a load f of 3 it is u = 1 − x + 3/2 x (1 − x), and the energy is
        // ½ − 3/2 − 9/24 (1 − h²).
        let body =
            format!("[[body]]\nname = \"a\"\n{cells}dirichlet = {{ left = 1, right = 0 }}\n");
        near(energy_of(&scratch, ranks, &body), 0.5);
        let h = 1.0 / f64::from(elements);
        let loaded = energy_of(&scratch, ranks, &format!("{body}load = 3\n"));
        near(loaded, 0.5 - 1.5 - 9.0 / 24.0 * (1.0 - h * h));
        // A lift without strain, and two bodies in contact that are pushed together by ½.
        let lift = format!("[[body]]\nname = \"a\"\n{cells}dirichlet = {{ left = 2, top = 2 }}\n");
        near(energy_of(&scratch, ranks, &lift), 0.0);
        let pushed = format!(
            "[[body]]\nname = \"a\"\n{cells}dirichlet = {{ left = 1 }}\n\
             [[body]]\nname = \"b\"\norigin = [1, 0]\n{cells}dirichlet = {{ right = 0 }}\n\
             [[contact]]\nbodies = [\"a\", \"b\"]\ngap = 0.5\n"
        );
        // The jump of ½ is spread over a length of two: ½ ∫ (1/4)².
        near(energy_of(&scratch, ranks, &pushed), 0.5 * 0.0625 * 2.0);
    }
}

#[test]
fn the_energy_of_a_stretched_elastic_body() {
    let scratch = Scratch::new("given-elastic");
    // Plane stress, held at x on both sides and free to contract: ½ E ε².
    let body =
        "physics = \"elasticity\"\nplane = \"stress\"\n[[body]]\nname = \"a\"\nsize = [2, 1]\n\
                elements = [8, 4]\nsubdomains = [2, 2]\nyoung = 10\npoisson = 0.3\n\
                dirichlet = { left = { x = 0 }, right = { x = 0.2 }, bottom = { y = 0 } }\n";
    let energy = energy_of(&scratch, 1, body);
    assert!((energy - 0.5 * 10.0 * 0.01 * 2.0).abs() < 1e-10, "{energy}");
}
