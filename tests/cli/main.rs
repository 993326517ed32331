//! The program from the outside: what it prints, writes and refuses.

#[path = "../support/mod.rs"]
mod support;

mod checkpoint;
mod contact;
mod elastic;
mod input;
mod solve;
mod table;
