//! The projector P of the floating bodies: G and Gᵀ Q G.

mod alone;
pub mod balance;
pub mod blocks;
pub mod by_column;
mod candidates;
mod choice;
pub mod columns;
pub mod distributed;
pub mod freedom;
pub mod gram;
pub mod graph;
pub mod gtg;
pub mod held;
mod hidden;
pub mod known;
pub mod motion;
mod motions;
pub mod natural;
mod noise;
mod numbers;
pub mod pattern;
#[cfg(feature = "cli")]
pub mod planned;
pub mod products;
mod raised;
pub mod refined;
mod rounding;
pub mod rows;
pub mod shape;
pub mod spread;
pub mod sweep;
pub mod twist;
mod weak;
mod weights;
pub mod words;
