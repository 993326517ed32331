//! Friction between sides whose nodes do not match.

use super::friction::{near, solved};
use fetifeti::solution::RowState;

/// Two blocks whose nodes do not match: as tied ones where friction holds everywhere, up to the friction of the force
/// that presses them together where it does not.
#[test]
fn sides_that_do_not_match_have_friction() {
    let blocks = |joint: &str| {
        format!(
            "physics = \"elasticity\"\n[[body]]\nname = \"low\"\nsize = [2, 1]\nelements = [14, 7]\n\
             subdomains = [2, 1]\nyoung = 1\npoisson = 0.3\ndirichlet = {{ bottom = 0 }}\n[[body]]\nname = \"high\"\n\
             origin = [0.5, 1]\nsize = 1\nelements = 10\nsubdomains = 2\nyoung = 2\npoisson = 0.3\n\
             traction = {{ top = [0.01, -0.1] }}\n{joint}\nbodies = [\"low\", \"high\"]\nmultipliers = \"high\"\n"
        )
    };
    let held = solved(blocks("[[contact]]\nfriction = 1e3")).expect("a solution");
    let tied = solved(blocks("[[tie]]")).expect("a solution");
    assert!(held.converged() && tied.converged());
    assert!(held.rows().iter().all(|r| r.holds()));
    near(held.energy, tied.energy, 1e-9, "tied");
    let slips = solved(blocks("[[contact]]\nfriction = 0.11")).expect("it stands");
    assert!(slips.converged(), "{}", slips.status);
    let rows = slips.tangential_rows();
    let drag: f64 = rows.iter().map(|r| r.multiplier * r.normal()[0]).sum();
    near(drag.abs(), 0.01, 1e-7, "friction");
    // Shear stresses need the areas that pressures have.
    let area =
        |rows: &[fetifeti::solution::SolvedRow]| -> f64 { rows.iter().map(|r| r.label.area).sum() };
    near(area(rows), area(slips.rows()), 1e-12, "area");
    near(area(rows), 1.0, 1e-12, "area");
    assert!(rows.iter().filter(|r| r.state == RowState::Slips).count() > rows.len() / 2);
    let error = solved(blocks("[[contact]]\nfriction = 0.09")).map(|s| s.status);
    let text = error.expect_err("it slides").to_string();
    assert!(
        text.contains("\"high\" is pushed away for ever where it slides along x"),
        "{text}"
    );
}

/// Sides in space whose nodes do not match, in a block of many rows: as tied where friction holds everywhere; else with
/// the force of the load, and alike for loads and bodies that are mirrored.
#[test]
fn sides_in_space_that_do_not_match_have_friction() {
    let blocks = |joint: &str, pull: [f64; 2]| {
        format!(
            "dimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"low\"\nsize = [2, 1, 2]\n\
             elements = [6, 3, 6]\nsubdomains = [2, 1, 1]\nyoung = 1\npoisson = 0.3\n\
             dirichlet = {{ bottom = 0 }}\n[[body]]\nname = \"high\"\norigin = [0.5, 1, 0.5]\nsize = 1\n\
             elements = 4\nsubdomains = [2, 1, 1]\nyoung = 2\npoisson = 0.3\n\
             traction = {{ top = [{}, -0.1, {}] }}\n{joint}\nbodies = [\"low\", \"high\"]\n\
             multipliers = \"high\"\n",
            pull[0], pull[1]
        )
    };
    let held = solved(blocks("[[contact]]\nfriction = 1e3", [0.01, 0.0])).expect("a solution");
    let tied = solved(blocks("[[tie]]", [0.01, 0.0])).expect("a solution");
    assert!(held.converged() && tied.converged());
    assert_eq!(held.tangential_rows().len(), 50);
    near(held.energy, tied.energy, 1e-9, "tied");
    let mut energies = Vec::new();
    for pull in [[0.02, 0.01], [-0.02, 0.01], [0.02, -0.01]] {
        let slips = solved(blocks("[[contact]]\nfriction = 0.3", pull)).expect("it stands");
        assert!(slips.converged(), "{}", slips.status);
        let rows = slips.tangential_rows();
        for (axis, pull) in [0, 2].into_iter().zip(pull) {
            let drag: f64 = rows.iter().map(|r| r.multiplier * r.normal()[axis]).sum();
            near(drag.abs(), pull.abs(), 1e-7, "friction");
        }
        assert!(rows.iter().filter(|r| r.state == RowState::Slips).count() > 10);
        energies.push(slips.energy);
    }
    near(energies[0], energies[1], 1e-8, "mirrored");
    near(energies[0], energies[2], 1e-8, "mirrored");
    let error = solved(blocks("[[contact]]\nfriction = 0.2", [0.02, 0.01])).map(|s| s.status);
    let text = error.expect_err("it slides").to_string();
    assert!(text.contains("\"high\" is pushed away for ever"), "{text}");
}
