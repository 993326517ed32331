//! Every way to write a scene wrongly, and the one sentence that says so.

use fetifeti::scene::{BodySpec, Field, GridSpec, Scene, SceneSpec};
use fetifeti::Error;

/// The message for the scene `text`.
fn message(text: &str) -> String {
    let result = Scene::parse("s.toml", text).and_then(|s| s.check_values());
    match result {
        Ok(()) => panic!("accepted:\n{text}"),
        Err(e @ Error::Input(_)) => {
            assert_eq!(e.exit_code(), 2);
            let message = e.to_string();
            assert!(!message.contains('\n'), "{message}");
            message
        }
        Err(e) => panic!("{e:?}"),
    }
}

/// A body on three lines: 1 + `line` is its header.
fn body(name: &str, origin: &str, more: &str) -> String {
    format!("[[body]]\nname = \"{name}\"\norigin = {origin}\nsize = [1, 1]\n{more}\n")
}

/// Two unit squares side by side, followed by `more`.
fn pair(more: &str) -> String {
    format!(
        "{}{}{more}",
        body("a", "[0, 0]", "elements = 4"),
        body("b", "[1, 0]", "elements = 4")
    )
}

#[track_caller]
fn check(text: &str, expected: &str) {
    assert_eq!(message(text), expected);
}

#[test]
fn files_and_syntax() {
    let e = Scene::load("no/such/scene.toml").unwrap_err();
    assert_eq!(e.exit_code(), 2);
    assert!(
        e.to_string()
            .starts_with("no/such/scene.toml: the scene cannot be read: No such file"),
        "{e}"
    );
    let e = message("title = \"x\"\n[[body]\n");
    assert!(e.starts_with("s.toml:2: not valid TOML: "), "{e}");
    let e = message("[[body]]\nsize = [1, 1\n");
    assert!(
        e.starts_with("s.toml:2: not valid TOML: ") || e.starts_with("s.toml:3: not valid"),
        "{e}"
    );
    let e = message("title = 1\ntitle = 2\n");
    assert!(
        e.starts_with("s.toml:2: not valid TOML: duplicate key"),
        "{e}"
    );
    check(
        "",
        "s.toml: the scene has no bodies ([[body]] or [grid] was expected)",
    );
    check(
        "body = []",
        "s.toml: the scene has no bodies ([[body]] or [grid] was expected)",
    );
}

#[test]
fn keys_and_types() {
    check(
        &body("a", "[0, 0]", "elements = 4\nrhoo = 2"),
        "s.toml:6: unknown key `rhoo` in [[body]] (known keys are name, origin, shape, size, subdomains, elements, \
         elements_per_subdomain, rho, load, flux, spring, dirichlet, ramp)",
    );
    let e = message(&format!("colour = 1\n{}", pair("")));
    assert!(
        e.starts_with(
            "s.toml:1: unknown key `colour` in the scene (known keys are dimension, physics,"
        ),
        "{e}"
    );
    let e = message(&pair("[[tie]]\nbodies = \"all\"\nrang = [0, 1]\n"));
    assert!(
        e.starts_with("s.toml:13: unknown key `rang` in [[tie]]"),
        "{e}"
    );
    check(
        "[[body]]\nsize = \"big\"\nelements = 2\n",
        "s.toml:2: bad expression \"big\": unknown name `big` at character 1 (variables are x, y, bi, bj, si, sj)",
    );
    check(
        "[[body]]\nsize = true\nelements = 2\n",
        "s.toml:2: true where a number or an expression was expected",
    );
    check(
        "[[body]]\nsize = [1]\nelements = 2\n",
        "s.toml:2: a list of 1 where a width and a height was expected",
    );
    check(
        "[[body]]\nname = 7\nsize = 1\nelements = 2\n",
        "s.toml:2: the number 7 where a name was expected",
    );
    check(
        "body = 3",
        "s.toml:1: the number 3 where a table was expected",
    );
    check(
        "body = [3]",
        "s.toml:1: [[body]] is the number 3 where a table was expected",
    );
    check(
        "[[body]]\nelements = 2\n",
        "s.toml:1: [[body]] has no `size` (a width and a height was expected)",
    );
    check(
        "[[body]]\nname = \"a\"\nsize = 1\n",
        "s.toml:1: body `a` has no `elements` (or `elements_per_subdomain`)",
    );
    check(
        "[grid]\nbodies = 2\n",
        "s.toml:1: body of the grid has no `elements` (or `elements_per_subdomain`)",
    );
    check(
        "[grid]\nelements = 2\n",
        "s.toml:1: [grid] has no `bodies` (the number of bodies in x and y was expected)",
    );
    check(
        "physics = \"stokes\"\n[grid]\nbodies = 2\nelements = 2\n",
        "s.toml:1: the text \"stokes\" where \"scalar\" or \"elasticity\" was expected",
    );
    check(
        &pair("[options]\nx = [1]\n"),
        "s.toml:12: a list of 1 where a text, a number or a truth value was expected",
    );
}

