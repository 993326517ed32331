//! Bodies that do not fit together, ties without nodes, invalid scenes built by programs; one sentence for each.

use crate::support::scene_message;
use mesh::BoxMesh;
use scene::{BodySpec, Field, GridSpec, Scene, SceneSpec};
use scene_message::{body, check, message, pair};

/// Sentences are one line, also where they quote texts of several.
#[test]
fn names_of_two_lines() {
    let two = body("a\\nb", "[0, 0]", "elements = 4");
    check(
        &two,
        "s.toml:1: body \"a\\nb\": a control character in its name, expected letters, digits and signs",
    );
    let said = message(&body("a", "[0, 0]", "elements = 4\nload = \"1 +\\n; 2\""));
    assert!(said.contains("1 +\\n; 2"), "{said}");
}

#[test]
fn bodies_together() {
    check(
        &format!(
            "{}{}",
            body("a", "[0, 0]", "elements = 4"),
            body("a", "[1, 0]", "elements = 4")
        ),
        "s.toml:6: body `a`: a second body of this name (names must be unique)",
    );
    check(
        &format!(
            "{}{}",
            body("a", "[0, 0]", "elements = 4"),
            body("b", "[0.75, 0.5]", "elements = 4")
        ),
        "s.toml:6: bodies `a` and `b` overlap in [0.75, 1] × [0.5, 1] (bodies may only touch)",
    );
    check(
        &format!(
            "{}{}",
            body("a", "[0, 0]", "elements = 4"),
            body("b", "[0, 0]", "elements = 4")
        ),
        "s.toml:6: bodies `a` and `b` overlap in [0, 1] × [0, 1] (bodies may only touch)",
    );
    // Single nodes can be tied only where both bodies have them.
    let points = "[[tie]]\nbodies = [\"a\", \"b\"]\npoints = [0.2]\n";
    check(
        &format!("{}{}{points}", body("a", "[0, 0]", "elements = 4"), body("b", "[1, 0]", "elements = 5")),
        "s.toml:11: bodies `a` and `b` are tied, but node (1, 0.2) of `b` (t = 0.2) meets no node of `a` \
         (matching nodes were expected on a tied face)",
    );
    // With a shift by half an element, no node matches, not even the end of the common face.
    let nodes = "[[tie]]\nbodies = [\"a\", \"b\"]\nnodes = [0]\n";
    let e = message(&format!(
        "{}{}{nodes}",
        body("a", "[0, 0]", "elements = 4"),
        body("b", "[1, 0.125]", "elements = 4")
    ));
    assert!(
        e.contains("node (1, 0.125) of `b` (t = 0) meets no node of `a`"),
        "{e}"
    );
    check(
        &format!(
            "{}{}",
            body("a", "[0, 0]", "elements = 4\ndirichlet = { bottom = 1 }"),
            body("b", "[1, 0]", "elements = 4\ndirichlet = { bottom = 2 }")
        ),
        "s.toml:7: bodies `a` and `b` are tied at (1, 0), where they prescribe 1 and 2 (equal values were expected)",
    );
    check(
        &body("a", "[0, 0]", "elements = 4\ndirichlet = { left = 1, top = 2 }"),
        "s.toml:1: body `a`: sides left and top prescribe 1 and 2 at their common corner (0, 1) (equal values were \
         expected)",
    );
    check(
        &body("a", "[0, 0]", "elements = 4\ndirichlet = [\"west\"]"),
        "s.toml:6: the text \"west\" where left, right, bottom or top was expected",
    );
    check(
        &body("a", "[0, 0]", "elements = 4\ndirichlet = 3"),
        "s.toml:6: the number 3 where \"all\", a list of sides (left, right, bottom, top) or a table of their values \
         was expected",
    );
}

