//! Z_c and M_C: the lifting of jumps between bodies into whole bodies.

pub mod applied;
pub mod averaging;
pub mod block;
mod coarse_functions;
pub mod correction;
pub mod factor;
pub mod interpolation;
pub mod matrix;
pub mod stored;