#[test]
fn sizes_and_counts() {
    check(
        &body("a", "[0, 0]", "elements = 0"),
        "s.toml:5: the number 0 where a positive whole number or a pair of them was expected",
    );
    check(
        &body("a", "[0, 0]", "elements = [4, 0]"),
        "s.toml:5: the number 0 where a positive whole number was expected",
    );
    check(
        &body("a", "[0, 0]", "elements = 2.5"),
        "s.toml:5: the number 2.5 where a positive whole number or a pair of them was expected",
    );
    check(
        &body("a", "[0, 0]", "elements = -4"),
        "s.toml:5: the number -4 where a positive whole number or a pair of them was expected",
    );
    check(
        &body("a", "[0, 0]", "elements = [6, 4]\nsubdomains = [2, 3]"),
        "s.toml:1: body `a`: 3 subdomains in y do not divide 4 elements (a multiple was expected)",
    );
    check(
        &body("a", "[0, 0]", "elements = 99999999999"),
        "s.toml:5: the number 99999999999 where a positive whole number or a pair of them of at most 4194304 was \
         expected",
    );
    check(
        "[[body]]\nsize = [1, -2]\nelements = 2\n",
        "s.toml:2: the size -2 where a positive number was expected",
    );
    check(
        "[[body]]\nsize = 0\nelements = 2\n",
        "s.toml:2: the size 0 where a positive number was expected",
    );
    check(
        "[grid]\nbodies = [100000, 100000]\nelements = 2\n",
        "s.toml:2: 10000000000 bodies where at most 262144 were expected",
    );
    check(
        &body("a", "[0, 0]", "elements = [4194304, 4194304]"),
        "s.toml:1: body `a`: a subdomain of 4194304 × 4194304 elements is too large (more subdomains were expected)",
    );
    let e = message(&body("a", "[1e12, 0]", "elements = 4"));
    assert!(
        e.starts_with("s.toml:1: body `a`: elements of size 0.25 in x cannot be told apart at"),
        "{e}"
    );
    check(
        &body("a", "[0, 0]", "elements = 1\ndirichlet = \"all\""),
        "s.toml:1: body `a`: every node of the scene lies on a Dirichlet side (at least one free node was expected)",
    );
    check(
        &body("a", "[0, 0]", "elements = [8192, 8192]\nsubdomains = 8192"),
        "s.toml:1: body `a`: the scene has more than 16777216 subdomains with this body",
    );
    check(
        &body("a", "[0, 0]", "elements = 2\nelements_per_subdomain = 2"),
        "s.toml:6: both `elements` and `elements_per_subdomain` are given where one was expected",
    );
}

