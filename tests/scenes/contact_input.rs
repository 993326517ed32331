//! All mistakes in contacts, obstacles and load steps, and the one sentence for each.

use scene::{
    ContactSpec, Extent, ObstacleSpec, PairSelector, Profile, Ramp, Scene, SceneSpec, StepsSpec,
};

/// A body on five lines.
fn body(name: &str, origin: &str, more: &str) -> String {
    format!("[[body]]\nname = \"{name}\"\norigin = {origin}\nsize = [1, 1]\nelements = 4\n{more}")
}

/// Two unit squares side by side on ten lines, followed by `more`.
fn pair(more: &str) -> String {
    body("a", "[0, 0]", "") + &body("b", "[1, 0]", "") + more
}

#[track_caller]
fn check(text: &str, expected: &str) {
    match Scene::parse("s.toml", text) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(e) if e.is_input() => {
            assert_eq!(e.exit_code(), 2);
            assert_eq!(e.to_string(), expected);
        }
        Err(e) => panic!("{e:?}"),
    }
}

#[test]
fn contacts() {
    let with = |lines: &str| pair(&format!("[[contact]]\nbodies = [\"a\", \"b\"]\n{lines}\n"));
    check(
        &with("gapp = 1"),
        "s.toml:13: unknown key `gapp` in [[contact]] (known keys are surfaces, bodies, \
         sides, multipliers, adjust, distance, where, range, points, nodes, gap, friction, \
         friction_limit, tresca, stiffness, stick_stiffness, ramp)",
    );
    check(
        &pair("[[contact]]\ngap = 1\n"),
        "s.toml:11: [[contact]] has no `bodies` (\"all\" or a pair of names was expected)",
    );
    check(
        &pair("[[contact]]\nbodies = [\"a\", \"c\"]\n"),
        "s.toml:11: a contact names body `c`, which the scene does not have (bodies are `a`, `b`)",
    );
    check(
        &pair("[[contact]]\nbodies = [\"b\", \"b\"]\n"),
        "s.toml:11: a contact names body `b` twice where two bodies were expected (or `sides`, two sides of it)",
    );
    let apart = body("a", "[0, 0]", "") + &body("b", "[1.5, 0]", "");
    check(
        &format!("{apart}[[contact]]\nbodies = [0, 1]\n"),
        "s.toml:11: a contact joins bodies `a` and `b`, which do not touch",
    );
    check(
        &with("range = [0.3, 0.4]"),
        "s.toml:11: the contact of bodies `a` and `b` selects no node of their common face",
    );
    check(
        &pair("[[contact]]\nbodies = \"all\"\nrange = [0.3, 0.4]\n"),
        "s.toml:11: the contact of all bodies selects no node of any common face",
    );
    check(
        &with("points = [0.3]"),
        "s.toml:11: the contact of bodies `a` and `b` names the node with t = 0.3, but their common face has 5 nodes \
         and none like that",
    );
    check(
        &with("nodes = [7]"),
        "s.toml:11: the contact of bodies `a` and `b` names the node with number 7, but their common face has 5 nodes \
         and none like that",
    );
    check(
        &with("range = [0, 1]\nwhere = \"all\""),
        "s.toml:11: [[contact]] has several of `where`, `range`, `points` and `nodes` where one was expected",
    );
    let other = "[[contact]]\nbodies = [\"b\", \"a\"]\nrange = [0.5, 1]\n";
    check(
        &(with("range = [0, 0.5]") + other),
        "s.toml:14: the contact names bodies `b` and `a` in the other order than the contact of s.toml:11 \
         (the second body lies above the first, one order for a pair was expected)",
    );
    let unmatched = body("a", "[0, 0]", "") + &body("b", "[1, 0.125]", "");
    check(
        &format!("{unmatched}[[contact]]\nbodies = [\"a\", \"b\"]\nnodes = [0]\n"),
        "s.toml:11: bodies `a` and `b` are in contact, but node (1, 0.125) of `b` (t = 0) meets no node of `a` \
         (matching nodes were expected on a contact face)",
    );
}

