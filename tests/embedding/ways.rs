//! KSPFETIFETI where programs put solvers: inside other solvers, on some of the ranks, on matrices of several types, in
//! programs that go on after an error, and on processors that lack what the library was built for.

use crate::support::{mpi, plugin};
use mpi::{command, Scratch};
use plugin::{library, number_after, Program};

/// Runs tests/plugin/ways.c, which must succeed.
fn good(program: &Program, ranks: usize, options: &str) {
    let out = program.with_plugin(ranks, options);
    assert_eq!(out.code, 0, "{ranks} ranks, {options}: {}", out.all());
    assert!(out.stdout.contains("ok"), "{options}: {}", out.all());
}

#[test]
fn local_matrices_of_other_types() {
    let scratch = Scratch::new("ways-local");
    let program = Program::own("mpicc", &scratch, "ways.c");
    for ranks in [1, 4] {
        good(&program, ranks, "-do local -ksp_type fetifeti");
    }
}

/// The block of the displacements of a saddle point, and one of several preconditioners that are added up.
#[test]
fn inside_other_solvers() {
    let scratch = Scratch::new("ways-inside");
    let program = Program::own("mpicc", &scratch, "ways.c");
    let split = "-do split -ksp_type fgmres -ksp_rtol 1e-9 -pc_fieldsplit_type schur \
                 -pc_fieldsplit_schur_fact_type full -pc_fieldsplit_schur_precondition selfp \
                 -fieldsplit_u_ksp_type fetifeti -fieldsplit_u_ksp_rtol 1e-10 -fieldsplit_u_fetifeti_bodies 2 \
                 -fieldsplit_p_ksp_type gmres -fieldsplit_p_ksp_rtol 1e-10 -fieldsplit_p_pc_type jacobi -options_left";
    let composite = "-do composite -ksp_type fgmres -pc_type composite -pc_composite_type multiplicative \
                     -pc_composite_pcs jacobi,ksp -sub_1_ksp_ksp_type fetifeti -sub_1_ksp_ksp_rtol 1e-8 \
                     -sub_1_ksp_fetifeti_bodies 2 -options_left";
    for options in [split, composite] {
        for ranks in [1, 2, 4] {
            let out = program.with_plugin(ranks, options);
            assert_eq!(out.code, 0, "{ranks} ranks, {options}: {}", out.all());
            // The prefix of the split stands before the method's own options.
            let used = out.stdout.contains("There are no unused options.");
            assert!(used, "{ranks} ranks: {}", out.all());
        }
    }
}

#[test]
fn a_nested_matrix_is_refused_by_name() {
    let scratch = Scratch::new("ways-nest");
    let program = Program::own("mpicc", &scratch, "ways.c");
    let out = program.with_plugin(2, "-do nest -ksp_type fetifeti");
    assert_ne!(out.code, 0);
    for part in [
        "of type nest (MATNEST), expected is (MATIS)",
        "PCFIELDSPLIT",
    ] {
        assert!(out.stderr.contains(part), "{}", out.all());
    }
}

/// The numbers in a line of words.
fn integers(line: &str) -> Vec<usize> {
    let numbers = line.split(|c: char| !c.is_ascii_digit());
    numbers.filter_map(|n| n.parse().ok()).collect()
}

/// Counts over all ranks: set-ups of everything and of numbers; patterns, subdomains, partitions into bodies.
#[test]
fn other_entries_analyse_nothing_again() {
    let scratch = Scratch::new("ways-again");
    let program = Program::own("mpicc", &scratch, "again.c");
    let sizes = "-dim 3 -m 5 -times 2 -ksp_type fetifeti -fetifeti_bodies 2 -ksp_view";
    let out = program.with_plugin(4, sizes);
    assert_eq!(out.code, 0, "{}", out.all());
    let lines = out.stdout.lines().filter(|l| l.contains("set-ups: "));
    let counts: Vec<Vec<usize>> = lines.map(integers).collect();
    let [first, second] = &counts[..] else {
        panic!("{}", out.all());
    };
    let patterns = first[3];
    assert!(patterns >= 8, "kernels and factors of each subdomain");
    assert_eq!(first[..], [1, 0, 0, patterns, 4, 1]);
    assert_eq!(second[..], [1, 1, 0, patterns, 8, 1]);
}

