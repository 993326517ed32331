//! The functions of wrappers/fetifeti.h from C: bars whose solution is known, contact in a DMDA program, and mistakes.

mod mpi;
mod plugin;

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
fn mistakes_are_sentences() {
    let scratch = Scratch::new("capi-wrong");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/capi.c");
    for (wrong, sentence) in [
        ("null", "the FetiFeti is NULL"),
        ("order", "expected FetiFetiSolve before"),
        ("symmetry", "is not symmetric"),
        ("column", "has an entry in column 5"),
        ("start", "the row pointers fall from 9"),
        ("dof", "has unknown 1000, expected numbers below 26"),
        ("bodies", "expected a body for every subdomain"),
        (
            "row",
            "contact row 0 of rank 1 has a coefficient at unknown 31",
        ),
        ("kind", "contact row 0 is of kind 2"),
        ("vector", "the right-hand side has entries"),
        ("room", "there is room for 7 multipliers"),
    ] {
        let out = program.run(2, &format!("-wrong {wrong}"));
        assert_ne!(out.code, 0, "{wrong}: {}", out.all());
        assert!(out.stderr.contains(sentence), "{wrong}: {}", out.all());
        assert!(
            !out.all().contains("Segmentation"),
            "{wrong}: {}",
            out.all()
        );
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
        // The program measures with its own matrices.
        for what in ["equilibrium", "overlap", "pull", "product"] {
            assert!(number_after(&out, what) < 1e-7, "{what}: {}", out.all());
        }
        assert!(out.stdout.contains("13 of 17 nodes touch"), "{}", out.all());
        works.push(number_after(&out, "work"));
    }
    assert!(works.iter().all(|w| (w - works[0]).abs() < 1e-7));
    // And as it was: one block, any KSP.
    let direct = program.run(1, "-m 17 -ksp_rtol 1e-10 -pc_type none");
    let ours = program.run(4, "-m 17 -ksp_rtol 1e-8 -ksp_type fetifeti");
    let energy = |out| number_after(out, "energy");
    assert!((energy(&direct) - energy(&ours)).abs() < 1e-8);
}