#[test]
fn gaps() {
    let with = |gap: &str| {
        pair(&format!(
            "[[contact]]\nbodies = [\"a\", \"b\"]\ngap = {gap}\n"
        ))
    };
    check(
        &with("true"),
        "s.toml:13: true where a number or an expression was expected",
    );
    check(
        &with("nan"),
        "s.toml:13: nan where a finite number was expected",
    );
    check(
        &with("\"z\""),
        "s.toml:13: bad expression \"z\": unknown name `z` at character 1 (variables are x, y, bi, bj, si, sj)",
    );
    check(
        &with("\"1/y\""),
        "s.toml:11: the gap of bodies `a` and `b` is inf at (1, 0) where a finite number was expected",
    );
    check(
        &with("[]"),
        "s.toml:13: a list of 0 where a table [[t, value], …] with increasing t between 0 and 1 was expected",
    );
    check(
        &with("[0, 1]"),
        "s.toml:13: the number 0 where a pair [t, value] was expected",
    );
    check(
        &with("[[0, 1], [0, 2]]"),
        "s.toml:13: t = 0 where a table [[t, value], …] with increasing t between 0 and 1 was expected",
    );
    check(
        &with("[[0, 1], [1.5, 2]]"),
        "s.toml:13: t = 1.5 where a table [[t, value], …] with increasing t between 0 and 1 was expected",
    );
}

#[test]
fn nodes_that_are_tied_and_in_contact() {
    let both = |tie: &str, contact: &str| {
        pair(&format!(
            "[[tie]]\nbodies = [0, 1]\n{tie}\n[[contact]]\nbodies = [0, 1]\n{contact}\n"
        ))
    };
    let message = |t: &str| {
        format!(
            "s.toml:14: the contact of bodies `a` and `b` selects the node at t = {t}, which the \
             tie of s.toml:11 selects too (ranges that share no more than their ends were expected)"
        )
    };
    check(&both("range = [0, 0.5]", "where = \"all\""), &message("0"));
    check(
        &both("range = [0, 0.5]", "range = [0.25, 1]"),
        &message("0.25"),
    );
    check(&both("points = [0.5]", "range = [0.5, 1]"), &message("0.5"));
    check(&both("where = \"all\"", "nodes = [3]"), &message("0.75"));
}

#[test]
fn contacts_that_are_decided_already() {
    let given = |a: &str, b: &str, more: &str| {
        let a = format!("dirichlet = {{ bottom = {a} }}\n");
        let b = format!("dirichlet = {{ bottom = {b} }}\n");
        body("a", "[0, 0]", &a) + &body("b", "[1, 0]", &b) + more
    };
    let contact = "[[contact]]\nbodies = [\"a\", \"b\"]\ngap = 0.5\n";
    assert!(Scene::parse("s.toml", &given("1", "0.5", contact)).is_ok());
    check(
        &given("2", "1", contact),
        "s.toml:13: bodies `a` and `b` have the given values 2 and 1 at (1, 0), which contradicts their contact \
         (u of `a` − u of `b` ≤ 0.5 was expected)",
    );
    // The contact comes from the default: the message names a body instead of an entry.
    check(
        &given("2", "1", "[interface]\ndefault = \"contact\"\n"),
        "s.toml:7: bodies `a` and `b` have the given values 2 and 1 at (1, 0), which contradicts their contact \
         (u of `a` − u of `b` ≤ 0 was expected)",
    );
    // Compatible at first, contradictory once the prescribed values have grown.
    let steps = "[steps]\ntimes = [0.25, 0.75]\ndirichlet = \"t\"\n";
    check(
        &given("2", "1", &format!("{contact}{steps}")),
        "s.toml:13: bodies `a` and `b` have the given values 1.5 and 0.75 at (1, 0), t = 0.75, which contradicts their \
         contact (u of `a` − u of `b` ≤ 0.5 was expected)",
    );
    // Three faces tie four bodies at their cross point.
    let grid = "[grid]\nbodies = 2\nsize = 2\nelements = 2\n[[contact]]\nbodies = [0, 1]\n";
    assert!(Scene::parse("s.toml", &format!("{grid}gap = 0.1\n")).is_ok());
    check(
        &format!("{grid}gap = -0.1\n"),
        "s.toml:5: bodies `b0_0` and `b1_0` are tied through others at (1, 1), which contradicts their contact \
         (u of `b0_0` − u of `b1_0` ≤ -0.1 was expected)",
    );
}

