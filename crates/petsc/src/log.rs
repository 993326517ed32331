//! Events and stages of `-log_view`.

use super::error::{c_string, got};
use super::Session;
use base::Result;
use std::cell::RefCell;
use std::collections::HashMap;

thread_local! {
    /// The names registered on this thread: registering a name twice would list it twice.
    static KNOWN: RefCell<HashMap<(bool, String), i32>> = RefCell::default();
}

fn register(stage: bool, name: &str, make: impl FnOnce(&mut i32) -> Result<()>) -> Result<i32> {
    let key = (stage, name.to_string());
    if let Some(id) = KNOWN.with_borrow(|known| known.get(&key).copied()) {
        return Ok(id);
    }
    let id = got(make)?;
    KNOWN.with_borrow_mut(|known| known.insert(key, id));
    Ok(id)
}

/// A kind of work that `-log_view` times, by name.
#[derive(Debug, Clone, Copy)]
pub struct Event(i32);

impl Event {
    /// The event of this name; repeated calls return the same event.
    pub fn register(_session: &Session, name: &str) -> Result<Event> {
        let class = register(false, "", |id| {
            petsc!(PetscClassIdRegister(c"fetifeti".as_ptr(), id))
        })?;
        let id = register(false, name, |id| {
            petsc!(PetscLogEventRegister(c_string(name).as_ptr(), class, id))
        })?;
        Ok(Event(id))
    }

    /// Starts the clock.
    pub fn begin(&self) -> Result<()> {
        petsc!(ff_event_begin(self.0))
    }

    /// Stops the clock.
    pub fn end(&self) -> Result<()> {
        petsc!(ff_event_end(self.0))
    }

    /// Runs the clock until the guard is dropped.
    pub fn scope(&self) -> Result<Scope> {
        self.begin()?;
        Ok(Scope::Event(*self))
    }
}

/// A phase of the program: `-log_view` has a table for each.
#[derive(Debug, Clone, Copy)]
pub struct LogStage(i32);

impl LogStage {
    /// The stage of this name; repeated calls return the same stage.
    pub fn register(_session: &Session, name: &str) -> Result<LogStage> {
        let id = register(true, name, |id| {
            // A second library with this crate in the same process may have made it, and PETSc takes a name once.
            *id = -1;
            petsc!(PetscLogStageGetId(c_string(name).as_ptr(), id))?;
            if *id >= 0 {
                return Ok(());
            }
            petsc!(PetscLogStageRegister(c_string(name).as_ptr(), id))
        })?;
        Ok(LogStage(id))
    }

    /// Makes this the current stage.
    pub fn push(&self) -> Result<()> {
        petsc!(PetscLogStagePush(self.0))
    }

    /// Returns to the previous stage.
    pub fn pop(&self) -> Result<()> {
        petsc!(PetscLogStagePop())
    }

    /// Makes this the current stage until the guard is dropped.
    pub fn scope(&self) -> Result<Scope> {
        self.push()?;
        Ok(Scope::Stage(*self))
    }
}

/// The messages that PETSc has sent on this rank since it started, as `-log_view` counts them. MPI calls of other
/// libraries are not included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Counters {
    /// Messages to single ranks.
    pub messages: f64,
    /// Their bytes.
    pub bytes: f64,
    /// All-reduces among several ranks.
    pub reductions: f64,
}

/// The counters; `None` if PETSc was built without logging.
pub fn counters() -> Option<Counters> {
    let mut counts = [0.0; 3];
    // SAFETY: the shim writes three numbers.
    let there = unsafe { petsc_sys::ff_counters(counts.as_mut_ptr()) };
    let [messages, bytes, reductions] = counts;
    (there != 0).then_some(Counters {
        messages,
        bytes,
        reductions,
    })
}

/// A guard that ends an event or a stage when dropped.
#[must_use = "the clock stops when the scope is dropped"]
pub enum Scope {
    /// A running event.
    Event(Event),
    /// The current stage.
    Stage(LogStage),
}

impl Drop for Scope {
    fn drop(&mut self) {
        // A clock that cannot be stopped is no reason to fail.
        let _ = match self {
            Scope::Event(event) => event.end(),
            Scope::Stage(stage) => stage.pop(),
        };
    }
}
