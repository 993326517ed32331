//! Which operator is meant, and how it is held.

/// How S and T are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OperatorForm {
    /// As dense matrices.
    Explicit,
    /// As sparse solves; where the vertices alone do not hold the subdomain, dense matrices after all.
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
