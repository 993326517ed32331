//! The plug-in in programs that use another PETSc than it was built for: one sentence, and no crash.

use crate::support::{mpi, plugin};
use mpi::Scratch;
use plugin::Program;

#[test]
fn another_petsc_is_refused() {
    // Debian's builds with complex scalars and with 64-bit indices (scripts/setup.sh).
    for build in ["petsc3.18/*-complex", "petsc64-3.18/*-real"] {
        let scratch = Scratch::new("embed-wrong");
        let program = Program::tutorial_of(&scratch, "ex2", build);
        for ranks in [1, 2] {
            // The program runs as long as the plug-in is not loaded.
            let out = program.run(ranks, "-ksp_type cg");
            assert_eq!(out.code, 0, "{build}: {}", out.all());
            let out = program.with_plugin(ranks, "-ksp_type fetifeti");
            assert_ne!(out.code, 0, "{build}");
            let said = out.all();
            assert!(said.contains("libfetifeti.so was built for"), "{said}");
            assert!(!said.contains("SEGV"), "{said}");
            assert!(!said.contains("signal 11"), "{said}");
        }
    }
}
