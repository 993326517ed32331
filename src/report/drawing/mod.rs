//! What every picture is drawn with: a canvas for pixels (PNG) and one for vectors (SVG), text, colours, ticks.

pub mod canvas;
pub mod colormap;
pub mod raster;
pub mod svg;
pub mod ticks;
