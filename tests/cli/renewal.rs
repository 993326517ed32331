//! `[steps] update = true`: contacts that are renewed at each load step.

use super::checkpoint::solve;
use crate::support::checks::number;
use crate::support::{mpi, program};
use std::fs;
use std::path::Path;

use mpi::{Output, Scratch};
use program::{fetifeti, run_fetifeti, PATH};
use scene::checkpoint::{file::read, NoRecords};
use serde_json::Value;

pub(super) fn run(name: &str, scene: &str, ranks: usize, more: &[&str]) -> (Output, Option<Value>) {
    let scratch = Scratch::new(&format!("renewal-{name}-{ranks}"));
    let file = scratch.path("s.toml");
    fs::write(&file, scene).expect("a scene is written");
    let json = scratch.path("r.json");
    let out = run_fetifeti(
        ranks,
        &[
            &[
                "solve",
                &file,
                "--json",
                &json,
                "-fetifeti_ksp_rtol",
                "1e-10",
            ],
            more,
        ]
        .concat(),
    );
    let report = fs::read_to_string(&json).ok();
    (out, report.map(|r| serde_json::from_str(&r).expect("JSON")))
}

fn solved(name: &str, scene: &str, ranks: usize) -> Value {
    let (out, report) = run(name, scene, ranks, &[]);
    assert_eq!(out.code, 0, "{name}: {}", out.all());
    report.expect("a report")
}

pub(super) fn interface(report: &Value, k: usize, key: &str) -> f64 {
    number(&report["contact"]["interfaces"][k][key])
}

/// u of a probe.
pub(super) fn probe(report: &Value, k: usize) -> Vec<f64> {
    let u = report["probes"][k]["u"].as_array().expect("a displacement");
    u.iter().map(number).collect()
}

pub(super) fn near(what: &str, found: f64, expected: f64, tolerance: f64) {
    let near = (found - expected).abs() <= tolerance * expected.abs().max(1e-300);
    assert!(near, "{what}: {found} and not {expected}");
}

/// A block of `n` elements across, at `x` on a layer of 24 elements, that is pushed by `push` in 5 steps. The layer is
/// as soft as the block, or a million times stiffer.
pub(super) fn blocks(x: f64, push: f64, n: usize, stiff: bool, steps: &str) -> String {
    let young = if stiff { 1e8 } else { 1e3 };
    format!(
        "title = \"blocks\"\nphysics = \"elasticity\"\n[[body]]\nname = \"low\"\nsize = [6, 1]\nelements = [24, 4]\n\
         subdomains = [6, 1]\nyoung = {young}\npoisson = 0\ndirichlet = [\"bottom\"]\n\
         [[body]]\nname = \"high\"\norigin = [{x}, 1]\nsize = [1, 1]\nelements = [{n}, 4]\nsubdomains = [2, 2]\n\
         young = 1000\npoisson = 0\ndirichlet = {{ left = {{ x = {push} }} }}\ntraction = {{ top = [0, -0.1] }}\n\
         [[contact]]\nbodies = [\"high\", \"low\"]\nsides = [\"bottom\", \"top\"]\n\
         [[probe]]\nname = \"far\"\nbody = \"low\"\npoint = [4.5, 1]\n\
         [[probe]]\nname = \"near\"\nbody = \"low\"\npoint = [1.5, 1]\n{steps}"
    )
}

pub(super) const UPDATE: &str = "[steps]\ncount = 5\ndirichlet = \"t\"\nupdate = true\n";

#[test]
fn a_block_keeps_its_uniform_pressure_wherever_it_is_pushed() {
    // With 6 elements nodes match nowhere; with 4 they match at the start, and not at 1.15 + 3/5.
    for (n, x) in [(6, 1.1), (4, 1.0)] {
        let report = solved("uniform", &blocks(x, 3.15, n, true, UPDATE), 2);
        near("force", interface(&report, 0, "force"), 0.1, 1e-8);
        near("area", interface(&report, 0, "area"), 1.0, 1e-6);
        near("pressure", interface(&report, 0, "max_pressure"), 0.1, 1e-4);
        let steps = report["contact"]["load_steps"].as_array().expect("steps");
        for step in steps {
            near("sliding", number(&step["largest_sliding"]), 0.63, 1e-4);
        }
        // The first step has the rows of the scene.
        assert!(steps[0].get("factored").is_none() && steps[1]["factored"].is_u64());
    }
}

