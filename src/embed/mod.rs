//! From matrices that other programs assembled, subdomain by subdomain, to [`Substructures`](crate::Substructures), and back.
//!
//! ```text
//! MATIS ─> Torn ─> states ─> parts ─> sharing ─> bodies ─> classes, hold ─> Substructures ─> FetiFeti
//! ```
//!
//! A host program knows dofs by their global numbers and has one matrix per subdomain. What the method wants besides is
//! found here from the matrices and the numbers: which dofs are held (`states`), who shares what (`sharing`), which subdomains form a body
//! (`bodies`), rows between bodies and the host's own (`rows`, `contact`), vertices, edges and faces (`classes`), and constraints enough that no subdomain is loose (`hold`).

pub(crate) mod bodies;
pub(crate) mod classes;
pub(crate) mod contact;
pub(crate) mod hold;
pub(crate) mod kernels;
pub(crate) mod partition;
pub(crate) mod parts;
pub(crate) mod pieces;
pub(crate) mod rows;
pub(crate) mod shares;
pub(crate) mod sharing;
pub(crate) mod solver;
pub(crate) mod states;
pub(crate) mod subdomains;
pub(crate) mod torn;

pub use bodies::Grouping;
pub use pieces::Piece;
pub use solver::{Embedded, Outcome};
pub use torn::{GivenRow, Torn};
