//! The FETI-FETI method: FETI-DP inside every body, one-level FETI between the bodies, on PETSc.
//!
//! # The problem
//!
//! Bodies Ω_i, i = 1..N, are each cut into subdomains Ω_ij. Every body carries −∇·(ρ∇u) = f with Dirichlet conditions
//! on some of its sides. A body without Dirichlet conditions *floats*. On the faces where bodies meet, their
//! displacements are tied, B_gl u = c, or in contact, B_gl u ≤ c with λ ≥ 0; the model is \[Lee\] (3.1)–(3.3).
//! [`contact`] is the loop around the equations; it changes Z and nothing that depends on K.
//!
//! After condensation to the interface Γ the unknowns are torn twice, inside the bodies and between them, and tied
//! again by multipliers λ. The dual problem is \[Lee\] (2.11), (3.8):
//!
//! ```text
//!     Pᵀ F λ = Pᵀ d,   Gᵀ λ = e        by CG in λ₀ + ker Gᵀ, preconditioned by P M⁻¹ Pᵀ
//!     u = S̃⁺(g − Bᵀ λ) + R α           and back substitution into the interiors
//! ```
//!
//! # Notation
//!
//! | symbol | shape | meaning | where |
//! |---|---|---|---|
//! | K, f | n × n, n | stiffness and load of one subdomain, Dirichlet dofs eliminated | [`substructures`] |
//! | Γ = Δ ∪ Π | | interface dofs of a subdomain: dual, then primal ones | `feti::subdomain::problem` |
//! | S | n_Γ × n_Γ | Schur complement K_ΓΓ − K_ΓI K_II⁻¹ K_IΓ, with T = S_ΔΔ⁻¹ and the coarse basis Ψ | `feti::subdomain::problem` |
//! | W̃ | | functions continuous at the primal dofs of a body, torn elsewhere, \[Lee\] (3.5)–(3.7) | `feti::primal` |
//! | S̃⁺ | dim W̃ | Σ T + Ψ S_Π⁺ Ψᵀ, block diagonal by body | `feti::operators::stiffness`, `feti::primal::coarse` |
//! | B = \[B_loc; B_gl\] | m × dim W̃ | jumps inside the bodies (fully redundant) and between them | `feti::jump` |
//! | Z | m × m | 0/1 diagonal: rows that hold; 1 on B_loc | `feti::jump` |
//! | B_D | m × dim W̃ | (B D⁻¹ Bᵀ)⁺ B D⁻¹, jumps scaled with D = ρ^γ | `feti::jump::scaling` |
//! | R | dim W̃ × r | kernels of the floating bodies, found from the matrices | `feti::primal::kernel` |
//! | F | m × m | Z B S̃⁺ Bᵀ Z, \[Lee\] (3.8) | `feti::operators::stiffness` |
//! | G, e | m × r, r | Z B R and Rᵀ g | `feti::projector::natural` |
//! | P | m × m | I − Q G (Gᵀ Q G)⁻¹ Gᵀ, \[Lee\] (2.11) | `feti::projector::natural` |
//! | M_D⁻¹ | m × m | Z B_D S̃ B_Dᵀ Z, \[Lee\] section 3.1 | `feti::operators::preconditioner` |
//! | Z_c, M_C⁻¹ | dim W̃ × n_c, m × m | coarse functions that vanish where bodies may touch; M_D⁻¹ with their span removed | `feti::lifting` |
//! | κ | | λ_max / λ_min of P M⁻¹ Pᵀ F on ker Gᵀ ∩ range B | [`Spectrum`](solution::Spectrum) |
//!
//! # The way data flows
//!
//! ```text
//! scene.toml ── scene ──┐
//!                       ├──> Problem ──> FetiFeti (contact around feti) ──> Solution ──> report
//! MATIS, CSR ── embed ──┘
//! ```
//!
//! A program may enter at [`Problem`] with matrices of its own. The crate `fetifeti-scene` builds substructures
//! from scenes; `embed` finds them in matrices of other PETSc programs (docs/embedding.md). The solver does not know
//! where they came from. `feti` solves equations, `contact` says which rows of B are equations, [`FetiFeti`] combines
//! both.
//!
//! The modules have an order, and each imports only from those before it. docs/architecture.md has the map, and follows
//! a load, a contact row and a MATIS through the code. The crate [`petsc`] and the C interface `capi` are the only ones
//! with unsafe code. docs/glossary.md has symbols and words.
//!
//! # Only what the problem needs
//!
//! | problem | what is not built | what it then is |
//! |---|---|---|
//! | one subdomain per body | B_loc, Z_c; the primal problem shrinks to the fixing dofs of floating bodies | one-level FETI, \[Lee\] section 2.2 |
//! | one body | B_gl, G, Z_c | FETI-DP, \[Lee\] section 2.3 |
//! | no floating body | G, P | |
//! | no inequality | the outer loop | one linear problem |
//! | `-fetifeti_pc_type dirichlet` | Z_c | the method whose κ ≤ C (H_b/H_s)(1 + log H_s/h)² is Theorem 3.10 of \[Lee\] |
//!
//! In these cases sizes become zero; there is one code path without branches of its own for them. `fetifeti plan`
//! prints the sizes for a scene.
//!
//! # Example
//!
//! ```no_run
//! use fetifeti::{FetiFeti, Result, Session, Settings};
//! use fetifeti_scene::{GridSpec, Scene};
//!
//! fn solve(session: &Session) -> Result<()> {
//!     // The unit square, held all round, f = 1: 2 × 2 bodies of 4 × 4 subdomains and 32 × 32 elements.
//!     let scene = Scene::grid("square", &GridSpec::unit_square([2, 2], [4, 4], [32, 32]))?;
//!     let mine = fetifeti::share(session, scene.n_subdomains());
//!     let problem = scene.substructures(&|s| mine.contains(&s))?;
//!     let mut solver = FetiFeti::new(session, problem, Settings::default())?;
//!     let solution = solver.solve()?;
//!     let kappa = solver.spectrum()?.map(|s| s.kappa());
//!     println!("{} iterations, kappa {kappa:?}", solution.iterations);
//!     Ok(())
//! }
//!
//! fn main() -> std::process::ExitCode {
//!     fetifeti::run(solve)
//! }
//! ```
//!
//! # References
//!
//! \[Lee\] J. Lee, *Convergence analysis of a new domain decomposition method for a linearized contact problem*, 2010.
//! `docs/theory.md` in the repository has the other references and the reasons behind the choices; `docs/options.md`
//! has every option. `docs/README.md` says which page is for whom.

