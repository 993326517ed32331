//! Tables of placements: names, what some copies have, files, and a sentence for each mistake.

use crate::support::mpi::Scratch;
use crate::support::scene_message;
use base::Result;
use elements::form::Form;
use scene::Scene;
use scene_message::{check, message};

const BRICK: &str = "[[body]]\nname = \"brick\"\nsize = [2, 1]\nelements = [4, 2]\n";

/// Elastic bricks with these placements, followed by `more`.
fn bricks(instances: &str, more: &str) -> String {
    format!("physics = \"elasticity\"\n{BRICK}instances = {instances}\n{more}")
}

fn scene(text: &str) -> Scene {
    Scene::parse("s.toml", text).unwrap_or_else(|e| panic!("{e}"))
}

fn names(scene: &Scene) -> Vec<&str> {
    scene.bodies.iter().map(|b| b.spec.name.as_str()).collect()
}

#[test]
fn copies_have_names_and_places() {
    let scene = scene(&bricks(
        "[[0, 0], { at = [5, 1], angle = 90, name = \"upright\" }, [2, \"1/2\"]]",
        "",
    ));
    assert_eq!(names(&scene), ["brick[0]", "upright", "brick[2]"]);
    let bounds: Vec<_> = scene.bodies.iter().map(|b| b.bounds).collect();
    assert_eq!(bounds[0], [[0.0; 3], [2.0, 1.0, 0.0]]);
    assert_eq!(bounds[1], [[4.0, 1.0, 0.0], [5.0, 3.0, 0.0]]);
    assert_eq!(bounds[2], [[2.0, 0.5, 0.0], [4.0, 1.5, 0.0]]);
}

#[test]
fn some_copies_have_more() {
    let only = |keys: &str| format!("[[body.only]]\n{keys}\n");
    let more = only("instances = \"1..2\"\ndirichlet = [\"bottom\"]")
        + &only("x = [4, 9]\ny = [0, 0]\nyoung = 5\nload = [0, -1]")
        + &only("instances = [0, \"k*y\"]\npressure = { top = 3 }");
    let list = "[[0, 0], [2, 0], [4, 0], [6, 0], { at = [8, 0], name = \"key\" }]";
    let scene = scene(&bricks(list, &(more + "[interface]\ndefault = \"free\"\n")));
    let held: Vec<usize> = scene.bodies.iter().map(|b| b.prescribed.len()).collect();
    assert_eq!(held, [0, 10, 10, 0, 0]);
    let young = |b: &scene::Body| b.spec.rho.as_constant().expect("a number");
    let all: Vec<f64> = scene.bodies.iter().map(young).collect();
    assert_eq!(all, [1.0, 1.0, 5.0, 5.0, 5.0]);
    let pressed: Vec<usize> = scene.bodies.iter().map(|b| b.spec.surface.len()).collect();
    assert_eq!(pressed, [1, 0, 0, 0, 1]);
    assert_eq!(scene.form.components(2), Form::default().components(2) + 1);
}

/// Reads bricks whose placements are the lines of a file.
fn from_file(dimension: usize, text: &str) -> Result<Scene> {
    let scratch = Scratch::new("instances");
    scratch.file("p.txt", text);
    let sizes = ["size = [2, 1]\nelements = [4, 2]", "size = 1\nelements = 2"][dimension - 2];
    let scene = format!(
        "dimension = {dimension}\nphysics = \"elasticity\"\n[[body]]\nname = \"b\"\n{sizes}\ninstances = \"p.txt\"\n"
    );
    Scene::load(scratch.file("s.toml", &scene))
}

#[test]
fn files_have_a_placement_on_each_line() {
    let scene = from_file(
        2,
        "# x y angle name\n0 0\n\n3, 1, 90  # turned\n7;0.5; 180; last\n",
    )
    .unwrap();
    assert_eq!(names(&scene), ["b[0]", "b[1]", "last"]);
    assert_eq!(scene.bodies[1].bounds, [[2.0, 1.0, 0.0], [3.0, 3.0, 0.0]]);
    assert_eq!(scene.bodies[2].bounds, [[5.0, -0.5, 0.0], [7.0, 0.5, 0.0]]);
    // An axis and an angle, and the same as a vector.
    let scene = from_file(3, "0 0 0 0 0 2 90\n0 0 5 0 0 90 same\n0 0 9 0 0 0").unwrap();
    for (k, z) in [(0, 0.0), (1, 5.0)] {
        assert_eq!(
            scene.bodies[k].bounds,
            [[-1.0, 0.0, z], [0.0, 1.0, z + 1.0]]
        );
    }
    let refused = [
        (
            2,
            "0 0\n1 2 3 4\n",
            ":2: a placement of 4 numbers where x y, and an angle if it is turned were expected",
        ),
        (
            2,
            "0 0\n\n1 wide 3\n",
            "p.txt:3: `wide` where a finite number was expected",
        ),
        (
            2,
            "0 inf\n",
            "p.txt:1: `inf` where a finite number was expected",
        ),
        (
            3,
            "0 0 0 0 0 0 20\n",
            "p.txt:1: an axis 0 where a direction was expected",
        ),
        (
            2,
            "0 0 twin\n4 0 twin\n",
            "p.txt:2: body `twin`: a second body of this name (names must be unique)",
        ),
        (
            2,
            "0 0\n1 0\n",
            "p.txt:2: bodies `b[0]` and `b[1]` overlap in [1, 2] × [0, 1] (bodies may only touch)",
        ),
        (
            2,
            "# nothing\n",
            "s.toml:7: no placements where one at least was expected",
        ),
    ];
    for (dimension, text, expected) in refused {
        let found = from_file(dimension, text)
            .map(drop)
            .unwrap_err()
            .to_string();
        assert!(found.ends_with(expected), "{found}");
    }
}

#[test]
fn mistakes_have_a_sentence_each() {
    let e = message(&bricks("\"nowhere.txt\"", ""));
    assert!(
        e.starts_with("s.toml:6: nowhere.txt: the list of placements cannot be read: "),
        "{e}"
    );
    check(
        &bricks("[[0]]", ""),
        "s.toml:6: a placement of 1 numbers where x y, and an angle if it is turned were expected",
    );
    check(
        &bricks("[{ angle = 4 }]", ""),
        "s.toml:6: a placement has no `at` (a point [x, y] was expected)",
    );
    check(
        &bricks("[[0, 0]]", "[[body.only]]\ninstances = 1\nyoung = 2\n"),
        "s.toml:7: copy 1 of body `brick` where a number below 1 was expected",
    );
    check(
        &bricks(
            "[[0, 0]]",
            "[[body.only]]\ninstances = \"stone*\"\nyoung = 2\n",
        ),
        "s.toml:7: [[body.only]] means no copy of body `brick` (one at least was expected)",
    );
    check(
        &bricks("[[0, 0]]", "[[body.only]]\nsize = 2\n"),
        "s.toml:8: unknown key `size` in [[body.only]] (known keys are instances, x, y, young, poisson, material, \
         expansion, temperature, reference, load, ramp, \
         traction, pressure, spring, dirichlet)",
    );
    check(
        &format!("{BRICK}[[body.only]]\nrho = 2\n"),
        "s.toml:5: [[body.only]] in a body without `instances`, where there are no copies to select from",
    );
    check(
        &bricks("[[1, 0], [3, 0]]", "").replace("physics", "plane = \"axisymmetric\"\norder = 2\nphysics"),
        "s.toml:8: body `brick[0]`: a ring at another radius or turned (shifts along the axis were expected in an \
         axisymmetric scene)",
    );
}
