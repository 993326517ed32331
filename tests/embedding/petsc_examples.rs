//! KSPFETIFETI in PETSc's own example programs, unmodified: the same answers as CG on the same matrix.

use crate::support::sample::sample;
use crate::support::{mpi, plugin};
use mpi::{Output, Scratch};
use plugin::{number_after, vector, Program};

/// ‖x − y‖ / ‖y‖.
fn distance(x: &[f64], y: &[f64]) -> f64 {
    assert_eq!(x.len(), y.len());
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|v| v * v).sum::<f64>().sqrt();
    norm(&mut x.iter().zip(y).map(|(x, y)| x - y)) / norm(&mut y.iter().copied())
}

/// Solves by FETI-FETI and by CG, if the last call was not for the same problem: the solutions agree, and the residual
/// is below the tolerance. Returns the iterations.
fn agrees(
    program: &Program,
    scratch: &Scratch,
    ranks: usize,
    prefix: &str,
    options: &str,
    ours: &str,
) -> usize {
    let (mine, theirs) = (scratch.path("mine"), scratch.path("theirs"));
    let common = |path: &str| {
        format!("{options} -{prefix}ksp_view_solution binary:{path} -{prefix}ksp_converged_reason")
    };
    let out = program.with_plugin(
        ranks,
        &format!(
            "{} -{prefix}ksp_type fetifeti -{prefix}ksp_rtol 1e-9 {ours}",
            common(&mine)
        ),
    );
    assert_eq!(out.code, 0, "{options} {ours}: {}", out.all());
    assert!(out.stdout.contains("CONVERGED_RTOL"), "{}", out.all());
    let of = format!("{ranks} {options}");
    if std::fs::read_to_string(scratch.path("theirs.of"))
        .ok()
        .as_ref()
        != Some(&of)
    {
        let other = program.run(
            ranks,
            &format!(
                "{} -{prefix}ksp_type cg -{prefix}pc_type jacobi -{prefix}ksp_rtol 1e-13",
                common(&theirs)
            ),
        );
        assert_eq!(other.code, 0, "{options}: {}", other.all());
        scratch.file("theirs.of", &of);
    }
    let error = distance(&vector(&mine), &vector(&theirs));
    assert!(error < 1e-7, "{ranks} ranks, {options} {ours}: {error:e}");
    number_after(&out, "iterations") as usize
}

#[test]
fn ex71_with_a_dirichlet_side() {
    let scratch = Scratch::new("embed-ex71");
    let program = Program::tutorial(&scratch, "ex71");
    let cases = [
        (1, "-dim 2 -cells 12,12", "", 0),
        (2, "-dim 2 -cells 12,12", "", 6),
        (4, "-dim 1 -cells 16", "", 2),
        (4, "-dim 2 -cells 24,24", "", 9),
        (9, "-dim 2 -cells 24,24", "-fetifeti_bodies 1", 10),
        (9, "-dim 2 -cells 24,24", "-fetifeti_bodies 2", 16),
        (9, "-dim 2 -cells 24,24", "-fetifeti_bodies 9", 18),
        (8, "-dim 3 -cells 8,8,8", "-fetifeti_bodies 2", 16),
        (4, "-dim 2 -cells 16,16 -pde_type Elasticity", "", 18),
        (
            9,
            "-dim 2 -cells 18,18 -pde_type Elasticity",
            "-fetifeti_bodies 3",
            40,
        ),
        (
            8,
            "-dim 3 -cells 6,6,6 -pde_type Elasticity",
            "-fetifeti_bodies 2",
            40,
        ),
        // Slabs: faces without edges.
        (
            3,
            "-dim 3 -cells 4,4,9 -pde_type Elasticity -da_processors_x 1 -da_processors_y 1",
            "",
            40,
        ),
    ];
    for (ranks, options, ours, most) in sample(3, cases) {
        let its = agrees(&program, &scratch, ranks, "", options, ours);
        assert!(
            its <= most,
            "{ranks} ranks, {options} {ours}: {its} iterations"
        );
    }
}

