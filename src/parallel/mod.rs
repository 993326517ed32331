//! Ranks and threads: messages between ranks, the threads of a rank, and what both cost.

#[cfg(feature = "cli")]
pub(crate) mod available;
pub mod clock;
pub mod exchange;
pub mod halo;
#[cfg(feature = "cli")]
pub(crate) mod meter;
pub mod owners;
pub mod post;
pub mod team;
pub mod traffic;
