//! `spring`: elastic foundations on sides of bodies.

use scene::Scene;

fn scene(head: &str, keys: &str) -> Scene {
    let text = format!("{head}[[body]]\nname = \"a\"\nelements = 6\nsubdomains = 2\n{keys}");
    Scene::parse("springs.toml", &text).expect("a scene")
}

/// eᵀKe for the translation e along component `c`: the total stiffness of all springs.
fn against_translation(scene: &Scene, c: usize) -> f64 {
    let components = scene.components();
    let of = |s: usize| {
        let sub = scene.subdomain(s).expect("a subdomain");
        let along = |dof: u64| f64::from(dof as usize % components == c);
        let e: Vec<f64> = sub.dofs.iter().map(|&d| along(d)).collect();
        let mut ke = vec![0.0; e.len()];
        sub.k.mul(&e, &mut ke);
        e.iter().zip(&ke).map(|(a, b)| a * b).sum::<f64>()
    };
    (0..scene.n_subdomains()).map(of).sum()
}

#[test]
fn springs_hold_translations_with_their_integral() {
    const SPRINGS: &str = "spring = { left = \"2*y\", top = 3 }\n";
    let flat = "size = [2, 1]\n";
    let solid = "size = [2, 1, 4]\n";
    let elastic = "physics = \"elasticity\"\n";
    // ∫ 2y over the left side is 1 (times the depth), 3 over the top 6.
    for (head, size, components, depth) in [
        ("", flat, 1, 1.0),
        (elastic, flat, 2, 1.0),
        ("dimension = 3\n", solid, 1, 4.0),
        ("dimension = 3\nphysics = \"elasticity\"\n", solid, 3, 4.0),
    ] {
        let held = scene(head, &format!("{size}{SPRINGS}"));
        for c in 0..components {
            let found = against_translation(&held, c);
            assert!((found - 7.0 * depth).abs() < 1e-12, "{found}");
        }
        assert!(against_translation(&scene(head, size), 0).abs() < 1e-12);
    }
}

#[test]
fn in_a_grid_springs_are_on_its_outer_sides() {
    let text = "[grid]\nbodies = [2, 2]\nelements = 4\nspring = { left = 1 }\n";
    let grid = Scene::parse("grid.toml", text).expect("a scene");
    assert!((against_translation(&grid, 0) - 1.0).abs() < 1e-13);
}

#[test]
fn springs_that_push_are_refused() {
    let pushing = scene("", "size = [2, 1]\nspring = { right = \"y - 0.5\" }\n");
    let refused = (0..pushing.n_subdomains()).find_map(|s| pushing.subdomain(s).err());
    let message = refused.expect("it is refused").to_string();
    for part in ["springs.toml:1", "`a`", "spring -", "at least 0"] {
        assert!(message.contains(part), "{message}");
    }
    let text = "[[body]]\nsize = 1\nelements = 2\nspring = { middle = 1 }\n";
    let message = Scene::parse("x.toml", text)
        .expect_err("no such side")
        .to_string();
    assert!(
        message.contains("x.toml:4") && message.contains("middle"),
        "{message}"
    );
}
