//! Pressures where the meshes of both sides differ: Hertz's problem of a cylinder on a block.

use crate::support::mpi::Output;
use crate::support::mpi::Scratch;
use crate::support::program::{fetifeti, run_fetifeti};
use std::f64::consts::PI;
use std::fmt::Write;
use std::fs;

/// Radius of the cylinder, half the width and the height of both bodies, Young's modulus, Poisson's ratio, load.
const RADIUS: f64 = 50.0;
const SIZE: f64 = 10.0;
const YOUNG: f64 = 210e3;
const POISSON: f64 = 0.3;
const LOAD: f64 = 62.5;

/// Half the width of the contact and the largest pressure, of half-spaces.
fn hertz(force: f64) -> (f64, f64) {
    let modulus = YOUNG / (2.0 * (1.0 - POISSON * POISSON));
    let a = (4.0 * force * RADIUS / (PI * modulus)).sqrt();
    (a, 2.0 * force / (PI * a))
}

/// Places from 0 to [`SIZE`] whose distances grow from `h` on; with the middles of edges for order 2.
fn places(h: f64, order: usize) -> Vec<f64> {
    let fits = |n: &usize| {
        let n = *n as f64;
        let cubic = (SIZE - h * n) / n.powi(3);
        cubic < 0.0 || 3.0 * cubic * n * n / h < 7.0
    };
    let n = (5..).find(fits).expect("some number");
    let cubic = (SIZE - h * n as f64) / (n as f64).powi(3);
    let at = |s: usize| h * s as f64 + cubic * (s as f64).powi(3);
    match order {
        1 => (0..=n).map(at).collect(),
        _ => (0..=2 * n)
            .map(|k| 0.5 * (at(k / 2) + at(k.div_ceil(2))))
            .collect(),
    }
}

/// A body with the first edges `h` at the contact, above (`up`) or below it.
fn body(deck: &mut String, name: &str, first: usize, (h, order): (f64, usize), up: bool) {
    let x = places(h, order);
    let n = x.len();
    let id = |i: usize, j: usize| first + 1 + i + n * j;
    writeln!(deck, "*NODE").unwrap();
    for (j, y) in x.iter().enumerate() {
        for (i, x) in x.iter().enumerate() {
            let curved = x * x / (2.0 * RADIUS) * (1.0 - y / SIZE);
            let y = if up { y + curved } else { -y };
            // Nodes inside elements of 8 nodes are left out.
            if order == 1 || i % 2 == 0 || j % 2 == 0 {
                writeln!(deck, "{}, {x:.15e}, {y:.15e}, 0.", id(i, j)).unwrap();
            }
        }
    }
    let kind = ["CPE4", "CPE8"][order - 1];
    writeln!(deck, "*ELEMENT, TYPE={kind}, ELSET={name}").unwrap();
    let cells = (n - 1) / order;
    for e in 0..cells * cells {
        let (i, j, o) = (order * (e % cells), order * (e / cells), order);
        let mut nodes = vec![id(i, j), id(i + o, j), id(i + o, j + o), id(i, j + o)];
        if order == 2 {
            nodes.extend([
                id(i + 1, j),
                id(i + 2, j + 1),
                id(i + 1, j + 2),
                id(i, j + 1),
            ]);
        }
        // The lower body is a mirror image.
        if !up {
            nodes[..4].reverse();
            if order == 2 {
                nodes[4..7].reverse();
            }
        }
        let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
        writeln!(deck, "{}, {}", first + 1 + e, nodes.join(", ")).unwrap();
    }
    for (group, row, side) in [("C", 0, ["S3", "S1"]), ("F", cells - 1, ["S1", "S3"])] {
        writeln!(deck, "*SURFACE, NAME={group}_{name}, TYPE=ELEMENT").unwrap();
        for e in row * cells..(row + 1) * cells {
            writeln!(deck, "{}, {}", first + 1 + e, side[usize::from(up)]).unwrap();
        }
    }
    writeln!(deck, "*NSET, NSET={name}_X").unwrap();
    (0..n).for_each(|j| writeln!(deck, "{},", id(0, j)).unwrap());
    writeln!(deck, "*NSET, NSET={name}_Y").unwrap();
    (0..n).for_each(|i| writeln!(deck, "{},", id(i, n - 1)).unwrap());
    writeln!(deck, "*SOLID SECTION, ELSET={name}, MATERIAL=M\n1.").unwrap();
}

