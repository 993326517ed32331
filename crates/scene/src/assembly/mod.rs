//! Finite elements: cells of two and three dimensions, scalar and elastic; assembly of one subdomain, loads, error
//! norms.

mod assemble;
mod cells;
mod energy;
mod internal_force;
mod loads;
mod norms;
pub mod recovery;
mod sparse;
mod subdomain;
mod thermal;
pub(crate) mod zero_energy;

pub(crate) use assemble::{free_load, given_columns, matrix};
pub(crate) use energy::given_energy;
pub use internal_force::{force_at_given, internal_force, InternalForce};
pub(crate) use loads::{add_side_load, load_vector, SidePart};
pub(crate) use norms::error_squares;
pub use norms::ErrorNorms;
pub use subdomain::{ElementHeat, ElementLaws, Grid, SubdomainElements, SubdomainMesh};
pub(crate) use thermal::add_thermal_load;
