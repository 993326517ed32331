//! Unit tests of `crates/report/src/tables/compare.rs`.

use super::*;
use crate::json::{CompareContact, ComparedScene, MethodRun, PhaseSeconds};

#[test]
fn compare_names_the_outcome() {
    let row = CompareRow {
        run: MethodRun {
            method: "hypre".into(),
            layout: "core".into(),
            options: "-ksp_type cg -pc_type hypre".into(),
            ranks: 2,
            threads: 1,
            kappa: Some(1.25),
            iterations: Some(8),
            error: Some(1.24e-9),
            converged: true,
            converged_reason: "CONVERGED_RTOL".into(),
            ..MethodRun::default()
        },
        seconds: PhaseSeconds {
            assemble: Some(0.125),
            setup: Some(0.5),
            solve: Some(0.25),
            total: Some(0.75),
        },
        memory_mb: Some(99.6),
        memory_at_start_mb: Some(50.0),
    };
    let mut failed = row.clone();
    failed.run.converged = false;
    failed.run.message = Some("PETSc was built without hypre".into());
    let report = CompareReport {
        facts: ComparedScene {
            scene: "four bodies".into(),
            bodies: 4,
            subdomains: 16,
            dofs: 225,
            rtol: 1e-6,
            ..ComparedScene::default()
        },
        cores: 2,
        supports: 0,
        rows: vec![row.clone(), failed.clone()],
    };
    let text = text(&report);
    let line = text.lines().find(|l| l.starts_with("hypre")).unwrap();
    assert_eq!(
        line.split_whitespace().collect::<Vec<_>>(),
        "hypre core – 2 1.250 8 0.500 0.250 0.750 100 50 1.2e-9 – CONVERGED_RTOL"
            .split(' ')
            .collect::<Vec<_>>()
    );
    assert!(text.contains("PETSc was built without hypre"));
    // The two rows have the same options.
    let said = "\noptions:\n  hypre (core, core): -ksp_type cg -pc_type hypre\n";
    assert!(text.contains(said), "{text}");
    assert!(text.contains("1e-6") || text.contains("1.0e-6"), "{text}");
    let csv = csv(&[failed]).to_csv();
    let end =
        "hypre,core,,2,1,1.25,8,0.125,0.5,0.25,0.75,99.6,50,1.24e-9,,,,,,,,,,,false,CONVERGED_RTOL,\
               -ksp_type cg -pc_type hypre,,,\
               PETSc was built without hypre\n";
    assert!(csv.ends_with(end), "{csv}");
}

/// Load steps stand together, whatever the order of the methods, and a cell has its value in full in the CSV.
#[test]
fn load_steps_have_a_table_of_their_own() {
    let row = |method: &str, error: f64| CompareRow {
        run: MethodRun {
            method: method.into(),
            ranks: 2,
            load_steps: [1.0, 2.0]
                .map(|factor| CompareStep {
                    iterations: Some(7),
                    error: Some(factor * error),
                    contact: CompareContact {
                        outer: Some(4),
                        active: 9,
                        differ: Some(2),
                        ..CompareContact::default()
                    },
                    ..CompareStep::default()
                })
                .to_vec(),
            ..MethodRun::default()
        },
        ..CompareRow::default()
    };
    let rows = vec![row("fetifeti", 0.125), row("mumps", 0.5)];
    let text = load_steps(&rows);
    let lines: Vec<Vec<&str>> = text
        .lines()
        .map(|l| l.split_whitespace().collect())
        .collect();
    let first: Vec<[&str; 2]> = lines[2..6].iter().map(|l| [l[0], l[1]]).collect();
    assert_eq!(
        first,
        [
            ["1", "fetifeti"],
            ["1", "mumps"],
            ["2", "fetifeti"],
            ["2", "mumps"]
        ]
    );
    let csv = steps_csv(&rows).expect("load steps").to_csv();
    assert!(csv.contains("\n2,mumps,2,0,4,7,,,1,,,9,2,"), "{csv}");
    assert!(steps_csv(&[CompareRow::default()]).is_none());
}

#[test]
fn contact_has_columns_of_its_own() {
    let row = |outer: Option<usize>, differ: Option<usize>| CompareRow {
        run: MethodRun {
            method: "mumps".into(),
            ranks: 2,
            contact: Some(CompareContact {
                outer,
                active: 9,
                differ,
                feasibility: Some(0.5),
                min_multiplier: Some(-0.25),
                ..CompareContact::default()
            }),
            converged: true,
            converged_reason: "CONVERGED_ITS".into(),
            ..MethodRun::default()
        },
        ..CompareRow::default()
    };
    let rows = vec![
        row(Some(5), Some(0)),
        row(None, Some(3)),
        row(Some(5), None),
    ];
    let report = CompareReport {
        facts: ComparedScene {
            scene: "model".into(),
            bodies: 2,
            subdomains: 2,
            dofs: 10,
            rtol: 1e-6,
            reference_residual: None,
            contact: Some(CompareInequalities {
                rows: 33,
                active: Some(9),
                outer: Some(6),
                load_steps: 4,
                ..CompareInequalities::default()
            }),
        },
        cores: 2,
        supports: 2,
        rows,
    };
    let text = text(&report);
    let lines: Vec<&str> = text.lines().filter(|l| l.starts_with("mumps")).collect();
    assert!(
        lines[0].contains(" 5 ") && lines[0].contains("same"),
        "{text}"
    );
    assert!(lines[1].contains("last set") && lines[1].contains("3 differ"));
    assert!(!lines[2].contains("same") && !lines[2].contains("differ"));
    assert!(text.contains("Of 33 inequalities 9 hold") && text.contains("in 6 steps"));
    assert!(text.contains("Of 4 load steps the last one"));
    assert!(text.contains("Nothing holds 2 rigid motions:"));
    let csv = csv(&report.rows[1..2]).to_csv();
    assert!(csv.contains(",,9,3,0.5,-0.25,,,,,true,"), "{csv}");
}
