//! Meshes that the program makes itself, no two elements of which are equal: triangles in the plane by Delaunay
//! refinement, and tetrahedra over them.

mod build;
mod graded;
mod planform;
mod solid;

pub(crate) use build::{build, GroupNumbers};
pub(crate) use graded::{along, graded, graded_arc, graded_line, quadratic};
pub(crate) use planform::{arc, circle, polyline, Planform};
pub(crate) use solid::Solid;