#[test]
fn numbers_that_are_none() {
    check(
        &body("a", "[nan, 0]", "elements = 2"),
        "s.toml:3: nan where a finite number was expected",
    );
    check(
        &body("a", "[0, 0]", "elements = 2\nload = inf"),
        "s.toml:6: inf where a finite number was expected",
    );
    check(
        &body("a", "[0, 0]", "elements = 2\nrho = 1e999"),
        "s.toml:6: 1e999 where a finite number was expected",
    );
    check(
        &body("a", "[\"1/0\", 0]", "elements = 2"),
        "s.toml:3: inf where a finite number was expected",
    );
    check(
        &body("a", "[\"x\", 0]", "elements = 2"),
        "s.toml:3: the text \"x\" where a number without variables was expected",
    );
    check(
        &body("a", "[0, 0]", "elements = 2\nload = \"ln(0 - 1)\""),
        "s.toml:1: body `a`: load NaN where a finite number was expected",
    );
    check(
        &body("a", "[0, 0]", "elements = 2\nload = \"1/(x - 0.25)\""),
        "s.toml:1: body `a`: load inf at (0.25, 0.25) where a finite number was expected",
    );
    check(
        &body("a", "[0, 0]", "elements = 2\ndirichlet = { left = \"ln(y)\" }"),
        "s.toml:1: body `a`: Dirichlet value -inf at (0, 0) on side left where a finite number was expected",
    );
}

