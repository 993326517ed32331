//! Unit tests of `crates/lab/src/baselines/bench/cases.rs`.

use super::*;
use crate::baselines::launch::Workspace;
use scene::{Numbering, Scene};

fn load(name: &str, quick: bool) -> Scene {
    let home = Workspace::new().expect("a directory");
    let named = NamedScene::find(name).expect("a name");
    let (file, _) = named.write(home.dir(), quick).expect("files");
    Scene::load(&file).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn cases_have_the_size_that_they_are_named_after() {
    let dofs = |name, quick| Numbering::new(&load(name, quick)).len();
    assert_eq!(dofs("poisson-1024", false), 1023 * 1023);
    assert_eq!(dofs("poisson-1024", true), 127 * 127);
    assert_eq!(dofs("poisson-1024-random", true), 127 * 127);
    assert_eq!(dofs("contact-512", false), 512 * 513 + 513 * 513);
    assert_eq!(dofs("cube-24", false), 3 * 25 * 24 * 25);
    assert_eq!(dofs("cube-40", false), 3 * 41 * 40 * 41);
    assert_eq!(dofs("cube-24", true), 3 * 13 * 12 * 13);
    assert_eq!(
        dofs("bodies-contact-512", true),
        27 * 375 - 9 * 75 - 4 * (6 * 25 + 3 * 20)
    );
    // Large meshes, a million random values and 4,096 bodies take seconds each.
    let dear = |c: &&NamedScene| {
        c.mesh.is_some() || c.name.ends_with("random") || c.name.ends_with("4096")
    };
    for quick in [false, true] {
        for case in CASES.iter().filter(|c| quick || !dear(c)) {
            let scene = load(case.name, quick);
            assert_eq!(
                scene.has_contact(),
                case.name.contains("contact"),
                "{}",
                case.name
            );
            let alone = ["holes", "plate"].contains(&case.name);
            assert_eq!(scene.n_bodies() == 1, alone, "{}", case.name);
            let whole = case.name.starts_with("bodies");
            let cut = scene.n_subdomains() > scene.n_bodies();
            assert_eq!(cut, !whole, "{}", case.name);
        }
    }
    for (name, about) in [
        ("holes", 18e3),
        ("plate", 18e3),
        ("rod-4", 22e3),
        ("rod-10", 25e3),
        ("blocks-contact-4", 20e3),
        ("blocks-contact-4-mortar", 20e3),
    ] {
        let n = dofs(name, true) as f64;
        assert!((0.7..1.4).contains(&(n / about)), "{name}: {n} unknowns");
    }
    for (name, mortar) in [
        ("blocks-contact-4", false),
        ("blocks-contact-4-mortar", true),
    ] {
        assert_eq!(
            load(name, true).mortar_rows().next().is_some(),
            mortar,
            "{name}"
        );
    }
}

#[test]
fn the_large_square_is_that_of_the_examples() {
    let example = Scene::load("../../examples/scenes/speed_1024.toml").expect("a scene");
    let scene = load("poisson-1024", false);
    let sizes = |s: &Scene| (s.n_bodies(), s.n_subdomains(), Numbering::new(s).len());
    assert_eq!(sizes(&scene), sizes(&example));
    let [a, b] = [&scene, &example].map(|s| s.subdomain(17).expect("a subdomain"));
    assert_eq!(a.k, b.k);
}

#[test]
fn in_the_random_case_no_two_subdomains_are_equal() {
    let scene = load("poisson-1024-random", true);
    scene
        .check_values()
        .expect("elements that are not turned over");
    let all: Vec<_> = (0..scene.n_subdomains())
        .map(|s| scene.subdomain(s).expect("a subdomain"))
        .collect();
    for (a, one) in all.iter().enumerate() {
        for other in &all[..a] {
            assert_ne!(one.k.val, other.k.val);
        }
        let (low, high) = one
            .rho
            .iter()
            .fold((f64::MAX, 0.0_f64), |r, &x| (r.0.min(x), r.1.max(x)));
        assert!(
            low > 0.09 && high < 10.1 && high / low > 3.0,
            "{low} {high}"
        );
    }
}
