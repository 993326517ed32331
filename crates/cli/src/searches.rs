//! A line on a terminal for long searches for eigenvalues, those of `-fetifeti_spectrum` among them.

use std::io::IsTerminal;

use petsc::{EigenSearch, Session};
use report::pace::left;

/// Shows the course of searches from now on, on the first rank and on a terminal.
pub(super) fn show(session: &Session, quiet: bool) {
    if quiet || session.rank() > 0 || !std::io::stderr().is_terminal() {
        return;
    }
    session.listen(Box::new(|search| {
        eprint!("\r\x1b[K{}", search.map_or(String::new(), line));
    }));
}

/// Such as "exact spectrum: smallest eigenvalue, restart 12, residual 1.3e-3 of 4.0e-7, about 20 s left".
fn line(search: &EigenSearch) -> String {
    let end = if search.largest {
        "largest"
    } else {
        "smallest"
    };
    // Residuals fall by about the same factor in each restart: thousandths of the way in powers of ten.
    let way = search.residual.ln() / search.tolerance.ln();
    let done = if way.is_finite() {
        (1000.0 * way).max(0.0) as usize
    } else {
        0
    };
    let left = left(search.elapsed, done, 1000).map_or(String::new(), |left| format!(", {left}"));
    format!(
        "exact spectrum: {end} eigenvalue, restart {}, residual {:.1e} of {:.1e}{left}",
        search.restarts, search.residual, search.tolerance
    )
}

#[cfg(test)]
#[path = "../tests/searches.rs"]
mod tests;
