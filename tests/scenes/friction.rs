//! Friction in scenes: its keys, the rows that they make, and sentences on bad input.

use crate::support::session::with_session;
use fetifeti::problem::{FrictionBound, Law};
use fetifeti::settings::{MethodSettings, Operators};
use fetifeti::FetiFeti;
use scene::Scene;

/// A block on a plane, with further lines of the obstacle.
fn block(friction: &str) -> String {
    format!(
        "physics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = 2\nelements = 4\nyoung = 1\npoisson = 0\n\
         load = [0, -1]\n[[obstacle]]\nbody = \"block\"\nside = \"bottom\"\n\
         plane = {{ point = [0, 0], normal = [0, 1] }}\n{friction}\n"
    )
}

#[track_caller]
fn refused(text: &str, expected: &str) {
    match Scene::parse("s.toml", text) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(e) => {
            assert!(e.is_input(), "{e}");
            assert_eq!(e.to_string(), expected);
        }
    }
}

#[test]
fn bad_friction_is_named() {
    refused(
        &block("friction = -0.1"),
        "s.toml:13: -0.1 where a number that is not negative was expected",
    );
    refused(
        &block("friction_limit = 1"),
        "s.toml:13: `friction_limit` without `friction`, which it limits",
    );
    refused(
        &block("friction = 0.1\ntresca = 1"),
        "s.toml:14: `tresca` beside `friction` where one was expected (a bound that does not depend on the pressure, \
         or one that does)",
    );
    refused(
        &block("friction = \"x - 1\""),
        "s.toml:9: `friction` is -1 at (0, 0) of body `block`, expected a number that is not negative",
    );
    refused(
        &block("stiffness = 0"),
        "s.toml:13: 0 where a positive number was expected",
    );
    refused(
        &block("stick_stiffness = 1"),
        "s.toml:13: `stick_stiffness` without `friction` or `tresca`",
    );
    refused(
        &block("stiffness = \"2*x\""),
        "s.toml:9: `stiffness` is 0 at (0, 0) of body `block`, expected a positive number",
    );
    let scalar = "[[body]]\nname = \"a\"\nsize = 1\nelements = 2\n[[obstacle]]\nbody = \"a\"\nside = \"bottom\"\n\
                  below = 0\nfriction = 1\n";
    refused(
        scalar,
        "s.toml:9: friction in a scene with one unknown at a node, where physics = \"elasticity\" was expected",
    );
    // Contacts that are found have the same keys.
    let auto = |physics: &str, law: &str| {
        format!(
            "{physics}[[body]]\nname = \"a\"\nsize = 1\nelements = 2\n[[body]]\nname = \"b\"\norigin = [1, 0]\n\
             size = 1\nelements = 2\n[contact]\nauto = true\n{law}\n"
        )
    };
    let solid = "physics = \"elasticity\"\n";
    refused(
        &auto(solid, "friction = -0.1"),
        "s.toml:13: -0.1 where a number that is not negative was expected",
    );
    refused(
        &auto(solid, "friction_limit = 1"),
        "s.toml:13: `friction_limit` without `friction`, which it limits",
    );
    refused(
        &auto(solid, "tresca = 1\nfriction = 0.2"),
        "s.toml:13: `tresca` beside `friction` where one was expected (a bound that does not depend on the pressure, \
         or one that does)",
    );
    refused(
        &auto(solid, "stiffness = 0"),
        "s.toml:13: 0 where a positive number was expected",
    );
    refused(
        &auto(solid, "stick_stiffness = 1"),
        "s.toml:13: `stick_stiffness` without `friction` or `tresca`",
    );
    refused(
        &auto("", "friction = 1"),
        "s.toml:12: friction in a scene with one unknown at a node, where physics = \"elasticity\" was expected",
    );
    let tied = "physics = \"elasticity\"\n[[body]]\nname = \"a\"\nsize = 1\nelements = 2\nyoung = 1\npoisson = 0\n\
                [[body]]\nname = \"b\"\norigin = [1, 0]\nsize = 1\nelements = 2\nyoung = 1\npoisson = 0\n[[tie]]\n\
                bodies = \"all\"\nfriction = 1\n";
    let text = Scene::parse("s.toml", tied)
        .map(|_| ())
        .expect_err("no")
        .to_string();
    assert!(
        text.contains("s.toml:17: unknown key `friction` in [[tie]]"),
        "{text}"
    );
}