#[test]
fn the_layer_bends_where_the_block_is() {
    // In the last step the block rests, so that the pairing is that of its place. The same block that is there from the
    // beginning:
    let there = solved("there", &blocks(4.1, 0.0, 6, false, ""), 1);
    let rest =
        "[steps]\ntimes = [0.2, 0.4, 0.6, 0.8, 1, 2]\ndirichlet = \"min(t, 1)\"\nupdate = true\n";
    let pushed = solved("pushed", &blocks(1.1, 3.0, 6, false, rest), 1);
    let without = rest.replace("update = true\n", "");
    let left = solved("left", &blocks(1.1, 3.0, 6, false, &without), 1);
    let depth = |report: &Value, k: usize| probe(report, k)[1];
    // Strains of 1e-4 are what the two problems differ by.
    near("far", depth(&pushed, 0), depth(&there, 0), 1e-3);
    let pressure = |report: &Value| interface(report, 0, "max_pressure");
    near("pressure", pressure(&pushed), pressure(&there), 1e-2);
    assert!(depth(&there, 0) < -5e-5 && depth(&there, 1).abs() < 1e-5);
    assert!(depth(&pushed, 1).abs() < 1e-5);
    // Without renewal it bends where the block was.
    assert!(depth(&left, 0).abs() < 1e-5 && depth(&left, 1) < -5e-5);
}

/// A stiff block whose left lower corner lies on top of a disc of radius 2 and is pushed along x by 1 in `n` steps.
fn on_a_disc(n: usize) -> String {
    format!(
        "title = \"disc\"\nphysics = \"elasticity\"\n[[body]]\nname = \"block\"\norigin = [0, 2]\nsize = [1, 1]\n\
         elements = [4, 4]\nsubdomains = [2, 2]\nyoung = 1e7\npoisson = 0\n\
         dirichlet = {{ left = {{ x = 1 }}, right = {{ x = 1 }} }}\ntraction = {{ top = [0, -1] }}\n\
         [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\ncylinder = {{ centre = [0, 0], radius = 2 }}\n\
         [[probe]]\nname = \"corner\"\npoint = [0, 2]\n\
         [steps]\ncount = {n}\ndirichlet = \"t\"\nupdate = true\n"
    )
}

#[test]
fn a_block_follows_a_circle_at_second_order() {
    // The corner is at (1, √3) in the end.
    let errors = [4, 8, 16].map(|n| {
        let report = solved(&format!("disc{n}"), &on_a_disc(n), 1);
        let u = probe(&report, 0);
        near("x", u[0], 1.0, 1e-9);
        (2.0 + u[1] - 3.0_f64.sqrt()).abs()
    });
    assert!(errors[0] < 0.03, "{errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.0..6.0).contains(&ratio), "{errors:?}");
    }
}

#[test]
fn without_sliding_nothing_changes() {
    let without = "[steps]\ncount = 3\nload = \"t\"\n";
    let with = format!("{without}update = true\n");
    // Nodes that match, nodes that do not, and an obstacle.
    let disc = |steps: &str| {
        let scene = on_a_disc(1).replace("x = 1 ", "x = 0 ");
        let at = scene.find("[steps]").expect("steps");
        format!("{}{steps}", &scene[..at])
    };
    let scenes = |steps: &str| {
        [
            blocks(1.0, 0.0, 4, false, steps),
            blocks(1.1, 0.0, 6, false, steps),
            disc(steps),
        ]
    };
    for (k, (a, b)) in scenes(without).iter().zip(&scenes(&with)).enumerate() {
        let [a, b] = [a, b].map(|scene| solved(&format!("still{k}"), scene, 1));
        // Strains of 1e-4 move nodes by as much.
        for key in ["force", "max_pressure"] {
            near(key, interface(&b, 0, key), interface(&a, 0, key), 2e-3);
        }
        near("energy", number(&b["energy"]), number(&a["energy"]), 1e-3);
    }
    // One step is the scene without `update`.
    for scene in scenes("[steps]\ncount = 1\n") {
        let [a, b] =
            ["", "update = true\n"].map(|more| solved("one", &format!("{scene}{more}"), 1));
        near("energy", number(&b["energy"]), number(&a["energy"]), 1e-12);
    }
}

