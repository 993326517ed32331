//! `study adaptive --quick`: the bound holds, errors are small, and missed bounds are reported.

use crate::support::keys::{self, Keys};
use crate::support::{mpi, program};
use lab::study::adaptive::{AdaptiveReport, AdaptiveRun};
use mpi::Scratch;
use program::run_fetifeti;

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "study rtol repeats cases"),
    ("cases[]", "case title bodies subdomains dofs multipliers fine reference mumps plain runs"),
    ("cases[].plain", "error estimate exact iterations message seconds"),
    (
        "cases[].runs[]",
        "tau kappa lambda_min error attainable iterations message most capped searched vectors search \
         seconds fails bddc",
    ),
];

#[test]
fn bounds_hold() {
    let dir = Scratch::new("study-adaptive");
    let (out, file) = (dir.path("out"), dir.path("adaptive.json"));
    let args = [
        "study", "adaptive", "--quick", "--quiet", "--out", &out, "--json", &file,
    ];
    let run = run_fetifeti(1, &args);
    let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{e}: {}", run.all()));
    let report: AdaptiveReport = keys::read(&text, KEYS);
    assert_eq!(report.cases.len(), 8);
    for case in &report.cases {
        println!("{}: {:?}", case.case, case.runs);
        // Without a reference solution there is nothing to compare with.
        assert!(case.reference.is_some_and(|r| r < 1e-9), "{}", case.case);
        // MUMPS may fail and has no error then; otherwise its error is small enough to compare with.
        assert!(case.mumps.is_none_or(|e| e < 1e-6), "{}", case.case);
        for run in &case.runs {
            assert_eq!(run.message, None, "{}", case.case);
            let kappa = run.kappa.expect("small enough for SLEPc");
            assert!(kappa <= 1.5 * run.tau, "{}: {kappa}", case.case);
            let least = run.lambda_min.expect("beside κ");
            assert!(least >= 1.0 - 1e-6, "{}: {least}", case.case);
            assert!(run.error.is_some_and(|e| e < 1e-4), "{}", case.case);
            // Further iterations do not increase the error, up to rounding.
            let [first, last] =
                [run.error, run.attainable].map(|e| e.expect("there is a reference"));
            assert!(last <= 10.0 * first, "{}: {last}", case.case);
            assert_eq!(run.capped, 0, "{}", case.case);
        }
        // The scene file exists, and can be solved again.
        let scene = format!("{out}/{}.toml", case.case);
        assert!(std::path::Path::new(&scene).exists());
    }
    // Constant coefficients need no vectors, jumps do.
    let find = |name: &str| report.cases.iter().find(|c| c.case == name).expect(name);
    let (constant, jumps) = (find("scalar-2d-constant"), find("elastic-3d-subdomain-6"));
    assert_eq!(constant.runs[0].vectors, 0);
    assert!(!constant.runs[0].searched);
    assert!(jumps.runs[0].vectors > 0 && jumps.plain.kappa() > jumps.runs[0].kappa);
    // The exit code agrees with the report.
    let failing = report.cases.iter().any(|c| c.failing().count() > 0);
    assert_eq!(run.code, i32::from(failing), "{}", run.all());
}

#[test]
fn what_is_missed_is_said() {
    let good = AdaptiveRun {
        tau: 10.0,
        kappa: Some(15.0),
        lambda_min: Some(1.0 - 9e-7),
        attainable: Some(9e-12),
        ..AdaptiveRun::default()
    };
    assert!(good.judge(true, Some(1e-12)).is_empty());
    let said = |change: &dyn Fn(&mut AdaptiveRun)| {
        let mut run = good.clone();
        change(&mut run);
        run.judge(true, Some(1e-12)).join("; ")
    };
    assert!(said(&|r| r.kappa = Some(15.1)).contains("15.10"));
    assert!(said(&|r| r.kappa = None).contains("no exact"));
    assert!(said(&|r| r.lambda_min = Some(0.99)).contains("0.99"));
    assert!(said(&|r| r.attainable = Some(1.1e-11)).contains("MUMPS 1e-12"));
    assert!(said(&|r| r.message = Some("DIVERGED_ITS".into())).contains("DIVERGED_ITS"));
    assert!(said(&|r| r.kappa = Some(f64::NAN)).contains("κ"));
    assert!(good.judge(false, None)[0].contains("direct"));
}

#[test]
fn several_ranks_are_refused() {
    let run = run_fetifeti(2, &["study", "adaptive", "--quick", "--quiet"]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(run.stderr.contains("2 ranks"), "{}", run.all());
}
