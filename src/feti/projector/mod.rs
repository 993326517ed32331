//! The projector P of the floating bodies: G and Gᵀ Q G.

mod alone;
pub mod balance;
pub mod blocks;
pub mod by_column;
mod candidates;
mod choice;
pub mod columns;
pub mod distributed;
pub mod gram;
pub mod graph;
pub mod gtg;
pub mod held;
mod hidden;
pub mod known;
pub mod motion;
mod motions;
pub mod natural;
mod numbers;
pub mod pattern;
pub mod products;
mod raised;
pub mod refined;
pub mod rows;
pub mod shape;
pub mod spread;
pub mod sweep;
mod weights;
