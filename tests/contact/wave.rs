//! A wave spring: rings that touch at their crests alone, float, and are held sideways by slopes alone.

use crate::support::assembled::Assembled;
use crate::support::checks::near;
use crate::support::mpi::{command, Scratch};
use crate::support::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::{FetiFeti, Solution};
use scene::Scene;

/// The scene that `scripts/wave_spring.py` writes.
fn scene(rings: usize, around: usize) -> Scene {
    let scratch = Scratch::new("wave");
    let out = scratch.path("");
    let (rings, around) = (rings.to_string(), around.to_string());
    let mut python = command("python3");
    python.args(["../../scripts/wave_spring.py", &rings, &around, &out]);
    let done = python.output().expect("python3 starts");
    assert!(done.status.success(), "{done:?}");
    Scene::load(scratch.path("wave_spring.toml")).expect("a good scene")
}

fn solve(scene: &Scene) -> Solution {
    let problem = scene.substructures(&|_| true).expect("a good scene");
    with_session(move |session| {
        let settings = MethodSettings::default().rtol(1e-8);
        let mut solver = FetiFeti::new(session, problem, settings).expect("the set-up works");
        solver.solve().expect("there is a solution")
    })
}

/// The loop comes to the energy of the assembled quadratic programme. It did not end with springs that are as stiff as
/// nodes.
#[test]
fn three_rings_have_the_energy_of_the_quadratic_programme() {
    let scene = scene(3, 24);
    let found = solve(&scene);
    println!(
        "{} steps, {} iterations",
        found.steps.len(),
        found.iterations
    );
    assert!(found.converged(), "{}", found.status);
    let (is, should) = (found.energy, Assembled::of_scene(&scene).solve().energy);
    assert!(near(is, should, 1e-6), "{is:e}, expected {should:e}");
}

/// Its solution has three rows at each crest and ten motions that nothing holds, some of which other sets hold by 1e-3
/// of a normal: without anchors the loop did not end. SMALBE, without Newton steps, comes to the same energy:
/// `fetifeti solve out/wave_spring.toml -fetifeti_contact_type smalbe` after `scripts/wave_spring.py 4 48 out`.
#[test]
fn four_rings_that_touch_at_their_crests_alone_have_the_energy_of_smalbe() {
    let found = solve(&scene(4, 48));
    println!("{} steps", found.steps.len());
    assert!(found.converged(), "{}", found.status);
    let (is, should) = (found.energy, 3.702812862232e-2);
    assert!(near(is, should, 1e-6), "{is:e}, expected {should:e}");
    assert!(found.steps.len() < 100);
}
