//! Pictures of fields on meshes: quadrilaterals from above, solids from a corner, faces of contact.

pub mod contact_map;
pub mod field;
mod marks;
pub mod mesh;
mod outline;
mod paint;
pub mod solid;
mod space;
mod stage;
mod surface;
pub mod values;
