//! Studies: questions about the method that take many runs, with the tables and pictures that answer them.
//!
//! A study is library code that returns data; `fetifeti study NAME` writes it to files. Every scene of a study is text as a user
//! would write it.

mod direct;
pub mod hard_cases;
pub mod hertz;
pub mod kappa;
mod solved;
pub mod speed_error;

/// a · b.
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
