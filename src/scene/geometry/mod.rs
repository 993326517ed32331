//! Where bodies touch: interfaces, sides, normals, and the nodes on them.

pub mod facing;
pub mod interface;
pub mod normals;
pub mod sides;
pub mod topology;
pub mod touching;
