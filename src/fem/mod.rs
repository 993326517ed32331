//! Finite elements: cells of two and three dimensions, scalar and elastic; assembly of one subdomain, loads, error
//! norms.

mod assemble;
pub mod cell;
mod cells;
pub mod element;
mod energy;
mod form;
mod internal_force;
mod loads;
mod norms;
pub(crate) mod q1;
pub mod recovery;
pub(crate) mod slack;
mod sparse;
mod subdomain;

pub(crate) use assemble::{free_load, given_columns, matrix};
pub(crate) use energy::given_energy;
pub use form::{Form, Physics};
pub use internal_force::{force_at_given, internal_force, Held};
pub use loads::Quadrature;
pub(crate) use loads::{add_side_load, load_vector, SidePart};
pub(crate) use norms::error_squares;
pub use norms::ErrorNorms;
pub use subdomain::{Elements, Grid, SubdomainMesh};
