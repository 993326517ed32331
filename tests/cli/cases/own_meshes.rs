//! Meshes of bodies that touch themselves: a ring with a slit, a block with a crack.

use std::collections::HashMap;
use std::fmt::Write;

/// A mesh with groups of cells, each with its dimension.
#[derive(Default)]
pub struct Mesh {
    points: Vec<[f64; 3]>,
    groups: Vec<(usize, &'static str, Vec<Vec<usize>>)>,
}

impl Mesh {
    /// The file of Gmsh, format 2.2.
    pub fn text(&self) -> String {
        let mut out = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n");
        writeln!(out, "{}", self.groups.len()).unwrap();
        for (k, (dim, name, _)) in self.groups.iter().enumerate() {
            writeln!(out, "{dim} {} \"{name}\"", k + 1).unwrap();
        }
        writeln!(out, "$EndPhysicalNames\n$Nodes\n{}", self.points.len()).unwrap();
        for (k, [x, y, z]) in self.points.iter().enumerate() {
            writeln!(out, "{} {x:?} {y:?} {z:?}", k + 1).unwrap();
        }
        let count: usize = self.groups.iter().map(|g| g.2.len()).sum();
        writeln!(out, "$EndNodes\n$Elements\n{count}").unwrap();
        let mut number = 0;
        for (k, (dim, _, cells)) in self.groups.iter().enumerate() {
            for cell in cells {
                number += 1;
                let kind = match (dim, cell.len()) {
                    (1, 2) => 1,
                    (2, 4) => 3,
                    (3, 8) => 5,
                    other => panic!("{other:?}"),
                };
                let nodes: Vec<String> = cell.iter().map(|n| (n + 1).to_string()).collect();
                let tag = k + 1;
                writeln!(out, "{number} {kind} 2 {tag} {tag} {}", nodes.join(" ")).unwrap();
            }
        }
        out + "$EndElements\n"
    }
}

/// A ring with a slit from x = 1 to 1.4, whose lips are at y = ±0.09, of 4 × 56 cells. With `warp` the nodes of one lip
/// lie elsewhere than those of the other. With `plate` another body touches its back.
pub fn ring(warp: f64, plate: bool) -> Mesh {
    let (nr, na) = (4, 56);
    let mut mesh = Mesh::default();
    let node = |i: usize, j: usize| j * (nr + 1) + i;
    for j in 0..=na {
        for i in 0..=nr {
            let (t, s) = (j as f64 / na as f64, i as f64 / nr as f64);
            let r = 1.0 + 0.4 * (s + warp * s * (1.0 - s) * (2.0 * t - 1.0));
            let from = (0.09 / r).asin();
            let angle = from + (std::f64::consts::TAU - 2.0 * from) * t;
            mesh.points.push([r * angle.cos(), r * angle.sin(), 0.0]);
        }
    }
    let cell = |i, j| {
        vec![
            node(i, j),
            node(i + 1, j),
            node(i + 1, j + 1),
            node(i, j + 1),
        ]
    };
    let cells = (0..na).flat_map(|j| (0..nr).map(move |i| (i, j)));
    let lip = |j: usize| (0..nr).map(|i| vec![node(i, j), node(i + 1, j)]).collect();
    let outer = |range: std::ops::Range<usize>| -> Vec<Vec<usize>> {
        range.map(|j| vec![node(nr, j), node(nr, j + 1)]).collect()
    };
    mesh.groups = vec![
        (2, "ring", cells.map(|(i, j)| cell(i, j)).collect()),
        (1, "first", lip(0)),
        (1, "second", lip(na)),
        (1, "pressed", [outer(0..10), outer(na - 10..na)].concat()),
        (1, "back", outer(na / 2 - 1..na / 2 + 1)),
    ];
    if plate {
        let back = [0, 1, 2].map(|k| mesh.points[node(nr, na / 2 - 1 + k)]);
        let first = mesh.points.len();
        mesh.points.extend(back.map(|[x, y, z]| [x - 0.3, y, z]));
        mesh.points.extend(back);
        let [l, r] = [first, first + 3];
        let cell = |k: usize| vec![l + k + 1, r + k + 1, r + k, l + k];
        mesh.groups.push((2, "plate", vec![cell(0), cell(1)]));
        let side = vec![vec![l + 1, l], vec![l + 2, l + 1]];
        mesh.groups.push((1, "held", side));
    }
    mesh
}

/// A block of 4 × 1 × 2 with a crack from x = 2 on at half its height, whose tip is closed: 8 × 2 × 4 cells. Nodes of
/// the upper face of the crack are moved by up to `shift`.
pub fn cracked(shift: f64) -> Mesh {
    let (mut mesh, mut known) = (Mesh::default(), HashMap::new());
    let mut node = |i: usize, j: usize, k: usize, up: bool| {
        let cut = up && k == 2 && i > 4;
        *known.entry((i, j, k, cut)).or_insert_with(|| {
            let [mut x, y, z] = [i, j, k].map(|n| 0.5 * n as f64);
            if cut && i < 8 {
                x += shift * if i % 2 == 1 { 1.0 } else { 0.6 };
            }
            mesh.points.push([x, y, z]);
            mesh.points.len() - 1
        })
    };
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
    let mut cells = Vec::new();
    for (k, j, i) in (0..4).flat_map(|k| (0..2).flat_map(move |j| (0..8).map(move |i| (k, j, i)))) {
        let floor = |c: usize| corners.map(|[a, b]| (i + a, j + b, k + c));
        let both = [floor(0), floor(1)].concat();
        cells.push(
            both.into_iter()
                .map(|(i, j, l)| node(i, j, l, k >= 2))
                .collect(),
        );
    }
    let mut quads = |k: usize, up: bool, from: usize| -> Vec<Vec<usize>> {
        let places = (0..2).flat_map(|j| (from..8).map(move |i| (i, j)));
        places
            .map(|(i, j)| corners.map(|[a, b]| node(i + a, j + b, k, up)).to_vec())
            .collect()
    };
    let sides = [
        ("upper", quads(2, true, 4)),
        ("lower", quads(2, false, 4)),
        ("press", quads(4, true, 6)),
        ("top", quads(4, true, 0)),
        ("bottom", quads(0, false, 0)),
    ];
    let mut wall = Vec::new();
    for (j, k) in (0..2).flat_map(|j| (0..4).map(move |k| (j, k))) {
        wall.push(corners.map(|[a, b]| node(0, j + a, k + b, false)).to_vec());
    }
    mesh.groups.push((3, "block", cells));
    mesh.groups
        .extend(sides.into_iter().map(|(n, q)| (2, n, q)));
    mesh.groups.push((2, "wall", wall));
    mesh
}
