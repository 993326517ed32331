//! Mortar rows between two sides whose nodes do not match.
//!
//! One side carries the multipliers (the *multiplier side*); its traces are φ, those of the *other side* φ°. Every node
//! p of the multiplier side that lies opposite the other side has a function ψ_p of a dual basis, and a row
//!
//! ```text
//!     Σ_k (D_pk / D_p) u_k − Σ_q (M_pq / D_p) u°_q,    D_pk = ∫ ψ_p φ_k,  M_pq = ∫ ψ_p φ°_q,  D_p = ∫ ψ_p
//! ```
//!
//! (Wohlmuth 2000; Popp, Wohlmuth, Gee and Wall 2012). Where all nodes of a face of first order carry multipliers, D is
//! diagonal. Integrals go over the part of the multiplier side that lies opposite the other side, piece by piece, where
//! both traces are smooth: constant pressures are transmitted to rounding, and rigid motions give no jump. The
//! multiplier of a row is D_p times the pressure.
//!
//! ```text
//!     Side, Side ── plane, space: samples ──> [Sample] ── dual: rows ──> [Row]
//! ```

mod distance;
mod dual;
mod foot;
mod orientation;
mod plane;
mod sample;
mod side;
mod space;
mod tree;

pub use distance::{distance, reach};
pub use dual::{has_positive_integrals, positive, rows, DualMortarRow};
pub use foot::Feet;
pub use orientation::one_way;
pub use sample::{samples, MortarSample};
pub use side::{across, reversed, MortarFace, MortarSide};
pub use tree::Tree;
