//! Unit tests of `crates/cli/src/physics.rs`.

use super::*;

fn of(head: &str, dim: usize) -> String {
    let size = ["1, 1", "1, 1, 1"][dim - 2];
    let text = format!(
        "dimension = {dim}\n{head}\n[[body]]\nsize = [{size}]\nelements = 1\ndirichlet = [\"left\"]\n"
    );
    form(&Scene::parse("form.toml", &text).unwrap())
}

#[test]
fn forms_are_named() {
    assert_eq!(of("", 2), "plane scalar, Q1");
    assert_eq!(of("element = \"p1\"", 3), "three-dimensional scalar, P1");
    let elastic = "physics = \"elasticity\"";
    assert_eq!(
        of(elastic, 2),
        "plane strain elasticity, Q1, no cure of locking"
    );
    let stress = format!("{elastic}\nplane = \"stress\"");
    assert_eq!(
        of(&stress, 2),
        "plane stress elasticity, Q1, no cure of locking"
    );
    let cured = format!("{elastic}\nlocking = \"bbar\"");
    assert_eq!(of(&cured, 3), "three-dimensional elasticity, Q1, B-bar");
}