/// Where the values of a block in space are given along one direction there is friction along the other. If they slide
/// there, they would be half a slip.
#[test]
fn friction_beside_given_values_is_along_the_other_direction() {
    let block = |given: &str| {
        format!(
            "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = 2\nelements = 1\nyoung = 1\n\
             poisson = 0\ndirichlet = {{ bottom = {{ y = {given} }} }}\nload = [0, 0, -1]\n[[obstacle]]\n\
             body = \"block\"\nside = \"bottom\"\nplane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}\nfriction = 0.5\n"
        )
    };
    let scene = Scene::parse("s.toml", &block("0")).expect("a scene");
    let nodes = scene.friction_nodes(&|_| true);
    assert_eq!(nodes.len(), 4);
    let rows = scene.solver_rows(&|_| true);
    for node in nodes {
        let [t] = node.tangential[..] else {
            panic!("{node:?}");
        };
        assert_eq!(rows[t].label.normal.map(f64::abs), [1.0, 0.0, 0.0]);
    }
    let text = Scene::parse("s.toml", &block("0.25")).map(|_| ());
    let text = text.expect_err("a slip that is given").to_string();
    assert!(
        text.starts_with("s.toml:11: friction of the obstacle of s.toml")
            && text.ends_with("free along the other, expected both given or both free"),
        "{text}"
    );
}

/// Tangential rows come after all others, in the blocks of their normal rows, and the bounds are forces.
#[test]
fn nodes_with_friction_have_tangential_rows() {
    let scene = Scene::parse(
        "s.toml",
        &block("friction = \"0.25*x\"\nfriction_limit = 8"),
    )
    .expect("a scene");
    let rows = scene.solver_rows(&|_| true);
    let nodes = scene.friction_nodes(&|_| true);
    assert_eq!((rows.len(), nodes.len(), scene.rows.len()), (10, 5, 5));
    for (k, node) in nodes.iter().enumerate() {
        assert_eq!((node.normal, &node.tangential[..]), (k, &[5 + k][..]));
        let (normal, tangential) = (&rows[k], &rows[5 + k]);
        assert_eq!(
            (normal.law, tangential.law),
            (Law::Unilateral, Law::Friction)
        );
        assert_eq!(normal.block, tangential.block);
        assert!(tangential.holds);
        // n points down, into the obstacle, t along x.
        assert_eq!(tangential.label.normal, [1.0, 0.0, 0.0]);
        let x = normal.label.point[0];
        let area = if x == 0.0 || x == 2.0 { 0.25 } else { 0.5 };
        let expected = FrictionBound::Coulomb {
            coefficient: 0.25 * x,
            limit: 8.0 * area,
        };
        let (FrictionBound::Coulomb { coefficient, limit }, FrictionBound::Coulomb { .. }) =
            (node.bound, expected)
        else {
            panic!("{node:?}");
        };
        assert!((coefficient - 0.25 * x).abs() < 1e-15 && (limit - 8.0 * area).abs() < 1e-12);
    }
}

/// Given values on both sides leave nothing to slide, and a scene without friction has no tangential row.
#[test]
fn rows_are_made_where_something_may_slide() {
    assert_eq!(
        Scene::parse("s.toml", &block(""))
            .expect("a scene")
            .solver_rows(&|_| true)
            .len(),
        5
    );
    let held = block("friction = 1").replace("load", "dirichlet = { left = { x = 0 } }\nload");
    let scene = Scene::parse("s.toml", &held).expect("a scene");
    assert_eq!(scene.friction_nodes(&|_| true).len(), 4);
}