#[allow(unsafe_code)]
mod capi;
mod contact;
mod embed;
mod feti;
pub mod settings;
pub mod solution;
mod solver;
mod status;
mod substructures;

#[cfg(test)]
#[path = "../tests/support/matrices.rs"]
#[allow(dead_code)]
mod matrices;
#[cfg(test)]
#[path = "../tests/support/mpi.rs"]
#[allow(dead_code)]
mod mpirun;
#[cfg(test)]
#[path = "../tests/support/session.rs"]
mod testing;

#[doc(inline)]
pub use base::{Error, Result};
#[doc(inline)]
pub use parallel::exchange::{max_all, sum_all};
#[doc(inline)]
pub use petsc::{Ksp, Session};
pub use settings::Settings;
pub use solution::Solution;
pub use solver::FetiFeti;
pub use status::Status;
pub use substructures::{Problem, Row, Subdomain};

/// Parts of a [`Problem`]: matrices, primal entities, and what rows say of themselves.
pub mod problem {
    pub use crate::feti::Numbers;
    pub use crate::substructures::{
        BodyNode, Entity, EntityKind, FrictionBound, FrictionNode, Idle, Law, RowLabel, RowSource,
    };
    #[doc(inline)]
    pub use base::linalg::csr::Csr;
}

/// Parts of an [`Error`]: its kind, and its place.
pub mod error {
    #[doc(inline)]
    pub use base::{ErrorKind, Fault, Location};
}

/// The part of the solver's inside that the other crates of this workspace and its tests reach. It is no part of the
/// interface: names in it change without notice.
#[doc(hidden)]
pub mod inside {
    pub use crate::capi::suits as processor_suits;
    pub use crate::contact::{driver, line_minimum, node, nodes};
    pub use crate::feti::cost::{forms, sizes::ProblemSizes, variation::JUMPS};
    pub use crate::feti::deflation::watch;
    pub use crate::feti::interface::entities::{Average, AverageKind};
    pub use crate::feti::interface::sharing::DofSharing;
    pub use crate::feti::jump::{operator::Jump, weights};
    pub use crate::feti::projector::{coarse_solver, distributed, gram::FEW};
    pub use crate::feti::subdomain::problem::{factorisations, LocalProblem};
    pub use crate::feti::subdomain::{equal, scaled::ScaledSubdomain, turn, which};
    pub use crate::feti::LinearMethod;
    pub use crate::solver::groups;
    pub use crate::substructures::idle;

    /// Handles and errors of C interfaces.
    pub mod c {
        pub use crate::capi::{alone, create, destroy, processor, put, together, Held, Pointer};
    }
}

/// Runs `work` as the whole program. It starts PETSc with the process's arguments (so that PETSc options work) and ends
/// it afterwards. An error is printed as one sentence and becomes the exit code of [`Error::exit_code`].
pub fn run(work: impl FnOnce(&Session) -> Result<()>) -> std::process::ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let code = match Session::new(&args, "") {
        Ok(session) => session.run(work),
        Err(error) => {
            error.tell("Error");
            error.exit_code()
        }
    };
    std::process::ExitCode::from(code as u8)
}

/// The subdomains of this rank if `n` subdomains are dealt out in equal runs. Any other distribution is as good.
pub fn share(session: &Session, n: usize) -> std::ops::Range<usize> {
    parallel::contiguous_share(n, session.size(), session.rank())
}
