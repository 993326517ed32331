//! Where bodies touch: interfaces, sides, normals, and the nodes on them.

pub mod curves;
pub mod facing;
pub mod interface;
pub mod loose;
pub mod matching;
pub mod mortar;
pub mod mortar_sides;
pub mod nearest;
pub mod normals;
pub mod overlap;
pub mod sides;
pub mod single;
pub mod surface;
pub mod sweep;
pub mod topology;
pub mod touching;
