//! Names of the operators S and T, and of the two forms that they are stored in.

/// The form in which S and T are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OperatorForm {
    /// As dense matrices.
    Explicit,
    /// As sparse solves. If the vertices alone do not hold the subdomain, they become dense matrices.
    Implicit,
}

/// One of the operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// S, of order n_Γ.
    S,
    /// T, of order n_Δ.
    T,
}
