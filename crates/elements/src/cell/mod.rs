//! One cell: quadrilaterals and hexahedra, scalar and elastic, from the corner points alone.
//!
//! A cell of dimension D = 2 or 3 has 2^D corners in lexicographic order, x fastest: corner a is the image of (a mod 2,
//! a div 2 mod 2, a div 4) of the unit cell. Its points are given with three coordinates, z being ignored in 2D. The
//! cell may be any quadrilateral or hexahedron whose map has a positive Jacobian ([`jacobian_is_positive`]); a box
//! takes the same path. Degrees of freedom are numbered node by node: component i of node a is C·a + i, where C is
//! [`Material::components`].
//!
//! Quadrature, by purpose and element:
//!
//! | | stiffness | loads | errors |
//! |---|---|---|---|
//! | [`Element::Q1`] | 2 Gauss points per direction | 2 per direction | 4 per direction |
//! | [`Element::P1`], per simplex | 1 point (exact) | D + 1 points, exact for degree 2 | 4 per direction, collapsed |
//!
//! Units: lengths as the points, stresses as Young's modulus; a 2D cell has thickness one. The strain is ε = (∇u +
//! ∇uᵀ)/2, so that the shear strain is half the engineering one.

// Tensors are written by their indices, as on paper.
#![allow(clippy::needless_range_loop)]

mod at_point;
mod errors;
mod loads;
mod map;
mod material;
mod reference;
mod rigid;
mod sides;
mod stiffness;
mod stress;

#[cfg(test)]
#[path = "../../tests/cell/locking_tests.rs"]
mod locking_tests;
#[cfg(test)]
#[path = "../../tests/cell/stiffness_tests.rs"]
mod stiffness_tests;
#[cfg(test)]
#[path = "../../tests/cell/testing.rs"]
mod testing;

pub use at_point::NodeStress;
pub(crate) use at_point::{is_plane_stress, stress_of_gradient};
pub use errors::error_squares;
pub use loads::body_load;
pub use map::jacobian_is_positive;
pub use material::{Cure, Material, Plane};
pub(crate) use material::{IsotropicModuli, Moduli};
pub use reference::Element;
pub use rigid::{rigid_count, rigid_motions};
pub use sides::side_load;
pub use sides::{side_weights, Side, SideWeights};
pub use stiffness::stiffness;
pub use stress::{centre_stress, CellStress};
