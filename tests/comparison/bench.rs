//! `fetifeti bench` from the outside: every method runs in every round, and the statistics follow from the samples. No
//! test depends on how long something took.

use std::path::Path;

use crate::support::keys::{self, Keys};
use crate::support::sample::of;
use crate::support::{mpi, program};
use mpi::Scratch;
use program::fetifeti;
use report::json::{BenchCase, BenchReport, BenchRow, BenchSample, Spread};

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "schema version blas cores rounds quick cases"),
    ("cases[]", "case scene bodies subdomains dofs rtol rounds reference_residual methods"),
    ("cases[].contact", "rows active outer feasibility min_multiplier load_steps"),
    (
        "cases[].methods[]",
        "method layout options subdomains ranks threads kappa iterations seconds ratio memory_mb \
         memory_at_start_mb error residual rtol converged converged_reason samples",
    ),
    ("cases[].methods[].contact", "outer active differ feasibility min_multiplier"),
    ("cases[].methods[].seconds", "assemble setup solve recover total again step"),
    ("cases[].methods[].seconds.assemble", "median min max"),
    ("cases[].methods[].seconds.setup", "median min max"),
    ("cases[].methods[].seconds.solve", "median min max"),
    ("cases[].methods[].seconds.total", "median min max"),
    ("cases[].methods[].seconds.again", "median min max"),
    ("cases[].methods[].memory_mb", "median min max"),
    ("cases[].methods[].memory_at_start_mb", "median min max"),
    (
        "cases[].methods[].samples[]",
        "round sequence converged assemble setup solve recover total again iterations outer memory_mb \
         memory_at_start_mb",
    ),
];

/// Four bodies of two subdomains, tied, no symmetry.
const TIED: &str = "title = \"four bodies\"\n[grid]\nbodies = 2\nsubdomains = [2, 1]\nelements_per_subdomain = 4\n\
                    load = \"1 + x\"\ndirichlet = [\"left\"]\n";

/// The model contact problem on few elements.
const CONTACT: &str = "title = \"model\"\n\
    [[body]]\nname = \"left\"\nsize = [1, 1]\nelements = 8\nsubdomains = 2\n\
    dirichlet = [\"left\"]\nload = [{ y = [0.75, 1], value = -3 }]\n\
    [[body]]\nname = \"right\"\norigin = [1, 0]\nsize = [1, 1]\n\
    elements = 8\nsubdomains = 2\nload = [{ y = [0, 0.25], value = -1 }]\n\
    [[contact]]\nbodies = [\"left\", \"right\"]\n";

fn bench(args: &[&str]) -> BenchReport {
    let all = [&["bench"], args, &["--json", "-", "-compare_cores", "2"]].concat();
    let run = fetifeti(&all);
    assert_eq!(run.code, 0, "{}", run.all());
    let report: BenchReport = keys::read(&run.stdout, KEYS);
    assert_eq!(report.schema, "fetifeti.bench/1");
    report
}

/// Whether a row has a solution. Ours must have one; another method may give a reason instead, and then has no times to
/// compare.
fn solved(row: &BenchRow) -> bool {
    let what = format!("{} {}: {row:?}", row.run.method, row.run.layout);
    let Some(message) = &row.run.message else {
        assert!(row.run.converged, "{what}");
        return true;
    };
    assert!(!row.run.is_ours() && !row.run.converged, "{what}");
    assert!(!message.trim().is_empty(), "{what}");
    assert!(row.ratio.is_none(), "{what}");
    println!("{}: {message}", row.run.method);
    false
}

