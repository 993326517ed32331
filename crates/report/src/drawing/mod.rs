//! The tools for all pictures: a canvas of pixels (PNG) and one of vectors (SVG), text, colours, ticks.

pub mod canvas;
pub mod colormap;
pub mod raster;
pub mod svg;
pub mod ticks;
