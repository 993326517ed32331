//! Numberings of unknowns: of all of them, or of those of one matrix.

/// The numbering that a number belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HostNumbering {
    /// The numbering of all unknowns.
    All,
    /// The numbering of one matrix; the index counts the matrices in the order in which they were added.
    Matrix(usize),
}
