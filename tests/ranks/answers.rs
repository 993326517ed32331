//! The program under mpirun: the answer depends neither on the number of ranks nor on the distribution of subdomains.

use crate::support::checks::{near, number};
use crate::support::sample::sample;
use crate::support::vtu::Vtu;
use crate::support::{mpi, program};
use mpi::Scratch;
use program::run_fetifeti;
use serde_json::Value;
use std::collections::HashMap;

fn solve(ranks: usize, scene: &str, more: &[&str]) -> Value {
    let args = [
        &[
            "solve",
            scene,
            "--json",
            "-",
            "-fetifeti_spectrum",
            "-fetifeti_ksp_rtol",
            "1e-10",
        ],
        more,
    ]
    .concat();
    let out = run_fetifeti(ranks, &args);
    assert_eq!(out.code, 0, "{ranks} ranks, {scene}: {}", out.all());
    let report: Value =
        serde_json::from_str(&out.stdout).unwrap_or_else(|e| panic!("{e}: {}", out.all()));
    assert_eq!(report["ranks"], ranks);
    report
}

/// The report is the same on every number of ranks. The sample is every other run.
fn same(scene: &str, runs: &[(usize, &str)]) {
    let one = solve(1, scene, &[]);
    for &(n, distribution) in sample(2, runs) {
        let other = solve(
            n,
            scene,
            &["-fetifeti_distribution", distribution, "-fetifeti_check"],
        );
        let what = format!("{scene}, {n} ranks, {distribution}");
        for key in [
            "bodies",
            "floating_bodies",
            "subdomains",
            "dofs",
            "multipliers",
            "preconditioner",
            "projector",
        ] {
            assert_eq!(one[key], other[key], "{what}: {key}");
        }
        let iterations =
            [&one, &other].map(|r| r["iterations"]["total"].as_i64().expect("a count"));
        assert!(
            (iterations[0] - iterations[1]).abs() <= 1,
            "{what}: {iterations:?}"
        );
        let energies = [&one, &other].map(|r| number(&r["energy"]));
        assert!(
            near(energies[1], energies[0], 1e-10),
            "{what}: {energies:?}"
        );
        let kappas = [&one, &other].map(|r| number(&r["condition"]["exact"]["kappa"]));
        assert!(near(kappas[1], kappas[0], 1e-6), "{what}: {kappas:?}");
        assert!(
            number(&other["condition"]["exact"]["lambda_min"]) > 1.0 - 1e-8,
            "{what}"
        );
        assert!(number(&other["kkt"]["feasibility"]) < 1e-6, "{what}");
        let identities = other["check"].as_object().expect("identities");
        assert!(!identities.is_empty(), "{what}");
        for (name, defect) in identities {
            assert!(number(defect) < 1e-10, "{what}: {name} {defect}");
        }
    }
}

#[test]
fn tied_bodies() {
    same(
        "../../examples/scenes/poisson_2x2.toml",
        &[(2, "block"), (2, "cyclic"), (3, "cyclic"), (4, "block")],
    );
}

#[test]
fn partly_tied_bodies() {
    same(
        "../../examples/scenes/partly_tied.toml",
        &[(2, "cyclic"), (3, "block"), (4, "cyclic")],
    );
}

/// Each rank reads the rows of its own points, before the options of the scene are in PETSc's database, which ignores
/// case.
#[test]
fn a_scene_says_how_its_subdomains_are_dealt_out() {
    let scratch = Scratch::new("dealt");
    let text = std::fs::read_to_string("../../examples/scenes/poisson_2x2.toml").expect("a scene");
    assert!(!text.contains("[options]"));
    for (k, option) in [
        "fetifeti_distribution = \"cyclic\"",
        "FETIFETI_Distribution = \"Cyclic\"",
    ]
    .iter()
    .enumerate()
    {
        let scene = scratch.file(
            &format!("{k}.toml"),
            &format!("{text}\n[options]\n{option}\n"),
        );
        let [one, three] = [1, 3].map(|ranks| solve(ranks, &scene, &[]));
        let energies = [&one, &three].map(|r| number(&r["energy"]));
        assert!(
            near(energies[0], energies[1], 1e-9),
            "{option}: {energies:?}"
        );
        for key in ["multipliers", "bodies", "dofs"] {
            assert_eq!(one[key], three[key], "{option}: {key}");
        }
    }
}

