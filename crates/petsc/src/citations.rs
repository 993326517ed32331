//! Entries of `-citations`.

use super::error::c_string;
use super::Session;
use base::Result;
use std::cell::RefCell;
use std::collections::HashSet;

thread_local! {
    static CITED: RefCell<HashSet<String>> = RefCell::default();
}

/// Lists a BibTeX entry under `-citations`, once.
pub fn cite(_session: &Session, bibtex: &str) -> Result<()> {
    if !CITED.with_borrow_mut(|cited| cited.insert(bibtex.to_string())) {
        return Ok(());
    }
    let mut set = 0;
    petsc!(ff_citation(c_string(bibtex).as_ptr(), &mut set))
}