/// A TS has another matrix in each step of Newton's method, whose shift and entries change with the time.
#[test]
fn time_steps_renew_numbers() {
    let scratch = Scratch::new("ways-time");
    let program = Program::own("mpicc", &scratch, "time.c");
    for (ranks, method) in [(1, "arkimex"), (2, "arkimex"), (2, "beuler")] {
        let options = "-ts_adapt_type none -ksp_type fetifeti -fetifeti_bodies 2";
        let out = program.with_plugin(ranks, &format!("-ts_type {method} {options}"));
        assert_eq!(out.code, 0, "{method}, {ranks} ranks: {}", out.all());
        // The solution by LU first.
        let marches: Vec<Vec<usize>> = (out.stdout.lines())
            .filter(|l| l.contains(" Jacobians"))
            .map(integers)
            .collect();
        let [exact, own] = &marches[..] else {
            panic!("{}", out.all());
        };
        assert_eq!(exact, own, "steps and Jacobians: {}", out.all());
        let done = out.stdout.lines().find(|l| l.contains("set-ups: "));
        let done = integers(done.expect("KSPView says what was set up"));
        // A pattern of a kernel and one of a factor for each subdomain.
        let (patterns, jacobians) = (2 * ranks, own[1]);
        let expected = [1, jacobians - 1, 0, patterns, ranks * jacobians, 1];
        assert_eq!(done, expected, "{}", out.all());
        let error = number_after(&out, "error");
        assert!(error < 1e-10, "{method}, {ranks} ranks: {error}");
    }
}

#[test]
fn some_of_the_ranks_do_nothing() {
    let scratch = Scratch::new("ways-half");
    let program = Program::own("mpicc", &scratch, "ways.c");
    for what in ["half", "world"] {
        good(
            &program,
            4,
            &format!("-do {what} -ksp_type fetifeti -fetifeti_bodies 2"),
        );
    }
}

#[test]
fn an_error_is_a_code_on_all_ranks() {
    let scratch = Scratch::new("ways-codes");
    let program = Program::own("mpicc", &scratch, "ways.c");
    for ranks in [1, 2, 4] {
        good(&program, ranks, "-do codes -ksp_type fetifeti");
    }
}

/// QEMU plays a processor without AVX2 to the program, to a host of the plug-in, and to one of the C API.
#[test]
fn an_old_processor_gets_a_sentence() {
    let qemu = "/usr/bin/qemu-x86_64";
    assert!(
        std::path::Path::new(qemu).exists(),
        "qemu-user is not installed: run scripts/setup.sh"
    );
    let old = |program: &str, args: &[&str]| {
        let mut run = command(qemu);
        let out = run.args(["-cpu", "Nehalem", program]).args(args).output();
        let out = out.expect("QEMU runs");
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(!out.status.success(), "{program}: {said}");
        let sentence = "built for processors with AVX2 and FMA, which this one lacks";
        assert!(said.contains(sentence), "{program}: {said}");
        out.status.code()
    };
    let scene = concat!(env!("FETIFETI_ROOT"), "/examples/scenes/poisson_2x2.toml");
    assert_eq!(
        old(env!("CARGO_BIN_EXE_fetifeti"), &["solve", scene]),
        Some(3)
    );
    let scratch = Scratch::new("ways-processor");
    let host = Program::own("mpicc", &scratch, "host.c");
    old(
        host.path(),
        &["-ksp_type", "fetifeti", "-dll_append", &library()],
    );
    let linked = Program::linked("mpicc", &scratch, "tests/plugin/capi.c");
    old(linked.path(), &[]);
}
