//! How far sides slide along each other, in the report of `fetifeti solve`: blocks that are pushed along by a given
//! displacement, so that the sliding is known.

use crate::support::checks::number;
use crate::support::{mpi, program};
use std::fs;

use mpi::Scratch;
use program::run_fetifeti;
use serde_json::Value;

/// A block of 4 elements across that is pushed by `push` along x on a rigid plane, and is pressed down.
fn on_a_plane(push: f64) -> String {
    format!(
        "title = \"plane\"\nphysics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = [1, 1]\nelements = [4, 4]\n\
         subdomains = [2, 2]\nyoung = 10\npoisson = 0\ndirichlet = {{ left = {{ x = {push} }} }}\n\
         traction = {{ top = [0, -1] }}\n[[obstacle]]\nbody = \"block\"\nside = \"bottom\"\n\
         plane = {{ point = [0, 0], normal = [0, 1] }}\n"
    )
}

/// A soft block on a stiff one whose nodes do not match, in space, pushed by (0.3, 0, 0.4): by 0.5.
fn on_a_block() -> String {
    "title = \"block\"\ndimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"low\"\nsize = [4, 1, 4]\n\
     elements = [8, 2, 8]\nsubdomains = [2, 1, 2]\nyoung = 1e6\npoisson = 0\ndirichlet = [\"bottom\"]\n\
     [[body]]\nname = \"high\"\norigin = [0.6, 1, 0.6]\nsize = [2, 1, 2]\nelements = [5, 2, 5]\n\
     subdomains = [1, 1, 1]\nyoung = 1\npoisson = 0\n\
     dirichlet = { left = { x = 0.3 }, back = { z = 0.4 } }\ntraction = { top = [0, -0.1, 0] }\n\
     [[contact]]\nbodies = [\"high\", \"low\"]\nsides = [\"bottom\", \"top\"]\n"
        .into()
}

fn solved(name: &str, scene: &str, ranks: usize) -> (Value, String) {
    let scratch = Scratch::new(&format!("sliding-{name}-{ranks}"));
    let file = scratch.path("s.toml");
    fs::write(&file, scene).expect("a scene is written");
    let json = scratch.path("r.json");
    let out = run_fetifeti(ranks, &["solve", &file, "--json", &json]);
    assert_eq!(out.code, 0, "{}", out.all());
    let text = fs::read_to_string(&json).expect("a report");
    (serde_json::from_str(&text).expect("JSON"), out.stdout)
}

fn near(found: &Value, expected: f64, tolerance: f64) {
    let found = number(found);
    assert!(
        (found - expected).abs() <= tolerance,
        "{found} and not {expected}"
    );
}

#[test]
fn a_block_on_a_plane_slides_as_far_as_it_is_pushed() {
    for (push, far) in [(0.3, true), (-0.1, false)] {
        let (report, text) = solved(&format!("plane{far}"), &on_a_plane(push), 1);
        let interface = &report["contact"]["interfaces"][0];
        near(&interface["largest_sliding"], push.abs(), 1e-6);
        near(&interface["sliding_over_face"], push.abs() / 0.25, 1e-5);
        near(&interface["largest_turn"], 0.0, 1e-3);
        assert!(
            text.contains("of the size of a face (block.bottom"),
            "{text}"
        );
        assert_eq!(text.contains("[steps] update = true"), far, "{text}");
    }
}

#[test]
fn sides_that_do_not_match_slide_alike_on_all_ranks() {
    for ranks in [1, 2, 4] {
        let (report, text) = solved("block", &on_a_block(), ranks);
        let interface = &report["contact"]["interfaces"][0];
        near(&interface["largest_sliding"], 0.5, 1e-5);
        // The faces above are the smaller ones.
        near(&interface["sliding_over_face"], 0.5 / 0.4, 1e-4);
        assert!(
            text.contains("sliding of more than 0.5 of a face"),
            "{text}"
        );
    }
}

#[test]
fn every_load_step_has_its_sliding() {
    let steps = "[steps]\ncount = 3\ndirichlet = \"t*(4 - 3*t)\"\n";
    let (report, text) = solved("steps", &(on_a_plane(0.1) + steps), 2);
    // t (4 − 3 t) at 1/3, 2/3 and 1.
    for (step, factor) in report["contact"]["load_steps"]
        .as_array()
        .expect("steps")
        .iter()
        .zip([1.0, 4.0 / 3.0, 1.0])
    {
        near(&step["largest_sliding"], 0.1 * factor, 1e-6);
        near(&step["sliding_over_face"], 0.4 * factor, 1e-5);
    }
    // Only the second step is beyond half a face.
    assert!(text.contains("over all load steps 0.5333"), "{text}");
    assert!(
        text.contains("sliding of more than 0.5 of a face"),
        "{text}"
    );
}

#[test]
fn a_side_that_tilts_is_said_to_turn() {
    // The top is tilted by given displacements, and a corner of the bottom touches.
    let scene = "title = \"tilt\"\nphysics = \"elasticity\"\n[[body]]\nname = \"block\"\nsize = [1, 1]\n\
         elements = [4, 4]\nyoung = 10\npoisson = 0\ndirichlet = { top = { x = 0, y = \"-0.2 - 0.2*x\" } }\n\
         [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\nplane = { point = [0, -0.395], normal = [0, 1] }\n";
    let (report, text) = solved("tilt", scene, 1);
    let turned = number(&report["contact"]["interfaces"][0]["largest_turn"]);
    // The top turns by atan(0.2) = 11.3 degrees, and the bottom follows as far as the plane lets it.
    assert!(turned > 5.0 && turned < 11.4, "{turned}");
    assert!(text.contains("turns of more than 5 degrees"), "{text}");
}

#[test]
fn scalar_contact_says_nothing_about_sliding() {
    let out = run_fetifeti(1, &["solve", "../../examples/scenes/obstacle.toml"]);
    assert_eq!(out.code, 0, "{}", out.all());
    assert!(!out.stdout.contains("sliding"), "{}", out.stdout);
}

#[test]
fn an_obstacle_that_moves_slides_along_a_body_at_rest() {
    // The block is held where it is pushed along else; the plane moves up into it and along it.
    let scene = on_a_plane(0.0) + "move = [0.2, 1e-3]\nramp = \"t\"\n[steps]\ncount = 2\n";
    let (report, _) = solved("moving", &scene, 1);
    near(
        &report["contact"]["interfaces"][0]["largest_sliding"],
        0.2,
        1e-6,
    );
    near(
        &report["contact"]["load_steps"][0]["largest_sliding"],
        0.1,
        1e-6,
    );
}
