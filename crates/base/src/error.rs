//! One error type for all crates. Every message is one sentence that names the file, the line or body,
//! what was found and what was expected.

use std::fmt;
use std::io::Write;

/// The kind of an error, which determines the exit code of the command-line program.
#[derive(Debug, Clone)]
pub enum Error {
    /// The input of the user cannot be solved as written (exit code 2).
    Input(String),
    /// An argument that a caller of the C API handed over cannot be taken (exit code 2).
    Argument(Fault, String),
    /// A matrix that is no stiffness matrix: not positive semidefinite (exit code 2).
    Unfit(String),
    /// The Krylov or the outer iteration did not reach its tolerance (exit code 1).
    NotConverged(String),
    /// The machine, MPI, the disk or the installation refused (exit code 3).
    Environment(String),
    /// A PETSc or SLEPc call failed; `trace` holds PETSc's own error stack, innermost call first (exit code 3).
    Petsc {
        /// The PETSc error code (`PETSC_ERR_*`).
        code: i32,
        /// The call that failed, by its C name.
        call: &'static str,
        /// PETSc's message and stack, one entry per frame.
        trace: Vec<String>,
    },
}

/// The fault of an argument, as PETSc tells such errors apart; the number is its `PETSC_ERR_*`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// PETSC_ERR_SUP: what was asked for is not supported.
    Unsupported = 56,
    /// PETSC_ERR_ARG_SIZ: things whose sizes do not fit.
    Sizes = 60,
    /// PETSC_ERR_ARG_WRONG: anything else.
    Wrong = 62,
    /// PETSC_ERR_ARG_OUTOFRANGE: a number that there is not.
    OutOfRange = 63,
    /// PETSC_ERR_ARG_CORRUPT: not the object that it should be.
    Corrupt = 64,
    /// PETSC_ERR_ARG_WRONGSTATE: something has to be done before.
    WrongState = 73,
    /// PETSC_ERR_ARG_NULL: nothing where something should be.
    Null = 85,
}

impl Fault {
    /// All of them.
    pub const ALL: [Fault; 7] = [
        Fault::Unsupported,
        Fault::Sizes,
        Fault::Wrong,
        Fault::OutOfRange,
        Fault::Corrupt,
        Fault::WrongState,
        Fault::Null,
    ];

    /// An [`Error::Argument`] from anything printable.
    pub fn error(self, message: impl Into<String>) -> Error {
        Error::Argument(self, message.into())
    }
}

/// Shorthand for results with this error.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An [`Error::Input`] from anything printable.
    pub fn input(message: impl Into<String>) -> Self {
        Error::Input(message.into())
    }

    /// An [`Error::Environment`] from anything printable.
    pub fn environment(message: impl Into<String>) -> Self {
        Error::Environment(message.into())
    }

    /// Prints the error on standard error, after `who`, in one piece: what mpirun and other ranks write comes before or
    /// after it.
    pub fn tell(&self, who: &str) {
        let text = format!("{who}: {self}\n");
        // Where nobody listens there is the exit code.
        let _ = std::io::stderr().write_all(text.as_bytes());
    }

    /// The exit code of the command-line program: 1 not converged, 2 bad input, 3 the environment.
    pub fn exit_code(&self) -> i32 {
        match self {
            Error::NotConverged(_) => 1,
            Error::Input(_) | Error::Argument(..) | Error::Unfit(_) => 2,
            Error::Environment(_) | Error::Petsc { .. } => 3,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Input(m)
            | Error::Argument(_, m)
            | Error::Unfit(m)
            | Error::NotConverged(m)
            | Error::Environment(m) => out.write_str(m),
            Error::Petsc { code, call, trace } => {
                write!(out, "{call} failed with PETSc error {code}")?;
                for line in trace {
                    write!(out, "\n  {line}")?;
                }
                Ok(())
            }
        }
    }
}

impl std::error::Error for Error {}