#[test]
fn all_ranks_give_the_same() {
    let scene = blocks(1.1, 3.15, 6, false, UPDATE);
    let scratch = Scratch::new("renewal-events");
    let [one, two, four] = [1, 2, 4].map(|ranks| {
        let events = scratch.path(&format!("{ranks}.jsonl"));
        let (out, report) = run("ranks", &scene, ranks, &["--events", &events]);
        assert_eq!(out.code, 0, "{}", out.all());
        let report = report.expect("a report");
        let lines = fs::read_to_string(events).expect("a line for each step");
        let lines = lines
            .lines()
            .map(|l| serde_json::from_str(l).expect("JSON"));
        let steps = Value::Array(lines.collect());
        assert_eq!(steps, report["contact"]["steps"]);
        report
    });
    for other in [two, four] {
        for key in ["force", "max_pressure", "area", "largest_sliding"] {
            near(
                key,
                interface(&other, 0, key),
                interface(&one, 0, key),
                1e-6,
            );
        }
        // Energies are differences of those of a displacement by 3, with strains of 1e-4.
        let energy = |r: &Value| number(&r["energy"]);
        assert!(
            (energy(&other) - energy(&one)).abs() < 1e-10,
            "{} {}",
            energy(&other),
            energy(&one)
        );
        for k in 0..5 {
            let active = |r: &Value| r["contact"]["load_steps"][k]["active"].clone();
            assert_eq!(active(&other), active(&one));
        }
    }
}

#[test]
fn blocks_in_space_slide_with_surfaces_and_from_all() {
    // A block on a plate, in space, pushed along both axes by a multiple of its faces; nodes match at the start. The
    // contact is that of bodies that touch, or of all sides that are near.
    let scene = |contact: &str| {
        format!(
            "title = \"space\"\ndimension = 3\nphysics = \"elasticity\"\n[[body]]\nname = \"low\"\nsize = [3, 1, 3]\n\
             elements = [6, 2, 6]\nsubdomains = [2, 1, 2]\nyoung = 1e6\npoisson = 0\ndirichlet = [\"bottom\"]\n\
             [[body]]\nname = \"high\"\norigin = [0.5, 1, 0.5]\nsize = [1, 1, 1]\nelements = [2, 2, 2]\nyoung = 100\n\
             poisson = 0\ndirichlet = {{ left = {{ x = 0.7 }}, back = {{ z = 1.1 }} }}\n\
             traction = {{ top = [0, -0.1, 0] }}\n[steps]\ncount = 3\ndirichlet = \"t\"\nupdate = true\n{contact}"
        )
    };
    for (contact, tolerance) in [
        // The plate carries the multipliers, of which some lie beyond the block.
        ("[[contact]]\nbodies = [\"low\", \"high\"]\n", 2e-2),
        ("[contact]\nauto = true\n", 1e-3),
    ] {
        let report = solved("space", &scene(contact), 2);
        near("force", interface(&report, 0, "force"), 0.1, 1e-7);
        near(
            "pressure",
            interface(&report, 0, "max_pressure"),
            0.1,
            tolerance,
        );
        let sliding = interface(&report, 0, "largest_sliding");
        near("sliding", sliding, 0.7_f64.hypot(1.1) / 3.0, 1e-3);
    }
}

#[test]
fn every_rank_may_write_its_own_pieces() {
    let scratch = Scratch::new("renewal-pieces");
    let dir = scratch.path("out");
    let scene = blocks(1.1, 3.15, 6, true, UPDATE);
    let (out, _) = run("pieces", &scene, 2, &["--pieces", "--out", &dir]);
    assert_eq!(out.code, 0, "{}", out.all());
    let series = fs::read_to_string(format!("{dir}/solution.pvd")).expect("a series");
    assert_eq!(series.matches("step_000").count(), 5, "{series}");
}

#[test]
fn what_cannot_be_renewed_is_refused() {
    let scene = blocks(1.1, 3.15, 6, true, UPDATE);
    let cases = [
        (
            blocks(1.0, 3.15, 4, true, UPDATE)
                .replace("sides = [\"bottom\", \"top\"]", "range = [0, 0.5]"),
            "the common face changes when bodies slide",
        ),
        (
            scene.replace("update = true", "update = 1"),
            "true or false was expected",
        ),
        (
            "[steps]\ncount = 2\nupdate = true\n[[body]]\nsize = [1, 1]\nelements = 4\nload = -1\n\
             dirichlet = [\"left\"]\n\
             [[obstacle]]\nbody = \"all\"\nside = \"top\"\nbelow = -0.1\n"
                .into(),
            "a scalar scene, in which nothing moves",
        ),
    ];
    for (text, message) in cases {
        let (out, _) = run("refused", &text, 1, &[]);
        assert_eq!(out.code, 2, "{message}: {}", out.all());
        assert!(out.stderr.contains(message), "{message}: {}", out.stderr);
    }
}

