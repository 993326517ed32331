//! Checkpoints of the contact loop: `--checkpoint FILE` and `--resume FILE` of `fetifeti solve`.
//!
//! A file says in which load step the run is, where the contact loop stands in it, and what came before. It belongs to
//! a scene, not to a run: ranks, tolerances and methods may be others.
//!
//! | file | what it does |
//! |---|---|
//! | [`rows`] | takes the ranks out of a state and deals it out again |
//! | [`mod@file`] | writes a checkpoint and reads it, with all that a file on a disk needs |
//! | this one | decides whether a checkpoint belongs to a scene, and goes on from it |

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::contact::State;
use crate::petsc::Session;
use crate::report::json::contact::{LoadStep, OuterStep};
use crate::report::output;
use crate::scene::Scene;
use crate::{Error, FetiFeti, Result};
use rows::{GlobalState, Layout};

pub mod file;
pub mod rows;

/// Everything that a run needs to go on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Title of the scene, for messages.
    pub title: String,
    /// Fingerprint of the scene.
    pub scene: u64,
    /// The load step that is under way.
    pub load_step: usize,
    /// The [`Records`] of the time before this state, as JSON.
    pub records: String,
    /// Where the load step stands.
    pub state: GlobalState,
}

/// What was asked for, checked before the work.
pub struct Checkpoints {
    /// File to write.
    file: Option<PathBuf>,
    /// File that was read.
    resume: Option<PathBuf>,
    title: String,
    scene: u64,
    /// What was read; rank 0 has the state.
    found: Option<Checkpoint>,
    /// Its load step and records, on every rank.
    before: Option<(usize, String)>,
}

/// The same with a solver to take states from and to give one to.
pub struct Attached {
    asked: Checkpoints,
    layout: Option<Layout>,
    start: Option<State>,
}

/// Where to go on; a run that starts afresh goes on at the beginning.
#[derive(Debug, Default)]
pub struct Resumed {
    /// Load step, from 0.
    pub load_step: usize,
    /// What was done before.
    pub records: Records,
    /// Where the load step stands.
    pub state: Option<State>,
}

/// What the report of a run says of the time before a checkpoint.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Records {
    /// Steps of the contact loop.
    pub outer: Vec<OuterStep>,
    /// Load steps that are finished.
    pub load_steps: Vec<LoadStep>,
    /// Krylov iterations of each outer step of the load steps that are finished.
    pub iterations: Vec<usize>,
}

impl Records {
    /// Takes out the outer steps of the load step that is under way.
    pub fn take(&mut self, load_step: usize) -> Vec<OuterStep> {
        let finished = self.outer.iter().take_while(|s| s.load_step != load_step);
        let n = finished.count();
        self.outer.split_off(n)
    }

    /// With the outer steps of the load step that is under way.
    pub fn followed_by(&self, outer: &[OuterStep]) -> Records {
        let mut all = self.clone();
        all.outer.extend_from_slice(outer);
        all
    }
}

impl Checkpoints {
    /// Proves that `file` can be written and reads the one to resume from; `path` is the file of the scene. Collective.
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
            let before = out.found.as_ref().map(|c| (c.load_step, c.records.clone()));
            let everywhere = before.map(|before| vec![before; session.size()]);
            out.before = Some(rows::from_first(session, everywhere));
        }
        Ok(out)
    }

    /// What rank 0 does alone.
    fn read(&mut self, path: &Path, scene: &Scene) -> Result<()> {
        if !scene.has_contact() {
            let flag = if self.resume.is_some() {
                "--resume"
            } else {
                "--checkpoint"
            };
            return Err(Error::input(format!(
                "{flag}: {} has no contact and no obstacle, so that there is no outer loop, expected a scene with inequalities",
                path.display()
            )));
        }
        let text = std::fs::read_to_string(path).map_err(|e| {
            Error::input(format!("{}: the scene cannot be read: {e}", path.display()))
        })?;
        self.scene = fingerprint(&text);
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

    /// Finds out who owns what in this run. Collective.
    ///
    /// # Errors
    /// A checkpoint whose rows are not those of the solver.
    pub fn attach(mut self, session: &Session, solver: &FetiFeti) -> Result<Attached> {
        let wanted = self.file.is_some() || self.resume.is_some();
        let layout = wanted.then(|| Layout::new(solver.method()));
        let start = match (&layout, &self.resume) {
            (Some(layout), Some(file)) => {
                let state = self.found.take().map(|found| found.state);
                Some(layout.scatter(session, file, state.as_ref())?)
            }
            _ => None,
        };
        Ok(Attached {
            asked: self,
            layout,
            start,
        })
    }
}

impl Attached {
    /// Where the run goes on. Collective.
    ///
    /// # Errors
    /// Records that are not ours.
    pub fn resume(&self, session: &Session) -> Result<Resumed> {
        let (Some((load_step, records)), Some(file)) = (&self.asked.before, &self.asked.resume)
        else {
            return Ok(Resumed::default());
        };
        let records = serde_json::from_str(records).map_err(|e| {
            Error::input(format!(
                "{}: the records of the checkpoint cannot be read: {e}",
                file.display()
            ))
        });
        Ok(Resumed {
            load_step: *load_step,
            records: session.agree(records)?,
            state: self.start.clone(),
        })
    }

    /// Writes where load step `load_step` stands and what was done so far; nothing where no file was asked for. Between
    /// two load steps that is the beginning of the next one. Collective.
    ///
    /// # Errors
    /// [`Error::Environment`] when the disk refuses; the old file is then untouched.
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
            let records = serde_json::to_string(&records())
                .map_err(|e| Error::environment(format!("{}: {e}", file.display())))?;
            let content = Checkpoint {
                title: self.asked.title.clone(),
                scene: self.asked.scene,
                load_step,
                records,
                state,
            };
            file::write(file, &content)
        };
        session.agree(layout.gather(session, state).map_or(Ok(()), write))
    }
}

/// Tells scenes apart by what is solved: comments, layout, title and PETSc options do not count.
fn fingerprint(text: &str) -> u64 {
    match text.parse::<toml::Table>() {
        Ok(mut table) => {
            for key in ["title", "name", "options"] {
                table.remove(key);
            }
            file::hash(table.to_string().as_bytes())
        }
        // Not reached: the scene was read from this text.
        Err(_) => file::hash(text.as_bytes()),
    }
}

#[cfg(test)]
mod tests {
    use super::fingerprint;

    #[test]
    fn what_is_solved_tells_scenes_apart() {
        let text = "title = \"a\"\n[[body]]\nsize = 1\nload = [{ x = [0, 1], value = 2 }]\n";
        let same = "# other words\ntitle = 'b'\n[[body]]\nload = [ {value=2, x=[0,1]} ]\nsize=1\n[options]\nfetifeti_ksp_rtol = 1e-9\n";
        let other = text.replace("value = 2", "value = 3");
        assert_eq!(fingerprint(text), fingerprint(same));
        assert_ne!(fingerprint(text), fingerprint(&other));
    }
}
