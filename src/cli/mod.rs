//! The command-line program: arguments, then run, then an exit code.

pub mod args;
mod balance;
mod coefficient;
mod contact;
mod course;
mod fields;
mod maps;
mod parse;
mod physics;
mod picture;
mod plan;
mod solve;
mod study;
mod table1;
mod usage;

use args::{Command, Invocation};

use crate::baselines::{self, Benchmark, Comparison};
use crate::petsc::{self, Comm, Ksp, Session};
use crate::report::output;
use crate::scene::distribution::Distribution;
use crate::{Error, Result, Settings, Status};

/// Runs the program with the process's arguments and returns its exit code.
pub fn main() -> i32 {
    petsc::let_threads_allocate();
    let args: Vec<String> = std::env::args().skip(1).collect();
    let parsed = args::parse(&args);
    let petsc = parsed.as_ref().map(|p| p.petsc.clone()).unwrap_or_default();
    let session = match Session::new(&petsc, args::USAGE) {
        Ok(session) => session,
        Err(error) => {
            eprintln!("Error: {error}");
            return error.exit_code();
        }
    };
    session.run(|session| run(session, parsed?))
}

fn run(session: &Session, invocation: Invocation) -> Result<()> {
    let Invocation { command, petsc } = invocation;
    let wants_help = petsc.iter().any(|a| a == "-help" || a == "-h");
    match command {
        Command::Help if wants_help => list_options(session),
        Command::Help => say(session, args::USAGE),
        Command::Version => say(
            session,
            concat!("fetifeti ", env!("CARGO_PKG_VERSION"), "\n"),
        ),
        Command::Solve(args) => solve::run(session, &args),
        Command::Plan { scene } => plan::run(session, &scene),
        Command::Table1(args) => table1::run(session, &args),
        Command::Study(args) => study::run(session, &args, &petsc),
        Command::Compare(wanted) => baselines::compare(session, &Comparison { petsc, ..wanted }),
        Command::Bench(wanted) => baselines::bench(session, &Benchmark { petsc, ..wanted }),
        Command::BenchList => say(session, &baselines::cases()),
        Command::Baseline { job } => baselines::run_job(session, &job),
        Command::Measure { task } => crate::study::scaling::run_task(session, &task),
    }
}

/// Prints `text` on rank 0. Collective.
fn say(session: &Session, text: &str) -> Result<()> {
    session.agree(match session.rank() {
        0 => output::print(text),
        _ => Ok(()),
    })
}

/// `fetifeti -help`: our options and those of the solvers behind them, without a scene.
fn list_options(session: &Session) -> Result<()> {
    let settings = Settings::default().with_options(session)?;
    Distribution::from_options(session)?;
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_options_prefix(&settings.method.prefix)?;
    ksp.set_type("cg")?;
    ksp.pc()?
        .set_options_prefix(&format!("{}ksp_", settings.method.prefix))?;
    ksp.set_from_options()
}

/// The error of a solve that stopped early; results were written before.
fn not_converged(what: &str, status: &Status, iterations: usize) -> Error {
    Error::NotConverged(format!(
        "{what} did not converge: {status} after {iterations} iterations (the results written are partial)"
    ))
}