#[test]
fn coefficients() {
    let with = |rho: &str| {
        body(
            "a",
            "[0, 0]",
            &format!("elements = 4\nsubdomains = 2\nrho = {rho}"),
        )
    };
    check(
        &with("0"),
        "s.toml:1: body `a`: ρ = 0 where a positive number was expected",
    );
    check(
        &with("-1e-3"),
        "s.toml:1: body `a`: ρ = -0.001 where a positive number was expected",
    );
    check(
        &with("\"x - 0.5\""),
        "s.toml:1: body `a`: ρ = -0.375 at (0.125, 0.125) where a positive number was expected",
    );
    check(
        &with("[{ x = [0, 0.5], value = -2 }]"),
        "s.toml:1: body `a`: ρ = -2 where a positive number was expected",
    );
    check(
        &with("{ regions = [{ x = [0, 0.5], value = 2 }], default = 0 }"),
        "s.toml:1: body `a`: ρ = 0 where a positive number was expected",
    );
    check(
        &with("[[1, 2], [3, 0]]"),
        "s.toml:1: body `a`: ρ = 0 where a positive number was expected",
    );
    check(
        &with("[[1, 2]]"),
        "s.toml:7: 1 row where 2 rows of 2 numbers (one for each of the subdomains) were expected",
    );
    check(
        &with("[[1, 2], [3]]"),
        "s.toml:7: a row of 1 where 2 rows of 2 numbers (one for each of the subdomains) were expected",
    );
    check(
        &with("{ checkerboard = [1, 2], by = \"element\" }"),
        "s.toml:7: the text \"element\" where \"body\" or \"subdomain\" was expected",
    );
    check(
        &with("{ checkerboard = [1, -2] }"),
        "s.toml:1: body `a`: ρ = -2 where a positive number was expected",
    );
    check(
        &with("{ per_body = [[1]] }"),
        "s.toml:7: `per_body` outside a [grid], where one number serves",
    );
    check(
        &with("{ by = \"body\" }"),
        "s.toml:7: unknown key `by` in this table (known keys are value, regions, checkerboard, per_body, \
         per_subdomain, quadrature)",
    );
    check(
        &with("{ }"),
        "s.toml:7: a table without `value`, `regions`, `checkerboard`, `per_body` or `per_subdomain`",
    );
    check(
        &with("{ value = 1, checkerboard = [1, 2] }"),
        "s.toml:7: 2 values where one of `value`, `regions`, `checkerboard`, `per_body` or `per_subdomain` was expected",
    );
    check(
        &with("[{ x = [1, 0], value = 2 }]"),
        "s.toml:7: the empty range [1, 0] in a region",
    );
    check(
        &with("[{ x = [0, 1] }]"),
        "s.toml:7: a region has no `value` (a number or an expression was expected)",
    );
    check(
        &with("\"1 + \""),
        "s.toml:7: bad expression \"1 + \": the end at character 5 where a number, a name or `(` was expected",
    );
    check(
        "[grid]\nbodies = [2, 1]\nelements = 2\nrho = [[1, 2, 3]]\n",
        "s.toml:4: a row of 3 where 1 row of 2 numbers (one for each of the bodies) were expected",
    );
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
    check(
        &format!("{}{}", body("a", "[0, 0]", "elements = 4"), body("b", "[1, 0]", "elements = 5")),
        "s.toml:6: bodies `a` and `b` are tied, but node (1, 0.2) of `b` (t = 0.2) meets no node of `a` \
         (matching nodes were expected on a tied face)",
    );
    // Shifted by half an element: already the end of the common face has no partner.
    let e = message(&format!(
        "{}{}",
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
        "s.toml:11: a tie names body `a` twice where two bodies were expected",
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
    let mesh = GridSpec::unit_square([1, 1], [1, 1], [2, 2]).expand()[0].mesh;
    let with = |change: &dyn Fn(&mut BodySpec)| {
        let mut body = BodySpec::new("b", mesh);
        change(&mut body);
        refuse(SceneSpec::tied("", vec![body]))
    };
    assert_eq!(
        with(&|b| b.mesh.elements = [0, 2, 0]),
        "body `b`: zero elements in x where at least one was expected"
    );
    assert_eq!(
        with(&|b| b.mesh.subdomains = [1, 0, 1]),
        "body `b`: zero subdomains in y where at least one was expected"
    );
    assert_eq!(
        with(&|b| b.mesh.size = [1.0, f64::NAN, 0.0]),
        "body `b`: size NaN in y where a positive number was expected"
    );
    assert_eq!(
        with(&|b| b.mesh.origin = [f64::INFINITY, 0.0, 0.0]),
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
    assert!(scene.rows(&|_| true).is_empty());
    // Half of the face matches: a tie there is fine.
    let text = format!(
        "{}{}[[tie]]\nbodies = [\"a\", \"b\"]\npoints = [0, 0.5, 1]\n",
        body("a", "[0, 0]", "elements = 4"),
        body("b", "[1, 0]", "elements = 6")
    );
    assert_eq!(
        Scene::parse("s.toml", &text).unwrap().rows(&|_| true).len(),
        3
    );
}

/// A pseudo-random sequence (splitmix64), the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n as u64) as usize
    }
}

#[test]
fn damaged_files_never_panic() {
    let files = [
        "unequal_bodies",
        "partly_tied",
        "lee_column_2",
        "jump_checkerboard",
        "obstacle",
        "press_ramp",
        "contact_gap_table",
    ];
    let mut random = Random(1);
    let (mut accepted, mut refused) = (0, 0);
    for name in files {
        let text = std::fs::read_to_string(format!("examples/scenes/{name}.toml")).unwrap();
        let text: Vec<char> = text.chars().collect();
        for _ in 0..2000 {
            let mut damaged = text.clone();
            for _ in 0..=random.below(2) {
                let at = random.below(damaged.len());
                let symbols = ['0', '-', '[', ']', '"', '.', '=', '\n', 'x', '(', ',', '{'];
                match random.below(3) {
                    0 => drop(damaged.remove(at)),
                    1 => damaged[at] = symbols[random.below(symbols.len())],
                    _ => damaged.insert(at, symbols[random.below(symbols.len())]),
                }
            }
            let damaged: String = damaged.into_iter().collect();
            match Scene::parse("damaged.toml", &damaged) {
                Ok(_) => accepted += 1,
                Err(Error::Input(message)) => {
                    assert!(message.starts_with("damaged.toml"), "{message}");
                    assert!(!message.contains('\n'), "{message}");
                    refused += 1;
                }
                Err(other) => panic!("{other:?}"),
            }
        }
    }
    // Most damage lands in comments and blanks or changes a value; a good part must be seen.
    assert!(accepted > 500 && refused > 500, "{accepted} {refused}");
}
