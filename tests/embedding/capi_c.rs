//! The functions of wrappers/fetifeti.h from C: bars whose solution is known, contact in a DMDA program, and mistakes.

use crate::support::sample::{all_cases, of};
use crate::support::{mpi, plugin};
use mpi::Scratch;
use plugin::{number_after, Program};

#[test]
fn bars_by_raw_arrays() {
    let scratch = Scratch::new("capi-bars");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/capi.c");
    for (ranks, options) in [
        (1, ""),
        (2, ""),
        (4, ""),
        (7, ""),
        (1, "-tied"),
        (3, "-tied"),
        (4, "-tied"),
    ] {
        let out = program.run(
            ranks,
            &format!("-bar_fetifeti_ksp_rtol 1e-10 -malloc_dump {options}"),
        );
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
        assert!(out.stdout.trim_end().ends_with("ok"), "{}", out.all());
        let bodies = if options.is_empty() {
            "bodies: 2"
        } else {
            "bodies: 4"
        };
        assert!(out.stdout.contains(bodies), "{}", out.all());
    }
}

#[test]
fn rows_of_a_block_come_from_all_ranks() {
    let scratch = Scratch::new("capi-rows");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/rows.c");
    for (ranks, shift) in [(1, 0), (2, 0), (2, 1), (3, 1), (4, 0), (4, 3), (9, 5)] {
        let options = "-fetifeti_ksp_rtol 1e-12 -malloc_dump";
        let out = program.run(ranks, &format!("-shift {shift} {options}"));
        assert_eq!(out.code, 0, "{ranks} ranks, {shift}: {}", out.all());
        assert!(out.stdout.trim_end().ends_with("ok"), "{}", out.all());
    }
}

#[test]
fn mistakes_are_sentences() {
    let scratch = Scratch::new("capi-wrong");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/capi.c");
    // PETSc's text for the error code, and our sentence.
    for (wrong, kind, sentence) in [
        ("null", NULL, "the FetiFeti is NULL"),
        ("order", STATE, "expected FetiFetiSolve before"),
        ("symmetry", WRONG, "is not symmetric"),
        ("column", RANGE, "has an entry in column 5"),
        ("start", WRONG, "the row pointers fall from 9"),
        ("dof", RANGE, "has unknown 1000, expected numbers below 26"),
        ("bodies", WRONG, "expected a body for every subdomain"),
        (
            "row",
            WRONG,
            "contact row 0 of rank 1 has a coefficient at unknown 31",
        ),
        ("kind", RANGE, "contact row 0 is of kind 2"),
        ("vector", SIZES, "the right-hand side has entries"),
        ("room", SIZES, "there is room for 7 multipliers"),
    ] {
        refused(&program, wrong, kind, sentence);
    }
}

/// PETSc's text for the codes of input errors.
const NULL: &str = "Null argument, when expecting valid pointer";
const STATE: &str = "Object is in wrong state";
const WRONG: &str = "Invalid argument";
const RANGE: &str = "Argument out of range";
const SIZES: &str = "Nonconforming object sizes";
const UNSUPPORTED: &str = "No support for this operation";

/// A run that must end with this kind of error and this sentence.
fn refused(program: &Program, wrong: &str, kind: &str, sentence: &str) {
    let out = program.run(2, &format!("-wrong {wrong}"));
    assert_ne!(out.code, 0, "{wrong}: {}", out.all());
    for text in [kind, sentence] {
        assert!(out.stderr.contains(text), "{wrong}: {}", out.all());
    }
    assert!(
        !out.all().contains("Segmentation"),
        "{wrong}: {}",
        out.all()
    );
}

