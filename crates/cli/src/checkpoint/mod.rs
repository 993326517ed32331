//! Checkpoints of the contact loop: `--checkpoint FILE` and `--resume FILE` of `fetifeti solve`.
//!
//! A file holds the current load step, the state of the contact loop in it, and the records of everything before. Where
//! load steps renew contacts it holds the displacements, too, from which those of the current step follow. It belongs
//! to a scene, not to a run: the run that resumes may have other ranks, tolerances and methods.
//!
//! | file | task |
//! |---|---|
//! | [`rows`] | removes the ranks from a state, and distributes it again |
//! | [`mod@file`] | writes a checkpoint file, and checks and reads it |
//! | this one | decides whether a checkpoint belongs to a scene, and resumes from it |

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use base::{Error, Location, Result};
use fetifeti::solution::State;
use fetifeti::FetiFeti;
use petsc::Session;
use report::json::contact::{LoadStep, OuterStep};
use report::output;
use rows::{CheckpointLayout, GlobalState};
use scene::{Displaced, Field, Scene};

pub mod file;
pub mod rows;

/// The content of a checkpoint: everything that a run needs to resume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Title of the scene, for messages.
    pub title: String,
    /// Fingerprint of the scene.
    pub scene: u64,
    /// The current load step.
    pub load_step: usize,
    /// The [`Records`] up to this state, as JSON.
    pub records: String,
    /// The displacements by body and node for which the contacts of the load step were made; empty unless load steps
    /// renew them.
    pub left: Vec<(usize, usize, [f64; 3])>,
    /// The state of the contact loop in the load step.
    pub state: GlobalState,
}

/// The part of a checkpoint that every rank needs.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Before {
    load_step: usize,
    records: String,
    left: Vec<(usize, usize, [f64; 3])>,
}

/// The files that the command line names, checked before the solve.
pub struct Checkpoints {
    /// File to write.
    file: Option<PathBuf>,
    /// File to resume from.
    resume: Option<PathBuf>,
    title: String,
    scene: u64,
    /// The checkpoint that was read; only rank 0 has the state.
    found: Option<Checkpoint>,
    /// The rest of it, on every rank.
    before: Option<Before>,
}

/// [`Checkpoints`] with a solver that provides and takes states.
pub struct AttachedCheckpoints {
    asked: Checkpoints,
    layout: Option<CheckpointLayout>,
    start: Option<State>,
    /// The displacements for which the present contacts were made, where load steps renew them.
    left: Displaced,
}

/// The point at which a run resumes; without a checkpoint, the beginning.
#[derive(Debug, Default)]
pub struct Resumed {
    /// Load step, from 0.
    pub load_step: usize,
    /// The records of everything before.
    pub records: Records,
    /// The state of the contact loop in this load step.
    pub state: Option<State>,
}

/// The part of a run's report that was made before a checkpoint.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Records {
    /// Steps of the contact loop.
    pub outer: Vec<OuterStep>,
    /// Finished load steps.
    pub load_steps: Vec<LoadStep>,
    /// Krylov iterations of each outer step of the finished load steps.
    pub iterations: Vec<usize>,
}

impl Records {
    /// Removes and returns the outer steps of the current load step.
    pub fn take(&mut self, load_step: usize) -> Vec<OuterStep> {
        let finished = self.outer.iter().take_while(|s| s.load_step != load_step);
        let n = finished.count();
        self.outer.split_off(n)
    }

    /// These records followed by the outer steps of the current load step.
    pub fn followed_by(&self, outer: &[OuterStep]) -> Records {
        let mut all = self.clone();
        all.outer.extend_from_slice(outer);
        all
    }
}

impl Checkpoints {
    /// Tests that `file` can be written, and reads the checkpoint to resume from; `path` is the file of the scene.
    /// Collective.
    ///
    /// # Errors
    /// A scene without an outer loop, a place that cannot be written, a file that is no checkpoint of this scene.
    pub fn new(
        session: &Session,
        path: &Path,
        scene: &Scene,
        file: Option<&Path>,
        resume: Option<&Path>,
    ) -> Result<Checkpoints> {
        let mut out = Checkpoints {
            file: file.map(Path::to_path_buf),
            resume: resume.map(Path::to_path_buf),
            title: scene.title.clone(),
            scene: 0,
            found: None,
            before: None,
        };
        if out.file.is_none() && out.resume.is_none() {
            return Ok(out);
        }
        let read = match session.rank() {
            0 => out.read(path, scene),
            _ => Ok(()),
        };
        session.agree(read)?;
        if out.resume.is_some() {
            let before = out.found.as_ref().map(|c| Before {
                load_step: c.load_step,
                records: c.records.clone(),
                left: c.left.clone(),
            });
            let everywhere = before.map(|before| vec![before; session.size()]);
            out.before = Some(rows::from_first(session, everywhere));
        }
        Ok(out)
    }

