//! Finite elements, and integrals between sides whose nodes do not match.
//!
//! - `kind`: the kinds of cells, their sides and edges, and the order of their nodes;
//! - `law`: elastic laws;
//! - `cell`: bilinear and trilinear elements on boxes, materials, cures of locking;
//! - `element`: elements of every kind of cell: shape functions, quadrature, stiffness, stress;
//! - `mortar`: mortar integrals, dual multipliers, feet of nodes on a side;
//! - `form`: the equation and its discretisation.
//!
//! Nothing here knows a mesh as a whole: each function takes the nodes of one cell or of two sides.

pub mod cell;
pub mod element;
pub mod form;
pub mod kind;
pub mod law;
pub mod mortar;
pub mod q1;
