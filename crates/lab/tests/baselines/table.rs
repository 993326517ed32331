//! Unit tests of `crates/lab/src/baselines/table.rs`.

use super::*;
use crate::testing::with_session;

#[test]
fn names_select_rows_in_the_order_of_the_table() {
    let names = |list: &[&str]| -> Vec<&'static str> {
        let list: Vec<String> = list.iter().map(|s| s.to_string()).collect();
        select(&list)
            .expect("known names")
            .iter()
            .map(|b| b.name)
            .collect()
    };
    assert_eq!(
        names(&[]),
        ["bddc", "fetidp", "hpddm", "gamg", "hypre", "mumps"]
    );
    assert_eq!(names(&["mumps", "bddc", "mumps"]), ["bddc", "mumps"]);
    let error = select(&["bdcc".to_string()]).expect_err("a typo");
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("bdcc"), "{error}");
}

fn case() -> BaselineCase {
    BaselineCase {
        space: false,
        elastic: false,
        newer: false,
        contact: false,
        rescue: false,
        local: Some("cholmod"),
        coarse: Some("mumps"),
    }
}

fn value(name: &str, case: &BaselineCase, option: &str) -> Option<String> {
    let all = Baseline::named(name).expect("a peer").options(case);
    let mut found = all.iter().filter(|(name, _)| name == option);
    let value = found.next().map(|(_, value)| value.clone());
    assert!(found.next().is_none(), "{option} stands twice");
    value
}

/// Sets for a kind of problem hold there only, and later ones override earlier ones.
#[test]
fn options_follow_the_kind_of_problem() {
    let plane = case();
    let space = BaselineCase {
        space: true,
        ..plane
    };
    assert_eq!(value("bddc", &plane, "pc_bddc_use_faces"), None);
    assert_eq!(
        value("bddc", &space, "pc_bddc_use_faces").as_deref(),
        Some("true")
    );
    let second = BaselineCase {
        rescue: true,
        ..plane
    };
    assert_eq!(value("bddc", &plane, "pc_bddc_use_change_of_basis"), None);
    assert_eq!(
        value("bddc", &second, "pc_bddc_use_change_of_basis").as_deref(),
        Some("true")
    );
    for peer in &BASELINES {
        for k in 0..32 {
            let bit = |b: usize| k >> b & 1 == 1;
            let case = BaselineCase {
                space: bit(0),
                elastic: bit(1),
                newer: bit(4),
                contact: bit(2),
                rescue: bit(3),
                local: None,
                coarse: None,
            };
            let all = peer.options(&case);
            for (name, _) in &all {
                assert!(value(peer.name, &case, name).is_some());
            }
        }
    }
}

/// Subdomains get a package only where this PETSc has one.
#[test]
fn subdomains_get_the_package_that_there_is() {
    let option = "pc_bddc_neumann_pc_factor_mat_solver_type";
    assert_eq!(value("bddc", &case(), option).as_deref(), Some("cholmod"));
    let none = BaselineCase {
        local: None,
        ..case()
    };
    assert_eq!(value("bddc", &none, option), None);
    assert_eq!(value("gamg", &case(), option), None);
    for (name, prefix) in [("bddc", ""), ("fetidp", "fetidp_bddc_")] {
        let option = format!("{prefix}pc_bddc_coarse_pc_factor_mat_solver_type");
        assert_eq!(value(name, &case(), &option).as_deref(), Some("mumps"));
    }
}

/// Options of the user stand in place of those that the program takes, and behind them.
#[test]
fn options_are_written_as_a_user_writes_them() {
    with_session(|session| {
        let peer = Baseline::named("gamg").expect("a peer");
        let written = || peer.written(session, &case()).expect("options");
        let before = written();
        assert!(before.starts_with("-ksp_type cg "), "{before}");
        assert!(before.contains(" -pc_type gamg"), "{before}");
        let user = Options::new(session, "gamg_");
        for (name, value) in [
            ("ksp_type", "minres"),
            ("ksp_rtol", "1e-3"),
            ("ksp_monitor", ""),
        ] {
            user.set_value(name, Some(value)).expect("an option");
        }
        let after = before.replace("-ksp_type cg", "-ksp_type minres") + " -ksp_monitor";
        assert_eq!(written(), after);
        for name in ["ksp_type", "ksp_rtol", "ksp_monitor"] {
            user.clear_value(name).expect("an option");
        }
    });
}

#[test]
fn what_a_build_of_petsc_lacks_is_said() {
    with_session(|session| {
        let missing = |needs| {
            let peer = Baseline {
                name: "x",
                description: "",
                needs,
                format: MatrixFormat::Assembled,
                krylov: "",
                bddc: None,
                sets: &[],
                near: Near::None,
                lag: 0.0,
            };
            peer.missing(session).expect("an answer")
        };
        assert_eq!(missing(Needs::Nothing), None);
        assert_eq!(missing(Needs::Pc("gamg")), None);
        assert_eq!(missing(Needs::Package("petsc")), None);
        let sentence = missing(Needs::Pc("no_such_pc")).expect("a sentence");
        assert!(
            sentence.ends_with("was built without no_such_pc"),
            "{sentence}"
        );
        assert!(missing(Needs::Package("no_such_package")).is_some());
    });
}
