//! Load steps: factors of loads, gaps and prescribed values.

use crate::support::mpi::Scratch;
use scene::{Scene, SteppedMesh, Stepping};

const SCENE: &str = "
[[body]]
name = \"a\"
size = [1, 1]
elements = [8, 4]
subdomains = [2, 2]
rho = \"1 + x\"
load = \"1 + x*y\"
dirichlet = { left = \"0.3 + y\" }
[[body]]
name = \"b\"
origin = [1, 0]
size = [1, 1]
elements = 4
load = 2
ramp = \"t^2\"
dirichlet = { right = 1, bottom = 1 }
[[contact]]
bodies = [\"a\", \"b\"]
gap = 0.5
[[obstacle]]
body = \"a\"
side = \"top\"
above = \"7 + x\"
ramp = \"1 - t\"
";

fn scene(steps: &str) -> Scene {
    Scene::parse("s.toml", &format!("{SCENE}{steps}")).unwrap()
}

/// The scene without steps, with data that are already scaled.
fn scaled(load: f64, ramp: f64, given: f64) -> Scene {
    let text = SCENE
        .replace("ramp = \"t^2\"\n", "")
        .replace("ramp = \"1 - t\"\n", "")
        .replace(
            "load = \"1 + x*y\"",
            &format!("load = \"(1 + x*y)*{load}\""),
        )
        .replace("load = 2", &format!("load = \"2*{ramp}\""))
        .replace("0.3 + y", &format!("(0.3 + y)*{given}"))
        .replace(
            "right = 1, bottom = 1",
            &format!("right = {given}, bottom = {given}"),
        );
    Scene::parse("t.toml", &text).unwrap()
}

const STEPS: &str =
    "[steps]\ntimes = [0.25, 0.5, 0.75]\nload = \"2*t\"\ndirichlet = \"t\"\ngap = \"1 + t\"\n";

#[test]
fn loads_are_those_of_a_scene_with_scaled_data() {
    let scene = scene(STEPS);
    assert_eq!(scene.steps.as_ref().unwrap().times, [0.25, 0.5, 0.75]);
    assert_eq!((scene.n_steps(), scene.plan().steps), (3, Some(3)));
    for (step, t) in [0.25, 0.5, 0.75].into_iter().enumerate() {
        assert_eq!(scene.prescribed_factor(step), t);
        let other = scaled(2.0 * t, t * t, t);
        for s in 0..scene.n_subdomains() {
            let (ours, theirs) = (scene.loads(s, step).unwrap(), other.subdomain(s).unwrap().f);
            assert_eq!(ours.len(), theirs.len());
            for (a, b) in ours.iter().zip(&theirs) {
                assert!((a - b).abs() < 1e-14, "{a} {b}");
            }
        }
    }
}

#[test]
fn the_last_step_is_that_of_the_subdomains_to_the_bit() {
    let names = [
        "press_ramp",
        "model_contact",
        "unequal_bodies",
        "exact_sine",
    ];
    let files = names.map(|n| Scene::load(format!("../../examples/scenes/{n}.toml")).unwrap());
    for scene in files.into_iter().chain([scene(STEPS)]) {
        let last = scene.n_steps() - 1;
        for index in 0..scene.n_subdomains() {
            let s = scene.subdomain(index).unwrap();
            let bits = |f: &[f64]| f.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&scene.loads(index, last).unwrap()), bits(&s.f));
            let mesh = scene.subdomain_mesh(index).unwrap();
            let body = &scene.bodies[s.body];
            let nodes = body.mesh().subdomain_nodes(index - body.first_subdomain);
            for (k, &dof) in mesh.dof.iter().enumerate() {
                let given = body.prescribed_at(nodes[k]);
                assert_eq!(given.is_some(), dof == u32::MAX);
                let scaled = given.unwrap_or(0.0) * scene.prescribed_factor(last);
                assert_eq!(mesh.prescribed[k], scaled);
            }
        }
        let rows = scene.solver_rows(&|_| true);
        let gaps: Vec<f64> = rows.iter().map(|r| r.gap).collect();
        assert_eq!(gaps, scene.gaps(&|_| true, last).unwrap());
    }
}

/// A mesh that follows the load steps is that of a scene with scaled data, also where the last factor is zero.
#[test]
fn meshes_follow_given_values() {
    let steps = "[steps]\ntimes = [0.25, 0.5, 1]\ndirichlet = \"1 - t\"\n";
    let scene = scene(steps);
    for index in 0..scene.n_subdomains() {
        let mut mesh = SteppedMesh::new(&scene, index).unwrap();
        // Forwards and back: a step leaves nothing behind for the next one.
        for step in [0, 1, 2, 0] {
            let factor = scene.prescribed_factor(step);
            assert_eq!(factor, [0.75, 0.5, 0.0][step]);
            let expected = scaled(1.0, 1.0, factor).subdomain_mesh(index).unwrap();
            let mesh = mesh.at(&scene, step);
            assert_eq!(mesh.dof, expected.dof);
            for (found, wanted) in mesh.prescribed.iter().zip(&expected.prescribed) {
                assert!((found - wanted).abs() < 1e-15, "{found} {wanted}");
            }
        }
    }
}

