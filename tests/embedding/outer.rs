//! Hosts with more than a KSP: the preconditioner of type fetifeti inside other solvers, several right-hand sides,
//! transposed systems, guesses, and all ways of looking at a solver.

use crate::support::sample::sample;
use crate::support::{mpi, plugin};
use mpi::{Output, Scratch};
use plugin::Program;

fn iterations(out: &Output) -> Vec<u32> {
    let lines = out
        .stdout
        .lines()
        .filter(|l| l.contains("converged due to"));
    lines
        .map(|l| {
            l.split_whitespace()
                .next_back()
                .and_then(|w| w.parse().ok())
        })
        .map(|n| n.expect("a number of iterations"))
        .collect()
}

/// Runs a program that says "ok", or has no more to say than its iterations, and returns these.
fn converges(program: &Program, ranks: usize, options: &str) -> Vec<u32> {
    let out = program.with_plugin(ranks, &format!("{options} -ksp_converged_reason"));
    assert_eq!(out.code, 0, "{options}: {}", out.all());
    assert!(
        !out.all().contains("did not converge"),
        "{options}: {}",
        out.all()
    );
    let found = iterations(&out);
    assert!(!found.is_empty(), "{options}: {}", out.all());
    found
}

/// The program compares the residuals of all systems with the tolerance, 1e-8.
#[test]
fn several_right_hand_sides_and_transposed_ones() {
    let scratch = Scratch::new("embed-outer-many");
    let program = Program::own("mpicc", &scratch, "outer.c");
    for options in [
        "-ksp_type fetifeti",
        "-ksp_type fetifeti -ksp_guess_type fischer",
    ] {
        let found = converges(&program, 4, options);
        // KSPMatSolve reports the longest of its five iterations; the others are a solve each.
        assert_eq!(found.len(), 5, "{options}: {found:?}");
        // Directions of earlier solves serve the later ones: each takes fewer.
        assert!(found[4] < found[0], "{options}: {found:?}");
    }
    // Where all unknowns are primal nothing is left to iterate on.
    let primal = "-ksp_type fetifeti -primal -fetifeti_bodies 1";
    assert!(converges(&program, 4, primal).iter().all(|&n| n == 0));
    // Every right-hand side of another solver takes the preconditioner anew.
    converges(&program, 2, "-ksp_type fgmres -pc_type fetifeti");
}

#[test]
fn a_preconditioner_for_flexible_methods() {
    let scratch = Scratch::new("embed-outer-pc");
    let program = Program::tutorial(&scratch, "ex71");
    let cases = [
        "-dim 2 -cells 24,24 -ksp_type fgmres",
        "-dim 2 -cells 24,24 -ksp_type gcr -pc_fetifeti_its 3",
        "-dim 2 -cells 24,24 -ksp_type fcg -pc_fetifeti_bodies 2",
        "-dim 3 -cells 6,6,6 -pde_type Elasticity -ksp_type fgmres",
        "-dim 3 -cells 6,6,6 -pde_type Elasticity -dirichlet 0 -ksp_type fgmres",
    ];
    for options in sample(2, cases) {
        let options = format!("{options} -ksp_rtol 1e-8 -pc_type fetifeti");
        let found = converges(&program, 4, &options);
        // The residual falls by about 1e-2 in each: 4 and some for the difference of the norms.
        assert!(found[0] <= 8, "{options}: {found:?}");
    }
    // As accurate as a direct solver, a method that is not flexible converges at once.
    let exact = "-dim 2 -cells 24,24 -ksp_type gmres -pc_type fetifeti -pc_fetifeti_ksp_rtol 1e-12";
    assert!(converges(&program, 4, exact)[0] <= 2);
}

