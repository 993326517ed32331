//! The operators of one subdomain: S, T, Ψ and Σ.

pub mod basis;
pub mod condense;
pub mod congruent;
pub mod equal;
pub mod factor;
pub mod halves;
pub mod held;
pub mod implicit;
pub mod loads;
pub mod operators;
pub mod problem;
pub mod retained;
pub mod scaled;
mod schur;
pub mod turn;
pub mod which;
