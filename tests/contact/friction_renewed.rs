//! Friction where contacts are renewed at each load step (`[steps] update`).

use crate::support::checks::number;
use crate::support::session::with_session;
use crate::support::{mpi, program};
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use mpi::Scratch;
use petsc::Session;
use program::run_fetifeti;
use scene::{Scene, Stepper};
use serde_json::Value;

/// A block on a plane under a load that grows, falls and grows again.
fn cycle(law: &str, update: bool) -> String {
    format!(
        "physics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = [2, 1]\nelements = [16, 8]\nsubdomains = [2, 1]\n\
         young = 1\npoisson = 0.3\ntraction = {{ top = [0.024, -0.1] }}\n[[obstacle]]\nbody = \"block\"\n\
         side = \"bottom\"\nplane = {{ point = [0, 0], normal = [0, 1] }}\nfriction = 0.3\n{law}\n[steps]\n\
         times = [0.25, 0.5, 0.75, 1.0]\nload = \"if(t<=0.5, 2*t, 1.6-1.2*t)\"\nupdate = {update}\n"
    )
}

fn stepper(session: &Session, text: &str) -> Stepper {
    let scene = Scene::parse("renewed.toml", text).expect("a scene");
    let problem = scene.substructures(&|_| true).expect("a problem");
    let solver = FetiFeti::new(session, problem, MethodSettings::default().rtol(1e-10));
    Stepper::with_solver(scene, solver.expect("a set-up")).expect("a stepper")
}

/// On a plane nothing changes: nodes touch it wherever they are. What has slid and what sticks elastically go along.
#[test]
fn a_plane_has_the_same_answers_with_renewed_contacts() {
    with_session(|session| {
        for law in [
            "",
            "stick_stiffness = 2",
            "stiffness = 5\nstick_stiffness = 1",
        ] {
            let of = |update| {
                let steps = stepper(session, &cycle(law, update));
                let steps = steps.map(|s| s.expect("a step").solution);
                let steps = steps.inspect(|s| assert!(s.converged(), "{law}: {}", s.status));
                let both = steps.map(|s| {
                    let forces = s.tangential_rows().iter().map(|r| r.multiplier);
                    (s.u.concat(), forces.collect::<Vec<f64>>())
                });
                both.collect::<Vec<_>>()
            };
            let (still, renewed) = (of(false), of(true));
            assert_eq!(still.len(), 4);
            for ((u, forces), (v, others)) in still.iter().zip(&renewed) {
                let apart = |a: &[f64], b: &[f64]| {
                    let pairs = a.iter().zip(b);
                    pairs.fold(0.0f64, |m, (a, b)| m.max((a - b).abs()))
                };
                let size = |a: &[f64]| a.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                assert_eq!(forces.len(), others.len());
                assert!(apart(u, v) < 1e-6 * size(u), "{law}: {}", apart(u, v));
                let off = apart(forces, others);
                assert!(off < 1e-6 * size(forces), "{law}: {off}");
            }
        }
    });
}

/// A slider that is drawn along a bed over sixteen elements in eight steps: its friction is μ N in each of them, and
/// what it dissipates is μ N times its way. Ranks and checkpoints do not matter.
#[test]
fn a_slider_has_the_friction_of_its_weight_wherever_it_is() {
    let text = "physics = \"elasticity\"\n[[body]]\nname = \"bed\"\nsize = [6, 1]\nelements = [30, 5]\nyoung = 100\n\
                poisson = 0.3\ndirichlet = { bottom = 0 }\n[[body]]\nname = \"slider\"\norigin = [0.5, 1]\nsize = 1\n\
                elements = 6\nyoung = 100\npoisson = 0.3\ntraction = { top = [0, -0.1] }\n\
                dirichlet = { top = { x = 3.2 } }\n[[contact]]\nbodies = [\"slider\", \"bed\"]\nfriction = 0.3\n\
                [steps]\ntimes = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1]\ndirichlet = \"t\"\nupdate = true\n";
    let scratch = Scratch::new("friction-renewed");
    let scene = scratch.file("slider.toml", text);
    for ranks in [1, 2] {
        let out = run_fetifeti(ranks, &["solve", &scene, "--json", "-"]);
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
        let report: Value = serde_json::from_str(&out.stdout).expect("JSON");
        let steps = report["contact"]["load_steps"].as_array().expect("a list");
        assert_eq!(steps.len(), 8);
        for step in steps {
            let force = number(&step["friction"][0]).abs();
            assert!((force - 0.03).abs() < 1e-6, "{force}");
            // The slider leans back in the first step, by 1 % of its way.
            let work = number(&step["dissipated"]);
            assert!((work - 0.03 * 0.4).abs() < 0.015 * 0.012, "{work}");
        }
    }
    with_session(move |session| {
        let steps = stepper(session, text).map(|s| s.expect("a step").energy.to_bits());
        let energies: Vec<u64> = steps.collect();
        let mut first = stepper(session, text);
        (0..3).for_each(|_| drop(first.next()));
        let state = first.checkpoint().expect("a checkpoint");
        let resumed = stepper(session, text).resume(state.as_ref());
        let resumed = resumed
            .expect("a state")
            .map(|s| s.expect("a step").energy.to_bits());
        assert_eq!(resumed.collect::<Vec<u64>>(), energies[3..]);
    });
}
