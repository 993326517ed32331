//! fetifeti (theory page to be completed)
#![deny(unsafe_code)]
#![deny(missing_docs)]

pub mod baselines;
pub mod cli;
pub mod error;
pub mod fem;
pub mod feti;
pub mod mesh;
#[allow(unsafe_code)]
pub mod petsc;
pub mod report;
pub mod scene;
pub mod sparse;
pub mod substructures;

pub use error::{Error, Result};
pub use feti::{FetiFeti, PcType, ProjectorKind, Scaling, Settings, Solution, Spectrum};