#[test]
fn ex71_with_a_null_space() {
    let scratch = Scratch::new("embed-null");
    let program = Program::tutorial(&scratch, "ex71");
    let cases = [
        (4, "-dim 2 -cells 16,16 -dirichlet 0"),
        (9, "-dim 2 -cells 18,18 -dirichlet 0 -fetifeti_bodies 3"),
        (4, "-dim 2 -cells 16,16 -periodicity 1,0"),
        (4, "-dim 2 -cells 16,16 -periodicity 1,1 -fetifeti_bodies 2"),
        (1, "-dim 2 -cells 8,8 -periodicity 1,1"),
        (8, "-dim 3 -cells 8,8,8 -dirichlet 0 -fetifeti_bodies 2"),
        (4, "-dim 2 -cells 12,12 -pde_type Elasticity -dirichlet 0"),
        (
            8,
            "-dim 3 -cells 6,6,6 -pde_type Elasticity -dirichlet 0 -fetifeti_bodies 4",
        ),
        (
            4,
            "-dim 2 -cells 12,12 -pde_type Elasticity -periodicity 1,0",
        ),
    ];
    for (ranks, options) in sample(3, cases) {
        let more =
            "-ksp_type fetifeti -ksp_rtol 1e-8 -ksp_converged_reason -ksp_view_final_residual";
        let out = program.with_plugin(ranks, &format!("{options} {more}"));
        assert_eq!(out.code, 0, "{options}: {}", out.all());
        assert!(
            out.stdout.contains("CONVERGED_RTOL"),
            "{options}: {}",
            out.all()
        );
        // Entries of b lie between 0 and 1: ‖b‖ is at most the root of the number of unknowns.
        let residual = number_after(&out, "KSP final norm of residual");
        assert!(residual < 1e-8 * 40.0, "{options}: {residual:e}");
    }
}

#[test]
fn ex49_elasticity_with_jumps() {
    let scratch = Scratch::new("embed-ex49");
    let program = Program::tutorial(&scratch, "ex49");
    let bricks = "-c_str 2 -brick_E 1,1000 -brick_nu 0.4,0.2 -brick_span 10";
    let sponge = "-c_str 3 -sponge_E0 1 -sponge_E1 1000 -sponge_nu0 0.4 -sponge_nu1 0.2 -sponge_t 1 -sponge_w 4";
    let cases = [
        (1, "", ""),
        (4, "", ""),
        (9, "", "-elas_fetifeti_bodies 3"),
        (4, bricks, "-elas_fetifeti_bodies 2"),
        // MatZeroRows on rows only: the operator is not symmetric.
        (4, "-use_nonsymbc", ""),
        (4, sponge, ""),
    ];
    for (ranks, options, ours) in sample(3, cases) {
        let options = format!("-mx 20 -my 20 -dm_mat_type is -no_view {options}");
        if options.contains("nonsymbc") {
            let more =
                "-elas_ksp_type fetifeti -elas_ksp_converged_reason -elas_ksp_view_final_residual";
            let out = program.with_plugin(ranks, &format!("{options} {more}"));
            assert!(out.stdout.contains("CONVERGED_RTOL"), "{}", out.all());
            assert!(number_after(&out, "KSP final norm of residual") < 1e-4);
        } else {
            agrees(&program, &scratch, ranks, "elas_", &options, ours);
        }
    }
}

#[test]
fn ex59_with_its_own_matis() {
    let scratch = Scratch::new("embed-ex59");
    let program = Program::tutorial(&scratch, "ex59");
    for (ranks, options) in [
        (4, "-npx 2 -npy 2 -nex 6 -ney 6"),
        (8, "-npx 2 -npy 2 -npz 2 -nex 6 -ney 5 -nez 4 -p 2"),
        (4, "-npx 2 -npy 2 -nex 6 -ney 6 -pureneumann"),
    ] {
        let more = "-physical_ksp_type fetifeti -physical_ksp_converged_reason -physical_ksp_rtol 1e-8 -testfetidp 0";
        let out = program.with_plugin(ranks, &format!("{options} {more}"));
        assert_eq!(out.code, 0, "{options}: {}", out.all());
        assert!(
            out.stdout.contains("CONVERGED_RTOL"),
            "{options}: {}",
            out.all()
        );
        assert!(!out.stdout.contains("Error"), "{options}: {}", out.all());
    }
}

