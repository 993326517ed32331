//! Where the results of a command go: the terminal, a JSON file, a directory.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{json, output};
use base::Result;

/// The destination of a command's results.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Destination {
    /// Directory for all results.
    pub out: Option<PathBuf>,
    /// File for the JSON record; `-` is standard output.
    pub json: Option<PathBuf>,
    /// Whether nothing is printed on the terminal.
    pub quiet: bool,
}

impl Destination {
    /// Checks, before the computation, that results can be written.
    ///
    /// # Errors
    /// [`base::ErrorKind::Environment`] with the path.
    pub fn prepare(&self) -> Result<()> {
        if let Some(dir) = &self.out {
            output::prepare_directory(dir)?;
        }
        self.json.as_deref().map_or(Ok(()), output::prepare_file)
    }

    /// Whether the record goes to standard output.
    pub fn json_on_stdout(&self) -> bool {
        self.json.as_deref().is_some_and(output::is_stdout)
    }

    /// Whether no text is printed on standard output: with `--quiet`, or because the record goes there.
    pub fn silent(&self) -> bool {
        self.quiet || self.json_on_stdout()
    }

    /// Prints text on standard output, unless that is [`silent`](Self::silent).
    ///
    /// # Errors
    /// [`base::ErrorKind::Environment`].
    pub fn print(&self, text: &str) -> Result<()> {
        if self.silent() {
            Ok(())
        } else {
            output::print(text)
        }
    }

    /// Prints a progress line on stderr, if that is a terminal; the next line overwrites it, an empty one removes it.
    pub fn progress(&self, line: &str) {
        if !self.quiet && std::io::stderr().is_terminal() {
            eprint!("\r\x1b[K{line}");
        }
    }

    /// Writes the record to the JSON file, and to the file `name` in the directory.
    ///
    /// # Errors
    /// [`base::ErrorKind::Environment`] with the path.
    pub fn write_json<T: Serialize>(&self, name: &str, record: &T) -> Result<()> {
        if let Some(file) = &self.json {
            json::write(file, record)?;
        }
        match &self.out {
            Some(dir) => json::write(&dir.join(name), record),
            None => Ok(()),
        }
    }

    /// Prints a list of the files that were written to the directory.
    ///
    /// # Errors
    /// [`base::ErrorKind::Environment`].
    pub fn written<S: AsRef<str>>(&self, files: &[S]) -> Result<()> {
        let Some(dir) = &self.out else { return Ok(()) };
        let list: Vec<&str> = files.iter().map(S::as_ref).collect();
        self.print(&format!(
            "written: {} in {}\n",
            list.join(", "),
            dir.display()
        ))
    }

    /// Prints `text` and writes the record, in the directory as `STEM.json`. `more` writes the other files there and
    /// returns their names.
    ///
    /// # Errors
    /// [`base::ErrorKind::Environment`]; those of `more`.
    pub fn finish<T: Serialize>(
        &self,
        stem: &str,
        text: &str,
        record: &T,
        more: impl FnOnce(&Path) -> Result<Vec<String>>,
    ) -> Result<()> {
        self.print(text)?;
        let json = format!("{stem}.json");
        self.write_json(&json, record)?;
        let Some(dir) = &self.out else { return Ok(()) };
        let mut files = vec![json];
        files.extend(more(dir)?);
        self.written(&files)
    }
}
