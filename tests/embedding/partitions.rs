//! Partitions of unstructured meshes: subdomains that hang together by an edge or a node, with and without a near-null
//! space, against a direct solution (tests/plugin/partitions.c).

use crate::support::sample::{of, sample};
use crate::support::{mpi, plugin};
use mpi::{Output, Scratch};
use plugin::Program;

fn program(scratch: &Scratch) -> Program {
    Program::linked("mpicc", scratch, "tests/plugin/partitions.c")
}

/// Every case was solved, with an error below that of `-near`.
fn good(out: &Output, what: &str) {
    assert_eq!(out.code, 0, "{what}: {}", out.all());
    let last = out.stdout.trim_end().lines().last();
    assert_eq!(last.map(str::trim), Some("ok"), "{what}: {}", out.all());
}

/// The number after a word in a line.
fn after<T: std::str::FromStr>(line: &str, word: &str) -> Option<T> {
    let rest = line.split(&format!("{word} ")).nth(1)?;
    rest.split_whitespace().next()?.parse().ok()
}

/// The iterations of each case.
fn iterations(out: &Output) -> Vec<usize> {
    let lines = out.stdout.lines();
    lines.filter_map(|line| after(line, " its")).collect()
}

#[test]
fn a_cell_that_hangs_by_an_edge_or_a_node() {
    let scratch = Scratch::new("embed-hinge");
    let program = program(&scratch);
    let cases = [
        (2, "-n 2", 10),
        // One tetrahedron of the second half belongs to the first, where it hangs by an edge.
        (2, "-hinge 0", 15),
        (2, "-hinge 0 -fetifeti_bodies 2", 15),
        (2, "-hinge 2 -fetifeti_bodies 2", 15),
        (2, "-hinge 5 -fetifeti_bodies 2 -kept 0", 15),
        (2, "-hinge 5 -fetifeti_bodies 2 -motions 0", 15),
        (2, "-hinge 5 -motions -1", 15),
        (4, "-n 4 -hinge 0", 25),
        (4, "-n 4 -hinge 0 -fetifeti_bodies 4", 30),
        // A triangle that hangs by a node.
        (2, "-dim 2 -n 8 -hinge 0 -fetifeti_bodies 2", 15),
        (4, "-dim 2 -n 8 -hinge 0 -fetifeti_bodies 1", 20),
    ];
    for (ranks, options, most) in sample(3, cases) {
        let out = program.run(ranks, &format!("-slices {options} -ksp_rtol 1e-10"));
        good(&out, options);
        assert!(iterations(&out)[0] <= most, "{options}: {}", out.all());
    }
}

/// Nothing tells that these unknowns are displacements: neither a block size nor a near-null space.
#[test]
fn a_clamped_plate_without_block_size() {
    let scratch = Scratch::new("embed-plate");
    let program = program(&scratch);
    for ranks in [1, 2, 4] {
        let options = "-slices -dim 2 -n 8 -motions -1 -ksp_rtol 1e-10";
        good(&program.run(ranks, options), &format!("{ranks} ranks"));
    }
}

/// A sample of the thousand below. Whether a case is solved does not depend on the number of ranks.
#[test]
fn random_partitions() {
    let scratch = Scratch::new("embed-partitions");
    let program = program(&scratch);
    let few = of(12, 40);
    for (ranks, first, count) in [(1, 0, of(60, 120)), (3, 200, few), (2, 0, few)] {
        let options = format!("-first {first} -count {count} -fetifeti_ksp_rtol 1e-11");
        let out = program.run(ranks, &options);
        good(&out, &options);
        assert_eq!(iterations(&out).len(), count, "{}", out.all());
    }
}

/// Averages of motions take fewer iterations than those of components, with a near-null space and without one.
#[test]
fn averages_of_motions() {
    let scratch = Scratch::new("embed-motions");
    let program = program(&scratch);
    let sum = |ranks, averages: &str| {
        let options = format!(
            "-first 200 -count 12 -fetifeti_ksp_rtol 1e-11 -fetifeti_primal vertices,edges,faces \
             -fetifeti_averages {averages}"
        );
        let out = program.run(ranks, &options);
        good(&out, &options);
        iterations(&out).iter().sum::<usize>()
    };
    let [one, two] = [1, 2].map(|ranks| sum(ranks, "motions"));
    assert!(one.abs_diff(two) <= 2, "{one} and {two}");
    assert!(one < sum(1, "components"));
}

/// Boxes that cross the whole body have no vertices. Nodes of their faces become some, so that K_rr is regular and
/// sparse solves do.
#[test]
fn subdomains_without_vertices() {
    let scratch = Scratch::new("embed-alone");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/yardstick.c");
    for problem in [
        "-elastic -n 18,12,8 -box 3,2,1 -fetifeti_primal vertices,faces -fetifeti_averages motions",
        "-n 36,36,12 -box 3,3,1",
    ] {
        for ranks in [1, 2] {
            let tolerance = "-operator capi -fetifeti_ksp_rtol 1e-9";
            let options =
                format!("{problem} {tolerance} -fetifeti_operators implicit -fetifeti_view");
            let out = program.run(ranks, &options);
            assert_eq!(out.code, 0, "{problem}: {}", out.all());
            let residual: f64 = after(&out.stdout, "residual").expect("a residual");
            assert!(residual <= 3e-8, "{problem}: {}", out.all());
            let dense = after(&out.stdout, "S and T as dense matrices:");
            assert_eq!(dense, Some(0), "{problem}: {}", out.all());
        }
    }
}