/// Symmetric loads leave CG few directions. After these only the rounding of the displacements is left, in the kernel
/// of F: a tolerance below that is not pursued.
#[test]
fn symmetric_loads_of_time_steps_end_at_rounding() {
    let scratch = Scratch::new("embed-ts-ex45");
    let program = Program::tutorial_below("ts", &scratch, "ex45");
    let heat =
        "-sol_type trig_trig -dm_plex_simplex 0 -dm_plex_box_faces 4,4 -dm_refine 2 -petscpartitioner_type simple \
         -temp_petscspace_degree 2 -ts_type beuler -ts_max_steps 3 -ts_dt 0.1 -dm_mat_type is";
    for rtol in ["1e-9", "1e-12"] {
        let options = format!("{heat} -ksp_type fetifeti -ksp_rtol {rtol} -ksp_converged_reason");
        let out = program.with_plugin(4, &options);
        assert_eq!(out.code, 0, "{rtol}: {}", out.all());
        let solved: Vec<&str> = out
            .stdout
            .lines()
            .filter(|line| line.contains("CONVERGED_RTOL"))
            .collect();
        assert!(solved.len() >= 3, "{rtol}: {}", out.all());
        for line in solved {
            let its: usize = line.rsplit(' ').next().unwrap().parse().expect("a number");
            assert!(its <= 6, "{rtol}: {line}");
        }
    }
}

/// The options of ex62 for a Stokes problem whose velocities are the first block of PCFIELDSPLIT.
const STOKES: &str =
    "-sol quadratic -dm_plex_simplex 0 -petscpartitioner_type simple -vel_petscspace_degree 2 \
     -pres_petscspace_degree 1 -petscds_jac_pre 0 -dm_mat_type is -ksp_type fgmres -ksp_rtol 1e-10 \
     -ksp_gmres_restart 100 -ksp_converged_reason -pc_type fieldsplit -pc_fieldsplit_type schur \
     -pc_fieldsplit_schur_fact_type upper -pc_fieldsplit_schur_precondition a11 -fieldsplit_pressure_pc_type jacobi \
     -fieldsplit_velocity_ksp_type fetifeti -fieldsplit_velocity_ksp_rtol 1e-3 \
     -fieldsplit_velocity_ksp_converged_reason";

/// The number of times that `-log_view` has counted an event, over all stages.
fn counted(out: &Output, event: &str) -> usize {
    let rows = out.stdout.lines().map(|line| line.split_whitespace());
    let rows = rows.filter_map(|mut row| (row.next()? == event).then(|| row.next()));
    let counts = rows.map(|count| {
        count
            .and_then(|c| c.parse::<usize>().ok())
            .expect("a count")
    });
    counts.sum()
}

/// The velocities of a Stokes problem, with one load after the other: what directions of earlier loads reach without an
/// iteration counts as progress. A solve whose residual the host has measured takes the displacements of the first λ
/// and of the last one, and no certificate.
#[test]
fn ex62_with_many_small_solves() {
    let scratch = Scratch::new("embed-ex62");
    let program = Program::tutorial_below("snes", &scratch, "ex62");
    let small = "-dm_plex_box_faces 4,4 -dm_refine 1 -fieldsplit_pressure_ksp_type preonly";
    let watch = "-log_view -fieldsplit_velocity_ksp_monitor_true_residual \
                 -fieldsplit_velocity_ksp_view_final_residual";
    let out = program.with_plugin(4, &format!("{STOKES} {small} {watch}"));
    assert_eq!(out.code, 0, "{}", out.all());
    assert!(
        out.stdout.contains("  Linear solve converged"),
        "{}",
        out.all()
    );
    // Host's residuals, which the KSP outside forms: ||b|| from the first of each solve, and the last one.
    let (mut load, mut solves, mut shown) = (f64::NAN, 0, 0);
    let last = |line: &str| -> f64 {
        line.rsplit(' ')
            .next()
            .and_then(|w| w.parse().ok())
            .expect("a number")
    };
    for line in out.stdout.lines() {
        if let Some((norm, ratio)) = line.split_once("||r(i)||/||b||") {
            load = last(norm.trim()) / last(ratio);
            shown += 1;
        } else if line.contains("KSP final norm of residual") {
            assert!(
                last(line) <= 1.001e-3 * load,
                "{line} in solve {solves}, load {load:e}"
            );
            solves += 1;
        }
    }
    assert!((30..60).contains(&solves), "{}", out.all());
    assert_eq!(counted(&out, "FetiFetiCertify"), 0);
    // A solve that has to go on for the host's residual takes a third one; a look of the monitor takes one.
    let taken = counted(&out, "FetiFetiResid") - shown;
    assert!(2 * taken <= 5 * solves, "{taken} for {solves} solves");

    let alone = "-log_view -fieldsplit_velocity_fetifeti_true_residual 0";
    let out = program.with_plugin(4, &format!("{STOKES} {small} {alone}"));
    assert_eq!(out.code, 0, "{}", out.all());
    assert!(counted(&out, "FetiFetiCertify") >= 2, "{}", out.all());
}

