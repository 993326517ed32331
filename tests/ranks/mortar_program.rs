//! The program on scenes whose nodes do not match: the same rows hold on 1, 7 and 2 or 4 ranks, with the same
//! multipliers and gaps, as `interfaces.csv` says.

use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use crate::support::sample::sample;
use lab::study::hard_cases::trackers;

/// A mesh of Gmsh's format 2.2: [0, 2] × [0, 1] and [0, 2] × [1, 2], cut into triangles along 12 and 17 edges, with the
/// groups of cells `low` and `up` and groups of edges `<body>_bottom`, `<body>_top` and `<body>_left`. Nodes inside are
/// moved: nothing repeats.
fn mesh() -> String {
    let (mut nodes, mut cells) = (Vec::new(), Vec::new());
    let mut names = String::new();
    for (k, (body, [n, m])) in [("low", [12, 6]), ("up", [17, 7])].into_iter().enumerate() {
        let first = nodes.len() + 1;
        let at = |i: usize, j: usize| first + j * (n + 1) + i;
        let group = 4 * k + 1;
        names += &format!("2 {group} \"{body}\"\n");
        for (g, side) in ["bottom", "top", "left"].into_iter().enumerate() {
            names += &format!("1 {} \"{body}_{side}\"\n", group + 1 + g);
        }
        for j in 0..=m {
            for i in 0..=n {
                let inside = i % n != 0 && j % m != 0;
                let shift = if inside {
                    0.1 * ((7 * i + 13 * j) as f64).sin() / m as f64
                } else {
                    0.0
                };
                let (x, y) = (2.0 * i as f64 / n as f64, (k as f64) + j as f64 / m as f64);
                nodes.push(format!("{} {} {} 0\n", at(i, j), x + shift, y - shift));
            }
        }
        let mut edge =
            |g: usize, a: usize, b: usize| cells.push(format!("1 2 {0} {0} {a} {b}\n", group + g));
        for i in 0..n {
            edge(1, at(i, 0), at(i + 1, 0));
            edge(2, at(i, m), at(i + 1, m));
        }
        (0..m).for_each(|j| edge(3, at(0, j), at(0, j + 1)));
        for (i, j) in (0..m).flat_map(|j| (0..n).map(move |i| (i, j))) {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let cuts = if (i + j) % 2 == 0 {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [b, c, d]]
            };
            for [a, b, c] in cuts {
                cells.push(format!("2 2 {group} {group} {a} {b} {c}\n"));
            }
        }
    }
    let cells: Vec<String> = (1..)
        .zip(cells)
        .map(|(k, c): (usize, String)| format!("{k} {c}"))
        .collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n8\n{names}$EndPhysicalNames\n\
         $Nodes\n{}\n{}$EndNodes\n$Elements\n{}\n{}$EndElements\n",
        nodes.len(),
        nodes.concat(),
        cells.len(),
        cells.concat()
    )
}

const MESH: &str = "physics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n\
    [[body]]\nname = \"low\"\nyoung = 100\npoisson = 0.3\nsubdomains = 5\ndirichlet = { low_bottom = 0 }\n\
    [[body]]\nname = \"up\"\nyoung = 300\npoisson = 0.3\nsubdomains = 6\ndirichlet = { up_left = { x = 0 } }\n\
    traction = { up_top = [0.1, -1] }\n\
    [[contact]]\nsurfaces = [\"low_top\", \"up_bottom\"]\ngap = \"0.02*x^2\"\n";

const SOLIDS: &str = "dimension = 3\nphysics = \"elasticity\"\n\
    [[body]]\nname = \"low\"\nsize = [2, 1, 2]\nelements = [6, 3, 6]\nsubdomains = [2, 1, 2]\nyoung = 100\n\
    poisson = 0.3\ndirichlet = [\"bottom\"]\n\
    [[body]]\nname = \"high\"\norigin = [0, 1, 0]\nshape = { y = \"y + 0.02*(x^2 + z^2)*(2 - y)\" }\n\
    size = [2, 1, 2]\nelements = [8, 3, 7]\nsubdomains = [2, 1, 1]\nyoung = 200\npoisson = 0.3\n\
    dirichlet = { left = { x = 0 }, back = { z = 0 } }\ntraction = { top = [0, -2, 0] }\n\
    [[contact]]\nbodies = [\"high\", \"low\"]\nsides = [\"bottom\", \"top\"]\n";

/// A row of `interfaces.csv`: what names it, its gap and multiplier, and whether it holds.
struct Row {
    name: String,
    gap: f64,
    multiplier: f64,
    holds: bool,
}

/// The rows of `interfaces.csv`.
fn rows(path: &str) -> Vec<Row> {
    let text = std::fs::read_to_string(path).expect("the table");
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().expect("a line").split(',').collect();
    let at = |name: &str| head.iter().position(|h| *h == name).expect("a column");
    let columns = ["gap", "multiplier", "active"].map(at);
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let [gap, multiplier, active] = columns.map(|c| cells[c].parse::<f64>().expect("a number"));
        Row {
            name: cells[..columns[0]].join(","),
            gap,
            multiplier,
            holds: active == 1.0,
        }
    };
    lines.map(row).collect()
}

#[test]
fn the_same_rows_hold_on_any_ranks() {
    let scratch = Scratch::new("mortar-sets");
    scratch.file("m.msh", &mesh());
    let mut scenes = vec![("mesh", MESH.to_string()), ("solids", SOLIDS.to_string())];
    let wanted = ["moose-10950-facets", "flow123d-1381-crossing"];
    let cases = trackers().into_iter().filter(|c| wanted.contains(&c.name));
    scenes.extend(cases.map(|c| (c.name, c.text)));
    assert_eq!(scenes.len(), 4);
    for (k, (name, text)) in sample(3, scenes).enumerate() {
        let file = scratch.file(&format!("{name}.toml"), &text);
        let tables = [1, [2, 4][k % 2], 7].map(|n| {
            let out = scratch.path(&format!("{name}-{n}"));
            let run = run_fetifeti(
                n,
                &[
                    "solve",
                    &file,
                    "--quiet",
                    "--out",
                    &out,
                    "-fetifeti_ksp_rtol",
                    "1e-10",
                ],
            );
            assert_eq!(run.code, 0, "{name} on {n} ranks: {}", run.all());
            rows(&format!("{out}/interfaces.csv"))
        });
        let [one, others @ ..] = &tables;
        let hold = one.iter().filter(|r| r.holds).count();
        println!("{name}: {hold} of {} rows hold", one.len());
        assert!(
            hold > 3 && hold + 2 < one.len(),
            "{name}: {hold} of {}",
            one.len()
        );
        let most = |f: fn(&Row) -> f64| one.iter().fold(0.0f64, |a, r| a.max(f(r).abs()));
        let [gap, multiplier] = [most(|r| r.gap), most(|r| r.multiplier)];
        for other in others {
            assert_eq!(one.len(), other.len(), "{name}");
            for (a, b) in one.iter().zip(other) {
                assert_eq!((&a.name, a.holds), (&b.name, b.holds), "{name}");
                assert!((a.gap - b.gap).abs() < 1e-6 * gap, "{name}, {}", a.name);
                let away = (a.multiplier - b.multiplier).abs();
                assert!(away < 1e-6 * multiplier, "{name}, {}: {away:e}", a.name);
            }
        }
    }
}