/// Properties of every case.
fn check(case: &BenchCase, rounds: usize) {
    assert_eq!(case.rounds, rounds);
    assert!(case.facts.reference_residual.expect("a direct solution") < 1e-10);
    for row in case.methods.iter().filter(|r| solved(r)) {
        let what = format!("{} {}: {row:?}", row.run.method, row.run.layout);
        assert!(row.run.error.expect("an error") < 1e-4, "{what}");
        assert!(
            row.run.residual.expect("a residual") <= case.facts.rtol,
            "{what}"
        );
        assert_eq!(row.samples.len(), rounds, "{what}");
        for (round, sample) in (1..).zip(&row.samples) {
            assert!(sample.converged && sample.round == round, "{what}");
            let s = sample.seconds;
            let [setup, solve, total] = [s.setup, s.solve, s.total].map(|s| s.expect("seconds"));
            // Reading JSON may change the last digit.
            assert!((setup + solve - total).abs() <= 1e-14 * total);
            assert!(sample.recover.is_none_or(|r| r <= solve), "{what}");
            assert_eq!(sample.recover.is_some(), row.run.is_ours(), "{what}");
        }
        let phases = row.seconds.phases;
        let seconds = [
            (phases.setup, (|s| s.seconds.setup) as fn(&BenchSample) -> _),
            (phases.solve, |s| s.seconds.solve),
            (phases.total, |s| s.seconds.total),
            (row.seconds.again, |s| s.again),
            (row.memory_mb, |s| s.memory_mb),
        ];
        for (spread, of) in seconds {
            let spread = spread.unwrap_or_else(|| panic!("a spread: {what}"));
            between(spread, row.samples.iter().filter_map(of).collect(), rounds);
        }
    }
    interleaved(case, rounds);
    let ours = case.fastest(true).expect("one of ours");
    assert_eq!(ours.ratio, Some(1.0));
}

/// The smallest and the largest value are samples, and half of all samples are on either side of the median.
fn between(spread: Spread, samples: Vec<f64>, rounds: usize) {
    let Spread { median, min, max } = spread;
    assert_eq!(samples.len(), rounds);
    assert!(min <= median && median <= max, "{spread:?}");
    assert!(samples.contains(&min) && samples.contains(&max));
    let below = samples.iter().filter(|s| **s <= median).count();
    let above = samples.iter().filter(|s| **s >= median).count();
    assert!(
        2 * below >= rounds && 2 * above >= rounds,
        "{spread:?} {samples:?}"
    );
}

/// The methods took turns: sorted by their position, rounds follow each other, and each round has the methods in order,
/// except for those that failed before. A method that was not run has no position.
fn interleaved(case: &BenchCase, rounds: usize) {
    let mut runs: Vec<(usize, usize, usize)> = Vec::new();
    for (k, row) in case.methods.iter().enumerate() {
        runs.extend(row.samples.iter().map(|s| (s.sequence, s.round, k)));
    }
    runs.sort_unstable();
    let mut expected = Vec::new();
    for round in 1..=rounds {
        for (k, row) in case.methods.iter().enumerate() {
            if row.samples[..round - 1].iter().all(|s| s.converged) {
                expected.push((expected.len() + 1, round, k));
            }
        }
    }
    assert_eq!(runs, expected);
}

fn names(rows: &[BenchRow]) -> Vec<(&str, &str, usize)> {
    rows.iter()
        .map(|r| (r.run.method.as_str(), r.run.layout.as_str(), r.run.ranks))
        .collect()
}

