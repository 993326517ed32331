//! The baselines: rows of option strings on the same problem, to the same residual.
//!
//! Every row has a prefix of its own, so that a researcher can tune it on the command line of `compare`:
//! `-gamg_pc_gamg_threshold 0.05`, `-bddc_pc_bddc_use_deluxe_scaling`, `-fetidp_fetidp_ksp_monitor`. Ours keeps
//! `-fetifeti_`.

use crate::assembled::near::Near;
use crate::assembled::system::MatrixFormat;
use base::{Error, Result};
use petsc::{Options, Session};
use scene::Scene;

/// One of PETSc's solvers.
#[derive(Debug, PartialEq)]
pub struct Baseline {
    /// The name for `--with`; followed by an underscore, the prefix of its options.
    pub name: &'static str,
    /// A description.
    pub description: &'static str,
    /// The matrix it takes.
    pub format: MatrixFormat,
    /// The prefix of the Krylov method's options behind the row's own prefix: KSPFETIDP iterates in an inner solver.
    pub krylov: &'static str,
    /// Options (without the prefix) that hold unless the user says otherwise.
    pub options: &'static [(&'static str, &'static str)],
    /// Further options in three dimensions.
    pub space: &'static [(&'static str, &'static str)],
    /// Further options in elasticity; they override those in three dimensions.
    pub elastic: &'static [(&'static str, &'static str)],
    /// The rigid motions that the solver is given.
    pub near: Near,
    /// Further options in contact loops, where the matrix changes and has entries that are zero.
    pub contact: &'static [(&'static str, &'static str)],
    /// In contact loops the preconditioner is kept until more than this part of the inequalities has changed since it
    /// was built. The value is the fastest one on the model problem.
    pub lag: f64,
    /// Further options for a second try, where the first one does not converge.
    pub rescue: &'static [(&'static str, &'static str)],
}

impl Baseline {
    /// The baseline of this name.
    pub fn named(name: &str) -> Option<&'static Baseline> {
        BASELINES.iter().find(|b| b.name == name)
    }

    /// The prefix of its options.
    pub fn prefix(&self) -> String {
        format!("{}_", self.name)
    }

    /// The options of the second try, as the user would write them.
    pub fn rescue_options(&self) -> String {
        let written = |(name, value): &(&str, &str)| format!("-{}{name} {value}", self.prefix());
        self.rescue
            .iter()
            .map(written)
            .collect::<Vec<_>>()
            .join(" ")
    }

    /// Puts the options into the database, where those of the user override them, and lists them under `-help`.
    ///
    /// # Errors
    /// PETSc's.
    pub fn set_options(&self, session: &Session, rtol: f64, case: BaselineCase) -> Result<()> {
        let options = Options::new(session, &self.prefix());
        options.heading(&format!(
            "compare --with {}: {}",
            self.name, self.description
        ))?;
        let rtol = format!("{rtol:e}");
        let tolerance = (format!("{}ksp_rtol", self.krylov), rtol.as_str());
        let further = [
            (true, self.options),
            (case.elastic, self.elastic),
            (case.space, self.space),
            (case.contact, self.contact),
            (case.rescue, self.rescue),
        ];
        let fixed = further
            .iter()
            .filter(|(holds, _)| *holds)
            .flat_map(|(_, list)| list.iter())
            .map(|(name, value)| (name.to_string(), *value));
        for (name, value) in fixed.chain([tolerance]) {
            options.set_default(&name, value)?;
            options.list(&name, value, "set by compare")?;
        }
        Ok(())
    }
}

/// The properties of a run that its options depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BaselineCase {
    /// Whether the problem is three-dimensional.
    pub space: bool,
    /// Whether it is elasticity.
    pub elastic: bool,
    /// Whether there are inequalities.
    pub contact: bool,
    /// Whether this is the second try.
    pub rescue: bool,
}

impl BaselineCase {
    /// The properties of `scene`, for the first try.
    pub fn of(scene: &Scene) -> BaselineCase {
        BaselineCase {
            space: scene.dim() == 3,
            elastic: scene.components() > 1,
            contact: scene.has_contact(),
            rescue: false,
        }
    }
}

