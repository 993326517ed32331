//! Meshes: boxes of rectangles, their partition into subdomains, the classification of their nodes; cells of any kind.

mod body;
mod boxes;
mod cell_mesh;
mod cells;
mod clockwise;
mod congruent;
pub mod deck;
mod defects;
#[cfg(feature = "cli")]
pub(crate) mod delaunay;
mod digits;
mod extract;
mod file;
pub mod gmsh;
mod kind;
pub mod partition;
mod parts;
mod point_grid;
mod second_order;

pub use crate::linalg::lists::Lists;
pub use body::{Mesh, SIDES};
pub use boxes::{places, Block, BoxMesh};
pub use cell_mesh::{CellMesh, SideGroup, SKIN};
pub use cells::Cells;
pub use congruent::{congruent, Outline};
pub use defects::{defects, of_both_sides, Defect};
pub(crate) use digits::Digits;
pub use extract::Extractor;
pub(crate) use file::{bytes, text, FARTHEST};
pub use file::{Group, Members, MeshFile};
pub use kind::{CellKind, CellSide};
pub use parts::Parts;
pub(crate) use point_grid::PointGrid;
pub use second_order::second_order;

use std::ops::Range;

/// The subdomains that rank `rank` of `ranks` holds when `n` of them are dealt out in contiguous blocks whose
/// sizes differ by at most one. Ranks beyond the number of subdomains get an empty range.
pub fn contiguous_share(n: usize, ranks: usize, rank: usize) -> Range<usize> {
    let (each, extra) = (n / ranks, n % ranks);
    let start = rank * each + rank.min(extra);
    start..start + each + usize::from(rank < extra)
}

#[cfg(test)]
#[path = "../../tests/inside/mesh.rs"]
mod tests;
