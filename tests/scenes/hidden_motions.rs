//! Loads along a motion of many bodies that nothing holds, and that no pivot of GᵀG shows.

use super::meshes::Model;
use crate::support::session::with_session;
use crate::support::surface_mesh::gmsh;
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;

/// Blocks in a row: with three motions each, more than dense algebra is for.
const BLOCKS: usize = 60;

/// A mesh of bodies of quadrilaterals of size 1 in a row, bent by a map; sides are groups.
struct Rows {
    points: Vec<[f64; 3]>,
    groups: Vec<(String, Vec<Vec<usize>>)>,
    slope: f64,
}

impl Rows {
    /// The slope from y = 0 down; it vanishes from y = 1 up.
    fn height(&self, x: f64, y: f64) -> f64 {
        y + self.slope * x * (1.0 - y).clamp(0.0, 1.0)
    }

    fn add(&mut self, name: &str, [x, y]: [f64; 2], n: usize) {
        let first = self.points.len();
        for k in 0..=n {
            let x = x + k as f64;
            let heights = [y, y + 1.0].map(|y| self.height(x, y));
            self.points.extend(heights.map(|y| [x, y, 0.0]));
        }
        let at = |k: usize, up: usize| first + 2 * k + up;
        let cell = |k: usize| vec![at(k, 0), at(k + 1, 0), at(k + 1, 1), at(k, 1)];
        let line = |up: usize| (0..n).map(|k| vec![at(k, up), at(k + 1, up)]).collect();
        let end = |k: usize| vec![vec![at(k, 0), at(k, 1)]];
        self.groups.push((name.into(), (0..n).map(cell).collect()));
        let sides = [
            ("bottom", line(0)),
            ("top", line(1)),
            ("left", end(0)),
            ("right", end(n)),
        ];
        for (side, lines) in sides {
            self.groups.push((format!("{name}_{side}"), lines));
        }
    }
}

/// Blocks tied to each other on a floor with a small slope, under a slab between two walls. They can slide up the
/// floor, and the slab, whose motions are eliminated last because it touches them all, rises by the slope.
fn model(slope: f64) -> (String, String) {
    let (points, groups) = (Vec::new(), Vec::new());
    let mut rows = Rows {
        points,
        groups,
        slope,
    };
    let mut scene = String::from(
        "physics = \"elasticity\"\n[mesh]\nfile = \"m.msh\"\n[interface]\ndefault = \"free\"\n",
    );
    let mut body = |name: &str, at: [f64; 2], n: usize, what: &str| {
        rows.add(name, at, n);
        scene += &format!(
            "[[body]]\nname = \"{name}\"\nsubdomains = 1\nyoung = 1\npoisson = 0.3\n{what}\n"
        );
    };
    body(
        "floor",
        [0.0, -1.0],
        BLOCKS,
        "dirichlet = { floor_bottom = 0 }",
    );
    for i in 0..BLOCKS {
        body(&format!("b{i}"), [i as f64, 0.0], 1, "load = [1, 0]");
    }
    body("slab", [0.0, 1.0], BLOCKS, "load = [0, -1]");
    body("west", [-1.0, 1.0], 1, "dirichlet = { west_left = 0 }");
    body(
        "east",
        [BLOCKS as f64, 1.0],
        1,
        "dirichlet = { east_right = 0 }",
    );
    let mut join = |kind: &str, a: &str, b: &str| {
        scene += &format!("[[{kind}]]\nsurfaces = [\"{a}\", \"{b}\"]\n");
    };
    for i in 0..BLOCKS {
        join("contact", &format!("b{i}_bottom"), "floor_top");
        join("contact", &format!("b{i}_top"), "slab_bottom");
        if i + 1 < BLOCKS {
            join("tie", &format!("b{i}_right"), &format!("b{}_left", i + 1));
        }
    }
    join("contact", "slab_left", "west_right");
    join("contact", "slab_right", "east_left");
    let groups: Vec<_> = rows
        .groups
        .iter()
        .map(|(n, f)| (&n[..], f.clone()))
        .collect();
    (gmsh(&rows.points, &groups), scene)
}

/// The load is refused before the first step, whether the last pivot is rounding over the square of 1e-3 or 1e-5.
#[test]
fn a_load_along_a_motion_that_no_pivot_shows_is_refused() {
    for (name, slope) in [("hidden-3", 1e-3), ("hidden-4", 1e-4), ("hidden-5", 1e-5)] {
        let (mesh, text) = model(slope);
        let scene = Model::new(name, &mesh).scene(&text);
        let problem = scene.substructures(&|_| true).unwrap();
        let said = with_session(move |session| {
            let mut solver = FetiFeti::new(session, problem, MethodSettings::default())?;
            Ok::<_, base::Error>(solver.solve().err().map(|e| e.to_string()))
        });
        let said = said.unwrap().expect("a refusal");
        let expected = format!("and {} more are pushed away for ever", BLOCKS + 1 - 3);
        assert!(said.contains(&expected), "slope {slope}: {said}");
    }
}
