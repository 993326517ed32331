//! Who shares what: copies of dofs, candidates, and the edges and faces that subdomains have in common.

pub mod candidates;
pub mod entities;
pub mod sharing;