#[test]
fn inside_multigrid_field_splits_and_composites() {
    let scratch = Scratch::new("embed-outer-inside");
    let program = Program::own("mpicc", &scratch, "outer.c");
    let split = "-fieldsplit_first_ksp_type preonly -fieldsplit_second_ksp_type preonly \
                 -fieldsplit_first_pc_type fetifeti -fieldsplit_second_pc_type fetifeti \
                 -fieldsplit_second_pc_fetifeti_its 4";
    for options in [
        "-do mg -ksp_type fgmres -mg_coarse_ksp_type preonly -mg_coarse_pc_type fetifeti".to_string(),
        "-do mg -ksp_type fgmres -mg_coarse_ksp_type fetifeti -mg_coarse_ksp_rtol 1e-3".to_string(),
        format!("-do nest -ksp_type fgmres {split}"),
        "-do many -ksp_type fgmres -pc_type composite -pc_composite_type additive -pc_composite_pcs fetifeti,none"
            .to_string(),
    ] {
        let found = converges(&program, 4, &options);
        assert!(found[0] <= 30, "{options}: {found:?}");
    }
}

#[test]
fn every_way_of_looking() {
    let scratch = Scratch::new("embed-outer-view");
    let program = Program::own("mpicc", &scratch, "outer.c");
    let file = scratch.path("view");
    for solver in ["-ksp_type fetifeti", "-ksp_type fgmres -pc_type fetifeti"] {
        let view = format!("-ksp_view binary:{file} -ksp_view_pre ascii:{file}.txt");
        let options = format!("{solver} {view} -malloc_debug -malloc_dump -objects_dump");
        let out = program.with_plugin(2, &options);
        assert_eq!(out.code, 0, "{options}: {}", out.all());
        assert!(out.stdout.contains("ok"), "{}", out.all());
        for leak in ["bytes in", "The following objects were never freed"] {
            assert!(!out.all().contains(leak), "{options}: {}", out.all());
        }
        // PETSc's own log is an object that 3.26 counts as left.
        let out = program.with_plugin(2, &format!("{solver} -log_view"));
        for event in ["Tear", "Local", "Primal", "Coarse", "F", "M", "P", "Resid"] {
            let name = format!("FetiFeti{event} ");
            assert!(out.stdout.contains(&name), "no {name}in {}", out.stdout);
        }
        for file in [file.clone(), format!("{file}.txt")] {
            let written = std::fs::metadata(&file).expect("it was written");
            assert!(written.len() > 0, "{file} is empty");
        }
    }
    let out = program.with_plugin(
        2,
        "-ksp_type fgmres -pc_type fetifeti -pc_fetifeti_its 3 -ksp_view",
    );
    for part in [
        "each application: 3 iterations",
        "type: fetifeti",
        "multipliers: ",
    ] {
        assert!(out.stdout.contains(part), "no \"{part}\" in {}", out.all());
    }
}

#[test]
fn what_the_preconditioner_refuses() {
    let scratch = Scratch::new("embed-outer-refuses");
    let program = Program::own("mpicc", &scratch, "outer.c");
    for (options, part) in [
        (
            "-ksp_type fetifeti -device",
            "vectors of type cuda, on a device, expected host memory",
        ),
        (
            "-ksp_type fgmres -pc_type fetifeti -pc_fetifeti_its -1",
            "-pc_fetifeti_its is -1, expected a number of at least 0",
        ),
        (
            "-ksp_type fgmres -pc_type fetifeti -pc_fetifeti_primal corners",
            "expected some of vertices, edges, faces",
        ),
    ] {
        let out = program.with_plugin(2, options);
        assert_ne!(out.code, 0, "{options}");
        assert!(out.all().contains(part), "{options}: {}", out.all());
    }
    let program = Program::own("mpicc", &scratch, "host.c");
    // A matrix that is no stiffness matrix: the sentence, and the outer method's reason.
    let shift = "-shift 0.1 -ksp_type fgmres -pc_type fetifeti";
    let out = program.with_plugin(2, shift);
    for part in [
        "the operator is indefinite",
        "one solve: DIVERGED_PC_FAILED",
    ] {
        assert!(out.stderr.contains(part), "{}", out.all());
    }
    // Without elements an assembled matrix cannot be torn.
    let program = Program::tutorial(&scratch, "ex2");
    let out = program.with_plugin(1, "-ksp_type fgmres -pc_type fetifeti");
    assert!(out.all().contains("expected is (MATIS)"), "{}", out.all());
}
