//! Several ranks: the same answers, and the messages between ranks.

#[path = "../support/mod.rs"]
mod support;

mod answers;
mod bits;
mod certified;
mod coarse;
mod communication;
mod constraints;
mod copies;
mod direct;
mod ended;
mod equations;
mod faults;
mod mortar;
mod mortar_program;
mod pairs;
