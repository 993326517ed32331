//! Work that rank 0 does for all ranks.

use base::Result;
use petsc::Session;
use report::output;

/// Does `work` on rank 0. Collective.
///
/// # Errors
/// Those of `work`, on all ranks.
pub fn on_first_rank(session: &Session, work: impl FnOnce() -> Result<()>) -> Result<()> {
    session.agree(match session.rank() {
        0 => work(),
        _ => Ok(()),
    })
}

/// Prints `text` on rank 0. Collective.
///
/// # Errors
/// [`base::ErrorKind::Environment`] where standard output cannot be written.
pub fn say(session: &Session, text: &str) -> Result<()> {
    on_first_rank(session, || output::print(text))
}
