//! Results for people and programs: JSON, terminal tables, CSV, plots (PNG and SVG), pictures of fields, VTU for
//! ParaView.
//!
//! This module is independent of PETSc, MPI and the method: every function takes plain arrays or the structs of
//! [`json`]. All files are written to a temporary name first and then renamed, so that a reader never sees half a file.
//!
//! | module | contents |
//! |---|---|
//! | `destination` | the destination of a command's results: terminal, JSON file, directory |
//! | [`json`] | the records of the commands: [`json::SolveReport`], [`json::CompareRow`], [`json::BenchReport`] |
//! | `interfaces` | the data along interfaces, and their CSV |
//! | `drawing` | pixels, vectors, text, colours, ticks |
//! | `tables` | aligned text for terminals, CSV, and the tables of the commands |
//! | `plots` | line and scatter plots: contact along interfaces, energy and force over load steps |
//! | `pictures` | fields on quadrilaterals and on the surface of solids, with the contact zone; pressure on faces of contact |
//! | `paraview` | VTU files, contact as point data, time series |
//! | `pace` | how much of a long run is left |
//! | `progress` | the progress line of a contact solve |

pub mod destination;
pub mod drawing;
pub mod interfaces;
pub mod json;
pub mod pace;
pub mod paraview;
pub mod pictures;
pub mod plots;
pub mod progress;
pub mod tables;

/// Files and standard output.
pub use base::output;

#[cfg(test)]
#[path = "../../../tests/support/scratch.rs"]
mod scratch;
#[cfg(test)]
#[path = "../tests/contact.rs"]
mod tests;
