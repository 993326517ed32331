//! The peers, each with the options that were the fastest for a kind of problem: scalar or elastic, in the plane or in
//! space, tied or in contact.
//!
//! docs/studies.md, "Options of the peers", has the sets that were tried, and the seconds that chose;
//! `scripts/peer_options.py` measures again.

use super::table::{Baseline, Needs, OptionSet, When};
use crate::assembled::near::Near;
use crate::assembled::system::MatrixFormat;

/// CG on the assembled problem, stopped by its residual.
const CG: OptionSet = OptionSet {
    when: When::Always,
    options: &[("ksp_type", "cg"), ("ksp_norm_type", "unpreconditioned")],
};

/// The options of PCBDDC, also of the one inside KSPFETIDP.
pub(super) const BDDC: [OptionSet; 5] = [
    OptionSet {
        when: When::Always,
        // Follows jumps of the coefficient; PETSc's default scales by multiplicity.
        options: &[("pc_is_use_stiffness_scaling", "true")],
    },
    OptionSet {
        when: When::Space,
        options: &[("pc_bddc_use_faces", "true")],
    },
    OptionSet {
        when: When::Elastic,
        // Parts have too few vertices to have no kernel: PETSc picks more by their positions.
        options: &[("pc_bddc_corner_selection", "true")],
    },
    OptionSet {
        when: When::ElasticSpace,
        // Averages of all rigid motions take fewer iterations, and more than that in the coarse problem.
        options: &[("pc_bddc_use_nnsp", "false")],
    },
    OptionSet {
        when: When::Rescue,
        // A floating part without a vertex gets a singular local problem unless averages become unknowns, which costs
        // the other problems time and memory: sixteen times the seconds on large faces.
        options: &[("pc_bddc_use_change_of_basis", "true")],
    },
];

/// BoomerAMG with sparse interpolation.
const HMIS: [(&str, &str); 4] = [
    ("pc_hypre_boomeramg_coarsen_type", "HMIS"),
    ("pc_hypre_boomeramg_interp_type", "ext+i"),
    ("pc_hypre_boomeramg_P_max", "4"),
    ("pc_hypre_boomeramg_strong_threshold", "0.5"),
];

/// The baselines in the order in which they are run.
pub const BASELINES: [Baseline; 6] = [
    Baseline {
        name: "bddc",
        description: "CG with PCBDDC, vertices and averages over edges or faces primal",
        needs: Needs::Nothing,
        format: MatrixFormat::Unassembled,
        krylov: "",
        bddc: Some(""),
        sets: &[
            CG,
            OptionSet {
                when: When::Always,
                options: &[("pc_type", "bddc")],
            },
        ],
        near: Near::Motions,
        lag: 0.0,
    },
    Baseline {
        name: "fetidp",
        description:
            "KSPFETIDP, CG on fully redundant multipliers, the primal constraints of PCBDDC",
        needs: Needs::Nothing,
        format: MatrixFormat::Unassembled,
        krylov: "fetidp_",
        bddc: Some("fetidp_bddc_"),
        sets: &[OptionSet {
            when: When::Always,
            options: &[
                ("ksp_type", "fetidp"),
                ("ksp_fetidp_fullyredundant", "true"),
                ("fetidp_ksp_type", "cg"),
                ("fetidp_ksp_norm_type", "unpreconditioned"),
            ],
        }],
        near: Near::Motions,
        lag: 0.0,
    },
    Baseline {
        name: "hpddm",
        description:
            "CG with PCHPDDM, overlapping subdomains and a coarse space of eigenvectors (GenEO)",
        needs: Needs::Pc("hpddm"),
        format: MatrixFormat::Unassembled,
        krylov: "",
        bddc: None,
        sets: &[
            CG,
            OptionSet {
                when: When::Always,
                // Those of PETSc's own example for a MATIS (ksp/tutorials/ex71).
                options: &[
                    ("pc_type", "hpddm"),
                    ("pc_hpddm_coarse_correction", "balanced"),
                    ("pc_hpddm_levels_1_pc_type", "asm"),
                    ("pc_hpddm_levels_1_pc_asm_overlap", "1"),
                    ("pc_hpddm_levels_1_pc_asm_type", "basic"),
                    ("pc_hpddm_levels_1_sub_pc_type", "cholesky"),
                    ("pc_hpddm_levels_1_eps_nev", "10"),
                    ("pc_hpddm_levels_1_st_pc_factor_shift_type", "INBLOCKS"),
                ],
            },
        ],
        near: Near::None,
        lag: 0.0,
    },
    Baseline {
        name: "gamg",
        description: "CG with PETSc's smoothed aggregation",
        needs: Needs::Nothing,
        format: MatrixFormat::Assembled,
        krylov: "",
        bddc: None,
        sets: &[
            CG,
            OptionSet {
                when: When::Always,
                options: &[("pc_type", "gamg")],
            },
            OptionSet {
                when: When::ElasticSpaceNewer,
                // Aggregates of the graph itself, not of its square: more iterations, and less than that in set-up.
                options: &[("pc_gamg_aggressive_square_graph", "false")],
            },
            OptionSet {
                when: When::Contact,
                // Unknowns that a step has released need a place on the coarse grids, and zero entries are no
                // connections.
                options: &[
                    ("pc_gamg_reuse_interpolation", "false"),
                    ("pc_gamg_threshold", "0"),
                ],
            },
        ],
        near: Near::Motions,
        lag: 0.05,
    },
    Baseline {
        name: "hypre",
        description: "CG with hypre's BoomerAMG",
        needs: Needs::Pc("hypre"),
        format: MatrixFormat::Assembled,
        krylov: "",
        bddc: None,
        sets: &[
            CG,
            OptionSet {
                when: When::Always,
                options: &[("pc_type", "hypre"), ("pc_hypre_type", "boomeramg")],
            },
            OptionSet {
                when: When::Space,
                // The recommendation of hypre's manual in three dimensions.
                options: &HMIS,
            },
            OptionSet {
                when: When::Elastic,
                // Every component is coarsened by itself, and components are connected through the smoother only (the
                // block size makes it so).
                options: &HMIS,
            },
            OptionSet {
                when: When::Elastic,
                // An aggressive level: a third to a half more iterations, each with far fewer entries.
                options: &[("pc_hypre_boomeramg_agg_nl", "1")],
            },
        ],
        near: Near::Rotations,
        lag: 0.0,
    },
    Baseline {
        name: "mumps",
        description: "sparse Cholesky by MUMPS",
        needs: Needs::Package("mumps"),
        format: MatrixFormat::Assembled,
        krylov: "",
        bddc: None,
        sets: &[OptionSet {
            when: When::Always,
            options: &[
                ("ksp_type", "preonly"),
                ("pc_type", "cholesky"),
                ("pc_factor_mat_solver_type", "mumps"),
            ],
        }],
        near: Near::None,
        lag: 0.0,
    },
];