#[test]
fn gaps_follow_their_ramp_and_given_values() {
    let scene = scene(STEPS);
    let rows = scene.solver_rows(&|_| true);
    for (step, t) in [0.25, 0.5, 0.75].into_iter().enumerate() {
        let gaps = scene.gaps(&|_| true, step).unwrap();
        let (mut contacts, mut given, mut bounds) = (0, 0, 0);
        for (label, gap) in rows.iter().map(|r| r.label).zip(gaps) {
            let [x, y, _] = label.point;
            let expected = match label.members[1] {
                // The obstacle follows its own ramp; the contact follows the factor of all gaps.
                None => {
                    bounds += 1;
                    (7.0 + x) * (1.0 - t)
                }
                // u_a ≤ g + u_b, where b is given at its bottom.
                Some(_) if y == 0.0 => {
                    given += 1;
                    0.5 * (1.0 + t) + t
                }
                Some(_) => {
                    contacts += 1;
                    0.5 * (1.0 + t)
                }
            };
            assert!((gap - expected).abs() < 1e-14, "{gap} {expected}");
        }
        assert_eq!((contacts, given, bounds), (4, 1, 8));
    }
    let e = scene.gaps(&|_| true, 3).unwrap_err().to_string();
    assert_eq!(
        e,
        "load step 3 of a scene with 3 (a number below that was expected)"
    );
    assert!(scene.loads(0, 3).is_err());
}

#[test]
fn counted_steps_end_at_one() {
    // Without the obstacle, which would contradict the prescribed values.
    let text = SCENE.split("[[obstacle]]").next().unwrap();
    let scene = Scene::parse("s.toml", &format!("{text}[steps]\ncount = 4\n")).unwrap();
    assert_eq!(scene.steps.as_ref().unwrap().times, [0.25, 0.5, 0.75, 1.0]);
    // Factors default to 1: without a ramp of its own the load does not change.
    assert_eq!(scene.loads(0, 0).unwrap(), scene.loads(0, 3).unwrap());
    assert_ne!(scene.loads(4, 0).unwrap(), scene.loads(4, 3).unwrap());
    // Of overlapping bounds with different ramps the tighter one counts in every step.
    let two = "[[body]]\nname = \"a\"\nsize = 1\nelements = 2\n\
               [[body]]\nname = \"b\"\norigin = [1, 0]\nsize = 1\nelements = 2\n\
               [[contact]]\nbodies = [0, 1]\ngap = 1\nramp = \"t\"\n\
               [[contact]]\nbodies = [0, 1]\ngap = 1\nramp = \"1 - t\"\n\
               [steps]\ntimes = [0.25, 0.5, 0.875]\n";
    let scene = Scene::parse("two.toml", two).unwrap();
    let gaps: Vec<f64> = (0..3)
        .map(|k| scene.gaps(&|_| true, k).unwrap()[0])
        .collect();
    assert_eq!(gaps, [0.25, 0.5, 0.125]);
}

#[test]
fn a_load_step_does_not_rebuild_meshes() {
    let scratch = Scratch::new("stepping");
    let values: Vec<u8> = (1..=16).flat_map(|v| f64::from(v).to_le_bytes()).collect();
    std::fs::write(scratch.path("rho.bin"), values).unwrap();
    let text = "[[body]]\nname = \"a\"\nsize = 1\nelements = 4\nsubdomains = 2\nload = 1\n\
                rho = { file = \"rho.bin\", type = \"f64\" }\ndirichlet = { left = 0.5 }\n\
                [steps]\ncount = 3\ndirichlet = \"t - 1/3\"\n";
    std::fs::write(scratch.path("s.toml"), text).unwrap();
    let scene = Scene::load(scratch.path("s.toml")).unwrap();
    let wanted: Vec<Vec<Vec<f64>>> = (0..3)
        .map(|step| (0..4).map(|s| scene.loads(s, step).unwrap()).collect())
        .collect();
    let mut stepping = Stepping::new(&scene, 0..4).unwrap();
    std::fs::remove_file(scratch.path("rho.bin")).unwrap();
    // A mesh needs its coefficients; a load step does not.
    assert!(scene.subdomain_mesh(0).is_err());
    for step in [0, 2, 1, 0] {
        assert_eq!(stepping.loads(&scene, step).unwrap(), wanted[step]);
    }
    assert_ne!(wanted[0], wanted[2]);
}
