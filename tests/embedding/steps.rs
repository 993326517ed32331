//! The functions of wrappers/step/fetifeti_step.h from C: the load steps of the program, checkpoints of each other, and
//! mistakes.

use std::process::Command;

use crate::support::checks::number;
use crate::support::{mpi, plugin, program};
use mpi::{Output, Scratch};
use plugin::{library, step_library, Program};
use program::run_fetifeti;
use serde_json::Value;

/// Two blocks of height 1 that do not match, one above the other. The upper one is pressed down by 0.1 and pushed
/// aside by 0.05, in three steps that renew the contact; a rigid floor holds the lower one.
const BLOCKS: &str = r#"
title = "Two blocks"
physics = "elasticity"
[options]
fetifeti_ksp_rtol = 1e-11
[interface]
default = "free"
[[body]]
name = "low"
size = 1
elements = 4
subdomains = 2
young = 100
poisson = 0.3
dirichlet = { left = { x = 0 } }
[[body]]
name = "high"
origin = [0.1, 1]
size = 0.8
elements = 6
subdomains = 2
young = 100
poisson = 0
dirichlet = { top = { x = 0.05, y = -0.1 } }
[[contact]]
bodies = ["low", "high"]
[[obstacle]]
body = "low"
side = "bottom"
plane = { point = [0, 0], normal = [0, 1] }
[steps]
count = 3
dirichlet = "t"
update = true
"#;

/// The program of tests/plugin/steps.c, linked with both libraries.
fn client(scratch: &Scratch) -> Program {
    let headers = concat!("-I", env!("FETIFETI_ROOT"), "/wrappers/step");
    let options = [headers.to_string(), step_library()];
    Program::linked_with("mpicc", scratch, "tests/plugin/steps.c", &options)
}

/// What the client prints of a step.
#[derive(Debug)]
struct Told {
    step: usize,
    t: f64,
    energy: f64,
    iterations: f64,
    active: f64,
    force: f64,
    /// The lowest place of each body.
    lowest: Vec<f64>,
}

/// The words behind a name.
fn after<'a>(line: &'a str, name: &str) -> &'a str {
    let mut words = line.split(' ').skip_while(|w| *w != name);
    words.nth(1).unwrap_or_else(|| panic!("{name}: {line}"))
}

/// The steps of a run of the client that ends well.
fn told(out: &Output) -> Vec<Told> {
    assert_eq!(out.code, 0, "{}", out.all());
    assert!(out.stdout.trim_end().ends_with("ok"), "{}", out.all());
    assert!(!out.all().contains("bytes in"), "{}", out.all());
    let mut steps: Vec<Told> = Vec::new();
    for line in out.stdout.lines() {
        let number = |name: &str| after(line, name).parse::<f64>().expect("a number");
        if line.starts_with("step") {
            assert!(
                number("reason") > 0.0 && line.contains("CONVERGED"),
                "{line}"
            );
            assert!(number("rows") >= number("active"), "{line}");
            assert!(number("gap").abs() < 1.0, "{line}");
            steps.push(Told {
                step: number("step") as usize,
                t: number("t"),
                energy: number("energy"),
                iterations: number("iterations"),
                active: number("active"),
                force: number("force"),
                lowest: Vec::new(),
            });
        } else if line.starts_with("body") {
            let step = steps.last_mut().expect("a step");
            step.lowest.push(number("lowest"));
        }
    }
    steps
}

fn near(what: &str, a: f64, b: f64) {
    assert!(
        (a - b).abs() <= 1e-7 * b.abs().max(1e-3),
        "{what}: {a}, {b}"
    );
}

/// The load steps that the program reports.
fn of_program(ranks: usize, scene: &str, more: &[&str]) -> Vec<Value> {
    let out = run_fetifeti(ranks, &[&["solve", scene, "--json", "-"], more].concat());
    assert_eq!(out.code, 0, "{}", out.all());
    let report: Value = serde_json::from_str(&out.stdout).expect("a report");
    let steps = report["contact"]["load_steps"].as_array();
    steps.expect("load steps").clone()
}

/// The steps are those of the program, which has solved them all.
fn same(steps: &[Told], program: &[Value]) {
    for told in steps {
        let reported = &program[told.step];
        near("t", told.t, number(&reported["t"]));
        near("energy", told.energy, number(&reported["energy"]));
        near("active", told.active, number(&reported["active"]));
        near("force", told.force, number(&reported["contact_force"]));
    }
}

