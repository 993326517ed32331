//! Unit tests of `crates/scene/src/need.rs`.

use super::Need;
use crate::read::read;

fn of(text: &str) -> Need {
    let spec = read("scene.toml", text).expect("a scene");
    Need::of(spec.bodies.iter(), &spec.form, true)
}

fn grid(bodies: usize, subdomains: usize, elements: usize, more: &str) -> Need {
    of(&format!(
        "{more}\n[grid]\nbodies = {bodies}\nsubdomains = {subdomains}\nelements_per_subdomain = {elements}\n"
    ))
}

/// Largest resident memory of `fetifeti plan` and `fetifeti solve` in MB, measured (docs/options.md, "Memory").
#[test]
fn the_need_is_what_was_measured_within_a_factor_of_two() {
    let solid = "dimension = 3\nphysics = \"elasticity\"";
    for (need, plan, solve) in [
        (grid(1, 447, 2, ""), 543.0, 999.0),
        (grid(1, 1, 1000, ""), 318.0, 928.0),
        (grid(30, 4, 8, ""), 333.0, 424.0),
        (grid(1, 1, 600, "physics = \"elasticity\""), 426.0, 1123.0),
        (grid(1, 1, 40, "dimension = 3"), 88.0, 444.0),
        (grid(1, 1, 24, solid), 106.0, 475.0),
        (grid(1, 4, 8, solid), 94.0, 249.0),
        (grid(1, 2, 8, &format!("{solid}\norder = 2")), 405.0, 1134.0),
    ] {
        let factors = [need.assembled(1) / plan / 1e6, need.solved(1) / solve / 1e6];
        assert!(
            (0.5..2.0).contains(&factors[0]) && (0.75..1.5).contains(&factors[1]),
            "{factors:?} of {plan} and {solve} MB: {need:?}"
        );
    }
}

/// Many bodies, as there, tied and in contact.
#[test]
fn many_bodies_take_what_was_measured() {
    let elastic = "physics = \"elasticity\"";
    let solid = format!("dimension = 3\n{elastic}");
    for (need, solve) in [
        (grid(64, 1, 4, ""), 209.0),
        (grid(100, 1, 2, ""), 317.0),
        (grid(40, 1, 4, elastic), 177.0),
        (grid(6, 2, 3, &solid), 685.0),
        (grid(12, 1, 3, &solid), 1434.0),
    ] {
        let factor = need.solved(1) / solve / 1e6;
        assert!((0.9..1.5).contains(&factor), "{factor} of {solve} MB");
    }
}

#[test]
fn ranks_share_the_need_but_for_what_all_of_them_know() {
    let need = grid(8, 4, 8, "");
    let [one, four] = [1, 4].map(|ranks| need.solved(ranks));
    assert!(four < one && 4.0 * four > one, "{one} {four}");
}

#[test]
fn coefficients_that_vary_in_space_leave_nothing_to_share() {
    let with = |rho: &str| {
        of(&format!(
            "[grid]\nbodies = 1\nsubdomains = 8\nelements_per_subdomain = 32\nrho = {rho}\n"
        ))
        .solved(1)
    };
    let [constant, by_body, by_point] = ["3", "\"1 + bi\"", "\"1 + x\""].map(with);
    // Bodies that differ by a factor have one factorisation, but matrices of their own.
    assert!(by_body > constant, "{by_body} {constant}");
    // 64 factors instead of 9.
    assert!(by_point > constant + 1e7, "{by_point} {constant}");
}
