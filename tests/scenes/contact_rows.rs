//! Rows where entries, sides or given values come together: corners between obstacles, oblique sides with given values,
//! the order of bodies in an entry, equations that a program adds.

use fetifeti::problem::BodyNode;
use fetifeti::Row;
use scene::{EquationSpec, Ramp, Scene, SceneSpec, StepsSpec};

/// A unit square at (x, 0) with n × n elements.
fn body(name: &str, x: f64, n: usize, more: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\norigin = [{x}, 0]\nsize = [1, 1]\nelements = {n}\n{more}\n"
    )
}

fn parse(text: &str) -> Scene {
    Scene::parse("s.toml", text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

#[test]
fn where_sides_beside_obstacles_meet_the_tighter_bound_counts() {
    for [right, top] in [[1, 2], [2, 1]] {
        let on = |side: &str, above: i32| {
            format!("[[obstacle]]\nbody = \"a\"\nside = \"{side}\"\nabove = {above}\n")
        };
        let scene = parse(&(body("a", 0.0, 4, "") + &on("right", right) + &on("top", top)));
        let rows = scene.solver_rows(&|_| true);
        assert_eq!(rows.len(), 9);
        let corner = rows.iter().filter(|r| r.terms[0].0 == 24);
        assert_eq!(corner.map(|r| r.gap).collect::<Vec<f64>>(), [1.0]);
    }
}

/// Two squares a quarter apart: given values may close the distance, but not take more than it.
#[test]
fn given_values_may_use_the_distance_and_no_more() {
    let apart = |way: f64| {
        let a = format!("dirichlet = {{ right = {{ x = {way}, y = 0 }} }}");
        let b = "dirichlet = { left = { x = 0, y = 0 } }";
        let contact = "[[contact]]\nbodies = [\"a\", \"b\"]\nsides = [\"right\", \"left\"]\n";
        let both = body("a", 0.0, 2, &a) + &body("b", 1.25, 2, b);
        let found = Scene::parse(
            "s.toml",
            &format!("physics = \"elasticity\"\n{both}{contact}"),
        );
        found.map(|scene| scene.solver_rows(&|_| true).len())
    };
    assert_eq!(apart(0.2).unwrap(), 0);
    assert_eq!(apart(0.25).unwrap(), 0);
    // Rounding is no violation, a millionth is one.
    assert_eq!(apart(0.25 + 1e-12).unwrap(), 0);
    let told = apart(0.25 + 1e-6).expect_err("refused").to_string();
    assert!(told.contains("which contradicts their contact"), "{told}");
}

/// The common side has the normal (2, −1)/√5: values that are given beyond it count along that.
#[test]
fn given_values_count_along_the_normal() {
    let shape = "shape = { x = \"x + 0.5*y\", y = \"y\" }\n";
    let given = format!("{shape}dirichlet = {{ left = {{ x = 0.3, y = 0.2 }} }}");
    let contact = "[[contact]]\nbodies = [\"a\", \"b\"]\ngap = 0.5\n";
    let bodies = body("a", 0.0, 2, shape) + &body("b", 1.0, 2, &given);
    let scene = parse(&format!("physics = \"elasticity\"\n{bodies}{contact}"));
    let rows = scene.solver_rows(&|_| true);
    assert_eq!(rows.len(), 3);
    let expected = 0.5 + (2.0 * 0.3 - 0.2) / 5.0_f64.sqrt();
    for row in rows {
        assert_eq!(row.terms.len(), 2);
        assert!((row.gap - expected).abs() < 1e-14, "{}", row.gap);
    }
}

/// The first body of an entry carries the multipliers where nothing is said, whatever its number is: there are as many
/// rows as it has nodes on the side.
#[test]
fn the_first_body_of_an_entry_carries_the_multipliers() {
    for sides in [true, false] {
        for (bodies, [first, second]) in [(["a", "b"], [5, 3]), (["b", "a"], [3, 5])] {
            let own = match (sides, bodies[0]) {
                (false, _) => "",
                (true, "a") => "sides = [\"right\", \"left\"]\n",
                _ => "sides = [\"left\", \"right\"]\n",
            };
            let of = |more: &str| {
                let entry = format!("[[contact]]\nbodies = {bodies:?}\n{own}{more}");
                let both = body("a", 0.0, 4, "") + &body("b", 1.0, 2, "");
                let scene = parse(&format!("physics = \"elasticity\"\n{both}{entry}"));
                scene.mortar_rows().count()
            };
            assert_eq!(of(""), first, "{bodies:?}");
            for (k, n) in [first, second].into_iter().enumerate() {
                let said = format!("multipliers = \"{}\"\n", bodies[k]);
                assert_eq!(of(&said), n, "{bodies:?} {said}");
            }
        }
    }
}

/// Of four bodies around a cross point two are tied on the far half of their face, the others as a whole: at the cross
/// point these tie the two, whose face is open there, so that it gets no open row.
#[test]
fn faces_that_others_tie_are_not_open_at_the_cross_point() {
    let part = "[[tie]]\nbodies = [0, 1]\nrange = [0, 0.5]\n";
    let scene = parse(&format!(
        "[grid]\nbodies = 2\nsize = 2\nelements = 4\n{part}"
    ));
    let rows = scene.solver_rows(&|_| true);
    let at = |row: &&Row| row.label.point == [1.0, 1.0, 0.0];
    assert!(rows.iter().filter(at).count() >= 5);
    assert!(rows.iter().filter(at).all(|row| row.holds));
    let open: Vec<f64> = rows
        .iter()
        .filter(|row| !row.holds)
        .map(|row| row.label.point[1])
        .collect();
    assert_eq!(open, [0.75]);
}

/// The far sides of two thin plates have opposite normals, too, and seem to overlap by both thicknesses.
#[test]
fn plates_touch_with_the_sides_between_them_alone() {
    let plate = |name: &str, y: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [0, {y}]\nsize = [1, 0.02]\nelements = [4, 1]\n"
        )
    };
    let scene = parse(&format!(
        "physics = \"elasticity\"\n{}{}[contact]\nauto = true\ndistance = 0.1\n",
        plate("low", 0.0),
        plate("up", 0.03)
    ));
    let rows = scene.solver_rows(&|_| true);
    assert_eq!(rows.len(), 5);
    for row in rows {
        assert!((row.gap - 0.01).abs() < 1e-15, "{}", row.gap);
    }
}