#[test]
fn load_steps_are_those_of_the_program() {
    let scratch = Scratch::new("steps");
    let client = client(&scratch);
    let blocks = scratch.file("blocks.toml", BLOCKS);
    let press = concat!(env!("FETIFETI_ROOT"), "/examples/scenes/press_ramp.toml");
    for (scene, n) in [(&blocks[..], 3), (press, 10)] {
        for ranks in [1, 2] {
            let steps = told(&client.run(ranks, &format!("-scene {scene} -malloc_dump")));
            let numbers: Vec<usize> = steps.iter().map(|s| s.step).collect();
            assert_eq!(numbers, (0..n).collect::<Vec<usize>>());
            let program = of_program(ranks, scene, &[]);
            same(&steps, &program);
            for (told, reported) in steps.iter().zip(&program) {
                let more = told.iterations - number(&reported["iterations"]);
                assert!(more.abs() <= 3.0, "{told:?}, {reported}");
            }
            if n == 3 {
                for step in &steps {
                    // The floor holds the lower block, and the upper one presses its top in.
                    near("floor", step.lowest[0], 0.0);
                    assert!(step.lowest[1] < 1.0 && step.lowest[1] > 0.9, "{step:?}");
                }
            }
        }
    }
}

/// A block that slips as a whole in the end: friction is μ N, and no node has more than μ of its force.
#[test]
fn friction_can_be_asked_for() {
    let scratch = Scratch::new("steps-friction");
    let headers = concat!("-I", env!("FETIFETI_ROOT"), "/wrappers/step");
    let options = [headers.to_string(), step_library()];
    let example = "examples/embedding/friction.c";
    let client = Program::linked_with("mpicc", &scratch, example, &options);
    let scene = concat!(
        env!("FETIFETI_ROOT"),
        "/examples/embedding/slipping_block.toml"
    );
    let program = of_program(1, scene, &[]);
    for ranks in [1, 2] {
        let out = client.run(ranks, &format!("-scene {scene} -fetifeti_ksp_rtol 1e-10"));
        assert_eq!(out.code, 0, "{}", out.all());
        let lines: Vec<&str> = out.stdout.lines().filter(|l| l.starts_with("t ")).collect();
        assert_eq!(lines.len(), program.len(), "{}", out.all());
        for (line, reported) in lines.iter().zip(&program) {
            let told = |name: &str| after(line, name).parse::<f64>().expect("a number");
            near("normal", told("normal"), 0.2);
            near("t", told("t"), number(&reported["t"]));
            let friction = number(&reported["friction"][0]).abs();
            assert!(
                (told("friction") - friction).abs() < 1e-7,
                "{line}, {reported}"
            );
            for (ours, theirs) in [("stick", "sticking"), ("slip", "slipping")] {
                assert_eq!(told(ours), number(&reported[theirs]), "{line}, {reported}");
            }
            assert!(told("ratio") < 0.3 + 1e-5, "{line}");
        }
        let first = after(lines[0], "friction")
            .parse::<f64>()
            .expect("a number");
        assert!(
            first < 0.05 && after(lines[0], "stick") != "0",
            "{}",
            lines[0]
        );
        let last = lines.last().expect("a line");
        assert_eq!(after(last, "stick"), "0");
        assert_eq!(after(last, "friction"), "0.06000000");
        // The top moves by 0.075 in a step, and the whole block with it.
        assert!((after(last, "slid").parse::<f64>().expect("a number") - 0.075).abs() < 1e-6);
    }
}

#[test]
fn a_scene_without_steps_has_one() {
    let scratch = Scratch::new("steps-one");
    let scene = concat!(env!("FETIFETI_ROOT"), "/examples/scenes/model_contact.toml");
    let steps = told(&client(&scratch).run(2, &format!("-scene {scene}")));
    assert_eq!((steps.len(), steps[0].step, steps[0].t), (1, 0, 1.0));
    // The load of the right body, -1/4, is carried by the contact alone.
    near("force", steps[0].force, 0.25);
}

