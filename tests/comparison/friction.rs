//! `fetifeti compare` on friction and soft contact: the loop of states is the same around every solver of equations, so
//! that all of them must find the forces and states of a refined direct solution.

use crate::support::compared::{solved, SceneFile};
use crate::support::program::fetifeti;
use report::json::CompareReport;
use serde_json::Value;

/// Compares with a solver that iterates and one that does not, on this many cores.
fn compared(name: &str, text: &str, cores: &str) -> CompareReport {
    let scene = SceneFile::new(name, text);
    let more = ["--with", "gamg,mumps", "-fetifeti_ksp_rtol", "1e-8"];
    scene.compare(&[&more[..], &["-compare_cores", cores]].concat())
}

/// States are equal, forces are those of the direct solution, and obey their laws.
fn check(report: &CompareReport, what: &str) {
    assert!(
        report.facts.reference_residual.expect(what) < 1e-11,
        "{what}"
    );
    let direct = report.facts.contact.expect("inequalities");
    assert!(direct.law.expect("laws") < 1e-9, "{what}: {direct:?}");
    let methods: Vec<&str> = report.rows.iter().map(|r| r.run.method.as_str()).collect();
    assert!(methods.ends_with(&["gamg", "mumps"]) && methods[0] == "fetifeti");
    for row in report.rows.iter().filter(|r| solved(r)) {
        let what = format!("{what}: {row:?}");
        let contact = row.run.contact.expect("what became of the inequalities");
        assert_eq!(contact.differ, Some(0), "{what}");
        assert!(contact.forces.expect("forces") < 1e-5, "{what}");
        assert!(contact.law.expect("laws") < 1e-5, "{what}");
        assert!(row.run.error.expect("an error") < 1e-6, "{what}");
        assert!(contact.outer.is_some(), "{what}");
    }
}

/// Their values are those of `solve`: tests/contact/friction.rs.
#[test]
fn methods_agree_on_the_cases_of_the_oracle() {
    let text = include_str!("../data/friction.json");
    let cases: serde_json::Map<String, Value> = serde_json::from_str(text).expect("JSON");
    let mut seen = 0;
    for (name, case) in cases {
        if case["steps"].as_array().expect("a list").len() > 1 {
            continue;
        }
        let scene = format!(
            "title = \"{name}\"\n{}",
            case["scene"].as_str().expect("a text")
        );
        for cores in ["1", "2"] {
            check(
                &compared(&name, &scene, cores),
                &format!("{name}, {cores} cores"),
            );
        }
        seen += 1;
    }
    assert_eq!(seen, 6);
}

/// A block that is pressed on another one across a gap, and pushed and turned: nodes slip in many directions. `shape`
/// keys turn the face between them.
fn blocks(shape: &str, laws: &str) -> String {
    format!(
        "title = \"blocks\"\ndimension = 3\nphysics = \"elasticity\"\n\
         [[body]]\nname = \"low\"\nsize = [2, 1, 2]\nelements = [4, 2, 4]\nsubdomains = [2, 1, 1]\nyoung = 1\n\
         poisson = 0.3\ndirichlet = [\"bottom\"]\n{shape}\n\
         [[body]]\nname = \"high\"\norigin = [0, 1, 0]\nsize = [2, 1, 2]\nelements = [4, 2, 4]\n\
         subdomains = [1, 1, 2]\nyoung = 2\npoisson = 0.3\n{shape}\n\
         traction = {{ top = [\"0.01 - 0.012*(z - 1)\", -0.1, \"0.005 + 0.012*(x - 1)\"] }}\n\
         [[contact]]\nbodies = [\"high\", \"low\"]\n{laws}\n"
    )
}

const FLAT: &str = "";
/// Its normals lie in no axis.
const SLOPE: &str = "shape = { y = \"y + (0.1*x + 0.05*z)*y*(2 - y)\" }";

#[test]
fn methods_agree_in_space() {
    let hard = "gap = \"0.005*(x + z)\"\nfriction = 0.25";
    let soft = "gap = \"0.005*(x + z)\"\nfriction = 0.25\nstiffness = 3\nstick_stiffness = 2";
    for (name, scene) in [
        ("hard", blocks(FLAT, hard)),
        ("sloping", blocks(SLOPE, hard)),
        ("soft", blocks(FLAT, soft)),
        ("tresca", blocks(FLAT, "tresca = 0.02")),
    ] {
        for cores in ["1", "2"] {
            let what = format!("{name}, {cores} cores");
            check(&compared(name, &scene, cores), &what);
        }
    }
}

