//! Scenes: what is read, what is refused, what is counted, and coefficients from files.

#[path = "../support/mod.rs"]
mod support;

mod coefficient_files;
mod coefficient_mistakes;
mod coefficient_scenes;
mod contact;
mod contact_input;
mod contact_rows;
mod contact_solution;
mod copies;
mod counts;
mod error_locations;
mod examples;
mod friction;
mod gallery;
mod guided;
mod heat;
mod hidden_motions;
mod input;
mod input_bodies;
mod instances;
mod instances_input;
mod laws;
mod loose;
mod many_bodies;
mod merged;
mod mesh_mistakes;
mod meshes;
mod mortar;
mod mortar_gaps;
mod mortar_mistakes;
mod mortar_rings;
mod mortar_second_order;
mod obstacle_surfaces;
mod scaling;
mod solution;
mod springs;
mod steps;
mod stiff_and_soft;
