//! `fetifeti compare` from the outside: methods that are independent of each other must agree.

use crate::support::{compared, keys, mpi, program};
use compared::{solved, SceneFile};
use program::fetifeti;
use report::json::{CompareReport, CompareRow};

fn row<'a>(report: &'a CompareReport, method: &str, parts: Option<usize>) -> &'a CompareRow {
    let fits =
        |r: &&CompareRow| r.run.method == method && (parts.is_none() || r.run.subdomains == parts);
    report
        .rows
        .iter()
        .find(fits)
        .unwrap_or_else(|| panic!("no row {method} {parts:?}"))
}

/// Properties of every row, for any scene.
fn check(report: &CompareReport, rtol: f64) {
    assert_eq!(report.facts.rtol, rtol);
    assert!(report.facts.reference_residual.expect("a direct solution") < 1e-11);
    for r in report.rows.iter().filter(|r| solved(r)) {
        let what = format!("{} on {} ranks: {r:?}", r.run.method, r.run.ranks);
        assert!(r.run.residual.expect("a residual") <= rtol, "{what}");
        // ‖e‖_A ≤ ‖r‖ / √λ_min: the residual bounds the error up to the mesh's condition.
        assert!(r.run.error.expect("an error") < 10.0 * rtol, "{what}");
        assert!(r.seconds.total.expect("seconds") > 0.0, "{what}");
        let net = r.memory_mb.expect("MB") - r.memory_at_start_mb.expect("MB");
        assert!((0.0..2000.0).contains(&net), "{what}");
        assert_eq!(
            r.run.kappa.is_some(),
            r.run.iterations.is_some_and(|n| n > 0),
            "{what}"
        );
    }
    let mumps = row(report, "mumps", None);
    assert!(!solved(mumps) || mumps.run.error.expect("an error") < 1e-12);
    assert_eq!((mumps.run.kappa, mumps.run.iterations), (None, None));
}

/// Two bodies with 2 + 4 subdomains, a jump of the coefficient, a load without symmetry; tied all along.
const TIED: &str = r#"
title = "two bodies"

[[body]]
name = "left"
origin = [0, 0]
size = [1, 1]
elements = [12, 12]
subdomains = [1, 2]
dirichlet = ["left"]
load = "1 + x"

[[body]]
name = "right"
origin = [1, 0]
size = [1, 1]
elements = [12, 12]
subdomains = [2, 2]
rho = 50
load = "x*y*y"
"#;

#[test]
fn all_methods_agree_on_tied_bodies() {
    let scene = SceneFile::new("tied", TIED);
    let report = scene.compare(&["-fetifeti_ksp_rtol", "1e-7"]);
    check(&report, 1e-7);
    // Nodes of both bodies, minus the held ones and the second copies on the common face.
    assert_eq!(report.facts.dofs, 13 * 12 + 13 * 13 - 13);
    let methods: Vec<(&str, Option<usize>, usize)> = report
        .rows
        .iter()
        .filter(|r| r.run.method != "hpddm")
        .map(|r| (r.run.method.as_str(), r.run.subdomains, r.run.ranks))
        .collect();
    assert_eq!(
        methods,
        [
            ("fetifeti", Some(6), 1),
            ("fetifeti", Some(6), 2),
            ("fetifeti", Some(6), 1),
            ("bddc", Some(6), 6),
            ("bddc", Some(2), 2),
            ("fetidp", Some(6), 6),
            ("fetidp", Some(2), 2),
            ("gamg", None, 2),
            ("hypre", None, 2),
            ("mumps", None, 2),
        ]
    );
    // Tied bodies as one: the domain that the others see.
    let merged = &report.rows[2].run;
    assert_eq!(merged.layout, "merged");
    assert!(
        merged.options.contains("-fetifeti_merge ties"),
        "{}",
        merged.options
    );
    assert!(
        merged.iterations < report.rows[0].run.iterations,
        "{merged:?}"
    );
    for parts in [6, 2] {
        // With the same primal space and scaling, the spectra of BDDC and FETI-DP agree except for eigenvalues 1.
        let both = ["bddc", "fetidp"].map(|m| row(&report, m, Some(parts)));
        let same_try = both[0].run.rescue == both[1].run.rescue;
        if same_try && both.iter().all(|r| solved(r)) {
            let [bddc, fetidp] = both.map(|r| r.run.kappa.expect("κ"));
            let ratio = bddc / fetidp;
            assert!((ratio - 1.0).abs() < 0.1, "{parts}: {bddc} and {fetidp}");
        }
    }
    let [one, two] = [&report.rows[0], &report.rows[1]];
    assert_eq!(one.run.iterations, two.run.iterations);
}

#[test]
fn all_methods_agree_on_partly_tied_bodies() {
    let partly =
        format!("{TIED}\n[[tie]]\nbodies = [\"left\", \"right\"]\nrange = [\"1/3\", \"2/3\"]\n");
    let scene = SceneFile::new("partly", &partly);
    let report = scene.compare(&[]);
    check(&report, 1e-6);
    // Five of the thirteen nodes of the face are tied.
    assert_eq!(report.facts.dofs, 13 * 12 + 13 * 13 - 5);
}

