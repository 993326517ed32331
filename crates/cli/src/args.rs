//! The command line as clap reads it. The comments on commands and fields are the help that users see.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum, ValueHint};
use clap_complete::Shell;

use lab::baselines::{Benchmark, Comparison, BASELINES};
use lab::study::table1;
use report::destination::Destination;
use report::output;

/// The end of the help of the program.
const PETSC: &str = "\
PETSc options have one dash and stand anywhere on the line, with their values: -fetifeti_ksp_rtol 1e-10.
fetifeti -help lists ours with PETSc's; they are also read from PETSC_OPTIONS and -options_file.

On several ranks: mpirun -n N fetifeti solve SCENE ... gives the same answer.

Exit codes: 0 solved, 1 not converged (what was written is partial), 2 bad input, 3 the environment \
(PETSc, MPI, disk).";

/// The end of the help of a command that solves something.
const OPTIONS: &str =
    "PETSc options have one dash and stand anywhere on the line: fetifeti -help lists them.";

/// The FETI-FETI method for bodies in contact, on PETSc
#[derive(Debug, Parser)]
#[command(name = "fetifeti", version, after_help = PETSC)]
// PETSc has the options of one dash, -h and -V among them.
#[command(disable_help_flag = true, disable_version_flag = true)]
pub struct CommandLine {
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Say this, or more of the command
    #[arg(long, global = true, action = ArgAction::Help)]
    help: Option<bool>,
    /// Say which version this is
    #[arg(long, action = ArgAction::Version)]
    version: Option<bool>,
}

/// A command with its arguments.
#[derive(Debug, Clone, PartialEq, Subcommand)]
pub enum Command {
    /// Solve a scene
    ///
    /// The directory of --out gets solution.vtu, solution.png and report.json; with contact also
    /// interfaces.png, .svg and .csv; with load steps also solution.pvd, step_*.vtu, steps.png, .svg and .csv.
    #[command(after_help = OPTIONS)]
    Solve(SolveArguments),
    /// Validate a scene; say what the solver will build and why, with sizes and memory
    #[command(after_help = OPTIONS)]
    Plan(PlanArguments),
    /// Solve a scene with PETSc's solvers, too
    ///
    /// All are driven to the same relative residual. The options of PETSc's solvers have the prefixes
    /// -bddc_ -fetidp_ -gamg_ -hypre_ -mumps_; -compare_cores N and -compare_time_limit SECONDS are for each method.
    #[command(after_help = OPTIONS)]
    Compare(Compare),
    /// Run the methods of compare in turns
    ///
    /// Several rounds of them: medians, smallest and largest seconds beside errors, as
    /// table, JSON, CSV and picture.
    #[command(after_help = OPTIONS)]
    Bench(Bench),
    /// Redo Table 1 and Figure 3 of Lee (2010)
    #[command(after_help = OPTIONS)]
    Table1(Table1),
    /// Run a study of the method
    #[command(after_help = OPTIONS)]
    Study(Study),
    /// Print a script that completes command lines
    ///
    /// For bash:
    /// fetifeti completions bash > ~/.local/share/bash-completion/completions/fetifeti
    Completions {
        /// The shell that reads it
        shell: Shell,
    },
    /// Print the manual page
    ///
    /// To read it: fetifeti man | man -l -. With --out it is written into a directory, with those of all commands.
    Man {
        /// Directory for fetifeti.1, fetifeti-solve.1, ...
        #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
        out: Option<PathBuf>,
    },
    /// One method of a comparison, in a process of its own (not for users)
    #[command(hide = true)]
    Baseline {
        /// File with the job, as the parent process wrote it
        job: PathBuf,
    },
    /// One measurement of a study, in a process of its own (not for users)
    #[command(hide = true)]
    Measure {
        /// File with the task, as the parent process wrote it
        task: PathBuf,
    },
}

impl Command {
    /// Whether nothing is drawn of what goes on.
    pub fn quiet(&self) -> bool {
        match self {
            Command::Solve(args) => args.results.quiet,
            Command::Table1(args) => args.results.quiet,
            Command::Study(args) => args.results.quiet,
            Command::Plan(_) => false,
            _ => true,
        }
    }

    /// Whether standard output gets a report as JSON.
    pub fn json_on_stdout(&self) -> bool {
        let json = match self {
            Command::Solve(args) => &args.results.json,
            Command::Plan(args) => &args.json,
            Command::Compare(args) => &args.results.json,
            Command::Bench(args) => &args.results.json,
            Command::Table1(args) => &args.results.json,
            Command::Study(args) => &args.results.json,
            _ => return false,
        };
        json.as_deref().is_some_and(output::is_stdout)
    }
}

/// Where results go.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct Results {
    /// Directory for all results; made if it is missing
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    out: Option<PathBuf>,
    /// File for the report; - is standard output, and then nothing else is printed there
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    json: Option<PathBuf>,
    /// No summary and no progress
    #[arg(long)]
    quiet: bool,
}