/// Sectors of a ring are turned copies of each other: that which is held, those between, and that which ends.
#[test]
fn sectors_of_a_ring_share_factors() {
    let scratch = Scratch::new("embed-ring");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/yardstick.c");
    for problem in [
        "-elastic -n 4,48 -box 1,8",
        "-elastic -n 8,48 -box 2,8",
        "-elastic -n 4,48,3 -box 1,8,1",
        "-elastic -n 6,48,4 -box 2,8,1 -fetifeti_primal vertices,edges",
        "-n 4,48,3 -box 1,8,1",
    ] {
        let across = if problem.contains("-box 2") { 2 } else { 1 };
        for ranks in [1, 2] {
            let options =
                format!("-ring {problem} -operator capi -fetifeti_ksp_rtol 1e-10 -fetifeti_view");
            let out = program.run(ranks, &options);
            assert_eq!(out.code, 0, "{problem}: {}", out.all());
            let residual: f64 = after(&out.stdout, "residual").expect("a residual");
            assert!(residual <= 3e-8, "{problem}: {}", out.all());
            let factored: usize = after(&out.stdout, "patterns analysed,").expect("a count");
            assert!(factored <= across * (2 + ranks), "{problem}: {}", out.all());
        }
    }
}

/// A subdomain of one node lies between two others that meet there only. It holds neither of them to the other.
#[test]
fn a_node_is_no_hinge_of_a_body() {
    let scratch = Scratch::new("embed-pin");
    let program = program(&scratch);
    for (ranks, bodies) in [(1, 1), (3, 2), (2, 6)] {
        let options =
            format!("-first 206 -count 1 -fetifeti_ksp_rtol 1e-11 -fetifeti_bodies {bodies}");
        good(&program.run(ranks, &options), &options);
    }
}

/// `cargo test --test embedding a_thousand -- --ignored --nocapture`, some 40 seconds: docs/embedding.md has the table.
#[test]
#[ignore = "random_partitions has a sample"]
fn a_thousand_partitions() {
    let scratch = Scratch::new("embed-thousand");
    let out = program(&scratch).run(1, "-count 1000 -fetifeti_ksp_rtol 1e-11");
    println!(
        "| mesh | problem | partition | cases | solved | iterations: median, 99 %, most | error |"
    );
    for (dim, mesh) in [(2, "plane"), (3, "space")] {
        for how in ["", "sides", "nodes", "ragged"] {
            let components = if how.is_empty() { 1 } else { dim };
            let wanted = [
                format!(" dim {dim} components {components} "),
                format!(" by {how}"),
            ];
            let of = |line: &&str| wanted.iter().all(|w| line.contains(w));
            let lines: Vec<&str> = out.stdout.lines().filter(of).collect();
            let solved = lines.iter().filter(|l| l.contains("CONVERGED")).count();
            let mut its: Vec<i32> = lines.iter().filter_map(|l| after(l, " its")).collect();
            its.sort_unstable();
            let part = |percent: usize| its[(its.len() * percent / 100).min(its.len() - 1)];
            let errors = lines.iter().filter_map(|l| after(l, " error"));
            println!(
                "| {mesh} | {} | {} | {} | {solved} | {}, {}, {} | {:.1e} |",
                if components == 1 { "scalar" } else { "elastic" },
                if how.is_empty() { "all" } else { how },
                lines.len(),
                part(50),
                part(99),
                part(100),
                errors.fold(0.0, f64::max)
            );
        }
    }
    good(&out, "a thousand");
}

/// The program that scripts/yardstick.py makes tables with: what it gives to this library and to other solvers is one
/// problem, and its boxes are those that the figures of docs/embedding.md belong to.
#[test]
fn the_yardstick_measures_one_problem() {
    let scratch = Scratch::new("embed-yardstick");
    let program = Program::linked("mpicc", &scratch, "tests/plugin/yardstick.c");
    let mut ways = vec![
        "-operator capi -fetifeti_ksp_rtol 1e-9",
        "-operator aij -pc_type jacobi -ksp_rtol 1e-9",
    ];
    if plugin::petsc_version() >= (3, 21) {
        ways.push("-operator matis -ksp_type fetifeti -ksp_rtol 1e-9");
    }
    for (problem, unknowns, parts) in [
        ("-elastic -n 4,4,4 -box 2,2,2 -shake 0.3 -vary 1", 300, 8),
        ("-n 12,12 -box 3,2", 156, 6),
    ] {
        for ranks in [1, 2] {
            let norm = |way: &&str| {
                let out = program.run(ranks, &format!("{problem} {way}"));
                assert_eq!(out.code, 0, "{problem} {way}: {}", out.all());
                let line = out.stdout.lines().next().unwrap_or_default();
                assert_eq!(after(line, "unknowns"), Some(unknowns), "{line}");
                assert_eq!(after(line, "parts"), Some(parts), "{line}");
                // Residuals of the multipliers stand for those of the unknowns up to a factor.
                let residual: f64 = after(line, "residual").expect("a residual");
                assert!(residual <= 3e-8, "{problem} {way}: {line}");
                after::<f64>(line, "norm").expect("the norm of the solution")
            };
            let norms: Vec<f64> = ways.iter().map(norm).collect();
            let apart = |n: &f64| (n - norms[0]).abs() > 1e-6 * norms[0];
            assert!(!norms.iter().any(apart), "{problem}: {norms:?}");
        }
    }
}