#[test]
fn unequal_bodies() {
    same(
        "../../examples/scenes/unequal_bodies.toml",
        &[(4, "block"), (2, "cyclic")],
    );
}

#[test]
fn floating_bodies_with_jumps() {
    same(
        "../../examples/scenes/jump_1e6.toml",
        &[(2, "cyclic"), (4, "block")],
    );
    same(
        "../../examples/scenes/jump_checkerboard.toml",
        &[(4, "block"), (2, "cyclic")],
    );
}

#[test]
fn one_level_and_dual_primal() {
    same(
        "../../examples/scenes/one_subdomain.toml",
        &[(2, "cyclic"), (4, "block")],
    );
    same(
        "../../examples/scenes/one_body.toml",
        &[(4, "block"), (2, "cyclic")],
    );
}

#[test]
fn more_ranks_than_subdomains() {
    let scratch = Scratch::new("many");
    let text = "[grid]\nbodies = 2\nelements = 6\nload = 1\ndirichlet = [\"left\"]\n";
    same(
        &scratch.file("four.toml", text),
        &[(5, "block"), (4, "cyclic")],
    );
    let text = "[grid]\nbodies = [2, 1]\nelements = 6\nsubdomains = [1, 2]\nload = 1\ndirichlet = [\"left\"]\n";
    same(&scratch.file("four_in_two.toml", text), &[(5, "cyclic")]);
    let text = "[[body]]\nsize = 1\nelements = 6\nload = 1\ndirichlet = [\"left\"]\n";
    let out = run_fetifeti(
        3,
        &["solve", &scratch.file("one.toml", text), "--json", "-"],
    );
    assert_eq!(out.code, 0, "{}", out.all());
}

