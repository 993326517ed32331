//! Contact on triangles of 6 and quadrilaterals of 8 nodes: under a constant pressure the force at a corner is zero or
//! negative, so that rows at nodes would say nothing of the pressure there.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::support::mpi::Scratch;
use crate::support::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::{FetiFeti, Solution};
use scene::Scene;

/// Two blocks, [0, 2] × [0, 1] × [0, 1] and one above, with an inclined common face, of hexahedra of 20 nodes.
struct Blocks {
    numbers: BTreeMap<[i64; 3], usize>,
    nodes: String,
    cells: String,
    n_cells: usize,
}

/// Edges of Gmsh's hexahedron of 20 nodes, in the order of its nodes from the ninth on.
const EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [0, 3],
    [0, 4],
    [1, 2],
    [1, 5],
    [2, 3],
    [2, 6],
    [3, 7],
    [4, 5],
    [4, 7],
    [5, 6],
    [6, 7],
];

/// The sides of a block, each with the axis, the place along it, and the corners of a cell there in their order.
const SIDES: [(&str, usize, f64, [usize; 4]); 6] = [
    ("left", 0, 0.0, [0, 3, 7, 4]),
    ("right", 0, 2.0, [1, 2, 6, 5]),
    ("bottom", 1, 0.0, [0, 1, 5, 4]),
    ("top", 1, 1.0, [3, 2, 6, 7]),
    ("back", 2, 0.0, [0, 1, 2, 3]),
    ("front", 2, 1.0, [4, 5, 6, 7]),
];

impl Blocks {
    /// A node, in parts of 1/1000 of the block before it is bent.
    fn node(&mut self, at: [i64; 3], x: [f64; 3]) -> usize {
        let next = self.numbers.len() + 1;
        let number = *self.numbers.entry(at).or_insert(next);
        if number == next {
            writeln!(self.nodes, "{next} {} {} {}", x[0], x[1], x[2]).expect("a string");
        }
        number
    }

    /// The block above y = `low` with n cells in x, y and z.
    fn block(&mut self, group: usize, low: f64, n: [usize; 3]) {
        let size = [2.0, 1.0, 1.0];
        for k in 0..n[0] * n[1] * n[2] {
            let cell = [k % n[0], k / n[0] % n[1], k / n[0] / n[1]];
            let corner = |a: usize| {
                let step = [a.div_ceil(2) % 2, a / 2 % 2, a / 4];
                [0, 1, 2].map(|d| (cell[d] + step[d]) as f64 / n[d] as f64 * size[d])
            };
            let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
            let middle = |e: &[usize; 2]| {
                let [a, b] = e.map(|k| corners[k]);
                [0, 1, 2].map(|d| 0.5 * (a[d] + b[d]))
            };
            let all = corners.iter().copied().chain(EDGES.iter().map(middle));
            let mut list = Vec::new();
            for x in all.collect::<Vec<_>>() {
                let key = [0, 1, 2].map(|d| (x[d] * 6000.0).round() as i64);
                let y = x[1] + low;
                let bent = [x[0], y + 0.1 * (x[0] + 0.5 * x[2]) * y * (2.0 - y), x[2]];
                // Blocks have no nodes in common.
                list.push(self.node([key[0], key[1] + 100_000 * group as i64, key[2]], bent));
            }
            self.cell(17, group, &list);
            for (side, (_, axis, place, at)) in SIDES.iter().enumerate() {
                if at.iter().any(|&a| (corners[a][*axis] - place).abs() > 1e-9) {
                    continue;
                }
                let edge = |k: usize| {
                    let ends = [at[k], at[(k + 1) % 4]];
                    let same = |e: &[usize; 2]| ends.contains(&e[0]) && ends.contains(&e[1]);
                    8 + EDGES.iter().position(same).expect("an edge")
                };
                let nodes = at.iter().copied().chain((0..4).map(edge));
                let nodes: Vec<usize> = nodes.map(|a| list[a]).collect();
                self.cell(16, 10 * group + side, &nodes);
            }
        }
    }

    fn cell(&mut self, kind: usize, group: usize, nodes: &[usize]) {
        self.n_cells += 1;
        let list: Vec<String> = nodes.iter().map(|k| k.to_string()).collect();
        let (number, list) = (self.n_cells, list.join(" "));
        writeln!(self.cells, "{number} {kind} 2 {group} {group} {list}").expect("a string");
    }

    fn file(upper: [usize; 3]) -> String {
        let mut blocks = Blocks {
            numbers: BTreeMap::new(),
            nodes: String::new(),
            cells: String::new(),
            n_cells: 0,
        };
        blocks.block(1, 0.0, [4, 2, 3]);
        blocks.block(2, 1.0, upper);
        let sides = [("low", 1), ("up", 2)]
            .into_iter()
            .flat_map(|(name, group)| {
                let name = move |(k, side): (usize, &(&str, usize, f64, [usize; 4]))| {
                    format!("2 {} \"{name}_{}\"\n", 10 * group + k, side.0)
                };
                SIDES.iter().enumerate().map(name)
            });
        let sides: String = sides.collect();
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n14\n3 1 \"low\"\n3 2 \"up\"\n{sides}\
             $EndPhysicalNames\n$Nodes\n{}\n{}$EndNodes\n$Elements\n{}\n{}$EndElements\n",
            blocks.numbers.len(),
            blocks.nodes,
            blocks.n_cells,
            blocks.cells
        )
    }
}

