//! The method, one file per operator, symbols as in the theory page.

pub mod adaptive;
pub mod blocks;
pub mod check;
pub mod classes;
pub mod coarse;
pub mod deluxe;
pub mod dual;
pub mod entities;
pub mod equal;
pub mod exchange;
pub mod gtg;
pub mod halo;
pub mod inner;
pub mod jump;
pub mod kernel;
pub mod kkt;
pub mod lifting;
pub mod local;
pub mod natural;
pub mod preconditioner;
pub mod primal;
pub mod recover;
pub mod rows;
pub mod scaling;
pub mod settings;
pub mod sharing;
pub mod sizes;
pub mod solver;
pub mod spectrum;
pub mod stiffness;
pub mod team;

pub use kkt::Kkt;
pub use recover::Solution;
pub use settings::{PcType, Precision, Primal, ProjectorKind, Scaling, Settings};
pub use solver::FetiFeti;
pub use spectrum::Spectrum;
