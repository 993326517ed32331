//! KSPFETIFETI as an ordinary KSP: used again, changed, reset, monitored; and problems that it refuses.

use crate::support::sample::{of, sample};
use crate::support::{mpi, plugin};
use mpi::Scratch;
use plugin::{number_after, Program};

#[test]
fn every_way_of_using_a_ksp() {
    let scratch = Scratch::new("embed-host");
    let program = Program::own("mpicc", &scratch, "host.c");
    let cases = [
        (4, "-do once -idle 2"),
        (1, "-do once"),
        (4, "-do again -fixed 0 -fetifeti_bodies 2"),
        (4, "-do once -ksp_rtol 1e-10"),
        (
            2,
            "-do two -one_ksp_type fetifeti -two_ksp_type fetifeti -two_fetifeti_bodies 2",
        ),
        (4, "-do once -fixed 0"),
        (4, "-do bodies -fixed 0"),
        (1, "-do again"),
        (2, "-do unfit"),
        (4, "-do again"),
        (4, "-do split"),
        (4, "-do bodies"),
    ];
    for (ranks, options) in sample(3, cases) {
        let out = program.with_plugin(ranks, &format!("{options} -ksp_type fetifeti"));
        assert_eq!(out.code, 0, "{options}: {}", out.all());
        assert!(
            out.stdout.lines().any(|line| line.trim() == "ok"),
            "{options}: {}",
            out.all()
        );
    }
}

#[test]
fn cycles_leave_nothing_behind() {
    let scratch = Scratch::new("embed-cycles");
    let program = Program::own("mpicc", &scratch, "host.c");
    let options = format!(
        "-do cycles -cycles {} -n 6 -ksp_type fetifeti -malloc_debug -malloc_dump",
        of(120, 500)
    );
    let out = program.with_plugin(2, &options);
    assert_eq!(out.code, 0, "{}", out.all());
    // -malloc_dump prints memory that has not been freed.
    assert!(!out.all().contains("bytes in"), "{}", out.all());
    let bytes = number_after(&out, "bytes per cycle:");
    assert!(bytes < 1500.0, "{bytes} bytes per cycle");
}

#[test]
fn what_a_user_may_watch() {
    let scratch = Scratch::new("embed-watch");
    let program = Program::own("mpicc", &scratch, "host.c");
    let watch = "-ksp_monitor_true_residual -ksp_converged_reason \
                 -ksp_view -ksp_view_singularvalues -ksp_view_eigenvalues";
    let more = "-options_left -log_view -citations";
    let out = program.with_plugin(
        4,
        &format!("-ksp_type fetifeti -fetifeti_bodies 2 {watch} {more}"),
    );
    assert_eq!(out.code, 0, "{}", out.all());
    for part in [
        "true resid norm",
        "bodies: 2",
        "multipliers: ",
        "primal dofs: ",
        "scaling: stiffness",
        "Inner KSP solver details",
        "Iteratively computed extreme singular values",
        "Iteratively computed eigenvalues",
        "There are no unused options.",
        "FetiFetiF",
        "Lee2010",
    ] {
        assert!(out.stdout.contains(part), "no \"{part}\" in {}", out.all());
    }
    // The last true residual that the monitor showed is below the tolerance.
    let last = out.stdout.lines().rfind(|l| l.contains("||r(i)||/||b||"));
    let ratio: f64 = last
        .and_then(|l| l.split_whitespace().next_back()?.parse().ok())
        .expect("a number");
    assert!(ratio < 1e-5, "{ratio:e}");

    let out = program.with_plugin(
        2,
        "-ksp_type fetifeti -fetifeti_ksp_rtol 1e-2 -fetifeti_true_residual 0 -ksp_view",
    );
    assert!(out.all().contains("relative=0.01"), "{}", out.all());
    let out = program.with_plugin(1, "-ksp_type fetifeti -help");
    for option in [
        "-fetifeti_bodies",
        "-fetifeti_true_residual",
        "-fetifeti_pc_type",
    ] {
        assert!(out.stdout.contains(option), "{option}: {}", out.all());
    }
}

#[test]
fn what_it_refuses_and_what_diverges() {
    let scratch = Scratch::new("embed-refuses");
    let program = Program::own("mpicc", &scratch, "host.c");
    for (options, part) in [
        ("-skew 0.1", "the operator is not symmetric"),
        ("-fetifeti_bodies x", "expected"),
        (
            "-fetifeti_primal corners",
            "expected some of vertices, edges, faces",
        ),
        ("-ksp_max_it 1 -ksp_error_if_not_converged", "DIVERGED_ITS"),
        (
            "-do unfit -ksp_error_if_not_converged",
            "expected a positive number",
        ),
    ] {
        let out = program.with_plugin(2, &format!("-ksp_type fetifeti {options}"));
        assert_ne!(out.code, 0, "{options}");
        assert!(out.all().contains(part), "{options}: {}", out.all());
    }
}

