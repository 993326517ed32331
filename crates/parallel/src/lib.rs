//! Ranks and threads: messages between ranks, the threads of a rank, and what both cost.

pub mod available;
pub mod clock;
pub mod exchange;
pub mod halo;
pub mod meter;
pub mod owners;
pub mod post;
mod share;
pub mod team;
pub mod traffic;

pub use share::contiguous_share;
