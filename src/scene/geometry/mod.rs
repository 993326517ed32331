//! Where bodies touch: interfaces, sides, normals, and the nodes on them.

pub mod interface;
pub mod normals;
pub mod select;
pub mod sides;
pub mod topology;