#[test]
fn obstacles() {
    let with = |lines: &str| pair(&format!("[[obstacle]]\n{lines}\n"));
    check(
        &with("side = \"top\"\nbelow = 0"),
        "s.toml:11: [[obstacle]] has no `body` (\"all\" or the name of a body was expected)",
    );
    check(
        &with("body = \"c\"\nside = \"top\"\nbelow = 0"),
        "s.toml:11: an obstacle names body `c`, which the scene does not have (bodies are `a`, `b`)",
    );
    check(
        &with("body = 2\nside = \"top\"\nbelow = 0"),
        "s.toml:12: body 2 where a number below 2 was expected",
    );
    check(
        &with("body = \"a\"\nbelow = 0"),
        "s.toml:11: [[obstacle]] has no `side` (a side, a list of them or \"all\" was expected)",
    );
    check(
        &with("body = \"a\"\nside = \"north\"\nbelow = 0"),
        "s.toml:13: the text \"north\" where left, right, bottom, top, a list of them or \"all\" was expected",
    );
    check(
        &with("body = \"a\"\nside = [\"top\", 3]\nbelow = 0"),
        "s.toml:13: the number 3 where left, right, bottom, top, a list of them or \"all\" was expected",
    );
    check(
        &with("body = \"a\"\nside = \"top\""),
        "s.toml:11: [[obstacle]] without a bound (`below`, `above` or both were expected)",
    );
    check(
        &with("body = \"a\"\nside = \"top\"\nover = 1"),
        "s.toml:14: unknown key `over` in [[obstacle]] (known keys are body, side, where, range, points, nodes, below, \
         above, friction, friction_limit, tresca, stiffness, stick_stiffness, ramp)",
    );
    check(
        &with("body = \"a\"\nside = \"top\"\nbelow = 0\nrange = [0.3, 0.4]"),
        "s.toml:11: the obstacle of body `a` selects no node of its side top",
    );
    check(
        &with("body = \"a\"\nside = \"top\"\nbelow = 0\nnodes = [5]"),
        "s.toml:11: the obstacle of body `a` names the node with number 5, \
         but its side top has 5 nodes and none like that",
    );
    check(
        &with("body = \"a\"\nside = \"left\"\nabove = \"ln(y)\""),
        "s.toml:11: the bound `above` of body `a` is -inf at (0, 0) where a finite number was expected",
    );
    let two = "body = \"a\"\nside = \"top\"\nbelow = \"x\"\nabove = 0.5";
    check(
        &with(two),
        "s.toml:11: the obstacles of body `a` leave nothing at (0.75, 1): below = 0.75 and above = 0.5 \
         (below ≤ above was expected)",
    );
    // Two sides at their common corner.
    let corner = "[[obstacle]]\nbody = \"a\"\nside = \"top\"\nbelow = 1\n\
                  [[obstacle]]\nbody = \"a\"\nside = \"left\"\nabove = 0\n";
    check(
        &pair(corner),
        "s.toml:15: the obstacles of body `a` leave nothing at (0, 1): \
         below = 1 and above = 0 (below ≤ above was expected)",
    );
    let given = body("a", "[0, 0]", "dirichlet = { top = \"2*x\" }\n");
    let above = "[[obstacle]]\nbody = \"a\"\nside = \"top\"\n";
    check(
        &format!("{given}{above}above = 1.25\n"),
        "s.toml:7: body `a` has the given value 1.5 at (0.75, 1), beyond its obstacle (u ≤ 1.25 was expected)",
    );
    check(
        &format!("{given}{above}below = 0.25\n[steps]\ncount = 2\ngap = \"t\"\n"),
        "s.toml:7: body `a` has the given value 0 at (0, 1), t = 0.5, beyond its obstacle (u ≥ 0.125 was expected)",
    );
}

