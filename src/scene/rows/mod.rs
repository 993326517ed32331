//! From where bodies touch to the rows of B_gl.
//!
//! A row has five forms, each made once from the one before, and one way back:
//!
//! ```text
//!     1  TieSpec, ContactSpec, ObstacleSpec   what the user writes, for whole faces
//!     2  Interface, Obstacle                  node by node: how it is joined, normal, distance, bounds of all entries
//!     3  PointRow                             at a point: members, direction, right-hand side; decided rows are gone
//!     4  InterfaceRow                         in the joint: coefficients by body dof, and a RowLabel
//!     5  a row of B                           in the method: owned, in a block, it holds or not
//!
//!     SolvedRow                               label, gap, multiplier, pressure, state
//! ```
//!
//! [`entries`] and [`links`] make the second form (an [`entry::Entry`] is a view of the first, [`select`] says which nodes it means),
//! [`obstacles`] that of obstacles, [`points`] and [`bounds`] the third, [`table`] the fourth. Normals and distances are found with the second
//! form, areas ([`areas`]) with the label, and nothing finds them again: reports, studies and C read them in the solved row. Of a load step
//! only the right-hand sides of the third form are evaluated ([`points::PointRow::right_hand_side`]).

pub mod areas;
pub mod bounds;
pub mod entries;
pub mod entry;
pub mod links;
pub mod obstacles;
pub mod points;
pub mod select;
pub mod table;
