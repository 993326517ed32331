//! Scenes: the problem as the user writes it, and its preparation up to the subdomain matrices.
//!
//! ```text
//! TOML ── read ──> SceneSpec ── Scene::new ──> Scene ──┬─> Problem   (the method)
//!                     ▲                                ├─> Stepper   (a solution for each load step)
//!                     │                                ├─> Numbering       (assembled baselines)
//!      a program ─────┘                                ├─> SubdomainMesh   (output, error norms)
//!                                                      └─> Plan            (what will be built)
//! ```
//!
//! A [`SceneSpec`] is unchecked data, a [`Scene`] is checked and has every default filled in. It holds data on the
//! boundaries of bodies only, O(boundary nodes). A program that solves it on several ranks needs no more on each than
//! the rows of the rank's own points: it reads a part (`part`), in which bodies and pairs of bodies are all there, with
//! the numbers of the whole. Matrices are assembled subdomain by subdomain, on the rank that owns the subdomain.
//! Coefficients in array files are read there, too.

pub mod assembly;
mod axis;
mod body;
mod checked;
pub mod checkpoint;
mod coefficient;
mod cut;
pub(crate) mod deck;
mod displaced;
pub mod distribution;
mod element_laws;
mod equilibrium;
pub mod fits;
pub(crate) mod geometry;
mod idle;
mod interfaces;
mod joint;
mod loads;
mod matrices;
mod meshes;
pub mod model;
pub mod need;
mod numbering;
mod part;
mod plan;
mod quantity;
mod read;
mod renew;
mod renewal;
pub(crate) mod rows;
mod side_pair;
pub mod sliding;
pub mod stepper;
mod validate;

/// Elements and materials, as scenes name them.
pub use elements;
/// Meshes, as scenes take them.
pub use mesh;

pub use body::Body;
pub use checked::Scene;
pub use checkpoint::Checkpoint;
pub use deck::{DeckScenes, SlipHistory};
pub use displaced::Displaced;
pub use equilibrium::{Forces, Wrench};
pub use geometry::interface::{BodyInterface, InterfaceShape, Link, SharedNode};
pub use interfaces::Interfaces;
pub use loads::{SteppedMesh, Stepping};
pub use model::body::{
    free_all_round, held_all_round, BodyKind, BodySpec, Cut, Force, GivenSides, Load, SurfaceLoad,
    SIDES,
};
pub use model::cells::{CellGrid, NumberFormat, Tone};
pub use model::entry::EntryId;
pub use model::expr::gradient::WithGradient;
pub use model::expr::{Expr, Variables};
pub use model::field::{At, By, Field, Region};
pub use model::grid::GridSpec;
pub use model::heat::{HeatSpec, Temperature};
pub use model::joints::{
    AutoContact, ContactSpec, EquationSpec, Extent, ObstacleSpec, PairSelector, TieSpec,
};
pub use model::law::{LawSpec, MaterialAxes, OrientedLaw};
pub use model::map::{BodyShape, Map, Round};
pub use model::motion::Isometry;
pub use model::profile::{Limit, Limits, Profile};
pub use model::ramp::{Ramp, StepsSpec};
pub use model::rigid::Rigid;
pub use model::rigid_surface::RigidSurface;
pub use model::spec::{lee, ByDefault, Faces, ProbeSpec, SceneSpec};
pub use model::steps::Steps;
pub use numbering::Numbering;
pub use plan::{BodyPlan, InterfacePlan, ScenePlan};
pub use read::read;
pub use rows::obstacles::Obstacle;
pub use rows::points::InterfacePoint;
pub use rows::row::{Bound, Combination, Row};
pub use rows::terms::{RowTerm, RowTerms};
pub use side_pair::{SidePair, SurfaceObstacle};
pub use stepper::{StepSolution, Stepper, StepperState};
