//! The events of a solve: every step of the contact loop as a line of JSON, written at once when it ends.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use base::{Error, Location, Result};
use petsc::Session;
use report::json::contact::OuterStep;
use report::output;

/// The file for events, which the first rank writes; or none.
pub(super) struct Events {
    path: Option<PathBuf>,
    file: Option<File>,
}

impl Events {
    /// Opens the file; lines are added at its end. Collective.
    ///
    /// # Errors
    /// A file that cannot be written; `-`, which is standard output elsewhere.
    pub fn new(session: &Session, path: Option<&Path>) -> Result<Events> {
        if path.is_some_and(output::is_stdout) {
            return Err(Error::input(
                "--events - is standard output, expected a file that lines can be added to",
            ));
        }
        let open = |path: &Path| {
            let file = File::options().append(true).create(true).open(path);
            file.map_err(|e| {
                Error::environment("")
                    .at(Location::file_named(path.display().to_string()))
                    .because(e)
            })
        };
        let file = path.filter(|_| session.rank() == 0).map(open);
        Ok(Events {
            path: path.map(Path::to_path_buf),
            file: session.agree(file.transpose())?,
        })
    }

    /// Writes a step. Collective.
    ///
    /// # Errors
    /// A file that can no longer be written.
    pub fn step(&self, session: &Session, step: &OuterStep) -> Result<()> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let write = |mut file: &File| {
            let mut line = serde_json::to_string(step)?;
            line.push('\n');
            file.write_all(line.as_bytes())
        };
        let written = self.file.as_ref().map_or(Ok(()), write);
        session.agree(written.map_err(|e| {
            Error::environment("")
                .at(Location::file_named(path.display().to_string()))
                .because(e)
        }))
    }
}