#[test]
fn options_of_a_baseline_reach_it_alone_and_its_failure_is_a_row() {
    let scene = SceneFile::new("options", TIED);
    let options = [
        "--with",
        "gamg,hypre,mumps",
        "-gamg_ksp_max_it",
        "2",
        "-hypre_pc_type",
        "no_such_thing",
    ];
    let report = scene.compare(&options);
    let gamg = row(&report, "gamg", None);
    assert!(!gamg.run.converged);
    assert_eq!(gamg.run.converged_reason, "DIVERGED_ITS");
    assert!(
        !solved(gamg) && gamg.run.error.is_some_and(|e| e > 1e-6),
        "{gamg:?}"
    );
    let options = &gamg.run.options;
    assert!(
        options.contains(" -pc_type gamg") && options.contains(" -ksp_max_it 2"),
        "{options}"
    );
    let hypre = row(&report, "hypre", None);
    assert!(
        hypre.run.options.contains(" -pc_type no_such_thing"),
        "{hypre:?}"
    );
    let message = hypre.run.message.as_deref().expect("a message");
    assert!(message.contains("no_such_thing"), "{message}");
    assert_eq!((hypre.run.error, hypre.run.iterations), (None, None));
    assert!(solved(row(&report, "fetifeti", None)));
    let mumps = row(&report, "mumps", None).run.message.as_deref();
    assert!(
        mumps.is_none_or(|m| !m.contains("no_such_thing")),
        "{mumps:?}"
    );
}

/// A method that breaks down is tried once more with safer options, and the row names them.
#[test]
fn a_second_try_is_told_with_its_options() {
    let scene = SceneFile::new("rescue", TIED);
    let report = scene.compare(&["--with", "bddc", "-bddc_ksp_max_it", "1"]);
    for bddc in report.rows.iter().filter(|r| r.run.method == "bddc") {
        let options = bddc.run.rescue.as_deref().expect("options of a second try");
        assert!(options.starts_with("-bddc_"), "{options}");
        // What the row ran with has them, without the prefix.
        let all = &bddc.run.options;
        assert!(
            all.starts_with("-ksp_type cg ") && all.contains(" -ksp_max_it 1"),
            "{all}"
        );
        assert!(all.contains(" -pc_bddc_use_change_of_basis true"), "{all}");
        assert!(!solved(bddc), "one iteration is too few: {bddc:?}");
    }
}

#[test]
fn mistakes_end_before_anything_runs() {
    let scene = SceneFile::new("mistakes", TIED);
    // Nothing holds these bodies, and our method, which runs first, finds that out.
    let floating = SceneFile::new("floating", &TIED.replace("dirichlet = [\"left\"]\n", ""));
    let cases: [(&[&str], i32, &str); 5] = [
        (&[scene.path(), "--with", "bddc,bdcc"], 2, "bdcc"),
        (&[scene.path(), "-fetifeti_ksp_rtol", "2"], 2, "ksp_rtol"),
        (
            &[scene.path(), "-compare_cores", "many"],
            2,
            "compare_cores",
        ),
        (
            &[scene.path(), "--json", "/dev/null/x.json"],
            3,
            "/dev/null",
        ),
        (&[floating.path(), "--with", "mumps"], 2, "left"),
    ];
    for (args, code, part) in cases {
        let output = fetifeti(&[&["compare"], args].concat());
        let err = &output.stderr;
        assert_eq!(output.code, code, "{args:?}: {err}");
        assert!(
            err.contains(part) && err.trim().lines().count() == 1,
            "{args:?}: {err}"
        );
    }
}

#[test]
fn under_mpirun_the_first_rank_runs_the_jobs_and_leaves_nothing_behind() {
    let scene = SceneFile::new("nested", TIED);
    let [out, tmp] = ["out", "tmp"].map(|d| scene.scratch.path(d));
    std::fs::create_dir_all(&tmp).expect("a directory");
    let args = ["compare", scene.path(), "--with", "mumps", "--out", &out];
    let run = mpi::mpirun(2, program::PATH, &args, &[("TMPDIR", &tmp)]);
    assert_eq!(run.code, 0, "{}", run.all());
    assert_eq!(
        run.stdout.matches("All methods were driven").count(),
        1,
        "{}",
        run.all()
    );
    let text = std::fs::read_to_string(format!("{out}/compare.json")).expect("a report");
    let report: CompareReport = keys::read(&text, compared::KEYS);
    assert!(solved(row(&report, "fetifeti", None)));
    solved(row(&report, "mumps", None));
    let csv = std::fs::read_to_string(format!("{out}/compare.csv")).expect("a table");
    assert_eq!(csv.lines().count(), 1 + report.rows.len());
    let left: Vec<_> = std::fs::read_dir(&tmp)
        .expect("the directory")
        .flatten()
        .map(|entry| entry.file_name())
        .filter(|entry| entry.to_string_lossy().starts_with("fetifeti"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}
