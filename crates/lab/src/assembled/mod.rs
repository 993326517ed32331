//! The assembled problem of a scene: one matrix, one unknown where tied bodies have several copies, none where an
//! equation determines it, inequalities as bounds of differences.
//!
//! ```text
//! Scene ──> Layout (unknowns w, frames, supports) ──> Unknowns ──> System (A, b) ──> Reduced (Tᵀ K T of active sets)
//!      └──> Inequalities (w_p − w_m ≤ g) ──> Groups (active rows as equations) ──────────────────────┘
//! ```

pub mod course;
mod cycles;
mod damped_newton;
mod eliminated;
mod equations;
pub mod exerted;
pub mod frame;
mod friction;
pub mod groups;
mod judged;
pub mod layout;
pub mod load_steps;
pub mod motions;
pub mod near;
pub mod outer;
mod potentials;
pub mod problem;
pub mod reduced;
pub mod reference;
pub mod refine;
pub mod rows;
mod sets;
pub mod strain;
pub mod system;
mod trials;
pub mod unknowns;
