//! The jump operator B and the scaled jump operator B_D.

pub mod blocks;
pub mod coupled;
pub mod deluxe;
pub mod dependent;
pub mod operator;
pub mod scaling;
pub mod weights;
