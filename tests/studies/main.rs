//! The studies on their small cases.

#[path = "../support/mod.rs"]
mod support;

mod adaptive;
mod benchmarks;
mod hard_cases;
mod hertz;
mod kappa;
mod scaling;
mod speed_error;
mod table1;
mod walls;
