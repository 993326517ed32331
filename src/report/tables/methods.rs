//! Functions shared by the tables of `compare` and `bench`, which have a method in each row.

use super::table::count;
use crate::report::json::CompareContact;

/// The cells of a row, without those at certain positions.
pub(super) fn without<T>(places: &[usize], cells: impl IntoIterator<Item = T>) -> Vec<T> {
    let kept = (0..).zip(cells).filter(|(k, _)| !places.contains(k));
    kept.map(|(_, cell)| cell).collect()
}

/// Ranks, and threads where a rank has several.
pub(super) fn ranks_and_threads(ranks: usize, threads: usize) -> String {
    match threads {
        0 | 1 => ranks.to_string(),
        n => format!("{ranks} x {n}"),
    }
}

/// The number of active sets that were solved for.
pub(super) fn outer(contact: Option<CompareContact>) -> String {
    match contact {
        Some(CompareContact { outer: None, .. }) => "last set".to_string(),
        contact => count(contact.and_then(|c| c.outer)),
    }
}

/// The end of a run in a word; longer messages go to `note`.
pub(super) fn outcome(
    reason: &str,
    rescue: Option<&str>,
    message: Option<&str>,
    mut note: impl FnMut(String),
) -> String {
    if let Some(options) = rescue {
        note(format!("second try, with {options}"));
    }
    match message {
        None => reason.to_string(),
        Some(message) => {
            note(message.to_string());
            "see below".to_string()
        }
    }
}

/// A count for programs; empty if unknown.
pub(super) fn counted(n: Option<usize>) -> String {
    n.map(|n| n.to_string()).unwrap_or_default()
}
