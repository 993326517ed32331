//! Several ranks: the same answers, and what they send each other.

#[path = "../support/mod.rs"]
mod support;

mod answers;
mod communication;
