//! Results for people and programs: JSON, terminal tables, CSV, plots (PNG and SVG), pictures of fields, VTU for ParaView.
//!
//! Nothing here knows PETSc, MPI or the method: every function takes plain arrays or the structs of [`json`]. All files are
//! written to a temporary name first and then renamed, so that a reader never sees half a file.
//!
//! | module | what it writes |
//! |---|---|
//! | [`json`] | the records of `solve`, `table1` and `compare` ([`json::SolveReport`], [`json::Table1Row`], [`json::CompareRow`]) |
//! | [`table`], [`summary`], [`compare`] | aligned text for terminals, CSV, and the tables of the three commands |
//! | [`mod@bench`] | medians over rounds: table, CSV, error over seconds ([`json::BenchReport`]) |
//! | [`paper`] | Table 1 of Lee (2010) as printed |
//! | [`plot`], [`figure3`] | line and scatter plots; Figure 3 of Lee (2010) redrawn |
//! | [`field`] | pictures of u and ρ on quadrilaterals, with the contact zone |
//! | [`solid`] | pictures of fields on the surface of solids, with the contact zone |
//! | [`contact`], [`contact_summary`] | the record of a contact solve, and what the terminal shows of it |
//! | [`profile`], [`contact_map`], [`load_steps`] | multiplier and gap along interfaces, pressure on faces of solids; energy and force over load steps; all as CSV, too |
//! | [`progress`] | the line that tells how far a contact solve is |
//! | [`vtu`], [`contact_fields`], [`pvd`] | ParaView files, contact as point data, time series |

pub mod adaptive;
pub mod bench;
pub mod canvas;
pub mod checkpoint;
pub mod colormap;
pub mod compare;
pub mod contact;
pub mod contact_fields;
pub mod contact_map;
pub mod contact_summary;
pub mod field;
pub mod figure3;
pub mod json;
pub mod load_steps;
mod marks;
mod outline;
pub mod output;
mod paint;
mod panel;
pub mod paper;
pub mod plot;
pub mod profile;
pub mod progress;
pub mod pvd;
pub mod raster;
mod series;
pub mod solid;
mod space;
mod stage;
pub mod summary;
mod surface;
pub mod svg;
pub mod table;
pub mod ticks;
pub mod vtu;
