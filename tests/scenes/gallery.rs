//! The gallery: models with meshes of Gmsh are solved, tied ones to the direct solution.

use crate::support::checks::identities;
use crate::support::session::with_session;
use crate::support::solid::assembled;
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use scene::Scene;

fn load(name: &str) -> Scene {
    Scene::load(format!("../../examples/gallery/{name}.toml")).unwrap()
}

/// Every file of the gallery is read, with its mesh.
#[test]
fn every_model_is_read() {
    let mut names = Vec::new();
    for entry in std::fs::read_dir("../../examples/gallery").unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let scene = Scene::load(&path).unwrap_or_else(|e| panic!("{e}"));
            assert!(
                scene.bodies.iter().all(|b| b.mesh().cells().is_some()),
                "{}",
                path.display()
            );
            names.push(path);
        }
    }
    assert!(names.len() >= 5, "{names:?}");
}

/// Contact of a pin in a lug: converged, with the whole load in the contact.
#[test]
fn the_pin_bears_the_lug() {
    let scene = load("pin_lug");
    assert!(scene.has_contact());
    let problem = scene.substructures(&|_| true).unwrap();
    with_session(move |session| {
        let settings = MethodSettings::default().rtol(1e-9);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        identities(&solver, 1e-8, "pin_lug");
        let solution = solver.solve().expect("solved");
        assert!(solution.converged(), "{}", solution.status);
        let pulling = solution
            .rows()
            .iter()
            .filter(|r| r.is_inequality() && r.multiplier < -1e-6);
        assert_eq!(pulling.count(), 0);
    });
}

/// The stem of a hip is tied to the bone: two materials, tetrahedra of second order.
#[test]
fn the_tied_model_has_the_direct_solution() {
    let scene = load("hip_stem");
    assert!(!scene.has_contact());
    let problem = scene.substructures(&|_| true).unwrap();
    let direct = assembled::solve(&problem);
    let local = problem.local.clone();
    let u = with_session(move |session| {
        let settings = MethodSettings::default().rtol(1e-11);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        let solution = solver.solve().expect("solved");
        assert!(solution.converged(), "{}", solution.status);
        solution.u
    });
    let square = |u: &dyn Fn(usize, usize) -> f64| -> f64 {
        let each = local.iter().enumerate().map(|(s, sub)| {
            let v: Vec<f64> = (0..sub.f.len()).map(|i| u(s, i)).collect();
            let mut kv = vec![0.0; v.len()];
            sub.k.mul(&v, &mut kv);
            kv.iter().zip(&v).map(|(a, b)| a * b).sum::<f64>()
        });
        each.sum()
    };
    let away = square(&|s, i| u[s][i] - direct[s][i]) / square(&|s, i| direct[s][i]);
    assert!(away.sqrt() < 1e-8, "{:e}", away.sqrt());
}
