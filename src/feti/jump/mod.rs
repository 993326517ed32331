//! The jump operator B and the scaled jump operator B_D.

pub mod blocks;
pub mod columns;
pub mod coupled;
pub mod deluxe;
pub mod dependent;
mod entry_locations;
mod ghost_rows;
pub mod operator;
pub mod scaling;
mod switch;
pub mod turn;
mod turned;
pub mod weights;
