//! The Krylov method at work: solve, iterate, look at the spectrum, refine, certify, recover.

pub mod bounded;
pub mod correction;
pub mod inner;
pub mod kkt;
pub mod persist;
pub mod recover;
pub mod recycle;
pub mod spectrum;
pub mod tally;
