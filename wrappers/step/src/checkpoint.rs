//! Checkpoints of a `FetiFetiStep`: files that the program reads and writes, too.

use std::ffi::{c_char, c_int};
use std::path::Path;

use base::{Fault, Location, Result};
use fetifeti::inside::c::{together, Held};
use scene::checkpoint::file;
use scene::Checkpoint;

use crate::life::{file_name, Pointer};
use crate::object::{path, Steps};

#[no_mangle]
unsafe extern "C" fn FetiFetiStepCheckpoint(step: Pointer, file: *const c_char) -> c_int {
    together(step, c"FetiFetiStepCheckpoint", |o| {
        write(o, &path(file_name(file, "checkpoint")?))
    })
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepResume(step: Pointer, file: *const c_char) -> c_int {
    together(step, c"FetiFetiStepResume", |o| {
        resume(o, &path(file_name(file, "checkpoint")?))
    })
}

/// Writes the state at the start of the next load step, if there is one and a step was solved. Collective.
fn write(o: &mut Steps, to: &Path) -> Result<()> {
    let state = o.work(|stepper| stepper.checkpoint())?;
    let scene = o.stepper()?.scene();
    let write = |stepper| {
        let checkpoint: Checkpoint = Checkpoint {
            title: scene.title.clone(),
            scene: o.identity,
            records: Default::default(),
            stepper,
        };
        file::write(to, &checkpoint)
    };
    o.session().agree(state.map_or(Ok(()), write))
}

/// Takes the stepper to the load step of a checkpoint, which rank 0 reads. Collective.
fn resume(o: &mut Steps, from: &Path) -> Result<()> {
    if o.has_begun() {
        return Err(Fault::WrongState.error(
            "a load step was solved already, expected FetiFetiStepResume before FetiFetiStepNext",
        ));
    }
    let scene = o.stepper()?.scene();
    let read = || -> Result<Checkpoint> { Checkpoint::of_scene(from, &o.path, scene, o.identity) };
    let first = o.session().rank() == 0;
    let found = o.session().agree(first.then(read).transpose())?;
    let state = found.as_ref().map(|found| &found.stepper);
    let resumed = o.replace(|stepper| stepper.resume(state));
    resumed.map_err(|e| match e.is_input() {
        true => e.at(Location::file_named(from.display().to_string())),
        false => e,
    })
}
