//! What `fetifeti solve` writes of friction: fields, the table of the interfaces and pictures.

use std::fs;

use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use crate::support::vtu::Vtu;

/// A block of height and width 1 on a wider one, pressed down and pushed to the right, and the law of their contact.
fn pushed(law: &str) -> String {
    format!(
        "title = \"pushed\"\ndimension = 2\nphysics = \"elasticity\"\n\
         [[body]]\nname = \"below\"\norigin = [0.0, 0.0]\nsize = [2.0, 1.0]\nelements = [16, 8]\nsubdomains = [4, 2]\n\
         young = 1.0\npoisson = 0.3\ndirichlet = {{ bottom = 0 }}\n\
         [[body]]\nname = \"above\"\norigin = [0.5, 1.0]\nsize = [1.0, 1.0]\nelements = [8, 8]\nsubdomains = [2, 2]\n\
         young = 2.0\npoisson = 0.2\ntraction = {{ top = [{PUSH}, -0.1] }}\n\
         [[contact]]\nbodies = [\"above\", \"below\"]\n{law}\n\
         [options]\nfetifeti_ksp_rtol = 1e-10\n"
    )
}

/// The force that pushes the upper block.
const PUSH: f64 = 0.01;
const COEFFICIENT: f64 = 0.2;
const TOLERANCE: f64 = 1e-6;

/// Solves a scene; returns the directory of the results.
fn solve(scratch: &Scratch, ranks: usize, law: &str, more: &[&str]) -> String {
    let scene = scratch.file("pushed.toml", &pushed(law));
    let out = scratch.path("out");
    let run = run_fetifeti(ranks, &[&["solve", &scene, "--out", &out], more].concat());
    assert_eq!(run.code, 0, "{}", run.all());
    out
}

/// The points of the upper body's lower side and of the lower body's upper side, with the fields there.
struct Side {
    x: Vec<f64>,
    pressure: Vec<f64>,
    shear: Vec<[f64; 3]>,
    slip: Vec<[f64; 3]>,
    state: Vec<i32>,
}

/// The sides of both bodies by x, the lower one first; away from them there is no friction.
fn sides(vtu: &Vtu) -> [Side; 2] {
    let bodies = vtu.whole("CellData", "body");
    let vectors = |name: &str| -> Vec<[f64; 3]> {
        let all = vtu.floats("PointData", name);
        all.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect()
    };
    let (points, pressure) = (vtu.points(), vtu.floats("PointData", "contact_pressure"));
    let (shear, slip) = (vectors("shear"), vectors("slip"));
    let state = vtu.whole("PointData", "contact_state");
    assert_eq!([shear.len(), slip.len(), state.len()], [points.len(); 3]);
    assert_eq!(bodies.len(), 16 * 8 + 8 * 8);
    let touches = |p: &[f64; 3]| p[1] == 1.0 && (0.5..=1.5).contains(&p[0]);
    for k in (0..points.len()).filter(|&k| !touches(&points[k])) {
        assert_eq!((shear[k], slip[k], state[k]), ([0.0; 3], [0.0; 3], 0));
    }
    // The points of the lower body come first.
    let below = points.iter().filter(|p| p[1] <= 1.0).count() - 9;
    [0..below, below..points.len()].map(|of_body| {
        let mut own: Vec<usize> = of_body.filter(|&k| touches(&points[k])).collect();
        own.sort_by(|&a, &b| points[a][0].total_cmp(&points[b][0]));
        assert_eq!(own.len(), 9);
        Side {
            x: own.iter().map(|&k| points[k][0]).collect(),
            pressure: own.iter().map(|&k| pressure[k]).collect(),
            shear: own.iter().map(|&k| shear[k]).collect(),
            slip: own.iter().map(|&k| slip[k]).collect(),
            state: own.iter().map(|&k| state[k]).collect(),
        }
    })
}

/// Balance, action and reaction, and Coulomb's law at both sides.
fn check(vtu: &Vtu) {
    let [below, above] = sides(vtu);
    let area = |k: usize| if k == 0 || k == 8 { 0.0625 } else { 0.125 };
    let force = |side: &Side| (0..9).map(|k| area(k) * side.shear[k][0]).sum::<f64>();
    // Friction holds the upper body, and drags the lower one to the right.
    assert!(
        (force(&above) + PUSH).abs() < TOLERANCE,
        "{}",
        force(&above)
    );
    assert!(
        (force(&below) - PUSH).abs() < TOLERANCE,
        "{}",
        force(&below)
    );
    assert_eq!((&below.x, &below.state), (&above.x, &above.state));
    let mut found = [0; 3];
    for k in 0..9 {
        assert!((below.pressure[k] - above.pressure[k]).abs() < TOLERANCE);
        for c in 0..3 {
            assert_eq!(below.shear[k][c], -above.shear[k][c]);
            assert_eq!(below.slip[k][c], -above.slip[k][c]);
        }
        let ([tau, across, _], [slip, ..]) = (above.shear[k], above.slip[k]);
        let bound = COEFFICIENT * above.pressure[k];
        assert_eq!(across, 0.0, "the face is horizontal");
        match above.state[k] {
            1 => assert!(tau.abs() <= bound + TOLERANCE && slip.abs() < TOLERANCE),
            2 => assert!((tau.abs() - bound).abs() < TOLERANCE && tau * slip <= 0.0),
            other => panic!("the blocks touch everywhere, found state {other}"),
        }
        found[above.state[k] as usize] += 1;
    }
    assert!(found[1] > 0 && found[2] > 0, "{found:?}");
}

