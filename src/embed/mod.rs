//! From subdomain matrices that other programs assembled to [`Problem`](crate::Problem), and back.
//!
//! ```text
//! MATIS ─> Torn ─> states ─> parts ─> sharing ─> bodies ─> classes, hold ─> Problem ─> FetiFeti
//! ```
//!
//! A host program knows dofs by their global numbers and has one matrix per subdomain. The other data of the method are
//! derived here from the matrices and the numbers: held dofs (`states`), shared dofs (`sharing`), pairs of subdomains
//! that hold each other (`bonds`), bodies (`bodies`), the rows of B_gl that tie bodies (`rows`) and those of the host
//! (`contact`), vertices, edges and faces (`classes`), what is averaged (`averaging`), and enough primal constraints
//! that no subdomain floats in its body (`rigid_constraints`), nor without its averages (`alone`).
//!
//! The host's rows come from any rank: the owners of their dofs say where the dofs are and which rows are connected
//! (`touched`), the rows go to the ranks that take them (`placed`) and nodes with friction go along (`friction`),
//! values of known dofs follow at each solve (`known_dofs`).
//!
//! Data that follow from patterns and numbers alone stay in a `frame`: with other entries in the same matrices, other
//! rows or other gaps (`renewal`) no more is done than they ask for, and `work` counts it.

mod alone;
mod averaging;
pub(crate) mod bodies;
pub(crate) mod bonds;
pub(crate) mod classes;
pub(crate) mod contact;
pub(crate) mod frame;
pub(crate) mod friction;
pub(crate) mod judged;
mod kernels;
pub(crate) mod known_dofs;
pub(crate) mod motions;
pub(crate) mod nullspace;
pub(crate) mod partition;
pub(crate) mod parts;
pub(crate) mod pieces;
pub(crate) mod placed;
pub(crate) mod renewal;
pub(crate) mod rigid_constraints;
pub(crate) mod rows;
pub(crate) mod shares;
pub(crate) mod sharing;
pub(crate) mod solver;
pub(crate) mod states;
pub(crate) mod subdomains;
mod together;
pub(crate) mod torn;
pub(crate) mod touched;
pub(crate) mod work;

pub use frame::Local;
pub use pieces::TornPiece;
pub use solver::{Embedded, EmbeddedResult, GivenResults};
pub use torn::{GivenRow, GivenRows, Torn};
pub use work::{SetUp, SetUpWork};
