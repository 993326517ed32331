//! All mistakes in files, keys and values of scenes, and the one sentence for each.

use crate::support::{rng, scene_message};
use rng::Rng;
use scene::Scene;
use scene_message::{body, check, message, pair};

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
         elements_per_subdomain, rho, load, ramp, flux, spring, dirichlet, order, instances, only)",
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
        "s.toml:7: 2 values where one of `value`, `regions`, \
         `checkerboard`, `per_body` or `per_subdomain` was expected",
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
    let mut random = Rng::new(1);
    let (mut accepted, mut refused) = (0, 0);
    for name in files {
        let text = std::fs::read_to_string(format!("../../examples/scenes/{name}.toml")).unwrap();
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
                Err(error) if error.is_input() => {
                    let message = error.to_string();
                    assert!(message.starts_with("damaged.toml"), "{message}");
                    assert!(!message.contains('\n'), "{message}");
                    refused += 1;
                }
                Err(other) => panic!("{other:?}"),
            }
        }
    }
    // Most random changes hit comments and blanks or change a value; a good part must be refused.
    assert!(accepted > 500 && refused > 500, "{accepted} {refused}");
}