/// A checkpoint has the displacements from which the contacts of its load step follow.
#[test]
fn an_interrupted_run_goes_on_with_the_contacts_of_its_step() {
    let scratch = Scratch::new("renewal-resumed");
    let scene = scratch.file("s.toml", &blocks(1.1, 3.15, 6, false, UPDATE));
    let (file, end) = (scratch.path("c"), scratch.path("e"));
    let tight = ["-fetifeti_ksp_rtol", "1e-10"];
    let whole = solve(1, &scene, 0, &tight);
    let mut child = std::process::Command::new(PATH)
        .args(["solve", &scene, "--quiet", "--checkpoint", &file])
        .args(tight)
        .spawn()
        .expect("the program starts");
    let at = || read::<NoRecords>(Path::new(&file)).map_or(0, |c| c.stepper.load_step);
    while at() < 2 && child.try_wait().expect("it can be asked").is_none() {
        std::thread::yield_now();
    }
    let _ = child.kill();
    child.wait().expect("it ends");
    assert!((2..5).contains(&at()), "load step {}", at());
    let energies = |report: &Value| -> Vec<f64> {
        let steps = report["contact"]["load_steps"].as_array();
        let steps = steps.expect("load steps").iter();
        steps.map(|s| number(&s["energy"])).collect()
    };
    // The end of the second run is in the last load step.
    for (ranks, from) in [(1, &file), (2, &file), (2, &end)] {
        let files = ["--resume", from, "--checkpoint", &end];
        let resumed = solve(ranks, &scene, 0, &[&files[..], &tight].concat());
        let (a, b) = (energies(&resumed), energies(&whole));
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            // The block moves so far that rounding of its rigid motion is a part of 10⁻⁶.
            near("energy", *a, *b, 1e-5);
        }
        near("depth", probe(&resumed, 0)[1], probe(&whole, 0)[1], 1e-7);
        assert_eq!(
            read::<NoRecords>(Path::new(&end))
                .expect("a checkpoint")
                .stepper
                .load_step,
            4
        );
    }
}

#[test]
fn plan_says_what_is_renewed() {
    let scratch = Scratch::new("renewal-plan");
    let file = scratch.path("s.toml");
    fs::write(&file, blocks(1.1, 3.15, 6, true, UPDATE)).expect("a scene is written");
    let out = fetifeti(&["plan", &file]);
    assert_eq!(out.code, 0, "{}", out.all());
    let said = "normals, pairing and gaps of 1 contact pairs and 0 obstacles";
    assert!(out.stdout.contains(said), "{}", out.stdout);
}

#[test]
fn the_dent_goes_along_with_the_punch_of_the_example() {
    let text = fs::read_to_string("../../examples/scenes/sliding_punch.toml").expect("the example");
    let probes = "[[probe]]\nname = \"there\"\nbody = \"layer\"\npoint = [4.05, 1]\n\
                  [[probe]]\nname = \"here\"\nbody = \"layer\"\npoint = [1.25, 1]\n";
    let report = solved("punch", &format!("{text}{probes}"), 2);
    let resultant = &report["contact"]["interfaces"][0]["resultant"];
    near("resultant", number(&resultant[1]), -0.05, 1e-6);
    let (there, here) = (probe(&report, 0)[1], probe(&report, 1)[1]);
    assert!(
        there < -0.01 && here.abs() < 0.1 * there.abs(),
        "{there} {here}"
    );
}

#[test]
fn a_body_that_is_pushed_off_is_told_with_its_load_step() {
    let scene = blocks(1.1, 40.0, 6, true, UPDATE);
    let (out, _) = run("off", &scene, 1, &[]);
    assert_eq!(out.code, 2, "{}", out.all());
    for part in ["load step 2, with contacts", "`high`", "held by nothing"] {
        let part = part.replace('`', "\"");
        assert!(out.stderr.contains(&part), "{part}: {}", out.stderr);
    }
}
