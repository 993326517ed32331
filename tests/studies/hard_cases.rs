//! `study hard-cases --quick`: no wrong answer is called a solution, and the study detects one.

use crate::support::keys::{self, Keys};
use crate::support::sample::of;
use crate::support::{mpi, program};
use lab::study::hard_cases::{trackers, HardCaseOutcome, HardCasesReport, Record};
use mpi::Scratch;
use program::run_fetifeti;
use std::sync::OnceLock;

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "study limit rtol cases"),
    (
        "cases[]",
        "case title verdict message reference force undecided error_max error_energy active condition kkt dofs \
         multipliers subdomains iterations outer_iterations seconds",
    ),
    (
        "cases[].kkt",
        "stationarity feasibility complementarity min_multiplier error",
    ),
    ("cases[].condition", "exact estimate"),
    ("cases[].condition.exact", "lambda_min lambda_max kappa"),
    ("cases[].condition.estimate", "lambda_min lambda_max kappa"),
];

/// The run on one rank, which two tests look at.
fn alone() -> &'static HardCasesReport {
    static REPORT: OnceLock<HardCasesReport> = OnceLock::new();
    REPORT.get_or_init(|| {
        let dir = Scratch::new("study-hard");
        let file = dir.path("hard.json");
        let args = ["study", "hard-cases", "--quick", "--quiet", "--json", &file];
        let run = run_fetifeti(1, &args);
        assert_eq!(run.code, 0, "{}", run.all());
        keys::read(&std::fs::read_to_string(&file).expect("a report"), KEYS)
    })
}

#[test]
fn nothing_is_wrong() {
    let report = alone();
    assert!(report.cases.len() >= 25);
    let find = |name: &str| -> &Record {
        let found = report.cases.iter().find(|c| c.case == name);
        found.unwrap_or_else(|| panic!("no case {name}"))
    };
    for case in &report.cases {
        println!("{}: {:?} {:?}", case.case, case.verdict, case.error_max);
        assert_ne!(case.verdict, HardCaseOutcome::Wrong, "{}", case.case);
        // The direct solution is certified; without one there would be nothing to compare with. Where the assembled
        // problem has no form for one, tests/ranks/mortar.rs has the direct solution.
        let certified = case.reference.is_some_and(|r| r < 1e-9) || case.undecided.is_some();
        assert_eq!(certified, case.case != "flies-away", "{}", case.case);
        // Where the solver fails, it says why; where it claims a solution, it is right.
        assert_eq!(
            case.message.is_some(),
            case.verdict != HardCaseOutcome::Solved
        );
        if case.verdict == HardCaseOutcome::Solved && case.undecided.is_none() {
            assert!(case.error_max.is_some_and(|e| e < report.limit));
            // Without a force any rows may hold among those that touch.
            if case.force.is_none_or(|[_, known]| known != 0.0) {
                assert_eq!(case.active[0], case.active[1], "{}", case.case);
            }
        }
    }
    assert_eq!(find("flies-away").verdict, HardCaseOutcome::Refused);
    assert_eq!(find("one-node").active[0], Some(1));
    assert_eq!(find("no-contact").active[0], Some(0));
    for name in [
        "jump-bodies-3d",
        "incompressible-bbar",
        "interpenetrating",
        "stiff-on-soft",
        "many-subdomains",
    ] {
        assert_eq!(find(name).verdict, HardCaseOutcome::Solved, "{name}");
    }
    // What others report is solved, and forces that are known beforehand are found.
    for known in trackers() {
        let case = find(known.name);
        assert_eq!(case.verdict, HardCaseOutcome::Solved, "{}", case.case);
        let force = case.force.map(|[found, value]| (found - value).abs());
        assert_eq!(force.is_some(), known.force.is_some(), "{}", case.case);
        if let (Some(away), Some(force)) = (force, known.force) {
            assert!(away <= force.within, "{}: {away:e}", case.case);
        }
    }
    let touching = find("4c-1585-moved");
    assert_eq!((touching.active[0], touching.iterations), (Some(25), 0));
    // Most cases are solved: a solver that always gives up would be useless.
    let solved = report
        .cases
        .iter()
        .filter(|c| c.verdict == HardCaseOutcome::Solved);
    assert!(solved.count() >= 29);
    for name in ["wall", "wall-jumps-1e4", "wall-jumps-1e6", "wall-elastic"] {
        let case = find(name);
        assert_eq!(case.verdict, HardCaseOutcome::Solved, "{name}");
        // The problem is one of contact: some rows hold, others do not.
        assert!(case.active[1].is_some_and(|n| n > 50), "{name}");
        assert!(case.active[1] < Some(case.multipliers), "{name}");
        assert!(case.outer_iterations > 5, "{name}");
    }
}