#[test]
fn checkpoints_of_program_and_library_are_the_same() {
    let scratch = Scratch::new("steps-checkpoint");
    let client = client(&scratch);
    let scene = scratch.file("blocks.toml", BLOCKS);
    let whole = of_program(1, &scene, &[]);
    let (file, ours) = (scratch.path("state"), scratch.path("program"));
    let first = told(&client.run(1, &format!("-scene {scene} -checkpoint {file}")));
    assert_eq!(first.len(), 1);
    for ranks in [1, 2] {
        let rest = told(&client.run(ranks, &format!("-scene {scene} -resume {file}")));
        let numbers: Vec<usize> = rest.iter().map(|s| s.step).collect();
        assert_eq!(numbers, [1, 2]);
        same(&rest, &whole);
    }
    // The program goes on from there, and its report begins with the second step.
    let rest = of_program(2, &scene, &["--resume", &file, "--checkpoint", &ours]);
    assert_eq!(rest.len(), 2);
    for (resumed, before) in rest.iter().zip(&whole[1..]) {
        near(
            "energy",
            number(&resumed["energy"]),
            number(&before["energy"]),
        );
    }
    // Its own file stands in the last step.
    let last = told(&client.run(1, &format!("-scene {scene} -resume {ours}")));
    assert_eq!((last.len(), last[0].step), (1, 2));
    same(&last, &whole);
}

#[test]
fn mistakes_are_sentences() {
    let scratch = Scratch::new("steps-wrong");
    let client = client(&scratch);
    let scene = scratch.file("blocks.toml", BLOCKS);
    let refused = |ranks: usize, options: &str, sentence: &str| {
        let out = client.run(ranks, options);
        assert_ne!(out.code, 0, "{options}: {}", out.all());
        assert!(out.stderr.contains(sentence), "{options}: {}", out.all());
        assert!(!out.all().contains("Segmentation"), "{}", out.all());
    };
    for (wrong, sentence) in [
        (
            "null",
            "the FetiFetiStep is NULL, expected one from FetiFetiStepCreate",
        ),
        (
            "order",
            "no load step was solved yet, expected FetiFetiStepNext before",
        ),
        (
            "body",
            "there is no body 2, expected a number from 0 to below 2",
        ),
        ("room", "there is room for 1 displacements, expected 50"),
        (
            "late",
            "expected FetiFetiStepResume before FetiFetiStepNext",
        ),
    ] {
        refused(1, &format!("-scene {scene} -wrong {wrong}"), sentence);
    }
    let bad = scratch.file("bad.toml", &BLOCKS.replace("poisson = 0.3", "poison = 0.3"));
    refused(
        2,
        &format!("-scene {bad}"),
        "bad.toml:14: unknown key `poison`",
    );
    let nothing = scratch.path("nothing.toml");
    refused(
        2,
        &format!("-scene {nothing}"),
        "nothing.toml: the scene cannot be read",
    );
    let no_file = format!("-scene {scene} -resume {scene}");
    refused(2, &no_file, "blocks.toml: the file is no checkpoint");
    let few = format!("-scene {scene} -fetifeti_ksp_max_it 1");
    refused(2, &few, "load step 1 of 3 of ");
    refused(2, &few, "blocks.toml did not converge: DIVERGED_ITS");
    // A checkpoint of another scene.
    let file = scratch.path("state");
    told(&client.run(1, &format!("-scene {scene} -checkpoint {file}")));
    let softer = scratch.file(
        "softer.toml",
        &BLOCKS.replace("poisson = 0.3", "poisson = 0.2"),
    );
    let other = format!("-scene {softer} -resume {file}");
    refused(
        2,
        &other,
        "belongs to the scene \"Two blocks\" as it was before it changed",
    );
}

/// The solver inside has the functions of fetifeti.h, too. Programs that are linked with both libraries, or load both,
/// must get those of libfetifeti.so.
#[test]
fn the_library_shows_its_own_functions_alone() {
    let shown = |library: &str| -> Vec<String> {
        let out = Command::new("nm")
            .args(["-D", "--defined-only", library])
            .output();
        let out = String::from_utf8(out.expect("nm runs").stdout).expect("names");
        let names = out.lines().filter_map(|l| l.split_whitespace().last());
        names.map(String::from).collect()
    };
    let functions = shown(&step_library());
    let foreign = |name: &&String| !name.starts_with("FetiFetiStep");
    assert_eq!(functions.iter().find(foreign), None);
    let header = include_str!("../../wrappers/step/fetifeti_step.h");
    let named = header.matches("PETSC_EXTERN").count();
    assert_eq!(functions.len(), named);
    assert!(!shown(&library())
        .iter()
        .any(|f| f.starts_with("FetiFetiStep")));
}
