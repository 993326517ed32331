//! The linear method, a room for each operator; symbols are those of the theory page.

pub mod adaptive;
pub mod cost;
pub mod deflation;
pub mod interface;
pub mod jump;
pub mod krylov;
pub mod lifting;
pub mod operators;
pub mod primal;
pub mod projector;
mod rows;
pub mod settings;
pub mod solver;
pub mod subdomain;

pub use krylov::kkt::Kkt;
pub use krylov::recover::Solution;
pub use krylov::spectrum::Spectrum;
pub use krylov::tally::Communication;
pub use settings::{CoarseFunctions, PcType, Precision, Primal, ProjectorKind, Scaling, Settings};
pub use solver::FetiFeti;