#[test]
fn steps() {
    let with = |lines: &str| pair(&format!("[steps]\n{lines}\n"));
    check(
        &with("load = \"t\""),
        "s.toml:11: [steps] has no `count` (or `times`)",
    );
    check(
        &with("count = 2\ntimes = [1]"),
        "s.toml:13: both `count` and `times` are given where one was expected",
    );
    check(
        &with("count = 0"),
        "s.toml:12: the number 0 where a positive whole number was expected",
    );
    check(
        &with("count = 2000000"),
        "s.toml:12: 2000000 steps where at most 1048576 were expected",
    );
    check(
        &with("times = [0.5, 0.5]"),
        "s.toml:12: the time 0.5 after 0.5 where increasing times were expected",
    );
    check(
        &with("times = []"),
        "s.toml:12: a list of 0 where a list of increasing times was expected",
    );
    check(
        &with("count = 2\nload = \"x\""),
        "s.toml:13: bad expression \"x\": unknown name `x` at character 1 (variables are t)",
    );
    check(
        &with("count = 2\nload = [1]"),
        "s.toml:13: a list of 1 where a number or an expression in t was expected",
    );
    check(
        &with("count = 2\nforce = 1"),
        "s.toml:13: unknown key `force` in [steps] (known keys are count, times, load, gap, dirichlet, update)",
    );
    check(
        &with("count = 2\ngap = \"1/(t - 0.5)\""),
        "s.toml:11: the factor `gap` = \"1/(t - 0.5)\" is inf at t = 0.5 where a finite number was expected",
    );
    let contact = "[[contact]]\nbodies = \"all\"\nramp = \"ln(t - 1)\"\n";
    check(
        &pair(&format!("{contact}[steps]\ncount = 1\n")),
        "s.toml:11: the factor `ramp` = \"ln(t - 1)\" is -inf at t = 1 where a finite number was expected",
    );
    check(
        &pair(contact),
        "s.toml:11: a `ramp` in a scene without load steps ([steps] was expected)",
    );
    check(
        "[grid]\nbodies = 2\nelements = 2\nramp = 1\n",
        "s.toml:1: a `ramp` in a scene without load steps ([steps] was expected)",
    );
    let huge = "[[contact]]\nbodies = \"all\"\ngap = 1e40\n[steps]\ncount = 2\ngap = \"1e300*t\"\n";
    check(
        &pair(huge),
        "s.toml:11: the bound of body `a` with its factor is inf at (1, 0), t = 0.5 where a finite number was expected",
    );
}

#[test]
fn scenes_that_a_program_builds_are_checked_too() {
    let spec = || {
        let square = scene::GridSpec::unit_square([2, 1], [1, 1], [2, 2]);
        SceneSpec::tied("built", square.expand())
    };
    let error = |spec: SceneSpec| Scene::new(spec).unwrap_err().to_string();
    let mut contact = spec();
    contact.contacts.push(ContactSpec {
        sides: None,
        pair: PairSelector::Named("b0_0".into(), "b1_0".into()),
        extent: Extent::All,
        gap: Profile::Table(Vec::new()),
        distance: None,
        multipliers: None,
        adjust: 0.0,
        adjusted: Vec::new(),
        opposed: None,
        law: Default::default(),
        ramp: None,
        location: base::Location::default(),
    });
    assert_eq!(
        error(contact),
        "the gap of bodies `b0_0` and `b1_0` is NaN at (0.5, 0) where a finite number was expected"
    );
    let mut obstacle = spec();
    obstacle.obstacles.push(ObstacleSpec {
        rigid: None,
        surface: None,
        motion: [0.0; 3],
        distance: None,
        adjust: 0.0,
        area: None,
        gap: Profile::constant(0.0),
        body: None,
        sides: vec![0],
        extent: Extent::All,
        below: None,
        above: None,
        law: Default::default(),
        ramp: None,
        location: base::Location::default(),
    });
    assert_eq!(
        error(obstacle),
        "an obstacle without a bound (`below`, `above` or both were expected)"
    );
    for (times, message) in [
        (
            vec![],
            "no times in [steps] where at least one was expected",
        ),
        (
            vec![f64::NAN],
            "the time NaN in [steps] where a finite number was expected",
        ),
        (
            vec![1.0, 0.5],
            "the time 0.5 after 1 in [steps] (increasing times were expected)",
        ),
    ] {
        let mut steps = spec();
        steps.steps = Some(StepsSpec {
            times,
            load: Ramp::constant(1.0),
            gap: Ramp::parse("t").unwrap(),
            dirichlet: Ramp::constant(1.0),
            update: false,
            location: base::Location::default(),
        });
        assert_eq!(error(steps), message);
    }
}
