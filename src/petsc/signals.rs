//! SIGINT and SIGTERM, for work that has processes and files of its own to end and to remove.

use petsc_sys as sys;

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
        // SAFETY: a call without arguments.
        match unsafe { sys::ff_signals_noted() } {
            0 => None,
            2 => Some("SIGINT"),
            _ => Some("SIGTERM"),
        }
    }
}

impl Drop for Signals {
    fn drop(&mut self) {
        // SAFETY: one call for that of `watch`.
        unsafe { sys::ff_signals_leave() }
    }
}

/// Asks a process to end, by SIGTERM.
pub fn terminate(child: &std::process::Child) {
    // SAFETY: a child that has not been waited for keeps its number.
    unsafe { sys::ff_terminate(child.id() as i32) }
}
