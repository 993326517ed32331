//! Checkpoints: files with the state of a stepper, and with what a program keeps beside it.
//!
//! A file belongs to a scene, not to a run: the run that resumes may have other ranks, tolerances and methods. The
//! program writes such files (`fetifeti solve --checkpoint`), and so does the C interface: each reads those of the
//! other.
//!
//! [`mod@file`] writes a file, and checks and reads it. This file decides whether a checkpoint belongs to a scene.

use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::checked::Scene;
use crate::model::field::Field;
use crate::stepper::StepperState;
use base::{Error, Result};
use mesh::file::text;

pub mod file;

/// The content of a checkpoint: everything that a run needs to resume. Beside the state of the stepper it has the
/// records `R` of those who report the steps before.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint<R = NoRecords> {
    /// Title of the scene, for messages.
    pub title: String,
    /// Fingerprint of the scene.
    pub scene: u64,
    /// The records up to this state.
    #[serde(default)]
    pub records: R,
    /// The load step, and the state of the contact loop in it.
    pub stepper: StepperState,
}

/// No records beside the state; those that a file has are passed over.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct NoRecords {}

impl<R: Default + DeserializeOwned> Checkpoint<R> {
    /// Reads the checkpoint in `file` for a scene, which was read from `path` and has this [`identity`]. To be called
    /// on one rank.
    ///
    /// # Errors
    /// As [`file::read`]; [`ErrorKind::Input`](base::ErrorKind::Input) for a checkpoint of another scene.
    pub fn of_scene(file: &Path, path: &Path, scene: &Scene, identity: u64) -> Result<Self> {
        let found: Self = file::read(file)?;
        if found.scene == identity {
            return Ok(found);
        }
        let changed = if found.title == scene.title {
            " as it was before it changed"
        } else {
            ""
        };
        Err(Error::input(format!(
            "{}: the checkpoint belongs to the scene \"{}\"{changed}, expected one of \"{}\" ({})",
            file.display(),
            found.title,
            scene.title,
            path.display()
        )))
    }
}

/// A hash of what is solved: the scene, which was read from the file `path`, and the content of each file with
/// coefficients that it reads.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) with the path of a file that cannot be read.
pub fn identity(path: &Path, scene: &Scene) -> Result<u64> {
    let specs = scene.bodies.iter().map(|body| &body.spec);
    let fields = specs.flat_map(|spec| [&spec.rho, &spec.poisson]);
    let files = fields.filter_map(|field| match field {
        Field::Cells(cells) => cells.file(),
        _ => None,
    });
    let mut out = fingerprint(&text(path, "scene")?);
    // Bodies of a grid read the same file.
    let mut known: Vec<&Path> = Vec::new();
    for path in files {
        if !known.contains(&path) {
            known.push(path);
            let content = file::hash_of(path)?;
            out = file::hash(&[out.to_le_bytes(), content.to_le_bytes()].concat());
        }
    }
    Ok(out)
}

/// A hash of the scene as text: comments, layout, title and PETSc options do not change it.
fn fingerprint(text: &str) -> u64 {
    match text.parse::<toml::Table>() {
        Ok(mut table) => {
            for key in ["title", "name", "options"] {
                table.remove(key);
            }
            file::hash(table.to_string().as_bytes())
        }
        // A deck.
        Err(_) => file::hash(text.as_bytes()),
    }
}

#[cfg(test)]
#[path = "../../tests/checkpoint.rs"]
mod tests;
