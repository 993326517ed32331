//! Meshes: boxes of rectangles, their partition into subdomains, the classification of their nodes; cells of any kind.

mod body;
mod boxes;
mod cell_mesh;
mod cells;
pub mod clockwise;
mod congruent;
mod defects;
mod digits;
mod extract;
pub mod file;
pub mod gmsh;
pub mod partition;
mod parts;
mod point_grid;
mod second_order;

pub use base::linalg::lists::Lists;
pub use body::{Mesh, SIDES};
pub use boxes::{places, Block, BoxMesh};
pub use cell_mesh::{CellMesh, SideGroup, SKIN};
pub use cells::Cells;
pub use congruent::{congruent, Outline};
pub use defects::{defects, of_both_sides, Defect};
pub use digits::Digits;
pub use elements::kind::{CellKind, CellSide};
pub use extract::Extractor;
pub use file::{bytes, text, FARTHEST};
pub use file::{Group, Members, MeshFile};
pub use parts::Parts;
pub use point_grid::PointGrid;
pub use second_order::second_order;