/// GMRES on the pressures takes the solves for velocities as one linear map, to digits beyond their tolerance: they
/// must not depend on the loads before. Where it fails, the reason is passed on.
#[test]
fn ex62_with_pressures_to_ten_digits() {
    let scratch = Scratch::new("embed-ex62-pressures");
    let program = Program::tutorial_below("snes", &scratch, "ex62");
    let cube = "-dm_plex_dim 3 -dm_plex_box_faces 3,3,3 -fieldsplit_pressure_ksp_type gmres";
    let tight = "-fieldsplit_pressure_ksp_rtol 1e-10";
    let out = program.with_plugin(4, &format!("{STOKES} {cube} {tight}"));
    assert_eq!(out.code, 0, "{}", out.all());
    assert!(
        out.stdout.contains("  Linear solve converged"),
        "{}",
        out.all()
    );

    let failing = "-fieldsplit_pressure_ksp_divtol 1e-30";
    let out = program.with_plugin(4, &format!("{STOKES} {cube} {failing}"));
    let reason = "KSP_DIVERGED_NANORINF: the right-hand side is NaN at global dof";
    assert!(out.stderr.contains(reason), "{}", out.all());
    assert!(
        !out.all().contains("PETSC ERROR: FETI-FETI"),
        "{}",
        out.all()
    );
}

#[test]
fn an_assembled_matrix_is_refused_in_one_sentence() {
    let scratch = Scratch::new("embed-ex2");
    let program = Program::tutorial(&scratch, "ex2");
    for ranks in [1, 3] {
        let out = program.with_plugin(ranks, "-m 8 -n 8 -ksp_type fetifeti");
        assert_ne!(out.code, 0);
        let said = out.all();
        for part in [
            "FETI-FETI: the operator is of type",
            "expected is (MATIS)",
            "-dm_mat_type is",
        ] {
            assert!(said.contains(part), "{said}");
        }
        assert!(!said.contains("Segmentation"), "{said}");
    }
}

/// Every element is a subdomain, many of them on a rank: MatISSetAllowRepeated, which PETSc has from 3.21 on (`make
/// test-newer`).
#[test]
fn ex71_with_many_subdomains_on_a_rank() {
    if plugin::petsc_version() < (3, 21) {
        println!("this PETSc has no MatISSetAllowRepeated");
        return;
    }
    let scratch = Scratch::new("embed-multi-element");
    let program = Program::tutorial(&scratch, "ex71");
    for (ranks, options, ours) in [
        (1, "-dim 2 -cells 6,6", ""),
        (4, "-dim 2 -cells 6,6", "-fetifeti_bodies 3"),
        (4, "-dim 3 -cells 3,3,3", ""),
        (2, "-dim 2 -cells 6,6 -pde_type Elasticity", ""),
        (4, "-dim 3 -cells 3,3,3 -pde_type Elasticity", ""),
    ] {
        let options = format!("{options} -multi_element");
        let iterations = agrees(&program, &scratch, ranks, "", &options, ours);
        // All nodes of an element are vertices: in one body nothing is left to iterate on.
        let torn = !ours.is_empty();
        assert!(
            !torn || iterations > 0,
            "{options}: there was one subdomain only"
        );
    }
}
