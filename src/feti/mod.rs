//! The linear method, a room for each operator; symbols are those of the theory page. It knows nothing of contact: which
//! rows hold is said to it.

pub mod adaptive;
pub mod cost;
pub mod deflation;
pub mod facts;
pub mod interface;
pub mod jump;
pub mod krylov;
pub mod lifting;
pub mod method;
pub mod operators;
pub mod primal;
pub mod projector;
pub mod settings;
mod setup;
pub mod spectrum;
pub mod subdomain;

pub use facts::Facts;
pub use krylov::certificate::Kkt;
pub use krylov::recovery::LinearSolution;
pub use krylov::tally::Communication;
pub use method::LinearMethod;
pub use settings::{
    CoarseFunctions, MethodSettings, PcType, Precision, Primal, ProjectorKind, Scaling,
};
pub use spectrum::Spectrum;
