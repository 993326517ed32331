//! The jump operator B and its scaled companion B_D.

pub mod blocks;
pub mod deluxe;
pub mod operator;
pub mod scaling;
pub mod weights;
