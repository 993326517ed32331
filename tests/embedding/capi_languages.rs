//! The functions of wrappers/fetifeti.h from Fortran (wrappers/fetifeti.f90) on bars with known solutions, and from
//! Python by the package of wrappers/python on blocks, compared with the same program in C.

use crate::python::script;
use crate::support::{mpi, plugin};
use mpi::Scratch;
use plugin::{number_after, Program};

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
        // The value of the second row, which was added after the first.
        assert!(number_after(&out, "obstacle").abs() < 1e-9);
    }
}

#[test]
fn contact_from_petsc4py() {
    let python = |ranks, options: &str| script("examples/embedding/contact.py", ranks, options);
    let scratch = Scratch::new("capi-python");
    let program = Program::linked("mpicc", &scratch, "examples/embedding/contact.c");
    let options = "-contact -m 13 -fetifeti_ksp_rtol 1e-10";
    let theirs = program.run(2, options);
    assert_eq!(theirs.code, 0, "{}", theirs.all());
    for ranks in [1, 2, 4] {
        let out = python(ranks, options);
        assert!(number_after(&out, "reason") > 0.0, "{}", out.all());
        for what in ["work", "force"] {
            let (ours, theirs) = (number_after(&out, what), number_after(&theirs, what));
            assert!((ours - theirs).abs() < 1e-7, "{what}: {}", out.all());
        }
        let touching = theirs.stdout.lines().find(|l| l.contains("nodes touch"));
        let touching = touching.and_then(|l| l.split(',').next()).expect("a line");
        assert!(out.stdout.contains(touching), "{touching}: {}", out.all());
    }
    // The former form still works: one block, any KSP.
    let direct = program.run(1, "-m 13 -ksp_rtol 1e-10 -pc_type none");
    let ours = python(4, "-m 13 -ksp_rtol 1e-8 -ksp_type fetifeti");
    let energy = |out| number_after(out, "energy");
    assert!((energy(&direct) - energy(&ours)).abs() < 1e-8);
}
