//! Functions shared by the tables of `compare` and `bench`, which have a method in each row.

use super::table::count;
use crate::json::{CompareContact, MethodRun};

/// The words for layouts, for the text below a table.
pub(super) const LAYOUTS: &str = "\
layout: threads or ranks for ours, or merged: threads, and bodies tied by whole faces are one, as they are for the \
others;\nelse a rank per subdomain, body or core (one part each: its subdomains are merged),\nor packed: a rank per \
core, whose MATIS keeps its subdomains apart (PETSc 3.21 and later);";

/// The options of each method, a line each; layouts with the same options share one.
pub(super) fn options<'a>(runs: impl Iterator<Item = &'a MethodRun>) -> String {
    let mut lines: Vec<(&MethodRun, Vec<&str>)> = Vec::new();
    for run in runs.filter(|run| !run.options.is_empty()) {
        let alike = |known: &MethodRun| {
            known.method == run.method && known.options == run.options && known.given == run.given
        };
        match lines.iter_mut().find(|(known, _)| alike(known)) {
            Some((_, layouts)) => layouts.push(&run.layout),
            None => lines.push((run, vec![&run.layout])),
        }
    }
    let mut text = String::new();
    for (run, layouts) in &lines {
        text += &format!("  {} ({}): {}", run.method, layouts.join(", "), run.options);
        text += &match run.given.as_str() {
            "" => "\n".to_string(),
            given => format!("  with {given}\n"),
        };
    }
    match text.is_empty() {
        true => text,
        false => format!("options:\n{text}"),
    }
}

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
