//! Runs the program itself, with and without mpirun.

use std::process::{Command, Stdio};
use std::time::Instant;

use super::mpi::{self, Output};

/// The executable.
pub const PATH: &str = env!("CARGO_BIN_EXE_fetifeti");

/// `mpirun -n ranks fetifeti args`.
pub fn run_fetifeti(ranks: usize, args: &[&str]) -> Output {
    mpi::mpirun(ranks, PATH, args, &[])
}

/// `fetifeti args` without mpirun. Comparisons start ranks themselves.
pub fn fetifeti(args: &[&str]) -> Output {
    ended(mpi::of_petsc(PATH).args(args))
}

/// What a command gives that reads nothing.
pub fn ended(command: &mut Command) -> Output {
    let start = Instant::now();
    let out = command
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    Output {
        code: out.status.code().unwrap_or(-2),
        stdout: String::from_utf8_lossy(&out.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&out.stderr).into_owned(),
        seconds: start.elapsed().as_secs_f64(),
    }
}
