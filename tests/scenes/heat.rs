//! Bodies that expand by heat, beside closed forms.

use crate::support::answer::solve;
use crate::support::scene_message::check;

#[test]
fn a_free_block_expands_along_the_axes_of_its_material() {
    // ½ ε₀ C ε₀ of an isotropic law is 9/2 of the bulk modulus times (α ΔT)².
    let (young, poisson) = (210.0, 0.3);
    let strain = 1e-2 * (70.0 - 20.0);
    let bulk = young / (3.0 * (1.0 - 2.0 * poisson));
    for more in ["", "order = 2\n", "locking = \"bbar\"\n"] {
        let text = format!(
            "dimension = 3\nphysics = \"elasticity\"\n{more}[[body]]\nsize = [2, 1, 1]\nelements = [4, 2, 2]\n\
             subdomains = [2, 1, 1]\nyoung = {young}\npoisson = {poisson}\nexpansion = 1e-2\ntemperature = 70\n\
             reference = 20\n"
        );
        let found = solve(&text);
        let (energy, nodes) = (found.energy, found.nodes);
        let expected = -4.5 * bulk * 2.0 * strain * strain;
        assert!(
            (energy / expected - 1.0).abs() < 1e-9,
            "{more} {energy} {expected}"
        );
        let along = |c: usize| {
            let of = nodes.iter().filter(|n| n.1 == c).map(|n| n.2);
            of.clone().fold(f64::MIN, f64::max) - of.fold(f64::MAX, f64::min)
        };
        for (c, length) in [(0, 2.0), (1, 1.0), (2, 1.0)] {
            assert!(
                (along(c) - strain * length).abs() < 1e-8,
                "{c} {}",
                along(c)
            );
        }
    }
    // Along fibres it shrinks: with axes 1 and 2 exchanged along y.
    let text = "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nsize = [2, 1, 1]\nelements = [2, 2, 2]\n\
                material = { transverse = { young = [140, 10], poisson = [0.3, 0.4], shear = 5 }, \
                axes = [[0, 1, 0], [1, 0, 0]] }\nexpansion = [-1e-3, 2e-2, 3e-2]\ntemperature = 10\n";
    let nodes = solve(text).nodes;
    for (c, grows) in [(0, 2.0 * 0.2), (1, -0.01), (2, 0.3)] {
        let at = |end: f64| {
            let of = nodes
                .iter()
                .filter(|n| n.1 == c && (n.0[c] - end).abs() < 1e-9);
            of.map(|n| n.2).next().expect("a node")
        };
        let length = [2.0, 1.0, 1.0][c];
        assert!((at(length) - at(0.0) - grows).abs() < 1e-8, "{c}");
    }
}

/// Without a temperature the body has the one of its reference.
#[test]
fn a_body_of_no_temperature_keeps_its_shape() {
    let found = solve(
        "physics = \"elasticity\"\n[[body]]\nsize = 1\nelements = 4\nexpansion = 1e-3\nreference = 20\n\
         dirichlet = [\"left\"]\n",
    );
    assert!(found.nodes.iter().all(|n| n.2 == 0.0));
}

#[test]
fn a_strip_of_two_metals_bends_as_timoshenko_says() {
    // Curvature 3/2 (α₁ − α₂) ΔT/h of two halves of equal thickness and stiffness.
    let (length, height, difference) = (20.0, 0.5, 1e-3);
    let half = |name: &str, y: f64, alpha: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [0, {y}]\nsize = [{length}, {}]\nelements = [80, 2]\n\
             subdomains = [4, 1]\nyoung = 1e3\npoisson = 0.3\nexpansion = {alpha}\ntemperature = 100\n\
             reference = 0\ndirichlet = {{ left = {{ x = 0 }} }}\n",
            0.5 * height
        )
    };
    let text = format!(
        "physics = \"elasticity\"\nplane = \"stress\"\norder = 2\n{}{}[[tie]]\nbodies = [\"low\", \"high\"]\n\
         [steps]\ntimes = [1, 2]\nload = \"t/2\"\n",
        half("low", 0.0, 0.02 * difference),
        half("high", 0.5 * height, 0.03 * difference)
    );
    let nodes = solve(&text).nodes;
    let y_at = |x: f64| {
        let near = nodes
            .iter()
            .filter(|n| n.1 == 1 && (n.0[0] - x).abs() < 1e-9 && n.0[1] < 1e-9);
        near.map(|n| n.2).next().expect("a node")
    };
    let curvature = 1.5 * 0.01 * difference * 100.0 / height;
    let sag = y_at(length) - y_at(0.0);
    let expected = -0.5 * curvature * length * length;
    assert!((sag / expected - 1.0).abs() < 5e-3, "{sag} {expected}");
}

#[test]
fn what_is_heated_without_sense_is_refused_in_one_sentence() {
    let body = |head: &str, keys: &str| format!("{head}[[body]]\nelements = 4\nsize = 1\n{keys}\n");
    check(
        &body("physics = \"elasticity\"\n", "expansion = [1, 2]"),
        "s.toml:5: a list of 2 where three numbers along the axes of the material was expected",
    );
    let of_p1 = body(
        "physics = \"elasticity\"\nelement = \"p1\"\n",
        "expansion = 1\ntemperature = 3",
    );
    check(
        &of_p1,
        "s.toml:3: body `body0`: `expansion` with `element = \"p1\"` (\"q1\" was expected)",
    );
    let keys = "expansion = 1\ntemperature = \"1/x\"";
    check(
        &body("physics = \"elasticity\"\n", keys),
        "s.toml:2: body `body0`: temperature inf at (0, 0) where a finite number was expected",
    );
    check(
        &body("physics = \"elasticity\"\n", "temperature = 3"),
        "s.toml:5: `temperature` without `expansion`, of which it is the cause",
    );
    let scalar = body("", "expansion = 1");
    assert!(crate::support::scene_message::message(&scalar).contains("unknown key `expansion`"));
}
