//! Unit tests of `crates/cli/src/parse.rs`.

use super::*;
use lab::baselines::{Benchmark, Comparison};
use report::destination::Destination;

fn read(line: &str) -> Result<Invocation> {
    parse(line.split_whitespace().map(String::from).collect())
}

fn command(line: &str) -> Command {
    match read(line).expect(line).wanted {
        Wanted::Run(command) => command,
        Wanted::Say(text) => panic!("{line}: {text}"),
    }
}

fn said(line: &str) -> String {
    match read(line).expect(line).wanted {
        Wanted::Say(text) => text,
        Wanted::Run(command) => panic!("{line}: {command:?}"),
    }
}

#[test]
fn the_definition_is_sound() {
    CommandLine::command().debug_assert();
}

#[test]
fn ours_and_petscs_arguments_mix() {
    let line = "-fetifeti_ksp_rtol 1e-9 solve a.toml --json - -fetifeti_ksp_monitor --quiet -n -3";
    let Command::Solve(solve) = command(line) else {
        panic!("solve")
    };
    assert_eq!(solve.scene.to_str(), Some("a.toml"));
    let wanted = Destination {
        json: Some("-".into()),
        quiet: true,
        out: None,
    };
    assert_eq!(Destination::from(solve.results), wanted);
    assert_eq!(
        read(line).expect(line).petsc.join(" "),
        "-fetifeti_ksp_rtol 1e-9 -fetifeti_ksp_monitor -n -3"
    );
}

#[test]
fn a_run_is_resumed_and_goes_on_writing() {
    let Command::Solve(solve) = command("solve --resume=a.ckpt --checkpoint b.ckpt a.toml") else {
        panic!("solve")
    };
    assert_eq!(solve.scene.to_str(), Some("a.toml"));
    assert_eq!(solve.checkpoint, Some("b.ckpt".into()));
    assert_eq!(solve.resume, Some("a.ckpt".into()));
}

#[test]
fn rows_repeat_and_are_checked() {
    let Command::Table1(table) = command("table1 --rows 2,4,2 --rows=2,2,8 --json -") else {
        panic!("table1")
    };
    assert_eq!(table.rows, [[2, 4, 2], [2, 2, 8]]);
    for bad in ["2,4", "2,4,0", "a,b,c", "1,2,2", ""] {
        assert!(read(&format!("table1 --rows={bad}")).is_err(), "{bad}");
    }
}

#[test]
fn bench_takes_any_number_of_cases() {
    let wanted = |line| match command(line) {
        Command::Bench(bench) => bench.wanted(vec!["-x".into()]),
        other => panic!("{other:?}"),
    };
    let bench = Benchmark {
        cases: vec!["cube-24".into(), "a.toml".into()],
        rounds: 7,
        with: vec!["gamg".into(), "mumps".into()],
        quick: true,
        petsc: vec!["-x".into()],
        ..Benchmark::default()
    };
    let line = "bench cube-24 --rounds 7 a.toml --with gamg,mumps --quick";
    assert_eq!(wanted(line), bench);
    let all = wanted("bench");
    assert_eq!((all.cases.len(), all.rounds, all.with.len()), (0, 5, 0));
}

#[test]
fn compare_passes_on_what_it_is_given() {
    let Command::Compare(compare) = command("compare a.toml --out d --with bddc") else {
        panic!("compare")
    };
    let wanted = Comparison {
        scene: "a.toml".into(),
        with: vec!["bddc".into()],
        destination: Destination {
            out: Some("d".into()),
            ..Destination::default()
        },
        petsc: Vec::new(),
    };
    assert_eq!(compare.wanted(Vec::new()), wanted);
}

#[test]
fn mistakes_are_named_in_one_line() {
    for (line, parts) in [
        ("solv a.toml", &["\"solv\" is no command", "solve"][..]),
        ("solve", &["no scene was given"]),
        ("solve a.toml b.toml", &["\"b.toml\" was not expected"]),
        ("solve a.toml --jsn x", &["--jsn is no option", "--json"]),
        ("solve a.toml --json", &["--json"]),
        ("solve a.toml --json -ksp_view", &["--json"]),
        ("solve a.toml --json x --json y", &["--json"]),
        ("solve a.toml --resume", &["--resume"]),
        ("plan a.toml --checkpoint c", &["--checkpoint"]),
        ("compare a.toml --with bdcc", &["bdcc", "did you mean bddc"]),
        ("bench --rounds 0", &["'0'", "--rounds"]),
        ("bench --rounds many", &["many"]),
        ("bench --rounds", &["--rounds"]),
        ("table1 --rows 2,4", &["2,4", "three counts"]),
        ("study", &["no study was given"]),
        ("study hurtz", &["hurtz", "kappa", "did you mean hertz"]),
        ("study hertz sphere a.toml", &["a.toml"]),
        ("completions tcsh", &["tcsh", "bash"]),
    ] {
        let message = read(line).expect_err(line).to_string();
        assert_eq!(message.lines().count(), 1, "{line}: {message}");
        for part in parts {
            assert!(message.contains(part), "{line}: {message}");
        }
    }
}

#[test]
fn every_command_that_users_see_has_its_help() {
    let all = said("");
    assert_eq!(all, said("--help"));
    assert!(said("--version").starts_with("fetifeti "));
    assert!(!all.contains("baseline"), "{all}");
    for name in [
        "solve",
        "plan",
        "compare",
        "bench",
        "table1",
        "study",
        "completions",
        "man",
    ] {
        assert!(all.contains(&format!("  {name} ")), "{name}: {all}");
        let own = said(&format!("{name} --help"));
        assert!(own.contains(&format!("Usage: fetifeti {name}")), "{own}");
        assert_eq!(own, said(&format!("help {name}")));
    }
    assert!(said("study --help").contains("- hard-cases:"));
}