/// What was wrong with the matrix, what was expected and what helps stands beside the reason, without any option.
#[test]
fn a_reason_comes_with_its_sentence() {
    let scratch = Scratch::new("embed-sentences");
    let program = Program::own("mpicc", &scratch, "host.c");
    let saddle = "KSP_DIVERGED_PC_FAILED: the local matrix of a subdomain has 0 on the diagonal at global dof 60";
    for (options, sentence, remedy) in [
        (
            "-shift 0.1",
            "FETI-FETI: KSP_DIVERGED_PC_FAILED: the operator is indefinite",
            "take the shift out",
        ),
        ("-hole 60", saddle, "a saddle point"),
        (
            "-no_number matrix",
            "FETI-FETI: KSP_DIVERGED_PC_FAILED: the local matrix of a subdomain has NaN at global dofs",
            "divides by zero",
        ),
    ] {
        let out = program.with_plugin(2, &format!("-ksp_type fetifeti {options}"));
        assert!(out.stderr.contains(sentence), "{options}: {}", out.all());
        assert!(out.stderr.contains(remedy), "{options}: {}", out.all());
        // The host's own test of the reason ends the program.
        assert!(out.stderr.contains("one solve: DIVERGED_PC_FAILED"), "{options}: {}", out.all());
    }
    let out = program.with_plugin(2, "-ksp_type fetifeti -no_number load");
    let sentence = "the right-hand side is NaN at global dof 158, expected finite numbers";
    let reason = format!("FETI-FETI: KSP_DIVERGED_NANORINF: {sentence}");
    assert!(out.stderr.contains(&reason), "{}", out.all());
    assert!(
        out.stderr.contains("one solve: DIVERGED_NANORINF"),
        "{}",
        out.all()
    );
    let strict = "-ksp_type fetifeti -no_number load -ksp_error_if_not_converged";
    let out = program.with_plugin(2, strict);
    assert_ne!(out.code, 0);
    assert!(
        out.stderr
            .contains(&format!("PETSC ERROR: FETI-FETI: {sentence}")),
        "{}",
        out.all()
    );
    assert!(!out.stderr.contains("KSPSetTolerances"), "{}", out.all());
}

/// A tolerance that rounding does not let the residual reach is not called converged.
#[test]
fn stagnation_is_said() {
    let scratch = Scratch::new("embed-stagnation");
    let program = Program::own("mpicc", &scratch, "host.c");
    let out = program.with_plugin(4, "-ksp_type fetifeti -n 24 -ksp_rtol 1e-17");
    let sentence = "FETI-FETI: KSP_DIVERGED_BREAKDOWN: the residual b - A x no longer falls at";
    assert!(out.stderr.contains(sentence), "{}", out.all());
    assert!(
        out.stderr.contains("one solve: DIVERGED_BREAKDOWN"),
        "{}",
        out.all()
    );
    let out = program.with_plugin(4, "-ksp_type fetifeti -n 24 -ksp_rtol 1e-12");
    assert_eq!(out.code, 0, "{}", out.all());
}

/// The load of the solution one: λ₀ is the solution, and what is left of the jumps is rounding, though more than 1e-14
/// of the displacements. Nothing is iterated on it.
#[test]
fn a_first_residual_of_rounding_is_no_task() {
    let scratch = Scratch::new("embed-at-once");
    let program = Program::own("mpicc", &scratch, "host.c");
    let constant = "-ksp_type fetifeti -constant -ksp_rtol 1e-8 -ksp_converged_reason";
    for options in [
        "-n 64 -fetifeti_bodies 4",
        "-n 120 -fetifeti_bodies 4",
        "-n 64",
    ] {
        let out = program.with_plugin(4, &format!("{constant} {options}"));
        assert_eq!(out.code, 0, "{options}: {}", out.all());
        let first = "converged due to CONVERGED_RTOL iterations 0";
        assert!(out.stdout.contains(first), "{options}: {}", out.all());
    }
    // Without a look at the host's residual the jumps are iterated on, as is said.
    let out = program.with_plugin(4, &format!("{constant} -n 12 -fetifeti_true_residual 0"));
    assert_eq!(out.code, 0, "{}", out.all());
}
