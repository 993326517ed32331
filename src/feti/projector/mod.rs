//! The projector P of the floating bodies: G and Gᵀ Q G.

pub mod balance;
pub mod distributed;
pub mod gram;
pub mod graph;
pub mod gtg;
pub mod held;
mod motions;
pub mod natural;
pub mod pattern;
pub mod refined;
pub mod rows;
pub mod spread;
pub mod sweep;
mod weights;