    /// The part on rank 0: reads the checkpoint and compares it with the scene.
    fn read(&mut self, path: &Path, scene: &Scene) -> Result<()> {
        let flag = match self.resume {
            Some(_) => "--resume",
            None => "--checkpoint",
        };
        if !scene.has_contact() {
            return Err(Error::input(format!(
                "{flag}: {} has no contact and no obstacle, \
                 so that there is no outer loop, expected a scene with inequalities",
                path.display()
            )));
        }
        let text = std::fs::read_to_string(path).map_err(|e| {
            Error::input("the scene cannot be read")
                .at(Location::file_named(path.display().to_string()))
                .because(e)
        })?;
        self.scene = identity(&text, scene)?;
        if let Some(file) = &self.file {
            if output::is_stdout(file) {
                return Err(Error::input(
                    "--checkpoint - is standard output, expected a file that can be replaced",
                ));
            }
            output::prepare_file(file)?;
        }
        if let Some(file) = &self.resume {
            let found = file::read(file)?;
            let name = file.display();
            if found.scene != self.scene {
                return Err(Error::input(format!(
                    "{name}: the checkpoint belongs to the scene \"{}\"{}, expected one of \"{}\" ({})",
                    found.title,
                    if found.title == scene.title {
                        " as it was before it changed"
                    } else {
                        ""
                    },
                    scene.title,
                    path.display()
                )));
            }
            if found.load_step >= scene.n_steps() {
                return Err(Error::input(format!(
                    "{name}: the checkpoint stands in load step {}, expected one below {}",
                    found.load_step,
                    scene.n_steps()
                )));
            }
            self.found = Some(found);
        }
        Ok(())
    }

    /// The load step at which the run resumes, and the displacements for which its contacts were made; `None` without a
    /// checkpoint, and in the first load step.
    pub fn left(&self) -> Option<(usize, Displaced)> {
        let before = self.before.as_ref().filter(|b| b.load_step > 0)?;
        Some((before.load_step, Displaced::of_nodes(&before.left)))
    }

    /// Determines the owners of rows in this run. The solver must have the rows of the load step at which it resumes.
    /// Collective.
    ///
    /// # Errors
    /// A checkpoint whose rows are not those of the solver.
    pub fn attach(mut self, session: &Session, solver: &FetiFeti) -> Result<AttachedCheckpoints> {
        let wanted = self.file.is_some() || self.resume.is_some();
        let layout = wanted.then(|| CheckpointLayout::new(solver.method()));
        let start = match (&layout, &self.resume) {
            (Some(layout), Some(file)) => {
                let state = self.found.take().map(|found| found.state);
                Some(layout.scatter(session, file, state.as_ref())?)
            }
            _ => None,
        };
        Ok(AttachedCheckpoints {
            left: self.left().map(|(_, left)| left).unwrap_or_default(),
            asked: self,
            layout,
            start,
        })
    }
}

impl AttachedCheckpoints {
    /// The point at which the run resumes. Collective.
    ///
    /// # Errors
    /// Records that this program has not written.
    pub fn resume(&self, session: &Session) -> Result<Resumed> {
        let (Some(before), Some(file)) = (&self.asked.before, &self.asked.resume) else {
            return Ok(Resumed::default());
        };
        let records = serde_json::from_str(&before.records).map_err(|e| {
            Error::input("the records of the checkpoint cannot be read")
                .at(Location::file_named(file.display().to_string()))
                .because(e)
        });
        Ok(Resumed {
            load_step: before.load_step,
            records: session.agree(records)?,
            state: self.start.clone(),
        })
    }

    /// The error of a run that a signal has ended: where it was, and how to go on from there.
    pub fn ended(&self, error: Error, (load_step, n): (usize, usize), steps: usize) -> Error {
        let mut what = error.to_string();
        if n > 1 {
            what += &format!(" in load step {} of {n}", load_step + 1);
        }
        if steps > 0 {
            what += &format!(" after {steps} contact steps");
        }
        what += match (&self.asked.file, load_step + steps) {
            (Some(file), 1..) => {
                return Error::environment(format!("{what}, --resume {} goes on", file.display()))
            }
            (_, 0) => "",
            (None, _) => " (--checkpoint FILE would have kept them)",
        };
        Error::environment(what)
    }

    /// Notes that the solver has new rows, made for these displacements. Collective.
    pub fn renewed(&mut self, solver: &FetiFeti, left: &Displaced) {
        if let Some(layout) = &mut self.layout {
            *layout = CheckpointLayout::new(solver.method());
            self.left.clone_from(left);
        }
    }

    /// Writes the state of load step `load_step` and the records so far; does nothing where no file was asked for.
    /// Between two load steps the state is the beginning of the next one. Collective.
    ///
    /// # Errors
    /// [`ErrorKind::Environment`](base::ErrorKind::Environment) when the disk refuses; the old file is then untouched.
    pub fn save(
        &self,
        session: &Session,
        load_step: usize,
        records: impl FnOnce() -> Records,
        state: &State,
    ) -> Result<()> {
        let (Some(file), Some(layout)) = (&self.asked.file, &self.layout) else {
            return Ok(());
        };
        let write = |state| {
            let records = serde_json::to_string(&records()).map_err(|e| {
                Error::environment("")
                    .at(Location::file_named(file.display().to_string()))
                    .because(e)
            })?;
            let content = Checkpoint {
                title: self.asked.title.clone(),
                scene: self.asked.scene,
                load_step,
                records,
                left: self.left.nodes(),
                state,
            };
            file::write(file, &content)
        };
        session.agree(layout.gather(session, state).map_or(Ok(()), write))
    }
}

/// A hash of what is solved: the scene, and the content of each file with coefficients that it reads.
fn identity(text: &str, scene: &Scene) -> Result<u64> {
    let specs = scene.bodies.iter().map(|body| &body.spec);
    let fields = specs.flat_map(|spec| [&spec.rho, &spec.poisson]);
    let files = fields.filter_map(|field| match field {
        Field::Cells(cells) => cells.file(),
        _ => None,
    });
    let mut out = fingerprint(text);
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
        // Unreachable: the scene was read from this text.
        Err(_) => file::hash(text.as_bytes()),
    }
}

#[cfg(test)]
#[path = "../../tests/checkpoint.rs"]
mod tests;