impl From<Results> for Destination {
    fn from(Results { out, json, quiet }: Results) -> Destination {
        Destination { out, json, quiet }
    }
}

/// Arguments of `solve`.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct SolveArguments {
    /// The scene, a TOML file
    #[arg(value_hint = ValueHint::FilePath)]
    pub scene: PathBuf,
    #[command(flatten)]
    pub results: Results,
    /// Every rank writes its part of the solution; solution.pvtu names them, in place of solution.vtu
    #[arg(long)]
    pub pieces: bool,
    /// File for the state of the contact loop, written after every step
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub checkpoint: Option<PathBuf>,
    /// File to which every step of the contact loop is appended when it ends, a line of JSON
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub events: Option<PathBuf>,
    /// Go on from such a file, on any number of ranks
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub resume: Option<PathBuf>,
}

/// Arguments of `plan`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct PlanArguments {
    /// The scene, a TOML file
    #[arg(value_hint = ValueHint::FilePath)]
    pub scene: PathBuf,
    /// File for the plan; - is standard output, and then nothing else is printed there
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub json: Option<PathBuf>,
}

/// Arguments of `table1`.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct Table1 {
    /// A row by 1/H_b, H_b/H_s and H_s/h, as in 2,4,2; may be repeated [default: the 20 rows of the paper]
    #[arg(long, value_name = "N,N,N", value_parser = table1::row)]
    pub rows: Vec<[usize; 3]>,
    #[command(flatten)]
    pub results: Results,
}

/// Which baselines run.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct With {
    /// Methods beside ours, with commas [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    #[arg(value_parser = PossibleValuesParser::new(BASELINES.map(|b| b.name)))]
    with: Vec<String>,
}

/// Arguments of `compare`.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct Compare {
    /// The scene, a TOML file
    #[arg(value_hint = ValueHint::FilePath)]
    scene: PathBuf,
    #[command(flatten)]
    with: With,
    #[command(flatten)]
    results: Results,
}

impl Compare {
    /// The comparison that is asked for; the jobs get PETSc's options, too.
    pub fn wanted(self, petsc: Vec<String>) -> Comparison {
        Comparison {
            scene: self.scene,
            with: self.with.with,
            destination: self.results.into(),
            petsc,
        }
    }
}

/// Arguments of `bench`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct Bench {
    /// Cases by name, or scenes [default: all cases]
    #[arg(value_name = "CASE|SCENE", value_hint = ValueHint::FilePath)]
    cases: Vec<String>,
    /// How often every method is run
    #[arg(long, value_name = "N", default_value = "5", value_parser = rounds)]
    rounds: usize,
    #[command(flatten)]
    with: With,
    /// Smaller cases
    #[arg(long)]
    quick: bool,
    /// Only say which cases there are
    #[arg(long)]
    pub list: bool,
    #[command(flatten)]
    results: Results,
}

impl Bench {
    /// As [`Compare::wanted`].
    pub fn wanted(self, petsc: Vec<String>) -> Benchmark {
        Benchmark {
            cases: self.cases,
            rounds: self.rounds,
            with: self.with.with,
            quick: self.quick,
            destination: self.results.into(),
            petsc,
        }
    }
}

/// The studies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StudyName {
    /// Condition numbers that the user chooses, where coefficients jump inside bodies
    Adaptive,
    /// Answers beside closed forms, equilibrium and other programs; exit code 1 where a tolerance is missed
    Benchmarks,
    /// Contact half-width and peak pressure against Hertz's theory
    Hertz,
    /// Problems that are hard for the method against direct solutions; exit code 1 where an answer is wrong
    HardCases,
    /// Condition numbers with M_D and M_C over H_b/H_s and H_s/h, and with friction; -fetifeti_spectrum: exact ones too
    Kappa,
    /// Seconds over ranks and bodies by phase, messages, and a model for up to 100 000 ranks of a network with
    /// -scaling_alpha SECONDS -scaling_beta SECONDS_PER_BYTE
    Scaling,
    /// Error against seconds, ours and the baselines of compare, over meshes and tolerances
    SpeedError,
    /// Lee's experiment: condition numbers and iterations beside his Table 1; a case is a row, as in 2,4,2
    Table1,
    /// Steps and iterations of the contact loop on random walls of bodies; exit code 1 where one is not solved
    Walls,
}

/// Arguments of `study`.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct Study {
    /// Which study
    #[arg(value_name = "STUDY")]
    pub name: StudyName,
    /// One of its cases [default: all]
    pub case: Option<String>,
    /// Coarser meshes, smaller cases, a few seconds
    #[arg(long)]
    pub quick: bool,
    #[command(flatten)]
    pub results: Results,
}

fn rounds(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|&n| n > 0);
    number.ok_or_else(|| "expected a whole number from 1".into())
}