#[test]
fn elastic_slip_and_sides_that_do_not_match_in_the_plane() {
    let plates = |laws: &str| {
        format!(
            "title = \"plates\"\nphysics = \"elasticity\"\n\
             [[body]]\nname = \"low\"\nsize = [2, 1]\nelements = [16, 8]\nsubdomains = [4, 2]\nyoung = 1\n\
             poisson = 0.3\ndirichlet = [\"bottom\"]\n\
             [[body]]\nname = \"high\"\norigin = [0.5, 1]\nsize = [1, 1]\nelements = [12, 8]\nsubdomains = [2, 2]\n\
             young = 2\npoisson = 0.2\ntraction = {{ top = [0.015, -0.1] }}\n\
             [[contact]]\nbodies = [\"high\", \"low\"]\nfriction = 0.25\n{laws}\n"
        )
    };
    for (name, laws) in [
        ("plates", ""),
        ("elastic", "stick_stiffness = 1.5\nstiffness = 4"),
    ] {
        check(&compared(name, &plates(laws), "2"), name);
    }
}

/// Each load step begins where the method's own one before has ended: all of them are right, and so is their sum.
fn check_load_steps(name: &str, text: &str, n: usize) {
    for cores in ["1", "2"] {
        let what = format!("{name}, {cores} cores");
        let report = compared(name, text, cores);
        check(&report, &what);
        let facts = report.facts.contact.expect("inequalities");
        assert_eq!((facts.load_steps, facts.solved), (n, n), "{what}");
        for row in report.rows.iter().filter(|r| solved(r)) {
            let what = format!("{what}: {row:?}");
            let steps = &row.run.load_steps;
            assert_eq!(steps.len(), n, "{what}");
            let total = row.run.contact.expect("what became of the inequalities");
            assert_eq!(total.outer, steps.iter().map(|s| s.contact.outer).sum());
            assert_eq!(row.run.iterations, steps.iter().map(|s| s.iterations).sum());
            assert!(row.run.from_ours.expect("a distance") < 1e-6, "{what}");
            for step in steps {
                assert_eq!(step.contact.differ, Some(0), "{what}");
                assert!(step.contact.forces.expect("forces") < 1e-5, "{what}");
                assert!(step.contact.law.expect("laws") < 1e-5, "{what}");
                assert!(step.error.expect("an error") < 1e-6, "{what}");
                assert!(step.residual.expect("a residual") < 1e-8, "{what}");
            }
        }
    }
}

#[test]
fn methods_agree_in_load_cycles() {
    let text = include_str!("../data/friction.json");
    let cases: Value = serde_json::from_str(text).expect("JSON");
    let cycle = cases["cycle"]["scene"].as_str().expect("a text");
    check_load_steps("cycle", &format!("title = \"cycle\"\n{cycle}"), 4);
    let steps = "[steps]\ntimes = [1, 2, 3]\nload = \"if(t < 2.5, 1 - 0.6*(t - 1), 0.8)\"\n";
    let laws = "gap = \"0.005*(x + z)\"\nfriction = 0.25\nstick_stiffness = 2";
    let text = blocks(FLAT, &format!("{laws}\n{steps}"));
    check_load_steps("cycle in space", &text, 3);
}

/// A plane drags the block on it to the right, to the left and lifts off its left part.
#[test]
fn methods_agree_on_an_obstacle_that_drags() {
    let text = "title = \"plane\"\nphysics = \"elasticity\"\n\
                [[body]]\nname = \"block\"\nsize = [2, 1]\nelements = [8, 4]\nsubdomains = [2, 1]\n\
                young = 1\npoisson = 0.3\ndirichlet = { top = { x = 0, y = \"-0.02 - 0.01*x\" } }\n\
                [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\nfriction = 0.3\n\
                plane = { point = [0, 0], normal = [0, 1] }\nmove = [0.02, 0.002]\n\
                [steps]\ntimes = [1, 2, 3, 4]\ngap = \"if(t < 3, t/2, 2.2 - t/2)\"\n";
    check_load_steps("plane", text, 4);
}

#[test]
fn what_is_not_compared_is_said() {
    let text = include_str!("../data/friction.json");
    let cases: Value = serde_json::from_str(text).expect("JSON");
    let cycle = cases["cycle"]["scene"].as_str().expect("a text");
    let cycle = SceneFile::new("renewed", &format!("{cycle}\nupdate = true\n"));
    let output = fetifeti(&["compare", cycle.path()]);
    assert_eq!(output.code, 2);
    let expected = "has `update` in [steps]";
    assert!(output.stderr.contains(expected), "{}", output.stderr);
    let push = SceneFile::new("push", cases["push"]["scene"].as_str().expect("a text"));
    let report = push.compare(&["--with", "bddc"]);
    let message = report.rows.last().and_then(|r| r.run.message.clone());
    let message = message.expect("a sentence");
    assert!(message.contains("no forces of friction"), "{message}");
}
