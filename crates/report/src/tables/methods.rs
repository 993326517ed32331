//! Functions shared by the tables of `compare` and `bench`, which have a method in each row.

use super::table::count;
use crate::json::{CompareContact, MethodRun};

/// Ranks, and threads where a rank has several.
pub(super) fn ranks_and_threads(run: &MethodRun) -> String {
    match run.threads {
        0 | 1 => run.ranks.to_string(),
        n => format!("{} x {n}", run.ranks),
    }
}

/// The number of active sets that were solved for.
pub(super) fn outer(run: &MethodRun) -> String {
    match run.contact {
        Some(CompareContact { outer: None, .. }) => "last set".to_string(),
        contact => count(contact.and_then(|c| c.outer)),
    }
}

/// The end of a run in a word; longer messages go to `note`.
pub(super) fn outcome(run: &MethodRun, mut note: impl FnMut(String)) -> String {
    if let Some(options) = &run.rescue {
        note(format!("second try, with {options}"));
    }
    match &run.message {
        None => run.converged_reason.clone(),
        Some(message) => {
            note(message.clone());
            "see below".to_string()
        }
    }
}
