//! From where bodies touch to the rows of B_gl.

pub mod bounds;
pub mod entries;
pub mod entry;
pub mod links;
pub mod obstacles;
pub mod points;
pub mod select;
pub mod table;
