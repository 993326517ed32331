//! Sparse Cholesky factorisation of one subdomain, and its Schur complement on the interface.

pub mod cover;
pub mod dissection;
pub mod interior;
pub mod lanes;
pub mod multifrontal;
pub mod panel;
pub mod substitution;
pub mod symbolic;
