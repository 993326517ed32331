//! The plug-in in host programs of other languages: Fortran, and Python by petsc4py.

use crate::support::{mpi, plugin};
use mpi::{mpirun, Scratch};
use plugin::{library, number_after, Program};
use std::path::Path;

#[test]
fn a_fortran_program() {
    let scratch = Scratch::new("embed-fortran");
    let program = Program::own("mpif90", &scratch, "host.F90");
    for ranks in [1, 4] {
        let out = program.with_plugin(ranks, "-ksp_type fetifeti -fetifeti_bodies 2");
        assert_eq!(out.code, 0, "{}", out.all());
        assert!(number_after(&out, "reason") > 0.0, "{}", out.all());
        assert!(number_after(&out, "residual") < 1e-4, "{}", out.all());
    }
}

#[test]
fn a_petsc4py_script() {
    let path = std::env::var("PYTHONPATH").unwrap_or_default();
    let path = format!("{}:{path}", plugin::petsc4py());
    let script = Path::new(env!("FETIFETI_ROOT")).join("tests/plugin/host.py");
    let script = script.to_str().expect("the path is UTF-8");
    for ranks in [1, 4] {
        let library = library();
        let args = [
            script,
            "-dll_append",
            &library,
            "-ksp_type",
            "fetifeti",
            "-fetifeti_bodies",
            "2",
        ];
        let out = mpirun(ranks, "/usr/bin/python3", &args, &[("PYTHONPATH", &path)]);
        assert_eq!(out.code, 0, "{}", out.all());
        assert!(out.stdout.contains("type fetifeti"), "{}", out.all());
        assert!(number_after(&out, "reason") > 0.0, "{}", out.all());
        assert!(number_after(&out, "residual") < 1e-4, "{}", out.all());
    }
}
