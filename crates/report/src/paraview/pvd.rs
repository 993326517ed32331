//! ParaView's collections (`.pvd`): the files of a time series with their times.

use crate::output;
use base::{Error, Result};
use std::path::{Path, PathBuf};

/// A collection that grows step by step. Its file is complete after every step: an interrupted run leaves a valid
/// series, and ParaView can open it during the run.
#[derive(Debug, Clone)]
pub struct Pvd {
    path: PathBuf,
    entries: Vec<(f64, String)>,
}

impl Pvd {
    /// An empty collection; nothing is written yet.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Pvd {
            path: path.into(),
            entries: Vec::new(),
        }
    }

    /// Adds the file of one time and writes the collection again. The file is named relative to the collection, so that
    /// their directory can be moved. If the time exists already, as after a restart, its file is replaced.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) when the time is not finite, is before the last one, or the file
    /// lies outside the collection's directory; [`ErrorKind::Environment`](base::ErrorKind::Environment) with the path
    /// when the collection cannot be written.
    pub fn add(&mut self, t: f64, file: &Path) -> Result<()> {
        let known = self.entries.iter().position(|e| e.0 == t);
        let last = self.entries.last().map_or(f64::NEG_INFINITY, |e| e.0);
        if !t.is_finite() || (known.is_none() && t < last) {
            return Err(Error::input(format!(
                "the time series {} got the time {t}, expected a number after {last}",
                self.path.display()
            )));
        }
        let directory = self.path.parent().unwrap_or(Path::new(""));
        let relative = file.strip_prefix(directory).ok().and_then(Path::to_str);
        let Some(relative) = relative.filter(|r| !r.is_empty() && !r.starts_with('/')) else {
            return Err(Error::input(format!(
                "the time series {} cannot name the file {}, expected one in its directory or below it",
                self.path.display(),
                file.display()
            )));
        };
        let entry = (t, relative.replace('\\', "/"));
        match known {
            Some(k) => self.entries[k] = entry,
            None => self.entries.push(entry),
        }
        output::write_text(&self.path, &self.to_text())
    }

    fn to_text(&self) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
        );
        for (t, file) in &self.entries {
            let file = file
                .replace('&', "&amp;")
                .replace('<', "&lt;")
                .replace('"', "&quot;");
            text += &format!("<DataSet timestep=\"{t}\" group=\"\" part=\"0\" file=\"{file}\"/>\n");
        }
        text + "</Collection>\n</VTKFile>\n"
    }
}

#[cfg(test)]
#[path = "../../tests/paraview/pvd.rs"]
mod tests;
