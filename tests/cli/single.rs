//! The program without mpirun: Open MPI starts no daemon for it and makes no directory, unless the user wants it.

use crate::support::mpi::{self, Output};
use crate::support::program::{ended, PATH};

/// `fetifeti solve` where no daemon can be found and no directory be made for one, with this variable.
fn alone(name: &str, value: &str) -> Output {
    let mut command = mpi::command(PATH);
    let command = command
        .args(["solve", "../../examples/scenes/poisson_2x2.toml"])
        .env("PATH", "")
        .env("OMPI_MCA_orte_tmpdir_base", "Cargo.toml/below_a_file")
        .env(name, value);
    ended(command)
}

#[test]
fn a_process_without_mpirun_needs_no_daemon_and_no_directory() {
    let out = alone("OMPI_MCA_pml", "ob1");
    assert_eq!(out.code, 0, "{}", out.all());
    assert!(out.stdout.contains("energy"), "{}", out.all());
}

/// What the user asks of Open MPI stays: then both are looked for, and are not there.
#[test]
fn settings_of_the_user_are_kept() {
    for (name, value) in [
        ("OMPI_MCA_ess_singleton_isolated", "0"),
        ("OMPI_MCA_orte_create_session_dirs", "1"),
    ] {
        let out = alone(name, value);
        assert_ne!(out.code, 0, "{name}: {}", out.all());
    }
}