#[test]
fn matrices_against_a_direct_solver() {
    let scratch = Scratch::new("capi-matis");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/capi_matis.c");
    for (k, way) in ["matis", "raw", "stack"].into_iter().enumerate() {
        for ranks in [1, 2, 4] {
            if ranks != 1 << k && !all_cases() {
                continue;
            }
            let options = "-fetifeti_ksp_rtol 1e-10 -fetifeti_bodies 2 -malloc_dump";
            let out = program.run(ranks, &format!("-do {way} {options}"));
            assert_eq!(out.code, 0, "{way}, {ranks} ranks: {}", out.all());
            assert!(out.stdout.trim_end().ends_with("ok"), "{}", out.all());
            assert!(!out.all().contains("bytes in"), "{}", out.all());
        }
    }
    for (wrong, kind, sentence) in [
        ("mixed", STATE, "expected one way for all of a FetiFeti"),
        ("raw", STATE, "expected one way for all of a FetiFeti"),
        ("type", UNSUPPORTED, "is of type mpiaij"),
        ("size", SIZES, "the layout of FetiFetiSetSizes has entries"),
        ("near", SIZES, "the near-null space has entries 0..6"),
        (
            "matrix",
            RANGE,
            "contact pairs name matrix 2 but 2 have been",
        ),
        ("same", WRONG, "contact pair 0 of rank 1 has unknown"),
        ("sort", RANGE, "contact pairs are of kind 9"),
        ("finite", WRONG, "contact pair 1 of rank 1 has a gap of NaN"),
        ("missing", NULL, "the second IS is NULL"),
        ("length", SIZES, "rank 0 gave 0 unknowns on the first side"),
        ("range", RANGE, "has unknown 162, expected numbers from 0"),
        ("gone", RANGE, "name matrix 1 but 1 have been added"),
        ("nest", SIZES, "has 3 parts, expected 2"),
        ("part", SIZES, "part 1 of the right-hand side has entries"),
    ] {
        refused(&program, wrong, kind, sentence);
    }
}

#[test]
fn motions_of_stacked_matrices_are_known_or_found() {
    let scratch = Scratch::new("capi-motions");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/capi_matis.c");
    let primal = |options: &str| {
        let out = program.run(2, &format!("-fetifeti_ksp_rtol 1e-10 {options}"));
        assert_eq!(out.code, 0, "{}", out.all());
        let kernel = "bodies: 2 (1 floating, kernels of dimension 3)";
        for part in [kernel, "scaling: stiffness"] {
            assert!(out.stdout.contains(part), "no \"{part}\" in {}", out.all());
        }
        number_after(&out, "primal dofs:")
    };
    // Rotations that are found in the matrices ask for as many constraints as given ones.
    let (with, without) = (primal("-fetifeti_view"), primal("-fetifeti_view -near 0"));
    assert_eq!(with, without);
}

#[test]
fn cycles_leave_nothing_behind() {
    let scratch = Scratch::new("capi-cycles");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/capi_matis.c");
    for ranks in [1, 2] {
        let options = format!("-cycles {} -m 3 -malloc_dump", of(400, 1000));
        let out = program.run(ranks, &options);
        assert_eq!(out.code, 0, "{}", out.all());
        // -malloc_dump prints memory that has not been freed.
        assert!(!out.all().contains("bytes in"), "{}", out.all());
        let bytes = number_after(&out, "bytes per cycle:");
        assert!(bytes < 1500.0, "{bytes} bytes per cycle on {ranks} ranks");
    }
}

#[test]
fn a_dmda_program_with_contact() {
    let scratch = Scratch::new("capi-contact");
    let program = Program::linked("mpicc", &scratch, "examples/embedding/contact.c");
    let mut works = Vec::new();
    for ranks in [1, 2, 4] {
        let out = program.run(ranks, "-contact -m 17 -fetifeti_ksp_rtol 1e-10");
        assert_eq!(out.code, 0, "{}", out.all());
        // The program measures these with its own matrices.
        for what in ["equilibrium", "overlap", "pull", "product"] {
            assert!(number_after(&out, what) < 1e-7, "{what}: {}", out.all());
        }
        assert!(out.stdout.contains("13 of 17 nodes touch"), "{}", out.all());
        works.push(number_after(&out, "work"));
    }
    assert!(works.iter().all(|w| (w - works[0]).abs() < 1e-7));
    // The former form still works: one block, any KSP.
    let direct = program.run(1, "-m 17 -ksp_rtol 1e-10 -pc_type none");
    let ours = program.run(4, "-m 17 -ksp_rtol 1e-8 -ksp_type fetifeti");
    let energy = |out| number_after(out, "energy");
    assert!((energy(&direct) - energy(&ours)).abs() < 1e-8);
}