#[test]
fn ties() {
    let tie = |lines: &str| pair(&format!("[[tie]]\n{lines}\n"));
    check(
        &tie("bodies = [\"a\", \"c\"]"),
        "s.toml:11: a tie names body `c`, which the scene does not have (bodies are `a`, `b`)",
    );
    check(
        &tie("bodies = [0, 2]"),
        "s.toml:12: body 2 where a number below 2 was expected",
    );
    check(
        &tie("bodies = [\"a\", \"a\"]"),
        "s.toml:11: a tie names body `a` twice where two bodies were expected (or `sides`, two sides of it)",
    );
    check(
        &tie("bodies = \"some\""),
        "s.toml:12: the text \"some\" where \"all\" or a pair of names was expected",
    );
    check(
        &format!(
            "{}{}[[tie]]\nbodies = [\"a\", \"b\"]\n",
            body("a", "[0, 0]", "elements = 4"),
            body("b", "[1.5, 0]", "elements = 4")
        ),
        "s.toml:11: a tie joins bodies `a` and `b`, which do not touch",
    );
    check(
        &tie("bodies = [\"a\", \"b\"]\nrange = [0.3, 0.4]"),
        "s.toml:11: the tie of bodies `a` and `b` selects no node of their common face",
    );
    check(
        &tie("bodies = \"all\"\nrange = [0.3, 0.4]"),
        "s.toml:11: the tie of all bodies selects no node of any common face",
    );
    check(
        &tie("bodies = \"all\"\nrange = [0.6, 0.4]"),
        "s.toml:13: the range [0.6, 0.4] where 0 ≤ t0 ≤ t1 ≤ 1 was expected",
    );
    check(
        &tie("bodies = \"all\"\nrange = [0.6, \"4/3\"]"),
        "s.toml:13: the range [0.6, 1.3333333333333333] where 0 ≤ t0 ≤ t1 ≤ 1 was expected",
    );
    check(
        &tie("bodies = [\"a\", \"b\"]\npoints = [0.1]"),
        "s.toml:11: the tie of bodies `a` and `b` names the node with t = 0.1, but their common face has 5 nodes and \
         none like that",
    );
    check(
        &tie("bodies = [\"a\", \"b\"]\nnodes = [5]"),
        "s.toml:11: the tie of bodies `a` and `b` names the node with number 5, but their common face has 5 nodes and \
         none like that",
    );
    check(
        &tie("bodies = [\"a\", \"b\"]\nnodes = [-1]"),
        "s.toml:13: the number -1 where a node number, counted from 0, was expected",
    );
    check(
        &tie("bodies = [\"a\", \"b\"]\nnodes = [1]\nwhere = \"all\""),
        "s.toml:11: [[tie]] has several of `where`, `range`, `points` and `nodes` where one was expected",
    );
    check(
        &tie("bodies = [\"a\", \"b\"]\nwhere = \"upper half\""),
        "s.toml:13: the text \"upper half\" where \"all\" or \"none\" (or the key `range`, `points` or `nodes`) was \
         expected",
    );
    check(
        &pair("[interface]\ndefault = \"glued\"\n"),
        "s.toml:12: the text \"glued\" where \"tied\", \"free\" or \"contact\" was expected",
    );
}

#[test]
fn scenes_built_by_programs_are_checked_too() {
    let refuse = |spec: SceneSpec| Scene::new(spec).unwrap_err().to_string();
    assert_eq!(
        refuse(SceneSpec::tied("", Vec::new())),
        "the scene has no bodies"
    );
    let grid = GridSpec::unit_square([2, 2], [3, 3], [8, 8]);
    assert_eq!(
        refuse(SceneSpec::tied("", grid.expand())),
        "body `b0_0`: 3 subdomains in x do not divide 8 elements (a multiple was expected)"
    );
    let mesh = GridSpec::unit_square([1, 1], [1, 1], [2, 2]).expand()[0]
        .mesh
        .clone();
    let mesh = *mesh.grid().unwrap();
    let with_mesh = |change: &dyn Fn(&mut BoxMesh)| {
        let mut mesh = mesh;
        change(&mut mesh);
        refuse(SceneSpec::tied("", vec![BodySpec::new("b", mesh)]))
    };
    let with = |change: &dyn Fn(&mut BodySpec)| {
        let mut body = BodySpec::new("b", mesh);
        change(&mut body);
        refuse(SceneSpec::tied("", vec![body]))
    };
    assert_eq!(
        with_mesh(&|mesh| mesh.elements = [0, 2, 0]),
        "body `b`: zero elements in x where at least one was expected"
    );
    assert_eq!(
        with_mesh(&|mesh| mesh.subdomains = [1, 0, 1]),
        "body `b`: zero subdomains in y where at least one was expected"
    );
    assert_eq!(
        with_mesh(&|mesh| mesh.size = [1.0, f64::NAN, 0.0]),
        "body `b`: size NaN in y where a positive number was expected"
    );
    assert_eq!(
        with_mesh(&|mesh| mesh.origin = [f64::INFINITY, 0.0, 0.0]),
        "body `b`: origin inf in x where a finite number was expected"
    );
    assert_eq!(
        with(&|b| b.rho = Field::constant(f64::NAN)),
        "body `b`: ρ = NaN where a positive number was expected"
    );
}

#[test]
fn free_faces_need_no_matching_nodes() {
    let text = format!(
        "{}{}[interface]\ndefault = \"free\"\n",
        body("a", "[0, 0]", "elements = 4"),
        body("b", "[1, 0]", "elements = 5")
    );
    let scene = Scene::parse("s.toml", &text).unwrap();
    assert!(scene.solver_rows(&|_| true).is_empty());
    // Half of the face matches: a tie there is fine.
    let text = format!(
        "{}{}[[tie]]\nbodies = [\"a\", \"b\"]\npoints = [0, 0.5, 1]\n",
        body("a", "[0, 0]", "elements = 4"),
        body("b", "[1, 0]", "elements = 6")
    );
    assert_eq!(
        Scene::parse("s.toml", &text)
            .unwrap()
            .solver_rows(&|_| true)
            .len(),
        3
    );
}
