//! The job of one process group of a comparison: one method on one scene, or the judgement of all solutions.
//!
//! A method writes its solution to a file, in the order of [`UnknownLayout`](crate::assembled::layout::UnknownLayout).
//! The judge compares all solutions with one assembled matrix and one direct solution, so that no method measures its
//! own error.

use std::path::Path;

use super::judge::judge;
use super::launch::{leave, task};
use super::table::{Baseline, BaselineCase};
use super::task::{BaselineTask, Job, Outcome};
use super::{contact, linear, ours};
use crate::assembled::system::MatrixFormat;
use base::{Error, Result};
use parallel::meter::memory;
use petsc::Session;
use scene::distribution;

/// Runs the job that `file` describes. Collective.
///
/// # Errors
/// Those of the scene, of the method, and of the disk.
pub fn run(session: &Session, file: &Path) -> Result<()> {
    let job: Job = task(session, file, "a job that compare has written")?;
    let memory_at_start = memory(session);
    let scene = distribution::load(session, &job.scene)?;
    let outcome = match &job.task {
        BaselineTask::FetiFeti {
            threads,
            merges,
            solution,
        } => ours::solve(session, &scene, &job, (*threads, *merges), solution)?,
        BaselineTask::Baseline {
            name,
            rescue,
            separate,
            active,
            solution,
        } => {
            let row = Baseline::named(name)
                .ok_or_else(|| Error::input(format!("there is no baseline \"{name}\"")))?;
            let case = BaselineCase {
                rescue: *rescue,
                ..BaselineCase::of(session, &scene)?
            };
            row.set_options(session, job.rtol, case)?;
            match row.format {
                MatrixFormat::Assembled if scene.has_contact() => {
                    contact::baseline(session, &scene, &job, row, solution)?
                }
                format => {
                    let format = if *separate {
                        MatrixFormat::Separate
                    } else {
                        format
                    };
                    linear::baseline(session, &scene, &job, (row, format), active, solution)?
                }
            }
        }
        BaselineTask::Judge { solutions } => {
            let verdict = judge(session, &scene, solutions)?;
            return leave(session, file, &verdict);
        }
    };
    let outcome = Outcome {
        memory_at_start,
        ..outcome
    };
    leave(session, file, &outcome)
}
