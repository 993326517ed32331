//! How a host program defines the bodies of a KSPFETIFETI: by a label of its mesh, by an index set over the rows, or
//! not at all.

use crate::support::{mpi, plugin};
use mpi::Scratch;
use plugin::{number_after, Program};

/// Runs tests/plugin/plex.c on four ranks. Their subdomains are halves of the two halves that the label defines.
fn plex(program: &Program, options: &str) -> mpi::Output {
    let always = "-petscpartitioner_type simple -ksp_type fetifeti -ksp_rtol 1e-10 -ksp_view";
    program.with_plugin(4, &format!("{options} {always}"))
}

#[test]
fn bodies_that_the_host_names() {
    let scratch = Scratch::new("embed-plex");
    let program = Program::own("mpicc", &scratch, "plex.c");
    for (options, bodies) in [
        ("-by label", 2.0),
        ("-by option -fetifeti_body_label material", 2.0),
        ("-by is", 2.0),
        ("-by none", 1.0),
        ("-by none -fetifeti_bodies 2", 2.0),
        (
            "-by none -fetifeti_bodies 2 -fetifeti_mat_partitioning_type ptscotch",
            2.0,
        ),
        ("-by none -fetifeti_bodies 4", 4.0),
    ] {
        let out = plex(&program, options);
        // Debian's PETSc has PT-Scotch; that of scripts/newer_petsc.sh has not where indices have 64 bits.
        let missing = "Unknown partitioning type ptscotch";
        if plugin::petsc_version() > (3, 18) && out.all().contains(missing) {
            println!("{missing}");
            continue;
        }
        assert_eq!(out.code, 0, "{options}: {}", out.all());
        assert_eq!(number_after(&out, "bodies: "), bodies, "{options}");
        let residual = number_after(&out, "residual ");
        assert!(residual < 1e-8, "{options}: {residual}");
    }
}

#[test]
fn mistakes_are_sentences() {
    let scratch = Scratch::new("embed-plex-mistakes");
    let program = Program::own("mpicc", &scratch, "plex.c");
    for (options, sentence) in [
        (
            "-by is -short_by 1",
            "rows of the operator there", // how many depends on the version of PETSc
        ),
        (
            "-by label -without_label 1",
            "The DMPlex has no label material that could name the bodies",
        ),
        (
            "-by none -fetifeti_bodies 2 -fetifeti_mat_partitioning_type xyz",
            "Unknown partitioning type xyz",
        ),
    ] {
        let out = plex(&program, options);
        assert_ne!(out.code, 0, "{options}");
        assert!(out.all().contains(sentence), "{options}: {}", out.all());
    }
    // A mesh that is no DMPlex has no labels of cells.
    let scratch = Scratch::new("embed-no-plex");
    let program = Program::own("mpicc", &scratch, "host.c");
    let out = program.with_plugin(2, "-ksp_type fetifeti -fetifeti_body_label material");
    assert_ne!(out.code, 0);
    let sentence = "neither the KSP nor its operator has a DMPlex";
    assert!(out.all().contains(sentence), "{}", out.all());
}
