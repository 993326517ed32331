//! From matrices that other programs assembled, subdomain by subdomain, to [`Substructures`](crate::Substructures), and back.
//!
//! ```text
//! MATIS ─> Torn ─> states ─> parts ─> sharing ─> bodies ─> classes, hold ─> Substructures ─> FetiFeti
//! ```
//!
//! A host program knows dofs by their global numbers and has one matrix per subdomain. What the method wants besides is
//! found here from the matrices and the numbers: which dofs are held ([`states`]), who shares what ([`sharing`]), which subdomains form a body
//! ([`bodies`]), rows between bodies and the host's own ([`rows`], [`contact`]), vertices, edges and faces ([`classes`]), and constraints enough that no subdomain is loose ([`hold`]).

pub mod bodies;
pub mod classes;
pub mod contact;
pub mod hold;
pub mod kernels;
pub mod partition;
pub mod parts;
pub mod pieces;
pub mod rows;
pub mod shares;
pub mod sharing;
pub mod solver;
pub mod states;
pub mod subdomains;
pub mod torn;

pub use bodies::Grouping;
pub use pieces::Piece;
pub use solver::{Embedded, Outcome};
pub use torn::{GivenRow, Torn};
