//! What the user writes, as plain data.

pub mod cells;
pub mod expr;
pub mod field;
pub mod joints;
pub mod map;
pub mod motion;
pub mod profile;
pub mod ramp;
pub mod rigid;
pub mod rigid_surface;
pub mod spec;
pub mod steps;
