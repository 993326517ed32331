//! The functions of wrappers/fetifeti.h for friction and soft contact, from C and Fortran: against the values of
//! tests/data/friction.json, against closed forms, and mistakes.

use crate::support::checks::number;
use crate::support::sample::all_cases;
use crate::support::{mpi, plugin};
use mpi::{Output, Scratch};
use plugin::{number_after, Program};
use serde_json::Value;

const TIGHT: &str = "-fetifeti_ksp_rtol 1e-10";

/// The result of a load step that tests/plugin/friction.c prints.
struct Step {
    normal: f64,
    friction: Vec<f64>,
    /// Numbers of rows that are open, hold without friction, stick and slip.
    states: [f64; 4],
    slid: f64,
    /// Displacements of two corners.
    probes: [Vec<f64>; 2],
}

fn steps(out: &Output) -> Vec<Step> {
    let numbers = |line: &str, key: &str, n: usize| -> Vec<f64> {
        let mut words = line.split_whitespace().skip_while(|w| *w != key).skip(1);
        let mut next = || words.next().and_then(|w| w.parse().ok());
        (0..n).map(|_| next().expect("a number")).collect()
    };
    let lines: Vec<&str> = out.stdout.lines().collect();
    let found = lines.windows(3).filter(|w| w[0].starts_with("step "));
    let step = |w: &[&str]| Step {
        normal: numbers(w[0], "normal", 1)[0],
        friction: numbers(w[0], "friction", 3),
        states: ["open", "holds", "stick", "slip"].map(|key| numbers(w[0], key, 1)[0]),
        slid: numbers(w[0], "slid", 1)[0],
        probes: [numbers(w[1], "A", 3), numbers(w[2], "B", 3)],
    };
    found.map(step).collect()
}

fn near(a: f64, b: f64, size: f64, what: &str) {
    assert!((a - b).abs() <= size, "{what}: {a} and {b}");
}

fn solved(program: &Program, ranks: usize, options: &str) -> Vec<Step> {
    let out = program.run(ranks, &format!("{options} {TIGHT}"));
    assert_eq!(out.code, 0, "{options}, {ranks} ranks: {}", out.all());
    steps(&out)
}

fn client(scratch: &Scratch) -> Program {
    Program::linked("mpicc", scratch, "tests/plugin/friction.c")
}

/// Forces and displacements to 1e-5, states of all nodes, with rows along the axes and along turned ones.
#[test]
fn cases_have_the_values_of_the_oracle() {
    let oracle: Value = serde_json::from_str(include_str!("../data/friction.json")).expect("JSON");
    let scratch = Scratch::new("capi-friction");
    let program = client(&scratch);
    let push = "-top 0.02,-0.1 -friction 0.3";
    let two = "-cells 8,8 -top 0.01,-0.1 -friction 0.2 -second";
    let solid = "-dim 3 -cells 6,4,6 -edge 0.25 -top 0.015,-0.1,0.01 -friction 0.25";
    let cases = [
        ("push", push.to_string()),
        ("push", format!("{push} -turn 0.3")),
        ("tresca", "-top 0.02,-0.1 -tresca 0.025".into()),
        ("soft", "-top 0.01,-0.1 -friction 0.3 -stiffness 2".into()),
        (
            "cycle",
            "-top 0.024,-0.1 -friction 0.3 -loads 0.5,1,0.7,0.4".into(),
        ),
        (
            "cycle",
            "-top 0.024,-0.1 -friction 0.3 -loads 0.5,1,0.7,0.4 -manual".into(),
        ),
        ("two", format!("{two} pairs")),
        ("two", format!("{two} mortar -turn 0.4")),
        ("push_3d", format!("{solid} -turn 0.2")),
    ];
    for (k, (name, options)) in cases.iter().enumerate() {
        for ranks in [1, 2, 4] {
            if ranks != 1 + k % 2 && !all_cases() {
                continue;
            }
            let wanted = oracle[name]["steps"].as_array().expect("a list");
            let found = solved(&program, ranks, options);
            assert_eq!(found.len(), wanted.len(), "{options}");
            for (found, wanted) in found.iter().zip(wanted) {
                let normal = number(&wanted["normal"]);
                near(found.normal, normal, 1e-5 * normal, options);
                let tangential = wanted["tangential"].as_array().expect("a list");
                // The oracle leaves out the component along y, and gives the friction on the upper body.
                for (c, t) in [0, 2].into_iter().zip(tangential) {
                    near(
                        found.friction[c].abs(),
                        number(t).abs(),
                        1e-5 * normal,
                        options,
                    );
                }
                near(found.friction[1], 0.0, 1e-5 * normal, options);
                let states = [("open", 0), ("stick", 2), ("slip", 3)];
                for (key, state) in states {
                    assert_eq!(
                        found.states[state],
                        number(&wanted[key]),
                        "{options}: {key}"
                    );
                }
                for (name, u) in ["A", "B"].into_iter().zip(&found.probes) {
                    let probe = wanted["probes"][name].as_array();
                    for (u, v) in u.iter().zip(probe.into_iter().flatten()) {
                        near(*u, number(v), 1e-5 * 0.1, options);
                    }
                }
            }
        }
    }
}

