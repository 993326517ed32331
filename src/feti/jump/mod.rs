//! The jump operator B and the scaled jump operator B_D.

pub mod blocks;
pub mod deluxe;
pub mod operator;
pub mod scaling;
pub mod weights;
