//! Meshes of the benchmark that no two elements of which are equal: triangles in the plane by Delaunay refinement, and
//! tetrahedra over them.

mod blocks;
mod plate;
mod rod;

pub(super) use blocks::blocks;
pub(super) use plate::plate;
pub(super) use rod::rod;

#[cfg(test)]
#[path = "../../../../tests/baselines/bench/shapes.rs"]
mod tests;
