//! Ranks and threads: messages between ranks, the threads of a rank, and what both cost.
//!
//! - [`exchange`], [`parcels`], [`post`]: irregular messages during set-up, those of lists of any length, and messages
//!   that go on their way while the sender computes;
//! - [`halo`]: ghost entries of a distributed vector, by PETSc's scatters;
//! - [`team`]: the threads that share one rank's subdomains;
//! - [`clock`], [`traffic`]: seconds by phase, and counters of messages and reductions.

pub mod available;
pub mod clock;
pub mod exchange;
pub mod halo;
pub mod meter;
pub mod owners;
pub mod parcels;
pub mod post;
mod share;
pub mod team;
pub mod traffic;

pub use share::contiguous_share;
