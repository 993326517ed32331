//! From interfaces of bodies to the rows of B_gl.
//!
//! A row has four forms, each made from the one before, and a solved form that leads back:
//!
//! ```text
//!     1  TieSpec, ContactSpec, ObstacleSpec   what the user writes, for whole faces
//!     2  Interface, Obstacle                  node by node: how it is joined, normal, distance, bounds of all entries
//!     3  Row                                  law, members or terms, right-hand side; decided rows are gone
//!     4  fetifeti::Row                        in the joint: coefficients by body dof, and a RowLabel
//!
//!     SolvedRow                               label, gap, multiplier, pressure, state
//! ```
//!
//! [`entries`] and [`links`] make the second form: an [`entry::Entry`] is a view of the first, and [`select`] finds the
//! nodes that it means. Interfaces of sides that an entry names come from `facing`, those of nodes that it names from
//! `opposed`, those of faces whose nodes do not match from `unmatched`. [`obstacles`] makes the second form of
//! obstacles. Five files make the third, [`row::Row`]: [`points`] between nodes that coincide, at the points that a
//! rank's bodies reach (`reach`); [`bounds`] beside obstacles; [`mortar`] where nodes do not match; [`facing_surfaces`]
//! beside surfaces; [`equations`]. [`all`] puts them in order. Nothing after that asks who has made a row. [`table`]
//! makes the fourth form. Normals and distances are computed once, with the second form, and areas ([`areas`]) with the
//! label; reports, studies and C read them in the solved row. A load step evaluates only the right-hand sides of the
//! third form. Balances and forces at nodes take all terms of a row from [`terms`], those of given values among them.

pub mod all;
pub mod areas;
pub(crate) mod at_node;
pub mod bounds;
pub mod entries;
pub mod entry;
pub mod equations;
mod facing;
pub mod facing_surfaces;
mod law_rows;
pub mod laws;
pub mod left_out;
pub mod links;
mod meeting;
pub mod mortar;
pub mod obstacles;
mod opposed;
pub mod origin;
pub mod points;
mod reach;
mod rounding;
pub mod row;
pub mod select;
pub mod surfaces;
pub mod table;
pub mod terms;
mod unmatched;
