//! Finite elements of every [kind of cell](crate::kind::CellKind): segments as sides, triangles, quadrilaterals,
//! tetrahedra, pyramids, wedges and hexahedra, of first and second order, scalar and elastic, from the points of their
//! nodes alone.
//!
//! [`cell`](super::cell) has the cells of boxes, with nodes in lexicographic order; here nodes are in the order of
//! [`CellKind`](crate::kind::CellKind). Points have three coordinates, z being ignored in 2D. Degrees of freedom are
//! numbered node by node: component i of node a is C·a + i, where C is
//! [`Material::components`](super::cell::Material::components). Cells are isoparametric: curved where their middle
//! nodes are not in the middle.
//!
//! Points of the rules of quadrature, by purpose:
//!
//! | | stiffness | reduced | loads, volume | errors, degree |
//! |---|---|---|---|---|
//! | triangle of 3, 6 nodes | 1, 3 | | 3, 6 | 6, 8 |
//! | quadrilateral of 4; 8, 9 | 2², 3² | mean; 2² (8 nodes) | 2², 3² | 7, 9 |
//! | tetrahedron of 4, 10 | 1, 4 | | 4, 14 | 5, 7 |
//! | pyramid of 5 | 2² | | 2³ | 4³ points |
//! | wedge of 6, 15 | 3 × 2, 6 × 3 | 1 × 2, 3 × 3 | 3 × 2, 6 × 3 | 6 and 7, 8 and 9 |
//! | hexahedron of 8; 20, 27 | 2³, 3³ | mean; 2³ (20 nodes) | 2³, 3³ | 7, 9 |
//!
//! Rules for stiffness are exact on affine cells, those for loads also for constants on curved ones. [`Integration`]
//! says which of them is which element of CalculiX.
//!
//! With [`Plane::Axial`](super::cell::Plane) plane cells are rings: x is the radius, y the axis, and stiffness, energy
//! and norms are those of the whole ring. Loads do not know the material: their forces have to be multiplied by 2π r.
//!
//! Units: lengths as the points, stresses as Young's modulus; a plane cell has thickness one.

// Tensors are written by their indices, as on paper.
#![allow(clippy::needless_range_loop)]

mod axial;
mod errors;
pub mod face_values;
mod fields;
mod hourglass;
mod incompatible;
mod integration;
mod loads;
mod locate;
mod map;
mod products;
pub mod quadrature;
mod shape_functions;
mod sides;
mod slack;
mod stiffness;
mod stress;
mod table;
mod thermal;
mod valid;

#[cfg(test)]
#[path = "../../tests/element/testing.rs"]
pub(crate) mod testing;

pub use errors::error_squares;
pub use face_values::FaceValues;
pub use fields::{recovered_squares, recovered_squares_of};
pub use integration::{check, Integration};
pub use loads::{body_load, body_load_by, middle, volume};
pub use locate::locate;
pub(crate) use quadrature::{gauss, triangle_rule};
pub use sides::{side_load, side_weights, ElementSideWeights};
pub use slack::{may_slack, rigid_of, sees, slack, strain_of};
pub use stiffness::stiffness;
pub use stress::{principal_stresses, stress_at_nodes, von_mises, NodeStress};
pub use thermal::{cell_temperatures, thermal_load, thermal_stress};
pub use valid::{check_jacobian, BadCell, Doubt};
