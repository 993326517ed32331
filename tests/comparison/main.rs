//! `fetifeti compare` and `fetifeti bench`: methods that are independent of each other.

#[path = "../support/mod.rs"]
mod support;

mod bench;
mod contact;
mod elastic;
mod equations;
mod friction;
mod mortar;
mod scalar;
mod signals;
