//! Partial sparse Cholesky factorisation: the interior of a subdomain is eliminated, the Schur complement S is kept.
//!
//! ```text
//!     pattern of K, interface ──dissection, cover──> order ──symbolic──> Symbolic (fronts)
//!     Symbolic, numbers of K  ──multifrontal───────> PartialCholesky (panels), S
//!     PartialCholesky, loads  ──substitution, lanes─> condensed loads, interior solutions
//! ```
//!
//! | file | what it does |
//! |---|---|
//! | [`dissection`], [`cover`], `nodes` | order of elimination: nested dissection with the smallest separators |
//! | [`symbolic`] | fronts, their rows, and where these stand in the parent's front |
//! | [`multifrontal`] | factors front by front; what reaches the root is S |
//! | `front` | factors one front, with or without pivots that vanish |
//! | [`panel`], `strips` | how the columns of a front lie in memory, and those of its update |
//! | `sweep` | the way of a solve through the fronts |
//! | [`substitution`], [`lanes`] | solves with one vector, and with eight side by side |
//! | [`reached`] | solves that some dofs alone take part in |
//! | `null_vector` | null vectors of a semidefinite matrix |
//! | `deal`, [`team`], `narrow`, [`shared`] | which rank has which front, the ranks that share a factor, what each of them knows, and the factor |
//! | [`interior`] | the face for subdomains: one analysis for a pattern, a factor and S for each matrix |
//!
//! `docs/cholesky.md` has the theory, the data structures and the measurements.

pub mod cover;
pub mod deal;
pub mod dissection;
mod front;
pub mod interior;
pub mod lanes;
pub mod multifrontal;
mod narrow;
mod nodes;
mod null_vector;
pub mod panel;
pub mod reached;
pub mod shared;
mod strips;
pub mod substitution;
mod sweep;
pub mod symbolic;
pub mod team;

#[cfg(test)]
#[path = "../../../tests/support/matrices.rs"]
#[allow(dead_code)]
mod matrices;