/// Boxes of tetrahedra of 10 nodes with the same shape; `upper` are the elements of the upper one.
fn boxes(upper: [usize; 3], joint: &str) -> String {
    let body = |name: &str, y: usize, n: [usize; 3], sides: &str, pressed: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [0, {y}, 0]\nsize = [2, 1, 1]\nelements = {n:?}\n\
             subdomains = [2, 1, 1]\nshape = {{ y = \"y + 0.1*(x + 0.5*z)*y*(2 - y)\" }}\n\
             young = 10\npoisson = 0.3\ndirichlet = {{ left = {{ x = 0 }}, back = {{ z = 0 }}{sides} }}\n\
             pressure = {{ right = 1, front = 1{pressed} }}\n"
        )
    };
    let low = body("low", 0, [4, 2, 3], ", bottom = { y = 0 }", "");
    let up = body("up", 1, upper, "", ", top = 1");
    format!(
        "dimension = 3\nphysics = \"elasticity\"\norder = 2\nelement = \"p1\"\n{low}{up}{joint}"
    )
}

fn solution(scene: &Scene) -> Solution {
    let problem = scene.substructures(&|_| true).expect("substructures");
    with_session(move |session| {
        let settings = MethodSettings::default().rtol(1e-12);
        let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
        solver.solve().expect("a solution")
    })
}

/// All rows hold, with the pressure of 1.
fn presses_evenly(scene: &Scene, what: &str) {
    let solution = solution(scene);
    assert!(solution.converged(), "{what}: {:?}", solution.status);
    assert!(solution.rows().len() > 50, "{what}");
    for row in solution.rows() {
        let pressure = row.pressure().expect("an area at every node");
        assert!((pressure - 1.0).abs() < 1e-9, "{what}: {pressure}");
    }
}

const MATCHING: [usize; 3] = [4, 2, 3];
const OTHER: [usize; 3] = [2, 1, 2];

#[test]
fn triangles_of_6_nodes_pass_a_constant_pressure() {
    for upper in [MATCHING, OTHER] {
        let joint = "[[contact]]\nbodies = [\"low\", \"up\"]\n";
        let scene = Scene::parse("s.toml", &boxes(upper, joint)).expect("a scene");
        assert_eq!(scene.mortar_rows().count(), 9 * 7);
        presses_evenly(&scene, &format!("tetrahedra, {upper:?}"));
    }
    // A tie has equations, which have no sign: nodes that match are tied one by one.
    let scene = Scene::parse("s.toml", &boxes(MATCHING, "")).expect("a scene");
    assert!(scene.mortar_rows().next().is_none());
}

#[test]
fn quadrilaterals_of_8_nodes_pass_a_constant_pressure() {
    let scratch = Scratch::new("quad8");
    for upper in [MATCHING, OTHER] {
        scratch.file("blocks.msh", &Blocks::file(upper));
        let body = |name: &str, held: &str, pressed: &str| {
            format!(
                "[[body]]\nname = \"{name}\"\nyoung = 10\npoisson = 0.3\nsubdomains = 2\n\
                 dirichlet = {{ {name}_left = {{ x = 0 }}, {name}_back = {{ z = 0 }}{held} }}\n\
                 pressure = {{ {name}_right = 1, {name}_front = 1{pressed} }}\n"
            )
        };
        let text = format!(
            "dimension = 3\nphysics = \"elasticity\"\n[mesh]\nfile = \"blocks.msh\"\n{}{}[[contact]]\n\
             surfaces = [\"low_top\", \"up_bottom\"]\n",
            body("low", ", low_bottom = { y = 0 }", ""),
            body("up", "", ", up_top = 1")
        );
        let path = scratch.file("s.toml", &text);
        let scene = Scene::load(path).expect("a scene");
        assert_eq!(scene.mortar_rows().count(), 9 * 7 - 4 * 3);
        presses_evenly(&scene, &format!("hexahedra of 20 nodes, {upper:?}"));
    }
}

#[test]
fn a_rigid_plane_presses_evenly_on_triangles_of_6_nodes() {
    let text = "dimension = 3\nphysics = \"elasticity\"\norder = 2\nelement = \"p1\"\n\
        [[body]]\nname = \"block\"\norigin = [0, 0.01, 0]\nsize = [2, 1, 1]\nelements = [4, 2, 3]\n\
        subdomains = [2, 1, 1]\nyoung = 10\npoisson = 0.3\n\
        dirichlet = { left = { x = 0 }, back = { z = 0 } }\npressure = { right = 1, front = 1, top = 1 }\n\
        [[obstacle]]\nbody = \"block\"\nside = \"bottom\"\nplane = { point = [0, 0], normal = [0, 1] }\n";
    let scene = Scene::parse(
        "s.toml",
        &text
            .replace("[0, 0]", "[0, 0, 0]")
            .replace("[0, 1] }", "[0, 1, 0] }"),
    );
    let scene = scene.expect("a scene");
    presses_evenly(&scene, "plane");
    let gaps = scene.obstacles[0].limits.all().len();
    assert_eq!((gaps, scene.mortar_rows().count()), (9 * 7, 9 * 7));
    for row in scene.mortar_rows() {
        let bound = row.bound.as_ref().expect("a bound");
        assert!(
            row.law.is_inequality() && (bound.value - 0.01).abs() < 1e-15,
            "{row:?}"
        );
    }
}
