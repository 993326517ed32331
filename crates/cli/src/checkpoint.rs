//! Checkpoints of the contact loop: `--checkpoint FILE` and `--resume FILE` of `fetifeti solve`.
//!
//! A file ([`scene::checkpoint`]) holds the state of the stepper, and here the records of everything before.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use base::{output, Error, Location, Result};
use bytemuck::{cast_slice, pod_collect_to_vec};
use parallel::exchange::gather_all;
use petsc::Session;
use report::json::contact::{LoadStep, OuterStep};
use scene::checkpoint::{file, identity};
use scene::stepper::Checkpointer;
use scene::{Scene, Stepper, StepperState};

/// A checkpoint of the program.
type Checkpoint = scene::Checkpoint<Records>;

/// The files that the command line names, checked before the solve.
pub struct Checkpoints {
    /// File to write.
    file: Option<PathBuf>,
    /// File to resume from.
    resume: Option<PathBuf>,
    title: String,
    scene: u64,
    /// The checkpoint that was read, on rank 0.
    found: Option<Checkpoint>,
}

/// The part of a run's report that was made before a checkpoint.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
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
        };
        if out.file.is_none() && out.resume.is_none() {
            return Ok(out);
        }
        let read = match session.rank() {
            0 => out.read(path, scene),
            _ => Ok(()),
        };
        session.agree(read)?;
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
        self.scene = identity(path, scene)?;
        if let Some(file) = &self.file {
            if output::is_stdout(file) {
                return Err(Error::input(
                    "--checkpoint - is standard output, expected a file that can be replaced",
                ));
            }
            output::prepare_file(file)?;
        }
        if let Some(file) = &self.resume {
            self.found = Some(Checkpoint::of_scene(file, path, scene, self.scene)?);
        }
        Ok(())
    }

    /// The stepper at the point at which the run resumes, and the records of everything before; without a checkpoint,
    /// the beginning. Collective.
    ///
    /// # Errors
    /// A checkpoint whose rows are not those of the solver, contacts that cannot be renewed.
    pub fn resume(&mut self, session: &Session, stepper: Stepper) -> Result<(Stepper, Records)> {
        let Some(file) = &self.resume else {
            return Ok((stepper, Records::default()));
        };
        let found = self.found.take();
        let state = found.as_ref().map(|found| &found.stepper);
        let resumed = stepper.resume(state).map_err(|e| match e.is_input() {
            true => e.at(Location::file_named(file.display().to_string())),
            false => e,
        })?;
        let text = found.map_or(Ok(Vec::new()), |found| serde_json::to_vec(&found.records));
        let text = text.expect("numbers, texts and lists have a form");
        let words: Vec<u32> = pod_collect_to_vec(&text);
        let everywhere = gather_all(session.comm(), &words).concat();
        // Behind the text are zeros up to a whole word.
        let mut text = serde_json::Deserializer::from_slice(cast_slice(&everywhere));
        let records = Records::deserialize(&mut text).expect("rank 0 has written it");
        Ok((resumed, records))
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
        what += match (&self.file, load_step + steps) {
            (Some(file), 1..) => {
                return Error::environment(format!("{what}, --resume {} goes on", file.display()))
            }
            (_, 0) => "",
            (None, _) => " (--checkpoint FILE would have kept them)",
        };
        Error::environment(what)
    }

    /// Makes checkpoints inside the load step that is ready, if a file was asked for. Collective.
    pub fn checkpointer(&self, stepper: &Stepper) -> Option<Checkpointer> {
        self.file.as_ref().map(|_| stepper.checkpointer())
    }

    /// Writes a state, which rank 0 has, and the records so far; does nothing where no file was asked for. Collective.
    ///
    /// # Errors
    /// [`ErrorKind::Environment`](base::ErrorKind::Environment) when the disk refuses; the old file is then untouched.
    pub fn save(
        &self,
        session: &Session,
        state: Option<StepperState>,
        records: impl FnOnce() -> Records,
    ) -> Result<()> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        let write = |stepper| {
            let content = Checkpoint {
                title: self.title.clone(),
                scene: self.scene,
                records: records(),
                stepper,
            };
            file::write(file, &content)
        };
        session.agree(state.map_or(Ok(()), write))
    }
}
