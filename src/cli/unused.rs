//! A warning about options that nobody has asked for.

use super::args::Command;
use crate::petsc::{Options, Session};
use crate::Result;

/// The prefixes of options that a command reads itself. What it only hands on to other processes, or would read in a
/// solve, is left out.
fn prefixes(command: &Command) -> &'static [&'static str] {
    match command {
        Command::Solve(_) | Command::Table1(_) => &["fetifeti_"],
        Command::Compare(_) | Command::Bench(_) => &["compare_"],
        Command::Study(_) => &["scaling_"],
        _ => &[],
    }
}

/// The warning after `command`, if there is anything to warn of. PETSc's own list, `-options_left`, takes its place.
pub fn warning(session: &Session, command: &Command) -> Result<Option<String>> {
    let of = prefixes(command);
    if of.is_empty() || Options::new(session, "").has("options_left")? {
        return Ok(None);
    }
    let mut names = Vec::new();
    for prefix in of {
        let left = Options::new(session, prefix).left()?;
        names.extend(left.into_iter().map(|(name, _)| name));
    }
    names.sort();
    names.dedup();
    Ok((!names.is_empty()).then(|| {
        format!(
            "Warning: nobody has asked for {}: misspelt, or of a part that this problem does not need \
             (fetifeti -help lists the options)",
            names.join(", ")
        )
    }))
}
