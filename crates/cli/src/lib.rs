//! The program `fetifeti`: arguments, then run, then an exit code.
//!
//! A command reads its scene (`fetifeti-scene`), asks the solver (`fetifeti`) or the laboratory (`fetifeti-lab`), and
//! hands what they answer to `fetifeti-report`. Which checkpoints are written and
//! read is decided here ([`checkpoint`]).

mod args;
mod balance;
mod checkpoint;
mod coefficient;
mod contact;
mod course;
mod doubts;
mod early;
mod events;
mod fields;
mod first_rank;
mod friction;
mod inputs;
mod line_marks;
mod maps;
mod pages;
mod parse;
mod phases;
mod physics;
mod picture;
mod plan;
mod plan_record;
mod plan_tables;
mod record;
mod row_forces;
mod searches;
mod single;
mod smoothed;
mod solve;
mod study;
mod table1;
mod unused;
mod values;

use args::Command;
use first_rank::{on_first_rank, say};
use parse::{Invocation, Wanted};

use base::{Error, Result};
use fetifeti::Settings;
use lab::baselines;
use petsc::{Comm, Ksp, Session};
use scene::distribution;

/// Runs the program with the process's arguments and returns its exit code.
pub fn main() -> i32 {
    if !fetifeti::inside::processor_suits() {
        eprintln!(
            "Error: fetifeti was built for processors with AVX2 and FMA, which this one lacks: \
             build it again with RUSTFLAGS=\"-C target-cpu=x86-64\""
        );
        return 3;
    }
    start()
}

/// Not inlined: whatever it needs stands behind the question for the processor.
#[inline(never)]
fn start() -> i32 {
    petsc::let_threads_allocate();
    let parsed = parse::parse(std::env::args().skip(1).collect());
    let petsc = parsed.as_ref().map(|p| p.petsc.clone()).unwrap_or_default();
    if parsed.is_err() {
        // PETSc starts to say the mistake once for all ranks, and must not read what it may be about.
        std::env::remove_var("PETSC_OPTIONS");
    }
    let quick = single::QuickStart::new();
    let begun = Session::new(&petsc, &parse::usage());
    drop(quick);
    let session = match begun {
        Ok(session) => session,
        Err(error) => {
            error.tell("Error");
            return error.exit_code();
        }
    };
    session.run(|session| run(session, parsed?))
}

/// The arguments for PETSc among these.
#[cfg(fuzzing)]
pub(crate) fn parse_line(args: Vec<String>) -> Result<Vec<String>> {
    Ok(parse::parse(args)?.petsc)
}

fn run(session: &Session, invocation: Invocation) -> Result<()> {
    let Invocation { wanted, petsc } = invocation;
    let command = match wanted {
        Wanted::Run(command) => command,
        Wanted::Say(_) if petsc.iter().any(|a| a == "-help" || a == "-h") => {
            return list_options(session)
        }
        Wanted::Say(text) => return say(session, &text),
    };
    if command.json_on_stdout() {
        petsc::print_on_stderr(session);
    }
    searches::show(session, command.quiet());
    let done = carry_out(session, command.clone(), petsc.clone());
    let came_to_an_end = done.as_ref().err().is_none_or(Error::is_not_converged);
    if came_to_an_end && session.rank() == 0 {
        if let Some(warning) = unused::warning(session, &command, &petsc)? {
            eprintln!("{warning}");
        }
    }
    done
}

fn carry_out(session: &Session, command: Command, petsc: Vec<String>) -> Result<()> {
    match command {
        Command::Solve(args) => solve::run(session, args),
        Command::Plan(args) => plan::run(session, args),
        Command::Table1(args) => table1::run(session, args),
        Command::Study(args) => study::run(session, args, &petsc),
        Command::Compare(args) => baselines::compare(session, &args.wanted(petsc)),
        Command::Bench(args) if args.list => say(session, &baselines::cases()),
        Command::Bench(args) => baselines::bench(session, &args.wanted(petsc)),
        Command::Completions { shell } => say(session, &pages::completions(shell)),
        Command::Man { out } => on_first_rank(session, || pages::manual(out.as_deref())),
        Command::Baseline { job } => baselines::run_job(session, &job),
        Command::Measure { task } => lab::study::scaling::run_task(session, &task),
    }
}

/// `fetifeti -help`: our options and those of the solvers behind them, without a scene.
fn list_options(session: &Session) -> Result<()> {
    let settings = Settings::default().with_options(session)?;
    distribution::is_cyclic(session)?;
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_options_prefix(&settings.method.prefix)?;
    ksp.set_type("cg")?;
    ksp.pc()?
        .set_options_prefix(&format!("{}ksp_", settings.method.prefix))?;
    ksp.set_from_options()
}

/// The readers that `make fuzz` feeds; cargo-fuzz compiles with this condition.
#[cfg(fuzzing)]
#[path = "../../../tests/fuzz/readers.rs"]
pub mod fuzz;
/// The random scenes that `make soak` runs.
#[cfg(any(fuzzing, test))]
#[path = "../../../tests/fuzz/soak.rs"]
pub mod soak;
#[cfg(test)]
#[path = "../tests/soak.rs"]
mod soak_tests;
#[cfg(test)]
#[path = "../../../tests/support/session.rs"]
mod testing;
