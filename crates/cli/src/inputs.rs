//! The files of a run with their hashes, for those who run it again.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use report::json::Input;

/// The files that are read for a scene: itself first, then those that it names, and what decks include. What cannot be
/// read is left out: whoever needs it says so.
pub(super) fn of(scene: &Path) -> Vec<Input> {
    let mut known = BTreeSet::new();
    let mut files = Vec::new();
    add(scene.to_path_buf(), &mut known, &mut files);
    let hashed = files.iter().filter_map(|path| hashed(path).ok());
    hashed.collect()
}

/// Adds a file and all that it names, each once.
fn add(path: PathBuf, known: &mut BTreeSet<PathBuf>, files: &mut Vec<PathBuf>) {
    if !known.insert(path.clone()) {
        return;
    }
    files.push(path.clone());
    let beside = |name: &str| {
        let whole = path
            .parent()
            .map_or(PathBuf::from(name), |dir| dir.join(name));
        (!name.is_empty() && whole.is_file()).then_some(whole)
    };
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let mut named: Vec<PathBuf> = Vec::new();
    match ending.as_deref() {
        Some("toml") => {
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            if let Ok(table) = text.parse::<toml::Table>() {
                strings(&toml::Value::Table(table), &mut |s| named.extend(beside(s)));
            }
        }
        Some("inp") => {
            let text = std::fs::read(&path).unwrap_or_default();
            let text = String::from_utf8_lossy(&text);
            named.extend(text.lines().filter_map(included).filter_map(beside));
        }
        _ => {}
    }
    for file in named {
        add(file, known, files);
    }
}

/// Calls `each` with every string in a value.
fn strings(value: &toml::Value, each: &mut impl FnMut(&str)) {
    match value {
        toml::Value::String(text) => each(text),
        toml::Value::Array(items) => items.iter().for_each(|item| strings(item, each)),
        toml::Value::Table(table) => table.iter().for_each(|(_, item)| strings(item, each)),
        _ => {}
    }
}

/// The file that a line of a deck includes.
fn included(line: &str) -> Option<&str> {
    let line = line.trim();
    let keyword = line
        .get(..8)
        .filter(|k| k.eq_ignore_ascii_case("*INCLUDE"))?;
    let (_, file) = line[keyword.len()..].split_once('=')?;
    Some(file.trim().trim_matches('"'))
}

fn hashed(path: &Path) -> std::io::Result<Input> {
    let (mut file, mut hash) = (File::open(path)?, Sha256::new());
    let (mut part, mut bytes) = (vec![0; 1 << 16], 0);
    loop {
        match file.read(&mut part)? {
            0 => break,
            n => {
                hash.update(&part[..n]);
                bytes += n as u64;
            }
        }
    }
    let digits = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
    Ok(Input {
        file: path.display().to_string(),
        bytes,
        sha256: digits,
    })
}

#[cfg(test)]
#[path = "../tests/inputs.rs"]
mod tests;