/// The deck with edges `up` and `low` at the contact.
fn deck(up: f64, low: f64, order: usize, pair: &str) -> String {
    let mut out = format!("*MATERIAL, NAME=M\n*ELASTIC\n{YOUNG}, {POISSON}\n");
    body(&mut out, "UP", 0, (up, order), true);
    body(&mut out, "LOW", 100_000, (low, order), false);
    write!(
        out,
        "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n\
         *CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\n{pair}\n*STEP\n*STATIC\n*BOUNDARY\nUP_X, 1\nLOW_X, 1\n\
         LOW_Y, 2\n*DSLOAD\nF_UP, P, {LOAD}\n*END STEP\n"
    )
    .unwrap();
    out
}

/// The fields of a column of `interfaces.csv`.
fn column(csv: &str, name: &str) -> Option<Vec<f64>> {
    let mut lines = csv.lines();
    let k = lines.next()?.split(',').position(|n| n == name)?;
    let field = |line: &str| line.split(',').nth(k).and_then(|f| f.parse().ok());
    Some(lines.map(|l| field(l).unwrap_or(f64::NAN)).collect())
}

/// The largest error of a column of pressures inside 0.9 of the contact zone, over the largest pressure.
fn error(csv: &str, name: &str) -> f64 {
    error_under(2.0 * LOAD * SIZE, csv, name)
}

/// The same under another force.
fn error_under(force: f64, csv: &str, name: &str) -> f64 {
    let (a, largest) = hertz(force);
    let x = column(csv, "x").expect("places");
    let p = column(csv, name).unwrap_or_else(|| panic!("no column {name}"));
    let inside = x.iter().zip(&p).filter(|(x, _)| x.abs() < 0.9 * a);
    let errors = inside.map(|(x, p)| (p - largest * (1.0 - (x / a).powi(2)).sqrt()).abs());
    errors.fold(0.0, f64::max) / largest
}

fn solve(file: &str, dir: &Scratch, ranks: usize) -> (Output, String) {
    let out = dir.path("out");
    let args = ["solve", file, "--out", &out, "-fetifeti_ksp_rtol", "1e-9"];
    let run = match ranks {
        1 => fetifeti(&args),
        _ => run_fetifeti(ranks, &args),
    };
    assert_eq!(run.code, 0, "{}", run.all());
    let csv = fs::read_to_string(format!("{out}/interfaces.csv")).expect("interfaces");
    (run, csv)
}

/// The model whose slave is finer by 3.4: pressures were off by 11 %.
#[test]
fn a_finer_slave_leaves_the_multipliers_to_the_master() {
    let dir = Scratch::new("pressures-case");
    let (run, csv) = solve("../../tests/data/cases/12_fine_slave_pressure.inp", &dir, 1);
    // The bodies are four times as wide.
    let worst = error_under(8.0 * LOAD * SIZE, &csv, "pressure");
    assert!(worst < 0.02, "{worst}");
    assert!(
        run.stdout.contains("LOW_Y1 carries the multipliers"),
        "{}",
        run.stdout
    );
    assert!(!run.stderr.contains("Warning"), "{}", run.stderr);
    assert!(column(&csv, "pressure_smoothed").is_none());
}

