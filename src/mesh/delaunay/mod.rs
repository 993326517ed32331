//! Meshes that the program makes itself, no two elements of which are equal: triangles in the plane by Delaunay
//! refinement, and tetrahedra over them.

mod build;
mod planform;
mod solid;

pub(crate) use build::{build, Groups};
pub(crate) use planform::{arc, circle, polyline, Planform};
pub(crate) use solid::Solid;
