//! Output of results: files written atomically, or standard output for the path `-`.

use crate::error::{Error, Result};
use std::fs;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes a file through `fill`, first to a temporary name beside it, then by a rename: a reader sees the old file or
/// the complete new one. Missing directories are made. The path `-` is standard output; devices and pipes are written
/// directly.
///
/// # Errors
/// [`ErrorKind::Environment`](crate::ErrorKind::Environment), one sentence with the path, when writing fails; the old
/// file is then untouched.
pub fn write_file(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<()> {
    replace(path, false, fill)
}

/// As [`write_file`], for bytes that must survive a crash of the machine: they are on the disk before the old file is
/// replaced.
///
/// # Errors
/// As [`write_file`].
pub fn write_durably(path: &Path, bytes: &[u8]) -> Result<()> {
    replace(path, true, |out| out.write_all(bytes))
}

fn replace(
    path: &Path,
    durable: bool,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<()> {
    let refused =
        |e: std::io::Error| Error::environment(format!("cannot write {}", shown(path))).because(e);
    if is_stdout(path) {
        let mut out = BufWriter::new(std::io::stdout().lock());
        return fill(&mut out).and_then(|()| out.flush()).map_err(refused);
    }
    // A symbolic link is kept: the file it points to is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if let Ok(there) = fs::metadata(&target) {
        if there.is_dir() {
            return Err(Error::environment(format!(
                "cannot write {}: it is a directory, expected a file",
                shown(path)
            )));
        }
        if !there.is_file() {
            // Renaming over /dev/null or a pipe would replace the device by a file.
            let device = fs::OpenOptions::new()
                .write(true)
                .open(&target)
                .map_err(refused)?;
            let mut out = BufWriter::new(device);
            return fill(&mut out).and_then(|()| out.flush()).map_err(refused);
        }
    }
    if let Some(parent) = target.parent().filter(|p| !p.as_os_str().is_empty()) {
        fs::create_dir_all(parent).map_err(refused)?;
    }
    let temporary = temporary_name(&target);
    let written = fs::File::create(&temporary).and_then(|file| {
        let mut out = BufWriter::new(file);
        fill(&mut out)?;
        out.flush()?;
        if durable {
            out.get_ref().sync_all()?;
        }
        drop(out);
        fs::rename(&temporary, &target)
    });
    if written.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    written.map_err(refused)
}

/// As [`write_file`], for text.
///
/// # Errors
/// As [`write_file`].
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    write_file(path, |out| out.write_all(text.as_bytes()))
}

/// Prints text on standard output. Unlike `print!` it does not panic where the output is a full disk or a closed pipe.
///
/// # Errors
/// [`ErrorKind::Environment`](crate::ErrorKind::Environment).
pub fn print(text: &str) -> Result<()> {
    write_text(Path::new("-"), text)
}

/// Makes a directory for results and tests, with an empty file that it removes again, that files can be written there.
/// It is called before a long computation, so that the results do not get lost at the end.
///
/// # Errors
/// [`ErrorKind::Environment`](crate::ErrorKind::Environment) with the path.
pub fn prepare_directory(path: &Path) -> Result<()> {
    let refused = |e: std::io::Error| {
        Error::environment(format!("cannot write into the directory {}", shown(path))).because(e)
    };
    if fs::metadata(path).is_ok_and(|there| !there.is_dir()) {
        return Err(Error::environment(format!(
            "cannot write into the directory {}: it is a file, expected a directory",
            shown(path)
        )));
    }
    fs::create_dir_all(path).map_err(refused)?;
    let probe = temporary_name(&path.join("probe"));
    fs::File::create(&probe).map_err(refused)?;
    fs::remove_file(&probe).map_err(refused)
}

/// As [`prepare_directory`], for the directory of a result file; for the path `-` it does nothing.
///
/// # Errors
/// [`ErrorKind::Environment`](crate::ErrorKind::Environment) with the path.
pub fn prepare_file(path: &Path) -> Result<()> {
    if is_stdout(path) {
        return Ok(());
    }
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => {
            return Err(Error::environment(format!(
                "cannot write {}: it is a directory, expected a file",
                shown(path)
            )))
        }
        Ok(there) if !there.is_file() => return Ok(()),
        _ => {}
    }
    match path.parent().filter(|p| !p.as_os_str().is_empty()) {
        Some(parent) => prepare_directory(parent),
        None => prepare_directory(Path::new(".")),
    }
}

/// Whether a path stands for standard output.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

fn shown(path: &Path) -> String {
    if is_stdout(path) {
        "to standard output".to_string()
    } else {
        path.display().to_string()
    }
}

fn temporary_name(target: &Path) -> PathBuf {
    let name = target
        .file_name()
        .map(|n| n.to_string_lossy().into_owned())
        .unwrap_or_default();
    target.with_file_name(format!(".{name}.{}.tmp", std::process::id()))
}

#[cfg(test)]
#[path = "../tests/output.rs"]
mod tests;
