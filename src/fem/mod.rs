//! Finite elements: Q1 rectangles for −∇·(ρ∇u) = f [Lee (2.1)–(2.2)], assembly of one subdomain, error norms.

mod assemble;
pub mod cell;
mod norms;
pub mod q1;

pub use assemble::{assemble, free_load, load_vector, Quadrature};
pub use norms::{error_squares, ErrorNorms};
