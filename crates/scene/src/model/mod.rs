//! The input of the user, as plain data.

pub mod body;
pub mod cells;
pub mod entry;
pub mod expr;
pub mod field;
pub mod friction;
pub mod grid;
pub mod heat;
pub mod joints;
pub mod law;
pub mod map;
pub mod motion;
pub mod profile;
pub mod ramp;
pub mod rigid;
pub mod rigid_surface;
pub mod spec;
pub mod steps;
