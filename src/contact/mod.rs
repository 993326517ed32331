//! The contact loop: inequality rows B_I u ≤ c with multipliers λ_I ≥ 0, [Lee (3.1)-(3.3)] (docs/theory.md, section 9).
//!
//! ```text
//!     min ½ uᵀ K u − fᵀ u    subject to    B_E u = c_E,  B_I u ≤ c_I
//! ```
//!
//! The loop (`driver`) calls the solver of equations and changes only Z^k, the set of rows that hold: subdomains are
//! factored once. There are three strategies (`dual_problem`): a primal-dual active set (`active_set`); damped Newton
//! steps on the augmented Lagrangian (`lagrangian`), to which the others hand over if their sets wander; and SMALBE
//! with MPRGP (`smalbe`). With friction they know nodes that stick and slip (`friction`). Sets that they propose are
//! repaired (`repairs`): rows are put back that hold bodies, bodies are placed, dependent rows agree.
//! Whether there is a solution at all is asked in one place (`existence`).

mod active_set;
mod anchored;
mod anchors;
mod augmented;
mod certified_signs;
mod course;
mod disc;
pub mod driver;
mod dual_problem;
mod existence;
mod feasible_set;
mod force_balance;
mod friction;
mod inner;
mod judge;
mod lagrangian;
mod line_search;
mod mean_compliance;
mod modes;
mod mprgp;
mod newton_termination;
mod piecewise_quadratic;
mod pull_monitor;
mod repairs;
mod semismooth_newton;
mod settings;
mod smalbe;
mod smalbe_iteration;
mod smalbe_trial;
mod state;
mod strategy;
mod tuning;

pub use friction::tuning::FrictionTuning;
pub use friction::{node, nodes};
pub use piecewise_quadratic::line_minimum;
pub use settings::{ContactSettings, ContactType};
pub use tuning::Tuning;

pub use state::{ActiveSetProgress, Observer, State, Step};

pub(crate) use dual_problem::solve;