#[test]
fn fields_have_shear_slip_and_state() {
    let scratch = Scratch::new("friction-fields");
    let out = solve(&scratch, 1, "friction = 0.2", &[]);
    check(&Vtu::read(&format!("{out}/solution.vtu")));
}

/// Place, shear stress, slip and state of each point.
fn friction_at(vtu: &Vtu) -> Vec<[f64; 10]> {
    let points = vtu.points();
    let [shear, slip] = ["shear", "slip"].map(|name| vtu.floats("PointData", name));
    let state = vtu.whole("PointData", "contact_state");
    let at = |k: usize| {
        let of = |list: &[f64], c: usize| list[3 * k + c];
        std::array::from_fn(|c| match c {
            0..3 => points[k][c],
            3..6 => of(&shear, c - 3),
            6..9 => of(&slip, c - 6),
            _ => f64::from(state[k]),
        })
    };
    (0..points.len()).map(at).collect()
}

/// A rank needs the rows of friction at its points that the other one provides.
#[test]
fn pieces_have_friction_too() {
    let scratch = Scratch::new("friction-pieces");
    let whole = solve(&scratch, 1, "friction = 0.2", &[]);
    let whole = friction_at(&Vtu::read(&format!("{whole}/solution.vtu")));
    let out = solve(&scratch, 2, "friction = 0.2", &["--pieces"]);
    let index = fs::read_to_string(format!("{out}/solution.pvtu")).expect("an index");
    for name in ["shear", "slip", "contact_state"] {
        assert!(index.contains(&format!("Name=\"{name}\"")), "{name}");
    }
    let pieces = [0, 1].map(|r| friction_at(&Vtu::read(&format!("{out}/solution_{r:04}.vtu"))));
    assert!(pieces.iter().all(|piece| piece.len() < whole.len()));
    let pieces = pieces.concat();
    let near = |a: &[f64; 10], b: &[f64; 10]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    for (some, all) in [(&pieces, &whole), (&whole, &pieces)] {
        for point in some {
            assert!(all.iter().any(|p| near(p, point)), "{point:?}");
        }
    }
    assert!(whole.iter().any(|point| point[9] == 2.0));
}

/// The columns of a table with these names, as text.
fn columns(csv: &str, names: [&str; 2]) -> Vec<[String; 2]> {
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let at = names.map(|name| head.iter().position(|n| *n == name).expect(name));
    let row = |line: &str| at.map(|k| line.split(',').nth(k).expect("a field").to_string());
    lines.map(row).collect()
}

#[test]
fn tables_have_the_bound_of_the_shear_stress() {
    let scratch = Scratch::new("friction-bound");
    let bounds = |law: &str| -> Vec<[f64; 2]> {
        let out = solve(&scratch, 1, law, &[]);
        let csv = fs::read_to_string(format!("{out}/interfaces.csv")).expect("a table");
        let rows = columns(&csv, ["pressure", "shear_bound"]);
        assert_eq!(rows.len(), 9);
        let number = |field: String| field.parse().expect("a number");
        rows.into_iter().map(|row| row.map(number)).collect()
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a}, not {b}");
    for [p, bound] in bounds("friction = 0.2") {
        near(bound, 0.2 * p);
    }
    let limited = bounds("friction = 0.2\nfriction_limit = 0.018");
    assert!(limited.iter().any(|[p, _]| 0.2 * p > 0.018));
    for [p, bound] in limited {
        near(bound, (0.2 * p).min(0.018));
    }
    for [_, bound] in bounds("tresca = 0.0125") {
        near(bound, 0.0125);
    }
}

/// Without friction there are none of its arrays and columns.
#[test]
fn frictionless_contact_has_no_fields_of_friction() {
    let scratch = Scratch::new("friction-none");
    let scene = pushed("").replace(&format!("[{PUSH}, -0.1]"), "[0.0, -0.1]");
    let spring = "young = 2.0\nspring = { left = 0.01 }\n";
    let scene = scratch.file("pressed.toml", &scene.replace("young = 2.0\n", spring));
    let out = scratch.path("out");
    let run = run_fetifeti(1, &["solve", &scene, "--out", &out]);
    assert_eq!(run.code, 0, "{}", run.all());
    let text = |name: &str| fs::read_to_string(format!("{out}/{name}")).expect("a file");
    let (vtu, csv) = (text("solution.vtu"), text("interfaces.csv"));
    assert!(vtu.contains("Name=\"contact_pressure\"") && csv.contains("pressure"));
    for name in ["shear", "slip", "contact_state"] {
        assert!(!vtu.contains(&format!("Name=\"{name}\"")), "{name}");
        assert!(!csv.contains(name), "{name}");
    }
}
