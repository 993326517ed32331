//! Bodies whose stiffness differs by many powers of ten.

use crate::support::session::with_session;
use fetifeti::feti::MethodSettings;
use fetifeti::scene::Scene;
use fetifeti::{FetiFeti, Solution};

fn solve(text: &str) -> Solution {
    let scene = Scene::parse("scene.toml", text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let problem = scene.substructures(&|_| true).expect("substructures");
    let solution = with_session(move |session| {
        let settings = MethodSettings {
            rtol: 1e-8,
            ..MethodSettings::default()
        };
        let solver = FetiFeti::new(session, problem, settings).expect("set up");
        solver.solve().expect("a solution")
    });
    assert!(solution.converged(), "{:?}\n{text}", solution.status);
    solution
}

/// A stiff plate that only a soft one holds. As it is rigid beside it, its mesh plays no part.
#[test]
fn a_stiff_body_floats_beside_a_soft_one() {
    let plates = |stiff: f64, n: usize| {
        format!(
            "physics = \"elasticity\"\n[[body]]\nname = \"soft\"\nsize = [1, 1]\nelements = [4, 4]\n\
             subdomains = [2, 2]\nyoung = 1\ndirichlet = [\"left\"]\n\
             [[body]]\nname = \"stiff\"\norigin = [1, 0]\nsize = [1, 1]\nelements = [{n}, {n}]\n\
             subdomains = [2, 2]\nyoung = {stiff:e}\ntraction = {{ right = [0.1, 0.05] }}\n"
        )
    };
    // With nodes that match, and with others.
    let energy = |stiff: f64, n: usize| solve(&plates(stiff, n)).energy;
    let rigid = energy(1e12, 4);
    // What a plate of 10⁶ strains is a part of 10⁻⁶.
    let strained = energy(1e6, 4);
    assert!((strained / rigid - 1.0).abs() < 1e-6, "{strained} {rigid}");
    assert!(strained != rigid);
    for other in [energy(1e12, 6), energy(1e10, 6)] {
        assert!((other / rigid - 1.0).abs() < 1e-8, "{other} {rigid}");
    }
}
