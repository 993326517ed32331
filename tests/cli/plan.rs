//! `fetifeti plan`: what it says of a scene.

use crate::support::program::fetifeti;
use crate::support::sample::sample;

#[test]
fn the_plan_names_bodies_and_sizes() {
    let out = fetifeti(&["plan", "../../examples/scenes/partly_tied.toml"]);
    assert_eq!(out.code, 0, "{}", out.all());
    for word in ["left", "middle", "right", "16", "multipliers"] {
        assert!(out.stdout.contains(word), "{word}: {}", out.all());
    }
    let examples = std::fs::read_dir("../../examples/scenes").expect("the examples");
    let mut paths: Vec<_> = examples.map(|e| e.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    for path in sample(4, paths) {
        let out = fetifeti(&["plan", path.to_str().expect("UTF-8")]);
        assert_eq!((out.code, out.stderr.as_str()), (0, ""), "{}", out.all());
    }
}

#[test]
fn the_plan_counts_inequalities_and_load_steps() {
    for (name, expected) in [
        (
            "model_contact",
            "outer loop            active set: 33 inequalities (33 candidate nodes in 1 contact pair)",
        ),
        (
            "obstacle",
            "outer loop            active set: 79 inequalities \
             (17 candidate nodes in 1 contact pair, 62 nodes beside 4 obstacles)",
        ),
        (
            "press_ramp",
            "load steps            10, each starts from the solution of the last",
        ),
        ("model_tied", "outer loop            none: no inequality"),
    ] {
        let out = fetifeti(&["plan", &format!("../../examples/scenes/{name}.toml")]);
        assert_eq!(out.code, 0, "{}", out.all());
        assert!(out.stdout.lines().any(|l| l == expected), "{}", out.stdout);
        let steps = out.stdout.contains("load steps");
        assert_eq!(steps, name == "press_ramp", "{}", out.stdout);
    }
}
