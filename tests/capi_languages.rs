//! The functions of wrappers/fetifeti.h from Fortran (wrappers/fetifeti.f90) and from Python by ctypes, on bars whose solution is known.

mod mpi;
mod plugin;

use mpi::{mpirun, Scratch};
use plugin::{library, number_after, Program};
use std::path::Path;

#[test]
fn bars_in_fortran() {
    let scratch = Scratch::new("capi-fortran");
    let program = Program::fortran_with_module(&scratch, "examples/embedding/bars.F90");
    for ranks in [1, 2, 4] {
        let out = program.run(ranks, "-fetifeti_ksp_rtol 1e-10");
        assert_eq!(out.code, 0, "{}", out.all());
        assert!(number_after(&out, "reason") > 0.0, "{}", out.all());
        let (force, exact) = (number_after(&out, "force"), number_after(&out, "exact"));
        assert!((force - exact).abs() < 1e-7, "{}", out.all());
    }
}

#[test]
fn bars_from_petsc4py() {
    // Debian keeps petsc4py beside the PETSc that it was built for.
    let modules = "/usr/lib/petscdir/petsc3.18/x86_64-linux-gnu-real/lib/python3/dist-packages";
    let path = std::env::var("PYTHONPATH").unwrap_or_default();
    let path = format!("{modules}:{path}");
    let library = library();
    let dir = Path::new(&library)
        .parent()
        .expect("it lies in a directory");
    let others = std::env::var("LD_LIBRARY_PATH").unwrap_or_default();
    let places = format!("{}:{others}", dir.display());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/embedding/contact.py");
    let script = script.to_str().expect("the path is UTF-8");
    for ranks in [1, 2, 4] {
        let args = [script, "-fetifeti_ksp_rtol", "1e-10"];
        let env = [("PYTHONPATH", &path[..]), ("LD_LIBRARY_PATH", &places)];
        let out = mpirun(ranks, "/usr/bin/python3", &args, &env);
        assert_eq!(out.code, 0, "{}", out.all());
        assert!(number_after(&out, "reason") > 0.0, "{}", out.all());
        let force = number_after(&out, "force");
        assert!((force - 0.05).abs() < 1e-7, "{}", out.all());
        assert!(number_after(&out, "error") < 1e-8, "{}", out.all());
    }
}
