//! The program from the outside: its output, its files and its error messages.

#[path = "../support/mod.rs"]
mod support;

mod cases;
mod checkpoint;
mod checkpoint_files;
mod checkpoint_refused;
mod contact;
mod deck;
mod deck_gaps;
mod elastic;
mod energy;
mod friction;
mod input;
mod limits;
mod mortar;
mod plan;
mod renewal;
mod renewal_obstacles;
mod report;
mod single;
mod sliding;
mod solve;
mod stepper;
mod table;
mod unusual;
