//! Helpers of the test programs; every program uses its own part.
#![allow(dead_code)]

pub mod answer;
pub mod assembled;
pub mod cells;
pub mod checks;
pub mod common;
pub mod compared;
pub mod contact_judge;
pub mod copies;
pub mod direct;
pub mod elastic_scene;
pub mod keys;
pub mod mpi;
pub mod plates;
pub mod plugin;
pub mod program;
pub mod qp;
pub mod random_scene;
pub mod rng;
pub mod sample;
pub mod scene_message;
pub mod session;
pub mod solid;
pub mod surface_mesh;
pub mod vtu;
pub mod wall;
