//! ParaView's collections (`.pvd`): the files of a time series with their times.

use crate::report::output;
use crate::{Error, Result};
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
    /// [`Error::Input`] when the time is not finite, is before the last one, or the file lies outside the collection's
    /// directory; [`Error::Environment`] with the path when the collection cannot be written.
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

    /// Times and files so far.
    pub fn entries(&self) -> &[(f64, String)] {
        &self.entries
    }

    fn to_text(&self) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
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
mod tests {
    use super::*;
    use crate::report::output::tests::Scratch;

    #[test]
    fn the_file_is_complete_after_every_step() {
        let dir = Scratch::new("pvd");
        let path = dir.0.join("solution.pvd");
        let mut pvd = Pvd::new(&path);
        let count = || {
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(text.ends_with("</VTKFile>\n"));
            text.matches("<DataSet ").count()
        };
        pvd.add(0.1, &dir.0.join("steps/a & \"b\".vtu")).unwrap();
        assert_eq!(count(), 1);
        pvd.add(1e-1 + 0.2, &dir.0.join("2.vtu")).unwrap();
        assert_eq!(count(), 2);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(
            text.contains("file=\"steps/a &amp; &quot;b&quot;.vtu\""),
            "{text}"
        );
        assert!(text.contains("timestep=\"0.30000000000000004\""), "{text}");
        // The same step once more, as after a restart.
        pvd.add(0.1, &dir.0.join("again.vtu")).unwrap();
        assert_eq!(count(), 2);
        assert_eq!(pvd.entries()[0], (0.1, "again.vtu".to_string()));
        // No other file is left behind.
        assert_eq!(std::fs::read_dir(&dir.0).unwrap().count(), 1);
    }

    #[test]
    fn a_collection_without_a_directory() {
        let mut pvd = Pvd::new("x.pvd");
        assert!(pvd.add(0.0, Path::new("/elsewhere/1.vtu")).is_err());
        assert!(pvd.entries().is_empty());
    }

    #[test]
    fn bad_times_and_places_are_refused() {
        let dir = Scratch::new("pvd-bad");
        let mut pvd = Pvd::new(dir.0.join("solution.pvd"));
        pvd.add(1.0, &dir.0.join("1.vtu")).unwrap();
        for (t, file, part) in [
            (f64::NAN, dir.0.join("2.vtu"), "NaN"),
            (0.5, dir.0.join("2.vtu"), "after 1"),
            (2.0, PathBuf::from("/elsewhere/2.vtu"), "/elsewhere/2.vtu"),
        ] {
            let message = pvd.add(t, &file).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
        assert_eq!(pvd.entries().len(), 1);
    }
}