/// Pairs, and mortars of surfaces that match, through a load cycle and in space; the forces have opposite first sides.
#[test]
fn mortars_are_pairs_where_nodes_match() {
    let scratch = Scratch::new("capi-friction-mortar");
    let program = client(&scratch);
    for options in [
        "-cells 8,8 -top 0.012,-0.1 -friction 0.2 -loads 0.5,1,0.3",
        "-dim 3 -cells 8,4,8 -top 0.01,-0.1,0.005 -friction 0.2",
        "-cells 8,8 -top 0.012,-0.1 -friction 0.4 -limit 0.018 -stiffness 20 -stick 30",
    ] {
        let pairs = solved(&program, 2, &format!("{options} -second pairs"));
        let mortar = solved(&program, 2, &format!("{options} -second mortar"));
        for (a, b) in pairs.iter().zip(&mortar) {
            near(a.normal, b.normal, 1e-8, options);
            near(a.slid, b.slid, 1e-7, options);
            assert_eq!(a.states, b.states, "{options}");
            assert!(a.states[3] > 0.0, "{options}: nothing slips");
            for c in 0..3 {
                near(a.friction[c], -b.friction[c], 1e-8, options);
                near(a.probes[0][c], b.probes[0][c], 1e-7, options);
            }
        }
    }
}

/// Surfaces that do not match: equilibrium, and at most the friction that the pressure allows.
#[test]
fn surfaces_that_do_not_match_have_friction() {
    let scratch = Scratch::new("capi-friction-coarse");
    let program = client(&scratch);
    let plane = "-edge 0.25 -cells 4,4 -top 0.01,-0.1 -second mortar -friction 0.2";
    let solid = "-dim 3 -edge 0.25 -cells 4,4,4 -top 0.01,-0.1 -second mortar -friction 0.2";
    for (ranks, options) in [(1, plane), (2, plane), (2, solid)] {
        let found = &solved(&program, ranks, options)[0];
        near(found.normal, 0.1, 1e-7, "normal");
        near(found.friction[0], 0.01, 1e-7, "friction");
        assert!(found.states[2] > 0.0 && found.states[3] > 0.0);
    }
}

/// A belt under a block that is held: all nodes slip, by μ λ against the way of the belt, and each by the whole way in
/// the second step.
#[test]
fn a_belt_drags() {
    let scratch = Scratch::new("capi-friction-belt");
    let found = solved(
        &client(&scratch),
        2,
        "-top 0,-0.1 -friction 0.3 -belt 0.5 -loads 1,1",
    );
    for step in &found {
        near(step.normal, 0.2, 1e-8, "normal");
        near(step.friction[0], -0.06, 1e-8, "friction");
        assert_eq!(step.states[2], 0.0);
    }
    near(found[1].slid, 17.0 * 0.5, 1e-7, "slid");
}

/// A surface that drags the one on it, which is held: friction is μ λ against its way, and in the second step each node
/// slips by the whole way. FetiFetiView counts them.
#[test]
fn a_surface_drags() {
    let scratch = Scratch::new("capi-friction-drag");
    let program = client(&scratch);
    for ranks in [1, 2] {
        let options = "-cells 8,8 -top 0,-0.1 -friction 0.2 -second mortar -belt 0.5 -loads 1,1";
        let out = program.run(ranks, &format!("{options} -view {TIGHT}"));
        assert_eq!(out.code, 0, "{}", out.all());
        let found = steps(&out);
        assert_eq!(found.len(), 2);
        for step in &found {
            near(step.normal, 0.1, 1e-8, "normal");
            near(step.friction[0], -0.02, 1e-8, "friction");
            assert_eq!(step.states[2], 0.0);
        }
        let slipping = found[1].states[3];
        near(found[1].slid, 0.5 * slipping, 1e-7, "slid");
        let line = format!("friction: 9 nodes, of which 0 stick and {slipping} slip");
        assert!(out.stdout.contains(&line), "{line}: {}", out.stdout);
    }
}

