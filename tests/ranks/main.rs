//! Several ranks: the same answers, and the messages between ranks.

#[path = "../support/mod.rs"]
mod support;

mod answers;
mod communication;
mod direct;
mod pairs;