/// Ratios of the edges of 1, 2, 3 and 4, either side finer and either one the slave, and elements of both orders: nodal
/// pressures are as good as the coarser mesh permits.
#[test]
fn pressures_do_not_depend_on_who_is_the_slave() {
    let dir = Scratch::new("pressures-ratios");
    let file = dir.path("hertz.inp");
    for (order, up, low, limit) in [
        (1, 0.1, 0.1, 0.03),
        (1, 0.1, 0.2, 0.03),
        (1, 0.05, 0.2, 0.03),
        (1, 0.2, 0.1, 0.03),
        (2, 0.1, 0.3, 0.06),
        (2, 0.3, 0.1, 0.06),
    ] {
        for pair in ["C_UP, C_LOW", "C_LOW, C_UP"] {
            fs::write(&file, deck(up, low, order, pair)).unwrap();
            let (run, csv) = solve(&file, &dir, 1);
            let worst = error(&csv, "pressure");
            assert!(
                worst < limit,
                "order {order}, {up} and {low}, {pair}: {worst}"
            );
            assert!(!run.stderr.contains("Warning"), "{}", run.stderr);
            let fine_slave = (up < low) == (pair == "C_UP, C_LOW") && up != low;
            let said = run.stdout.contains("carries the multipliers");
            assert_eq!(said, fine_slave, "{up} {low} {pair}: {}", run.stdout);
        }
    }
}

/// A scene says itself which surface carries the multipliers. If that is the finer one, a warning says that pressures
/// oscillate, and smoothed ones stand beside them.
#[test]
fn oscillating_pressures_are_a_warning_and_smoothed() {
    let dir = Scratch::new("pressures-scene");
    let mesh = dir.path("hertz.inp");
    fs::write(&mesh, deck(0.05, 0.3, 1, "C_UP, C_LOW")).unwrap();
    let text = |first: &str, second: &str| {
        format!(
            "title = \"hertz\"\ndimension = 2\nphysics = \"elasticity\"\n[mesh]\nfile = \"hertz.inp\"\n\
             [[body]]\nname = \"UP\"\nyoung = {YOUNG}\npoisson = {POISSON}\ndirichlet = {{ UP_X = {{ x = 0 }} }}\n\
             pressure = {{ F_UP = {LOAD} }}\n\
             [[body]]\nname = \"LOW\"\nyoung = {YOUNG}\npoisson = {POISSON}\n\
             dirichlet = {{ LOW_X = {{ x = 0 }}, LOW_Y = {{ y = 0 }} }}\n\
             [[contact]]\nsurfaces = [\"{first}\", \"{second}\"]\n"
        )
    };
    let scene = dir.path("hertz.toml");
    fs::write(&scene, text("C_UP", "C_LOW")).unwrap();
    for ranks in [1, 2] {
        let (run, csv) = solve(&scene, &dir, ranks);
        assert!(run
            .stderr
            .contains("Warning: the pressures between `UP` and `LOW` oscillate"));
        let (raw, smoothed) = (error(&csv, "pressure"), error(&csv, "pressure_smoothed"));
        assert!(raw > 0.15, "{raw}");
        assert!(smoothed < 0.07, "{smoothed}");
        let vtu = fs::read(dir.path("out/solution.vtu")).expect("fields");
        let vtu = String::from_utf8_lossy(&vtu);
        assert!(vtu.contains("contact_pressure_smoothed"));
        // Both have the same force.
        let area = column(&csv, "area").expect("areas");
        let force = |name: &str| -> f64 {
            let p = column(&csv, name).expect("pressures");
            p.iter().zip(&area).map(|(p, a)| p * a).sum()
        };
        let (raw, smoothed) = (force("pressure"), force("pressure_smoothed"));
        assert!((raw - smoothed).abs() < 1e-9 * raw, "{raw} {smoothed}");
    }
    fs::write(&scene, text("C_LOW", "C_UP")).unwrap();
    let (run, csv) = solve(&scene, &dir, 1);
    assert!(!run.stderr.contains("Warning"), "{}", run.stderr);
    assert!(column(&csv, "pressure_smoothed").is_none());
}
