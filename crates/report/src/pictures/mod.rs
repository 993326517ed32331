//! Pictures of fields on meshes: plane bodies from above, solids from a corner, faces of contact.

mod apart;
mod arrows;
pub mod contact_map;
pub mod field;
mod marks;
pub mod mesh;
pub mod obstacles;
mod outline;
mod paint;
pub mod pieces;
pub mod rigid_faces;
pub mod solid;
mod space;
mod stage;
mod surface;
pub mod values;
