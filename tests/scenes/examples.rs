//! The example scenes agree with their comments.

use scene::{Numbering, Scene};
use std::collections::HashSet;
use std::time::Instant;

fn load(name: &str) -> Scene {
    Scene::load(format!("../../examples/scenes/{name}.toml")).unwrap()
}

#[test]
fn every_example_is_valid_and_says_what_it_shows() {
    let mut seen = 0;
    for entry in std::fs::read_dir("../../examples/scenes").unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("# "), "{path:?}");
        let scene = Scene::load(&path).unwrap();
        assert!(!scene.title.is_empty());
        assert!(scene.notes.is_empty(), "{path:?}: {:?}", scene.notes);
        scene.check_values().unwrap();
        seen += 1;
    }
    assert!(seen >= 12, "{seen}");
}

#[test]
fn special_cases_are_special() {
    let plan = load("one_body").plan();
    assert_eq!((plan.bodies.len(), plan.global_multipliers), (1, 0));
    assert_eq!(plan.local_multipliers, 2 * 5 * 6 * 7);
    let plan = load("one_subdomain").plan();
    assert_eq!((plan.primal, plan.local_multipliers), (0, 0));
    assert_eq!(plan.subdomains, 16);
    let plan = load("partly_tied").plan();
    let tied: Vec<usize> = plan.interfaces.iter().map(|i| i.tied).collect();
    assert_eq!(tied, [9, 3]);
    let plan = load("model_tied").plan();
    assert_eq!(plan.global_multipliers, 33);
    assert_eq!(plan.dofs, 2 * 33 * 33 - 33);
}

#[test]
fn the_lee_examples_are_rows_of_table_1() {
    use scene::Faces;
    for (name, faces) in [
        ("lee_column_1", Faces::Whole),
        ("lee_column_2", Faces::MiddleThird),
    ] {
        let (file, built) = (load(name), Scene::lee(4, 4, 4, faces).unwrap());
        assert_eq!(file.points, built.points);
        for s in 0..file.n_subdomains() {
            let (a, b) = (file.subdomain(s).unwrap(), built.subdomain(s).unwrap());
            assert_eq!((a.k, a.f, a.dofs), (b.k, b.f, b.dofs));
        }
    }
    // The load of (3.3) integrates to −3/8 − 1/8.
    let scene = load("lee_column_1");
    let mut copies: f64 = 0.0;
    for s in 0..scene.n_subdomains() {
        let mut mesh = scene.subdomain_mesh(s).unwrap();
        // Without Dirichlet nodes the whole load remains.
        for (k, d) in mesh.dof.iter_mut().enumerate() {
            *d = k as u32;
        }
        let f = scene.subdomain(s).unwrap().f;
        assert!(f.len() <= mesh.dof.len());
        copies += f.iter().sum::<f64>();
    }
    // Free nodes get the load minus the share of the boundary: h/2 along its loaded parts, less at corners.
    let h: f64 = 1.0 / 64.0;
    let lost = 3.0 * (0.75 * h / 2.0 - h * h / 4.0) + (0.75 * h / 2.0 - h * h / 4.0);
    assert!((copies + 0.5 - lost).abs() < 1e-12, "{copies}");
}

#[test]
fn checkerboards_alternate_by_body() {
    let scene = load("jump_1e6");
    for s in 0..scene.n_subdomains() {
        let (body, _) = scene.body_of(s);
        let expected = if (body % 4 + body / 4) % 2 == 0 {
            1e-6
        } else {
            1e6
        };
        let s = scene.subdomain(s).unwrap();
        assert!(s.rho.iter().all(|&r| r == expected));
    }
}

#[test]
fn options_are_handed_on_without_their_dash() {
    let text = "[options]\nfetifeti_ksp_rtol = 1e-8\n-fetifeti_ksp_type = \"fcg\"\nfetifeti_check = true\n\
                [grid]\nbodies = 1\nelements = 2\n";
    let scene = Scene::parse("o.toml", text).unwrap();
    let pairs: Vec<(&str, &str)> = scene
        .options
        .iter()
        .map(|(k, v)| (k.as_str(), v.as_str()))
        .collect();
    assert_eq!(
        pairs,
        [
            ("fetifeti_ksp_rtol", "1e-8"),
            ("fetifeti_ksp_type", "fcg"),
            ("fetifeti_check", "true"),
        ]
    );
    assert_eq!(scene.title, "o");
}

#[test]
fn equal_subdomains_have_equal_matrices_to_the_bit() {
    let scene = Scene::load("../../examples/scenes/poisson_2x2.toml").unwrap();
    let inner: HashSet<Vec<u64>> = (0..scene.n_subdomains())
        .map(|s| scene.subdomain(s).unwrap())
        .filter(|s| s.k.n() == 8 * 8)
        .map(|s| s.k.val.iter().map(|v| v.to_bits()).collect())
        .collect();
    // Four corner subdomains, held on two sides in four different ways.
    assert_eq!(inner.len(), 4);
    let floating: HashSet<Vec<u64>> = (0..scene.n_subdomains())
        .map(|s| scene.subdomain(s).unwrap())
        .filter(|s| s.k.n() == 9 * 9)
        .map(|s| s.k.val.iter().map(|v| v.to_bits()).collect())
        .collect();
    assert_eq!(floating.len(), 1);
}

#[test]
fn a_million_unknowns_are_assembled() {
    let start = Instant::now();
    let scene = load("speed_1024");
    let read = start.elapsed().as_secs_f64();
    let start = Instant::now();
    // One core, as a rank among many would have.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let problem = pool.install(|| scene.substructures(&|_| true)).unwrap();
    let assembled = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let numbering = Numbering::new(&scene);
    let numbered = start.elapsed().as_secs_f64();
    eprintln!("read {read:.3} s, assemble {assembled:.3} s, number {numbered:.3} s");
    assert_eq!(numbering.len(), 1023 * 1023);
    assert_eq!(problem.local.len(), 256);
}