/// Terms at one degree of freedom add up, and given ones go to the right-hand side with the factor of the load step.
#[test]
fn equations_add_up_and_follow_given_values() {
    let text = body("a", 0.0, 2, "dirichlet = { left = 3 }") + &body("b", 4.0, 2, "");
    let mut spec: SceneSpec = scene::read("s.toml", &text).expect("a scene");
    spec.steps = Some(StepsSpec {
        times: vec![1.0, 2.0],
        load: Ramp::constant(1.0),
        gap: Ramp::constant(1.0),
        dirichlet: Ramp::parse("0.25*t").expect("a factor"),
        update: false,
        location: base::Location::default(),
    });
    // Node 3 of `a` is given, node 4 is in its middle.
    spec.equations.push(EquationSpec {
        terms: vec![(0, 4, 1.0), (1, 0, -2.0), (0, 3, 8.0), (0, 4, 0.5)],
        value: 10.0,
        resolution: 0.0,
        support: false,
        location: base::Location::default(),
    });
    let scene = Scene::new(spec).expect("a scene");
    let rows = scene.solver_rows(&|_| true);
    assert_eq!(rows.len(), 1);
    assert_eq!(rows[0].terms, [(4, 1.5), (9, -2.0)]);
    assert_eq!(rows[0].gap, 10.0 - 0.5 * 8.0 * 3.0);
    let gaps = [0, 1].map(|step| scene.gaps(&|_| true, step).expect("a step"));
    assert_eq!(gaps, [[10.0 - 0.25 * 8.0 * 3.0], [10.0 - 0.5 * 8.0 * 3.0]]);
    // Its forces act on the given one, too.
    let terms: Vec<_> = scene.row_terms(&|_| true).collect();
    let node = |body: usize, node: usize| BodyNode { body, node };
    let expected = [(node(0, 4), 1.5), (node(1, 0), -2.0), (node(0, 3), 8.0)];
    assert_eq!(terms.len(), 1);
    assert_eq!(terms[0].terms, expected.map(|(at, v)| (at, [v, 0.0, 0.0])));
}

/// The lower body reaches beyond the upper one by half: the rest of its side, beginning in the middle of a node's two
/// cells, belongs to no row.
#[test]
fn areas_end_where_the_other_body_does() {
    let of = |name: &str, y: i32, width: i32| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [0, {y}]\nsize = [{width}, 1]\nelements = [{}, 2]\n",
            2 * width
        )
    };
    for bodies in ["[\"low\", \"up\"]", "[\"up\", \"low\"]"] {
        let scene = parse(&format!(
            "physics = \"elasticity\"\n{}{}[[contact]]\nbodies = {bodies}\n",
            of("low", 0, 2),
            of("up", 1, 1)
        ));
        let rows = scene.solver_rows(&|_| true);
        let areas: Vec<f64> = rows.iter().map(|row| row.label.area).collect();
        assert_eq!(areas, [0.25, 0.5, 0.25], "{bodies}");
    }
}
