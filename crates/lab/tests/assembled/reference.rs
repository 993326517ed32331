//! Unit tests of `crates/lab/src/assembled/reference.rs`.

use super::*;
use crate::testing::with_session;

/// A column of two squares with these keys, the upper one on the lower one.
fn column(lower: &str, upper: &str) -> Scene {
    let body = |name: &str, y: f64, keys: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [0, {y}]\n\
                 size = [1, 1]\nelements = 4\nsubdomains = [2, 1]\n{keys}\n"
        )
    };
    let contact = "[[contact]]\nbodies = [\"lower\", \"upper\"]\n";
    let text = body("lower", 0.0, lower) + &body("upper", 1.0, upper) + contact;
    Scene::parse("column.toml", &text).expect("a scene")
}

fn subdomains(scene: &Scene) -> Vec<Subdomain> {
    let all = 0..scene.n_subdomains();
    all.map(|s| scene.subdomain(s).expect("a subdomain"))
        .collect()
}

#[test]
fn a_pressed_column_has_the_solution_of_the_bar() {
    with_session(|session| {
        let scene = column("dirichlet = [\"bottom\"]", "load = -1");
        let layout = UnknownLayout::new(&scene);
        let parts = subdomains(&scene);
        let direct = Reference::certified(session, &scene, &layout).expect("a solution");
        let found = &direct.found;
        assert!(
            found.certificate.largest() < 1e-14,
            "{:?}",
            found.certificate
        );
        assert!(found.active.iter().all(|on| *on) && found.active.len() == 5);
        assert!((found.lambda.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        // −u'' = −1 in the upper square, 0 in the lower one; nodal values are exact.
        let u = |y: f64| {
            if y > 1.0 {
                -1.0 + ((y - 2.0).powi(2) - 1.0) / 2.0
            } else {
                -y
            }
        };
        let exact = |s: &Subdomain| -> Vec<f64> {
            let first = scene.bodies[s.body].first_dof;
            let node = |&dof: &u64| (dof - first) as usize;
            let y = |dof: &u64| scene.bodies[s.body].spec.position(node(dof))[1];
            s.dofs.iter().map(|dof| u(y(dof))).collect()
        };
        let exact: Vec<Vec<f64>> = parts.iter().map(exact).collect();
        for copies in [Copies::Alike, Copies::ByCoefficient] {
            let away = direct.distance(&parts, &exact, copies).expect("a distance");
            assert!(away.iter().all(|d| *d < 1e-15), "{away:?}");
        }
        // A solution that is larger by one percent has a distance of one percent.
        let more: Vec<Vec<f64>> = exact
            .iter()
            .map(|u| u.iter().map(|u| 1.01 * u).collect())
            .collect();
        let away = direct
            .distance(&parts, &more, Copies::Alike)
            .expect("a distance");
        assert!(away.iter().all(|d| (d - 0.01).abs() < 1e-14), "{away:?}");
        let working = Reference::new(session, &scene, &layout, ResidualPrecision::Working, None);
        let working = working.expect("a solution");
        assert_eq!(working.found.active, found.active);
        let values = working.values(&parts).expect("values");
        let away = direct
            .distance(&parts, &values, Copies::Alike)
            .expect("a distance");
        assert!(away.iter().all(|d| *d < 1e-13), "{away:?}");
    });
}

#[test]
fn what_nothing_holds_has_no_solution_and_springs_hold() {
    with_session(|session| {
        let ends = |upper: &str| {
            let scene = column("dirichlet = [\"bottom\"]", upper);
            let layout = UnknownLayout::new(&scene);
            let found = Reference::certified(session, &scene, &layout);
            found.map(|r| r.found.active.iter().filter(|on| **on).count())
        };
        assert!(ends("load = 1").is_err_and(|e| e.is_not_converged()));
        assert_eq!(ends("load = 1\nspring = { top = 1e-8 }").ok(), Some(0));
        let alone = |load: &str| {
            let body = "[[body]]\nname = \"one\"\norigin = [0, 0]\nsize = [1, 1]\nelements = 4\nsubdomains = [2, 1]\n";
            let scene = Scene::parse("one.toml", &format!("{body}load = \"{load}\"\n"));
            let scene = scene.expect("a scene");
            let layout = UnknownLayout::new(&scene);
            Reference::certified(session, &scene, &layout).map(|_| ())
        };
        assert!(alone("x").is_err_and(|e| e.is_not_converged()));
        assert!(alone("x - 0.5").is_ok());
    });
}

#[test]
fn a_motion_without_energy_is_no_error() {
    with_session(|session| {
        // The round obstacle touches without force, and nothing else holds the block sideways.
        let text = "dimension = 2\nphysics = \"elasticity\"\n[[body]]\nname = \"one\"\norigin = [0, 0]\nsize = [1, 1]\n\
                    elements = 4\nsubdomains = [2, 1]\nyoung = 1e5\npoisson = 0.3\nload = [0, -1]\n\
                    dirichlet = { bottom = { y = 0 } }\n[[obstacle]]\nbody = \"one\"\nside = \"bottom\"\n\
                    cylinder = { centre = [0, -5.1], radius = 5 }\n";
        let scene = Scene::parse("one.toml", text).expect("a scene");
        let layout = UnknownLayout::new(&scene);
        assert_eq!(layout.loose(), 0);
        let parts = subdomains(&scene);
        let direct = Reference::certified(session, &scene, &layout).expect("a solution");
        let mut moved = direct.values(&parts).expect("values");
        for (s, u) in parts.iter().zip(&mut moved) {
            let x = s.dofs.iter().zip(u).filter(|(dof, _)| **dof % 2 == 0);
            x.for_each(|(_, u)| *u += 0.3);
        }
        let away = direct
            .distance(&parts, &moved, Copies::Alike)
            .expect("a distance");
        assert!(away[0] < 1e-11, "{away:?}");
    });
}
