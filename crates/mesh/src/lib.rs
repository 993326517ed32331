//! Meshes of bodies: boxes, and cells of any kind.
//!
//! - [`BoxMesh`]: boxes of rectangles, cut into equal subdomains; [`CellMesh`]: cells of any kind, with groups of
//!   sides;
//! - [`partition`]: cuts the mesh of a body into subdomains, and finds the vertices, edges and faces that they share;
//! - [`gmsh`]: reads and writes files of Gmsh; [`MeshFile`] is a mesh as any reader gives it, [`Extractor`] takes the
//!   bodies out of it;
//! - [`defects`](fn@defects): cells that no method can take, and cells that deserve a warning.
//!
//! No coefficient, load or material is known here.

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
pub use boxes::{places, BoxMesh, ElementBlock};
pub use cell_mesh::{CellMesh, SideGroup, SKIN};
pub use cells::Cells;
pub use congruent::{congruent, MeshFingerprint};
pub use defects::{defects, of_both_sides, Defect};
pub use digits::Digits;
pub use elements::kind::{CellKind, CellSide};
pub use extract::Extractor;
pub use file::{bytes, text, FARTHEST};
pub use file::{Members, MeshFile, MeshGroup};
pub use parts::MeshPartition;
pub use point_grid::PointGrid;
pub use second_order::second_order;
