//! PETSc's own solvers on the same problem: PCBDDC, KSPFETIDP, GAMG, hypre's BoomerAMG and MUMPS beside ours.
//!
//! ```text
//! Scene ──> System (A u = b, one unknown per tied point) ──> KSP by the options of a peer ──> Outcome
//!      └──> FetiFeti ───────────────────────────────────────────────────────────────────────> Outcome
//!                                             all solutions ──> judge (direct solution) ─────> Verdict
//! ```
//!
//! The assembled problem is that of [`assembled`](crate::assembled): in elasticity u is taken in blocks of nodes, in
//! coordinates along the normals of contact, and solvers are given the rigid motions. With inequalities the solvers of
//! the assembled problem run inside an active-set loop; the domain decompositions of PETSc solve the equations of the
//! last active set.
//!
//! Every method runs in a process group of its own, started by mpirun, so that memory and time of the methods are
//! separate. All are driven to the same relative residual of the assembled problem. `methods` runs them; `compare` does
//! so once, `bench` in rounds.

mod attempt;
mod bench;
mod compare;
mod contact;
mod corners;
mod job;
mod judge;
pub mod launch;
mod linear;
mod methods;
mod ours;
mod peers;
mod plan;
mod second;
pub(crate) mod single;
mod table;
mod task;

pub use bench::{bench, cases, Benchmark};
pub use compare::{compare, Comparison};
pub use job::run as run_job;
pub use judge::judge;
pub use ours::solve as solve_ours;
pub use peers::BASELINES;
pub use task::{BaselineTask, Job};
