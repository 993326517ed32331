//! One error type for all crates. Every message is one sentence that names the file, the line or body,
//! what was found and what was expected.

use std::fmt;
use std::io::Write;
use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::location::Location;

/// The kind of an error, which determines the exit code of the command-line program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The input of the user cannot be solved as written (exit code 2).
    Input,
    /// An argument that a caller of the C API handed over cannot be taken (exit code 2).
    Argument(Fault),
    /// A matrix that is no stiffness matrix: not positive semidefinite (exit code 2).
    Unfit,
    /// The Krylov or the outer iteration did not reach its tolerance (exit code 1).
    NotConverged,
    /// The machine, MPI, the disk or the installation refused (exit code 3).
    Environment,
    /// A signal asked the program to end (exit code 3).
    Ended,
    /// A PETSc or SLEPc call failed with this code, `PETSC_ERR_*` (exit code 3).
    Petsc(i32),
}

/// The fault of an argument, as PETSc tells such errors apart; the number is its `PETSC_ERR_*`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
#[non_exhaustive]
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
    /// An error of the kind [`ErrorKind::Argument`] from anything printable.
    pub fn error(self, message: impl Into<String>) -> Error {
        Error::new(ErrorKind::Argument(self), message)
    }
}

/// Shorthand for results with this error.
pub type Result<T> = std::result::Result<T, Error>;

/// The error of every crate: its message, its place, its cause. [`Display`](fmt::Display) writes one sentence of them;
/// each can also be asked for by itself.
///
/// ```
/// use fetifeti_base::{Error, ErrorKind, Location};
/// use std::error::Error as _;
///
/// let refused = std::io::Error::from(std::io::ErrorKind::NotFound);
/// let error = Error::input("the mesh cannot be read")
///     .at(Location::line("plate.toml", 12).with_key("mesh"))
///     .because(refused);
/// assert_eq!(error.to_string(), "plate.toml:12: the mesh cannot be read: entity not found");
/// assert_eq!(error.kind(), ErrorKind::Input);
/// assert_eq!(error.message(), "the mesh cannot be read");
/// assert_eq!(error.location().file(), Some("plate.toml"));
/// assert_eq!(error.location().key(), Some("mesh"));
/// assert!(error.source().expect("a cause").is::<std::io::Error>());
/// ```
///
/// An error can be sent to other ranks, where its cause is known by its text alone.
#[derive(Clone, Serialize, Deserialize)]
pub struct Error(Box<Parts>);

type Cause = Arc<dyn std::error::Error + Send + Sync>;

#[derive(Debug, Clone, Serialize, Deserialize)]
struct Parts {
    kind: ErrorKind,
    location: Location,
    message: String,
    #[serde(serialize_with = "cause_as_text", deserialize_with = "cause_from_text")]
    source: Option<Cause>,
    trace: Vec<String>,
}

impl Error {
    /// An error of this kind. The message is a sentence without the place and without the cause, which
    /// [`Error::at`] and [`Error::because`] add.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Error {
        Error(Box::new(Parts {
            kind,
            location: Location::default(),
            message: message.into(),
            source: None,
            trace: Vec::new(),
        }))
    }

    /// An error of the kind [`ErrorKind::Input`].
    pub fn input(message: impl Into<String>) -> Error {
        Error::new(ErrorKind::Input, message)
    }

    /// An error of the kind [`ErrorKind::Unfit`].
    pub fn unfit(message: impl Into<String>) -> Error {
        Error::new(ErrorKind::Unfit, message)
    }

    /// An error of the kind [`ErrorKind::NotConverged`].
    pub fn not_converged(message: impl Into<String>) -> Error {
        Error::new(ErrorKind::NotConverged, message)
    }

    /// An error of the kind [`ErrorKind::Environment`].
    pub fn environment(message: impl Into<String>) -> Error {
        Error::new(ErrorKind::Environment, message)
    }

    /// The failure of `call`, a function of PETSc or SLEPc by its C name. `trace` is PETSc's own message and error
    /// stack, one entry per frame, innermost call first.
    pub fn petsc(code: i32, call: &str, trace: Vec<String>) -> Error {
        let mut error = Error::new(
            ErrorKind::Petsc(code),
            format!("{call} failed with PETSc error {code}"),
        );
        error.0.trace = trace;
        error
    }

    /// This error, found at `location`.
    pub fn at(mut self, location: impl Into<Location>) -> Error {
        self.0.location = location.into();
        self
    }

    /// This error, caused by another one.
    pub fn because(mut self, source: impl std::error::Error + Send + Sync + 'static) -> Error {
        self.0.source = Some(Arc::new(source));
        self
    }

    /// This error, met while what stands at `location` was read: the cause of an error there.
    pub fn within(self, location: impl Into<Location>) -> Error {
        Error::new(self.kind(), "").at(location).because(self)
    }

    /// This error with another message, made of the present one.
    pub fn retold(mut self, tell: impl FnOnce(&str) -> String) -> Error {
        self.0.message = tell(&self.0.message);
        self
    }

    /// The kind.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// Whether the input cannot be solved as written.
    pub fn is_input(&self) -> bool {
        self.0.kind == ErrorKind::Input
    }

    /// Whether an iteration did not reach its tolerance.
    pub fn is_not_converged(&self) -> bool {
        self.0.kind == ErrorKind::NotConverged
    }

    /// File, line, key and body, as far as they are known.
    pub fn location(&self) -> &Location {
        &self.0.location
    }

    /// The sentence without the place and without the cause; empty where the cause says it all.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// PETSc's message and error stack, one entry per frame, innermost call first; empty for other errors.
    pub fn trace(&self) -> &[String] {
        &self.0.trace
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
        match self.0.kind {
            ErrorKind::NotConverged => 1,
            ErrorKind::Input | ErrorKind::Argument(_) | ErrorKind::Unfit => 2,
            ErrorKind::Environment | ErrorKind::Ended | ErrorKind::Petsc(_) => 3,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}{}", self.0.location, self.0.message)?;
        match &self.0.source {
            Some(source) if self.0.message.is_empty() => write!(out, "{source}")?,
            Some(source) => write!(out, ": {source}")?,
            None => {}
        }
        for line in &self.0.trace {
            write!(out, "\n  {line}")?;
        }
        Ok(())
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(out)
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        let source = self.0.source.as_ref()?;
        Some(source.as_ref())
    }
}

/// The cause of an error of another rank.
#[derive(Debug)]
struct Relayed(String);

impl fmt::Display for Relayed {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.0)
    }
}

impl std::error::Error for Relayed {}

fn cause_as_text<S: Serializer>(
    cause: &Option<Cause>,
    to: S,
) -> std::result::Result<S::Ok, S::Error> {
    cause.as_ref().map(ToString::to_string).serialize(to)
}

fn cause_from_text<'de, D: Deserializer<'de>>(
    from: D,
) -> std::result::Result<Option<Cause>, D::Error> {
    let text = Option::<String>::deserialize(from)?;
    Ok(text.map(|text| Arc::new(Relayed(text)) as Cause))
}