#[test]
fn files_are_written_once_for_all_ranks() {
    let scratch = Scratch::new("files");
    let mut all = Vec::new();
    for n in [1, 3] {
        let dir = scratch.path(&format!("out{n}"));
        let out = run_fetifeti(
            n,
            &[
                "solve",
                "../../examples/scenes/partly_tied.toml",
                "--out",
                &dir,
            ],
        );
        assert_eq!(out.code, 0, "{}", out.all());
        assert_eq!(out.stdout.matches("written:").count(), 1, "{}", out.all());
        let vtu = Vtu::read(&format!("{dir}/solution.vtu"));
        // Three bodies of 17² nodes, whatever their subdomains.
        assert_eq!(vtu.count("NumberOfPoints"), 3 * 17 * 17);
        let mut ranks = vtu.whole("CellData", "rank");
        ranks.sort_unstable();
        ranks.dedup();
        assert_eq!(ranks, (0..n as i32).collect::<Vec<_>>());
        all.push(vtu);
        assert!(
            std::fs::metadata(format!("{dir}/solution.png"))
                .expect("the picture")
                .len()
                > 1000
        );
        serde_json::from_slice::<Value>(
            &std::fs::read(format!("{dir}/report.json")).expect("the report"),
        )
        .expect("JSON");
    }
    assert_eq!(all[0].points(), all[1].points());
    let u = |vtu: &Vtu| vtu.floats("PointData", "u");
    for (a, b) in u(&all[0]).iter().zip(u(&all[1])) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

/// The pieces of three ranks have the stress of the whole, also where cells of several ranks meet in a node.
#[test]
fn pieces_have_the_fields_of_the_whole() {
    // Two bodies have points in one place where they touch: their contact pressures are equal, and strains differ.
    let names = [("u", 3), ("stress", 6), ("contact_pressure", 1), ("gap", 1)];
    compare_pieces("annulus", &["solution"], &names);
}

/// Load steps have pieces of their own, and `solution.pvd` names the index of each.
#[test]
fn load_steps_have_pieces() {
    let names = [("u", 1), ("multiplier", 1), ("gap", 1)];
    let steps: Vec<String> = (1..=10).map(|k| format!("step_{k:04}")).collect();
    let mut files: Vec<&str> = steps.iter().map(String::as_str).collect();
    files.push("solution");
    let scratch = compare_pieces("press_ramp", &files, &names);
    let course = std::fs::read_to_string(scratch.path("out3/solution.pvd")).expect("an index");
    for (k, step) in steps.iter().enumerate() {
        let entry = format!("timestep=\"{}\"", (k + 1) as f64 / 10.0);
        let line = course.lines().find(|line| line.contains(&entry));
        let line = line.unwrap_or_else(|| panic!("{entry}: {course}"));
        assert!(line.contains(&format!("file=\"{step}.pvtu\"")), "{line}");
    }
}

/// Compares the pieces of three ranks with the files that one rank writes, by place and the fields `names`.
fn compare_pieces(scene: &str, files: &[&str], names: &[(&str, usize)]) -> Scratch {
    let scratch = Scratch::new(&format!("pieces_{scene}"));
    let scene = format!("../../examples/scenes/{scene}.toml");
    let solve = |ranks: usize, more: &[&str]| {
        let dir = scratch.path(&format!("out{ranks}"));
        let options = ["-fetifeti_ksp_rtol", "1e-12"];
        let args = [&["solve", &scene, "--out", &dir][..], &options, more].concat();
        let out = run_fetifeti(ranks, &args);
        assert_eq!(out.code, 0, "{}", out.all());
        dir
    };
    let (one, dir) = (solve(1, &[]), solve(3, &["--pieces"]));
    let place = |p: [f64; 3]| p.map(|x| (1e9 * x).round() as i64);
    let values = |vtu: &Vtu| -> Vec<Vec<f64>> {
        let mut out = vec![Vec::new(); vtu.count("NumberOfPoints")];
        for &(name, n) in names {
            let all = vtu.floats("PointData", name);
            for (list, values) in out.iter_mut().zip(all.chunks_exact(n)) {
                list.extend(values);
            }
        }
        out
    };
    for file in files {
        assert!(!std::path::Path::new(&format!("{dir}/{file}.vtu")).exists());
        let whole = Vtu::read(&format!("{one}/{file}.vtu"));
        let index = Vtu::read(&format!("{dir}/{file}.pvtu")).0;
        let mut expected: HashMap<_, Vec<Vec<f64>>> = HashMap::new();
        for (p, v) in whole.points().into_iter().zip(values(&whole)) {
            expected.entry(place(p)).or_default().push(v);
        }
        let mut cells = 0;
        for rank in 0..3 {
            let name = format!("{file}_{rank:04}.vtu");
            assert!(index.contains(&format!("Source=\"{name}\"")), "{index}");
            let piece = Vtu::read(&format!("{dir}/{name}"));
            cells += piece.count("NumberOfCells");
            assert!(piece.whole("CellData", "rank").iter().all(|&r| r == rank));
            for (p, found) in piece.points().into_iter().zip(values(&piece)) {
                let here = &expected[&place(p)];
                let error = |e: &Vec<f64>| {
                    let pairs = e.iter().zip(&found);
                    // Where nothing is known both have NaN.
                    let apart = |(a, b): (&f64, &f64)| match a.is_nan() && b.is_nan() {
                        true => 0.0,
                        false if a.is_nan() || b.is_nan() => f64::INFINITY,
                        false => (a - b).abs(),
                    };
                    pairs.map(apart).fold(0.0, f64::max)
                };
                let least = here.iter().map(error).fold(f64::INFINITY, f64::min);
                assert!(least < 1e-6, "{file} {p:?}: {found:?} {here:?}");
            }
        }
        assert_eq!(cells, whole.count("NumberOfCells"));
    }
    scratch
}

#[test]
fn krylov_methods_on_two_ranks() {
    let scene = "../../examples/scenes/lee_column_2.toml";
    let energy = number(&solve(1, scene, &[])["energy"]);
    for method in ["fcg", "pipecg", "gmres"] {
        let report = solve(2, scene, &["-fetifeti_ksp_type", method]);
        assert_eq!(report["ksp_type"], method);
        assert!(
            near(number(&report["energy"]), energy, 1e-9),
            "{method}: {}",
            report["energy"]
        );
    }
}

#[test]
fn spectra_of_table_1_on_2_and_4_ranks() {
    let oracle: Vec<Value> =
        serde_json::from_str(include_str!("../data/grid2d_spectra.json")).expect("JSON");
    let key =
        |r: &Value| ["bodies", "subdomains", "elements"].map(|k| r[k].as_u64().expect("a count"));
    // One rank: `tests/linear/spectra.rs`.
    for (ranks, rows) in [
        (2, ["3,3,4", "2,4,2", "4,2,2"]),
        (4, ["2,2,8", "3,3,4", "2,4,2"]),
    ] {
        let rows: Vec<_> = sample(3, rows).collect();
        let count = rows.len();
        let rows = rows.iter().flat_map(|row| ["--rows", row]);
        let args: Vec<&str> = ["table1", "--json", "-"].into_iter().chain(rows).collect();
        let out = run_fetifeti(ranks, &args);
        assert_eq!(out.code, 0, "{}", out.all());
        let table: Vec<Value> = serde_json::from_str(&out.stdout).expect("JSON");
        assert_eq!(table.len(), count);
        for row in &table {
            let expected = oracle
                .iter()
                .find(|o| key(o) == key(row))
                .expect("the oracle has the row");
            for side in ["whole_interface", "middle_third"] {
                let (ours, want) = (&row[side], &expected[side]);
                let what = format!("{ranks} ranks, {:?} {side}", key(row));
                for count in ["multipliers", "local_multipliers", "floating_bodies"] {
                    assert_eq!(ours[count], want[count], "{what}: {count}");
                }
                let pairs = [
                    (&ours["exact"], &want["dirichlet"]["kappa"]),
                    (
                        &ours["coarse_corrected"]["exact"],
                        &want["coarse_corrected"]["kappa"],
                    ),
                ];
                for (ours, want) in pairs {
                    assert!(
                        near(number(ours), number(want), 1e-4),
                        "{what}: {ours} for {want}"
                    );
                }
                let iterations =
                    [ours, &want["dirichlet"]].map(|s| s["iterations"].as_i64().expect("a count"));
                assert!(
                    (iterations[0] - iterations[1]).abs() <= 1,
                    "{what}: {iterations:?}"
                );
            }
        }
    }
}

/// Cholesky factorisation refuses pivots below 100, which the soft body has and the stiff one has not: rank 0 fails and
/// rank 1 does not. All ranks report it; none waits for the other.
#[test]
fn a_factorisation_that_fails_on_one_rank_ends_on_all() {
    let scratch = Scratch::new("one-rank-fails");
    let scene = "[grid]\nbodies = [2, 1]\nsubdomains = 2\nelements_per_subdomain = 4\n\
                 dirichlet = \"all\"\nload = 1\n\
                 rho = { checkerboard = [1, 1e6], by = \"body\" }\n";
    let scene = scratch.file("two.toml", scene);
    let pivots = "-fetifeti_coarse_sub_pc_factor_zeropivot";
    let out = run_fetifeti(
        2,
        &[
            "solve",
            &scene,
            "--quiet",
            pivots,
            "100",
            "-fetifeti_coarse_sub_pc_factor_shift_type",
            "none",
        ],
    );
    assert_eq!(out.code, 1, "{}", out.all());
    // An error of one rank alone would begin with "Error on rank 0".
    let all = "Error: the primal problem of the bodies was not solved";
    assert!(out.stderr.contains(all), "{}", out.all());
    let out = run_fetifeti(2, &["solve", &scene, "--quiet", pivots, "1e-8"]);
    assert_eq!(out.code, 0, "{}", out.all());
}
