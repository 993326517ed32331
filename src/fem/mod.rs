//! Finite elements: cells of two and three dimensions, scalar and elastic; assembly of one subdomain, loads, error
//! norms.

mod assemble;
pub mod cell;
mod cells;
mod form;
mod loads;
mod norms;
pub mod q1;
mod subdomain;

pub use assemble::{assemble, free_load, given_columns};
pub use form::{Form, Physics};
pub use loads::{add_side_load, load_vector, Quadrature};
pub use norms::{error_squares, ErrorNorms};
pub use subdomain::SubdomainMesh;
