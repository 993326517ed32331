//! Aligned text for terminals and CSV: the tables of the commands.

pub mod bench;
pub mod compare;
pub mod contact;
mod methods;
pub mod summary;
pub mod table;