#[test]
fn every_method_runs_in_every_round() {
    let dir = Scratch::new("bench-tied");
    let scene = dir.file("four.toml", TIED);
    let out = dir.path("out");
    let rounds = of(1, 2);
    let report = bench(&[
        &scene,
        "--rounds",
        &rounds.to_string(),
        "--out",
        &out,
        "--quiet",
    ]);
    assert_eq!(
        (report.cores, report.rounds, report.quick),
        (2, rounds, false)
    );
    let [case] = &report.cases[..] else {
        panic!("one case")
    };
    assert_eq!(
        (case.case.as_str(), case.facts.scene.as_str()),
        ("four", "four bodies")
    );
    assert_eq!(
        (case.facts.bodies, case.facts.subdomains, case.facts.dofs),
        (4, 8, 16 * 9)
    );
    // From PETSc 3.21 on PCBDDC may have several subdomains on a rank.
    let packed = names(&case.methods).contains(&("bddc", "packed", 2));
    assert_eq!(packed, petsc::REPEATS);
    let rest: Vec<_> = names(&case.methods)
        .into_iter()
        .filter(|n| n.1 != "packed" && n.0 != "hpddm")
        .collect();
    assert_eq!(
        rest,
        [
            ("fetifeti", "threads", 1),
            ("fetifeti", "ranks", 2),
            ("bddc", "subdomain", 8),
            ("bddc", "body", 4),
            ("bddc", "core", 2),
            ("fetidp", "subdomain", 8),
            ("fetidp", "body", 4),
            ("fetidp", "core", 2),
            ("gamg", "core", 2),
            ("hypre", "core", 2),
            ("mumps", "core", 2),
        ]
    );
    check(case, rounds);
    // The file is equal to the printed report; the table has a line per method, the picture exists in both formats.
    let text = std::fs::read_to_string(format!("{out}/bench.json")).expect("a report");
    assert_eq!(keys::read::<BenchReport>(&text, KEYS), report);
    let csv = std::fs::read_to_string(format!("{out}/bench.csv")).expect("a table");
    assert_eq!(csv.lines().count(), 1 + case.methods.len());
    for end in ["png", "svg"] {
        let file = format!("{out}/bench.{end}");
        assert!(
            std::fs::metadata(&file).is_ok_and(|m| m.len() > 1000),
            "{file}"
        );
    }
}

