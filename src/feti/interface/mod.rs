//! Copies of dofs, candidates for contact, and the edges and faces that subdomains share.

pub mod candidates;
pub mod entities;
pub mod location;
pub mod motions;
pub mod sharing;