#[test]
fn mistakes_are_sentences() {
    let scratch = Scratch::new("capi-friction-wrong");
    let program = client(&scratch);
    let push = "-top 0.02,-0.1 -turn 0.3";
    let mortar = "-cells 8,8 -top 0.01,-0.1 -second mortar";
    for (options, sentence) in [
        (
            format!("{push} -friction -0.3"),
            "has a coefficient of friction of -0.3, expected a number that is not",
        ),
        (
            format!("{push} -friction 0.3 -limit -1"),
            "has a limit of friction of -0.0625",
        ),
        (
            format!("{push} -limit 1 -wrong limit"),
            "has a limit of friction without friction",
        ),
        (
            format!("{push} -friction 0.3 -tresca 1"),
            "has a Tresca bound beside a coefficient of friction",
        ),
        (
            format!("{push} -friction 0.3 -stiffness 0"),
            "has a contact stiffness of 0, expected a positive number",
        ),
        (
            format!("{push} -stick 1 -wrong stick"),
            "has a stick stiffness without friction",
        ),
        (
            format!("{push} -friction 0.3 -wrong tie"),
            "has friction and is an equation, expected an inequality",
        ),
        (
            format!("{push} -stiffness 2 -wrong soft_tie"),
            "has a contact stiffness and is an equation",
        ),
        (
            format!("{push} -friction 0.3 -wrong laws"),
            "laws, expected 9: as many as this rank gave rows",
        ),
        (
            format!("{push} -friction 0.3 -wrong directions"),
            "coefficients of different directions at its nodes",
        ),
        (
            format!("{push} -friction 0.3 -wrong blocks"),
            "has friction at nodes of 1 unknowns, expected 2 or 3",
        ),
        (
            format!("{push} -friction 0.3 -wrong dim"),
            "vectors at rows have 3 components, expected 2",
        ),
        (
            format!("{push} -friction 0.3 -wrong slip"),
            "has a slip of [0.0, NaN], expected a finite one",
        ),
        (
            format!("{push} -friction 0.3 -wrong order"),
            "nothing has been solved yet",
        ),
        (
            format!("{push} -friction 0.1"),
            "body \"0\" is pushed away for ever",
        ),
        (
            format!("{mortar} -friction -1"),
            "mortar 0 has a coefficient of friction of -1",
        ),
        (
            format!("{mortar} -limit 3"),
            "mortar 0 has a limit of friction without friction",
        ),
        (
            format!("{mortar} -friction 0.2 -tresca 1"),
            "mortar 0 has a Tresca bound beside",
        ),
        (
            format!("{mortar} -stiffness 0"),
            "mortar 0 has a contact stiffness of 0",
        ),
        (
            format!("{mortar} -friction 0.2 -wrong mortar_tie"),
            "mortar 0 has friction and is an equation",
        ),
        (
            format!("{mortar} -friction 0.2 -wrong ranks"),
            "ranks give mortar 0 different laws",
        ),
        (
            format!("{mortar} -friction 0.2 -wrong number"),
            "there is no mortar 3, expected one of 1",
        ),
        (
            format!("{mortar} -friction 0.2 -wrong mortar_slip"),
            "as many as this rank gave of surface 1",
        ),
    ] {
        let out = program.run(2, &options);
        assert_ne!(out.code, 0, "{options}: {}", out.all());
        assert!(out.stderr.contains(sentence), "{options}: {}", out.all());
        assert!(!out.all().contains("panicked"), "{options}: {}", out.all());
    }
}

/// Nodes on springs: sticking, slipping, back again, and Tresca's law with an elastic slip.
#[test]
fn springs_in_fortran() {
    let scratch = Scratch::new("capi-friction-fortran");
    let program = Program::fortran_with_module(&scratch, "tests/plugin/friction.F90");
    for ranks in [1, 2] {
        let out = program.run(ranks, "-fetifeti_ksp_rtol 1e-12");
        assert_eq!(out.code, 0, "{}", out.all());
        for (what, exact) in [
            ("slips: force ", 0.5),
            ("slips: slip ", 0.4),
            ("sticks: force ", -0.2),
            ("sticks: slip ", 0.0),
            ("elastic: force ", 0.8 / 3.0),
            ("mortar: shear ", 1.0),
            ("mortar: slip ", 0.4),
        ] {
            near(
                number_after(&out, what),
                exact,
                1e-8,
                &format!("{what}: {}", out.all()),
            );
        }
        for state in [
            "slips: state 3",
            "sticks: state 2",
            "elastic: state 2",
            "mortar: state 3 3",
        ] {
            let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(words(&out.stdout).contains(state), "{state}: {}", out.all());
        }
    }
}
