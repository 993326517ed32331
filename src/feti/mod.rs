//! The linear method, with one module for each operator. Symbols are those of the theory page. This module knows
//! nothing of contact: its caller says which rows hold.

pub(crate) mod adaptive;
pub mod cost;
pub mod deflation;
pub mod interface;
pub mod jump;
pub(crate) mod krylov;
pub(crate) mod lifting;
pub(crate) mod method;
pub(crate) mod operators;
pub(crate) mod primal;
mod primal_constraints;
pub mod projector;
mod removed;
pub(crate) mod set_up_summary;
pub mod settings;
mod setup;
pub(crate) mod spectrum;
pub mod subdomain;

pub use krylov::certificate::Kkt;
pub use krylov::certified::{CertificationResult, Certified, Uncertified};
pub(crate) use krylov::recovery::LinearSolution;
pub use krylov::tally::{Communication, PerIteration};
pub use method::LinearMethod;
pub use method::Numbers;
pub use projector::freedom::FreeMotion;
pub use set_up_summary::SetUpSummary;
pub use settings::MethodSettings;
pub use spectrum::Spectrum;
