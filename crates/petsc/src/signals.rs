//! SIGINT and SIGTERM, for work that has processes and files of its own to end and to remove.

use std::cell::Cell;

use super::Session;
use base::{Error, ErrorKind, Result};
use petsc_sys as sys;

thread_local! {
    /// Whether solves end when a signal has been noted, on the thread that runs PETSc.
    static HEEDED: Cell<bool> = const { Cell::new(false) };
}

/// While one of these lives, the first signal is noted only; a second one ends the program at once.
pub struct Signals(());

impl Signals {
    /// Begins to note signals.
    pub fn watch() -> Signals {
        // SAFETY: the handler stores a number; only the thread that runs PETSc watches.
        unsafe { sys::ff_signals_watch() }
        Signals(())
    }

    /// The name of the signal that has come, if one has.
    pub fn noted() -> Option<&'static str> {
        noted()
    }
}

impl Drop for Signals {
    fn drop(&mut self) {
        // SAFETY: one call for that of `watch`.
        unsafe { sys::ff_signals_leave() }
    }
}

/// The name of the signal that has come, if one has.
fn noted() -> Option<&'static str> {
    // SAFETY: a call without arguments.
    match unsafe { sys::ff_signals_noted() } {
        0 => None,
        2 => Some("SIGINT"),
        _ => Some("SIGTERM"),
    }
}

/// While it lives, solves of all ranks end with an error when one rank has got a signal: they ask at [`heed`].
pub struct Heeded(Signals);

impl Heeded {
    /// Begins to note signals, and to end solves for them. On all ranks.
    pub fn watch() -> Heeded {
        HEEDED.set(true);
        Heeded(Signals::watch())
    }
}

impl Drop for Heeded {
    fn drop(&mut self) {
        HEEDED.set(false);
    }
}

/// An error on all ranks if one of them has got a signal; nothing unless signals are [`Heeded`]. Collective.
///
/// # Errors
/// [`ErrorKind::Ended`] with the name of the signal.
pub fn heed(session: &Session) -> Result<()> {
    if !HEEDED.get() {
        return Ok(());
    }
    session.agree(match noted() {
        None => Ok(()),
        Some(signal) => Err(Error::new(ErrorKind::Ended, format!("ended by {signal}"))),
    })
}

/// Whether an error is that of [`heed`].
pub fn is_end(error: &Error) -> bool {
    error.kind() == ErrorKind::Ended
}

/// Asks a process to end, by SIGTERM.
pub fn terminate(child: &std::process::Child) {
    // SAFETY: a child that has not been waited for keeps its number.
    unsafe { sys::ff_terminate(child.id() as i32) }
}