/// The baselines in the order in which they are run.
pub const BASELINES: [Baseline; 5] = [
    Baseline {
        name: "bddc",
        description: "CG with PCBDDC, vertices, averages over edges and faces primal",
        format: MatrixFormat::Unassembled,
        krylov: "",
        options: &[
            ("ksp_type", "cg"),
            ("ksp_norm_type", "unpreconditioned"),
            ("pc_type", "bddc"),
            // Scaling by the stiffness follows jumps of the coefficient; PETSc's default scales by multiplicity.
            ("pc_is_use_stiffness_scaling", "true"),
            ("pc_bddc_dirichlet_pc_type", "cholesky"),
            ("pc_bddc_dirichlet_pc_factor_mat_solver_type", "cholmod"),
            ("pc_bddc_neumann_pc_type", "cholesky"),
            ("pc_bddc_neumann_pc_factor_mat_solver_type", "cholmod"),
        ],
        space: &[("pc_bddc_use_faces", "true")],
        // Parts have too few vertices to have no kernel: PETSc picks more by their positions. Making averages over
        // edges and faces unknowns instead took sixteen times as long on large faces.
        elastic: &[("pc_bddc_corner_selection", "true")],
        near: Near::Motions,
        contact: &[],
        lag: 0.0,
        // A floating part without a vertex gets a singular local problem unless averages become unknowns, which costs
        // the other problems time and memory.
        rescue: &[("pc_bddc_use_change_of_basis", "true")],
    },
    Baseline {
        name: "fetidp",
        description:
            "KSPFETIDP, CG on fully redundant multipliers, the primal constraints of PCBDDC",
        format: MatrixFormat::Unassembled,
        krylov: "fetidp_",
        options: &[
            ("ksp_type", "fetidp"),
            ("ksp_fetidp_fullyredundant", "true"),
            ("fetidp_ksp_type", "cg"),
            ("fetidp_ksp_norm_type", "unpreconditioned"),
            ("fetidp_bddc_pc_is_use_stiffness_scaling", "true"),
            ("fetidp_bddc_pc_bddc_dirichlet_pc_type", "cholesky"),
            (
                "fetidp_bddc_pc_bddc_dirichlet_pc_factor_mat_solver_type",
                "cholmod",
            ),
            ("fetidp_bddc_pc_bddc_neumann_pc_type", "cholesky"),
            (
                "fetidp_bddc_pc_bddc_neumann_pc_factor_mat_solver_type",
                "cholmod",
            ),
        ],
        space: &[("fetidp_bddc_pc_bddc_use_faces", "true")],
        elastic: &[("fetidp_bddc_pc_bddc_corner_selection", "true")],
        near: Near::Motions,
        contact: &[],
        lag: 0.0,
        rescue: &[("fetidp_bddc_pc_bddc_use_change_of_basis", "true")],
    },
    Baseline {
        name: "gamg",
        description: "CG with PETSc's smoothed aggregation",
        format: MatrixFormat::Assembled,
        krylov: "",
        options: &[
            ("ksp_type", "cg"),
            ("ksp_norm_type", "unpreconditioned"),
            ("pc_type", "gamg"),
        ],
        space: &[],
        elastic: &[],
        near: Near::Motions,
        // Unknowns that a step has released need a place on the coarse grids, and zero entries are no connections.
        contact: &[
            ("pc_gamg_reuse_interpolation", "false"),
            ("pc_gamg_threshold", "0"),
        ],
        lag: 0.05,
        rescue: &[],
    },
    Baseline {
        name: "hypre",
        description: "CG with hypre's BoomerAMG",
        format: MatrixFormat::Assembled,
        krylov: "",
        options: &[
            ("ksp_type", "cg"),
            ("ksp_norm_type", "unpreconditioned"),
            ("pc_type", "hypre"),
            ("pc_hypre_type", "boomeramg"),
        ],
        // The recommendation of hypre's manual in three dimensions. In elasticity every component is coarsened by
        // itself, and components are connected through the smoother only (the block size makes it so): nodal coarsening
        // with rotations in the interpolation took ten times as long.
        space: &[
            ("pc_hypre_boomeramg_coarsen_type", "HMIS"),
            ("pc_hypre_boomeramg_interp_type", "ext+i"),
            ("pc_hypre_boomeramg_P_max", "4"),
            ("pc_hypre_boomeramg_strong_threshold", "0.5"),
        ],
        elastic: &[("pc_hypre_boomeramg_strong_threshold", "0.5")],
        near: Near::Rotations,
        contact: &[],
        lag: 0.0,
        rescue: &[],
    },
    Baseline {
        name: "mumps",
        description: "sparse Cholesky by MUMPS",
        format: MatrixFormat::Assembled,
        krylov: "",
        options: &[
            ("ksp_type", "preonly"),
            ("pc_type", "cholesky"),
            ("pc_factor_mat_solver_type", "mumps"),
        ],
        space: &[],
        elastic: &[],
        near: Near::None,
        contact: &[],
        lag: 0.0,
        rescue: &[],
    },
];

/// The baselines that `--with` names, in the order of the table; all of them for an empty list.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for a name that is not in the table.
pub fn select(names: &[String]) -> Result<Vec<&'static Baseline>> {
    for name in names {
        if Baseline::named(name).is_none() {
            let known: Vec<&str> = BASELINES.iter().map(|b| b.name).collect();
            return Err(Error::input(format!(
                "--with names \"{name}\", expected some of {}",
                known.join(",")
            )));
        }
    }
    let wanted = |b: &&Baseline| names.is_empty() || names.iter().any(|n| n == b.name);
    Ok(BASELINES.iter().filter(wanted).collect())
}

#[cfg(test)]
#[path = "../../tests/baselines/table.rs"]
mod tests;
