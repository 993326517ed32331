//! Plots of numbers: axes, lines and markers in panels, and the figures that the program makes with them.

pub mod load_steps;
mod panel;
pub mod plot;
pub mod profile;
mod series;