/// In space a node slides in a plane of symmetry, along the tangent that is left to it.
#[test]
fn nodes_on_a_plane_of_symmetry_slide_along_it() {
    let solid = |held: &str, friction: &str| {
        format!(
            "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = [1, 1, 1]\n\
             elements = [2, 2, 2]\nload = [0, -1, 0]\ndirichlet = {{ {held} }}\n\
             [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\n\
             plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nfriction = 1\n{friction}"
        )
    };
    let scene = Scene::parse("s.toml", &solid("back = { z = 0 }", "")).expect("a scene");
    let count = |of: usize| {
        let nodes = scene.friction_nodes(&|_| true).into_iter();
        nodes.filter(|n| n.tangential.len() == of).count()
    };
    assert_eq!([count(1), count(2)], [3, 6]);
    let both = Scene::parse("s.toml", &solid("back = { x = 0, z = 0 }", "")).expect("a scene");
    assert_eq!(both.friction_nodes(&|_| true).len(), 6);
    refused(
        &solid("back = { z = 0 }", "move = [0, 0, 0.1]\n"),
        "s.toml:9: friction of the obstacle of s.toml:9 at a node whose slip is given along one tangent, and free \
         along the other, expected both given or both free",
    );
}

/// A plane that moves drags the nodes: c is its way along t since the load step before.
#[test]
fn a_moving_obstacle_drags() {
    let text = block("move = [0.5, -0.1]\nfriction = 1\n[steps]\ntimes = [0.5, 1]\ngap = \"t^2\"");
    let scene = Scene::parse("s.toml", &text).expect("a scene");
    for (step, way) in [(0, 0.25), (1, 0.75)] {
        let gaps = scene.gaps(&|_| true, step).expect("a step");
        for c in &gaps[5..] {
            assert!((c - 0.5 * way).abs() < 1e-15, "{step} {c}");
        }
    }
}

#[test]
fn entries_with_different_laws_at_one_node_are_named() {
    let second = "[[obstacle]]\nbody = \"block\"\nside = \"bottom\"\nrange = [0.4, 1]\n\
                  plane = { point = [0, 0], normal = [0, 1] }\n";
    refused(
        &format!("{}{second}", block("friction = 0.1")),
        "s.toml:14: the obstacle of s.toml:9 and the obstacle of s.toml:14 both select the node at (1, 0) of body \
         `block` and have different laws (friction, stiffness), expected one law at a node",
    );
    let text = format!("{}{second}friction = 0.1", block("friction = 0.1"));
    Scene::parse("s.toml", &text).expect("one law");
}

/// A slender bar whose rigid motions have rounding: its rows were taken for many directions along the plane, and their
/// differences for forces. What is found hangs neither on subdomains nor on how their matrices are stored.
#[test]
fn rows_of_slender_bodies_have_one_direction_along_a_plane() {
    for (elements, height) in [(36, 0.025), (40, 0.025), (48, 0.025), (40, 0.02)] {
        let mut slips: Vec<f64> = Vec::new();
        for parts in [1, 2, 3, 4].into_iter().filter(|n| elements % n == 0) {
            let text = format!(
                "physics = \"elasticity\"\nplane = \"stress\"\norder = 2\n\
                 [[body]]\nname = \"bar\"\nsize = [1, {height}]\nelements = [{elements}, 2]\n\
                 subdomains = [{parts}, 1]\nyoung = 1e4\npoisson = 0\npressure = {{ top = 1 }}\n\
                 traction = {{ right = [{}, 0] }}\n\
                 [[obstacle]]\nbody = \"bar\"\nside = \"bottom\"\n\
                 plane = {{ point = [0, 0], normal = [0, 1] }}\nfriction = 0.3\n",
                0.15 / height
            );
            let scene = Scene::parse("bar.toml", &text).expect("a scene");
            for operators in [Operators::Implicit, Operators::Explicit] {
                let problem = scene.substructures(&|_| true).expect("a problem");
                let found = with_session(move |session| {
                    let settings = MethodSettings::default().operators(operators);
                    FetiFeti::new(session, problem, settings)?.solve()
                });
                // Without friction nothing would hold the bar along the plane.
                let found = found.unwrap_or_else(|e| panic!("{elements} {height} {parts}: {e}"));
                let slip = found.tangential_rows().iter().map(|row| row.gap.abs());
                slips.push(slip.fold(0.0, f64::max));
            }
        }
        let alike = |slip: &f64| (slip / slips[0] - 1.0).abs() < 1e-4;
        assert!(slips.iter().all(alike), "{slips:?}");
    }
}