/// Sets wander in most of these walls: the direct solution comes from its safeguard, and agrees.
#[test]
fn walls_have_direct_solutions() {
    use crate::support::rng::Rng;
    use crate::support::session::with_session;
    use crate::support::wall::wall;
    use lab::study::hard_cases::{one, HardCase};
    with_session(|session| {
        for seed in 0..4 {
            for jump in [1.0, 1e2, 1e4, 1e6] {
                let what = format!("jump {jump:e}, seed {seed}");
                let case = HardCase {
                    point: None,
                    name: "wall",
                    title: what.clone(),
                    text: wall(&mut Rng::new(seed), 4, jump),
                    force: None,
                };
                let record = one(session, &case, 0).expect("it runs");
                println!("{what}: {record:?}");
                assert_eq!(record.verdict, HardCaseOutcome::Solved, "{what}");
                assert!(record.reference.is_some_and(|r| r < 1e-9), "{what}");
                // Energies differ by half of its square.
                assert!(record.error_energy.is_some_and(|e| e < 1e-4), "{what}");
                assert_eq!(record.active[0], record.active[1], "{what}");
            }
        }
    });
}

/// Every second case, in the sample every fifth, on two ranks and without spectra.
#[test]
fn ranks_do_not_matter() {
    use lab::study::hard_cases::{cases, one};
    let started = mpi::as_rank(|session, _| {
        for case in cases(true).iter().step_by(of(5, 2)) {
            let record = one(session, case, 0)?;
            if session.rank() == 0 {
                println!(
                    "CASE {} {:?} {:?}",
                    case.name, record.verdict, record.active[0]
                );
            }
        }
        Ok(())
    });
    let two = started.run(2, "cases");
    assert_eq!(two.code, 0, "{}", two.all());
    let mut compared = 0;
    for line in two.stdout.lines().filter_map(|l| l.split("CASE ").nth(1)) {
        let (name, found) = line.split_once(' ').expect("a name and what was found");
        let case = alone().cases.iter().find(|c| c.case == name);
        let case = case.expect("one rank solves all");
        compared += 1;
        // Rounding decides where a stagnating iteration stops.
        if name != "flat-elastic" {
            let wanted = format!("{:?} {:?}", case.verdict, case.active[0]);
            assert_eq!(found, wanted, "{name}");
        }
    }
    assert!(compared * 5 >= alone().cases.len(), "{}", two.all());
}

/// One case, solved with a tolerance too loose for a solution: the study detects it.
#[test]
fn a_wrong_answer_is_seen() {
    use crate::support::session::with_session;
    use lab::study::hard_cases::{cases, one};
    let verdict = with_session(|session| {
        let mut case = cases(true)
            .into_iter()
            .find(|c| c.name == "fine-subdomains")
            .expect("it is there");
        case.text += "[options]\nfetifeti_ksp_rtol = 1e-2\n";
        let record = one(session, &case, 0).expect("it runs");
        (record.verdict, record.error_energy)
    });
    assert_eq!(verdict.0, HardCaseOutcome::Wrong, "{verdict:?}");
}

/// A force that is one per cent away from what is known: the study detects it.
#[test]
fn a_wrong_force_is_seen() {
    use crate::support::session::with_session;
    use lab::study::hard_cases::one;
    with_session(|session| {
        for mut case in trackers() {
            let Some(known) = &mut case.force else {
                continue;
            };
            known.value += 0.01 * known.value.abs() + 2.0 * known.within;
            let record = one(session, &case, 0).expect("it runs");
            assert_eq!(record.verdict, HardCaseOutcome::Wrong, "{}", case.name);
        }
    });
}