#[test]
fn contact_cases_have_their_steps() {
    let dir = Scratch::new("bench-contact");
    let scene = dir.file("model.toml", CONTACT);
    let report = bench(&[
        &scene,
        "--rounds",
        "2",
        "--with",
        "bddc,gamg,mumps",
        "--quiet",
    ]);
    let case = &report.cases[0];
    check(case, 2);
    let contact = case.facts.contact.expect("inequalities");
    assert_eq!(contact.rows, 9);
    for row in case.methods.iter().filter(|r| solved(r)) {
        let found = row.run.contact.expect("a set");
        assert_eq!(found.differ, Some(0), "{row:?}");
        assert_eq!(row.run.set_given(), row.run.method == "bddc");
        match row.seconds.step {
            None => assert!(row.run.set_given()),
            Some(step) => {
                let steps = found.outer.expect("steps") as f64;
                let total = row.seconds.phases.total.expect("seconds");
                assert!((step.median * steps / total.median - 1.0).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn what_fails_is_said_and_not_run_again() {
    let dir = Scratch::new("bench-fails");
    // The options of one scene do not affect the next one.
    let tight = format!("[options]\nfetifeti_ksp_rtol = 1e-9\n{TIED}");
    let [one, two] = [dir.file("one.toml", &tight), dir.file("two.toml", TIED)];
    let run = fetifeti(&[
        "bench",
        &one,
        &two,
        "--rounds",
        "2",
        "--with",
        "gamg,mumps",
        "-gamg_ksp_max_it",
        "2",
        "--json",
        &dir.path("b.json"),
    ]);
    assert_eq!(run.code, 0, "{}", run.all());
    let text = std::fs::read_to_string(dir.path("b.json")).expect("a report");
    let report: BenchReport = keys::read(&text, KEYS);
    let rtol: Vec<f64> = report.cases.iter().map(|c| c.facts.rtol).collect();
    assert_eq!(rtol, [1e-9, 1e-6]);
    for case in &report.cases {
        let gamg = case
            .methods
            .iter()
            .find(|r| r.run.method == "gamg")
            .expect("gamg");
        let message = gamg.run.message.as_deref().expect("a message");
        assert!(
            message.contains("round 1") && message.contains("DIVERGED_ITS"),
            "{message}"
        );
        assert_eq!((gamg.samples.len(), gamg.run.converged), (1, false));
        assert!(!solved(gamg) && gamg.seconds.phases.total.is_none());
        for row in case.methods.iter().filter(|r| solved(r)) {
            assert_eq!(row.samples.len(), 2, "{row:?}");
        }
        interleaved(case, 2);
    }
    assert!(
        run.stdout.contains("gamg: round 1: did not converge"),
        "{}",
        run.all()
    );
    assert!(
        run.stderr.contains("two, round 2 of 2, mumps on 2 ranks"),
        "{}",
        run.all()
    );
}

#[test]
fn named_cases_are_listed_and_run_small() {
    let list = fetifeti(&["bench", "--list"]);
    assert_eq!(list.code, 0, "{}", list.all());
    let names: Vec<&str> = list
        .stdout
        .lines()
        .filter_map(|l| l.split_whitespace().next())
        .collect();
    assert_eq!(
        names,
        [
            "poisson-1024",
            "poisson-1024-random",
            "contact-512",
            "cube-24",
            "cube-40",
            "cube-contact-24",
            "holes",
            "plate",
            "rod-4",
            "rod-10",
            "rod-contact-4",
            "rod-contact-4-friction",
            "rod-contact-10",
            "blocks-contact-4",
            "blocks-contact-4-mortar",
            "bodies-contact-512",
            "bodies-contact-4096"
        ]
    );
    let dir = Scratch::new("bench-named");
    let out = dir.path("out");
    let quick = [
        "poisson-1024-random",
        "--quick",
        "--rounds",
        "1",
        "--with",
        "mumps",
        "--quiet",
        "--out",
        &out,
    ];
    let report = bench(&quick);
    assert!(report.quick);
    check(&report.cases[0], 1);
    let scene =
        std::fs::read_to_string(format!("{out}/poisson-1024-random.toml")).expect("the scene");
    let plan = fetifeti(&["plan", &format!("{out}/poisson-1024-random.toml")]);
    assert!(plan.code == 0 && scene.contains("rho = "), "{}", plan.all());
}

#[test]
fn a_named_case_on_a_mesh_leaves_scene_and_mesh() {
    let dir = Scratch::new("bench-mesh");
    let out = dir.path("out");
    let quick = [
        "rod-contact-4",
        "--quick",
        "--rounds",
        "1",
        "--with",
        "mumps",
        "--quiet",
        "--out",
        &out,
    ];
    let report = bench(&quick);
    check(&report.cases[0], 1);
    let plan = fetifeti(&["plan", &format!("{out}/rod-contact-4.toml")]);
    assert_eq!(plan.code, 0, "{}", plan.all());
    let kept = Path::new(&out).join("rod-contact-4.msh");
    assert!(kept.is_file(), "{}", kept.display());
}

#[test]
fn mistakes_are_one_sentence() {
    let dir = Scratch::new("bench-mistakes");
    let scene = dir.file("four.toml", TIED);
    let floating = dir.file(
        "floating.toml",
        &TIED.replace("dirichlet = [\"left\"]\n", ""),
    );
    let cases: [(&[&str], i32, &str); 7] = [
        (&["poisson-1023"], 2, "poisson-1024-random"),
        (&["nothing.toml"], 2, "nothing.toml"),
        (&[&scene, "--rounds", "0"], 2, "--rounds"),
        (&[&scene, "--rounds", "three"], 2, "three"),
        (&[&scene, "--with", "bdcc"], 2, "bdcc"),
        (&[&scene, "--json", "/dev/null/x.json"], 3, "/dev/null"),
        (&[&floating, "--with", "mumps", "--quiet"], 2, "b0_0"),
    ];
    for (args, code, part) in cases {
        let run = fetifeti(&[&["bench"], args].concat());
        assert_eq!(run.code, code, "{args:?}: {}", run.all());
        let err = &run.stderr;
        assert!(
            err.contains(part) && err.trim().lines().count() == 1,
            "{args:?}: {err}"
        );
    }
}
