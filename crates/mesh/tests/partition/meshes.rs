//! Meshes for the tests of partitions.

use std::collections::HashMap;

use crate::{places, Cells};
use elements::kind::CellKind;

/// Cells and the positions of their nodes.
pub struct Mesh {
    pub cells: Cells,
    pub points: Vec<[f64; 3]>,
}

/// Numbers in 0..1 that look random.
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The nodes of a grid of `n` blocks, moved by up to `jitter` block edges; z is 0 where `n[2]` is 0.
fn grid(n: [usize; 3], jitter: f64) -> Vec<[f64; 3]> {
    let mut noise = Noise(1);
    let counts = n.map(|n| n + 1);
    let moved = |p: [usize; 3]| {
        let mut x = p.map(|k| k as f64);
        let dim = if n[2] == 0 { 2 } else { 3 };
        x[..dim]
            .iter_mut()
            .for_each(|x| *x += jitter * (noise.next() - 0.5));
        x
    };
    places(counts).map(moved).collect()
}

/// The corner of a block that is `by` away from its lowest corner.
fn corner(n: [usize; 3], place: [usize; 3], by: [usize; 3]) -> u32 {
    let [i, j, k] = [0, 1, 2].map(|d| place[d] + by[d]);
    ((k * (n[1] + 1) + j) * (n[0] + 1) + i) as u32
}

const HEX: [[usize; 3]; 8] = [
    [0, 0, 0],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];

/// Bricks.
pub fn hexes(n: [usize; 3]) -> Mesh {
    let mut cells = Cells::default();
    for place in places(n) {
        cells.push(CellKind::Hex8, &HEX.map(|by| corner(n, place, by)));
    }
    Mesh {
        cells,
        points: grid(n, 0.0),
    }
}

/// Six tetrahedra in each block, nodes jittered.
pub fn tets(n: [usize; 3]) -> Mesh {
    let mut cells = Cells::default();
    for place in places(n) {
        for order in [
            [0, 1, 2],
            [1, 2, 0],
            [2, 0, 1],
            [0, 2, 1],
            [1, 0, 2],
            [2, 1, 0],
        ] {
            let mut by = [0; 3];
            let mut nodes = vec![corner(n, place, by)];
            for d in order {
                by[d] = 1;
                nodes.push(corner(n, place, by));
            }
            // Even orders are right-handed.
            if [[0, 2, 1], [1, 0, 2], [2, 1, 0]].contains(&order) {
                nodes.swap(1, 2);
            }
            cells.push(CellKind::Tet4, &nodes);
        }
    }
    Mesh {
        cells,
        points: grid(n, 0.3),
    }
}

/// Two triangles in each square, cut either way, but for squares with the middle in a hole; nodes jittered.
pub fn triangles(n: [usize; 2], hole: impl Fn(f64, f64) -> bool) -> Mesh {
    let n = [n[0], n[1], 0];
    let mut cells = Cells::default();
    let mut noise = Noise(2);
    for place in places([n[0], n[1], 1]) {
        if hole(place[0] as f64 + 0.5, place[1] as f64 + 0.5) {
            continue;
        }
        let [a, b, c, d] =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]].map(|by| corner(n, place, by));
        let [one, two] = if noise.next() < 0.5 {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        };
        cells.push(CellKind::Triangle3, &one);
        cells.push(CellKind::Triangle3, &two);
    }
    Mesh {
        cells,
        points: grid(n, 0.3),
    }
}

/// Squares.
pub fn quads(n: [usize; 2]) -> Mesh {
    let n = [n[0], n[1], 0];
    let mut cells = Cells::default();
    for place in places([n[0], n[1], 1]) {
        let square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]];
        cells.push(CellKind::Quad4, &square.map(|by| corner(n, place, by)));
    }
    Mesh {
        cells,
        points: grid(n, 0.0),
    }
}

/// Blocks that are bricks below, then pairs of wedges, then six pyramids around a middle node.
pub fn mixed(n: [usize; 3]) -> Mesh {
    let mut cells = Cells::default();
    let mut points = grid(n, 0.0);
    for place in places(n) {
        let v = HEX.map(|by| corner(n, place, by));
        match place[2] * 3 / n[2] {
            0 => cells.push(CellKind::Hex8, &v),
            1 => {
                cells.push(CellKind::Wedge6, &[v[0], v[3], v[7], v[1], v[2], v[6]]);
                cells.push(CellKind::Wedge6, &[v[0], v[7], v[4], v[1], v[6], v[5]]);
            }
            _ => {
                let middle = points.len() as u32;
                points.push(place.map(|k| k as f64 + 0.5));
                for side in CellKind::Hex8.sides() {
                    let [a, b, c, d] = [0, 1, 2, 3].map(|k| v[usize::from(side.nodes[k])]);
                    // The base of a pyramid looks away from its apex.
                    cells.push(CellKind::Pyramid5, &[a, d, c, b, middle]);
                }
            }
        }
    }
    Mesh { cells, points }
}

/// A mesh of second order: `mesh` with the middles of edges, of triangles, tetrahedra and bricks.
pub fn second_order(mesh: &Mesh) -> Mesh {
    let mut points = mesh.points.clone();
    let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
    let mut cells = Cells::default();
    for (kind, nodes) in mesh.cells.iter() {
        let quadratic = match kind {
            CellKind::Triangle3 => CellKind::Triangle6,
            CellKind::Tet4 => CellKind::Tet10,
            CellKind::Hex8 => CellKind::Hex20,
            _ => unreachable!("not in these tests"),
        };
        let mut all = nodes.to_vec();
        for ends in kind.edges() {
            let [a, b] = ends.map(|k| nodes[usize::from(k)]);
            let middle = *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                let (x, y) = (points[a as usize], points[b as usize]);
                points.push([0, 1, 2].map(|d| (x[d] + y[d]) / 2.0));
                points.len() as u32 - 1
            });
            all.push(middle);
        }
        cells.push(quadratic, &all);
    }
    Mesh { cells, points }
}

/// The mesh without some cells; nodes stay.
pub fn without(mesh: &Mesh, gone: impl Fn(usize) -> bool) -> Mesh {
    let mut cells = Cells::default();
    for (c, (kind, nodes)) in mesh.cells.iter().enumerate() {
        if !gone(c) {
            cells.push(kind, nodes);
        }
    }
    Mesh {
        cells,
        points: mesh.points.clone(),
    }
}

/// The middle of a cell.
pub fn middle(mesh: &Mesh, c: usize) -> [f64; 3] {
    let nodes = mesh.cells.nodes(c);
    let mean = |d: usize| {
        nodes
            .iter()
            .map(|&n| mesh.points[n as usize][d])
            .sum::<f64>()
            / nodes.len() as f64
    };
    [0, 1, 2].map(mean)
}
