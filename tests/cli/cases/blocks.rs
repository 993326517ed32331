//! Decks of blocks of hexahedra, and what a run of one prints.

use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use deck::{read_dat, DatQuantity};
use std::collections::BTreeMap;

/// A block of hexahedra between `origin` and `origin + size`; z grows by `slope` times x. Its nodes and cells are
/// numbered from `first` on. Its sides are the sets and surfaces N and S, its name, the axis, and 0 or 1.
pub struct Block {
    pub name: &'static str,
    pub first: usize,
    pub cells: [usize; 3],
    pub origin: [f64; 3],
    pub size: [f64; 3],
    pub slope: f64,
    /// Whether edges have a node in their middle.
    pub quadratic: bool,
}

/// The corners of the edges of a hexahedron, in the order of their middle nodes.
const EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [1, 2],
    [2, 3],
    [3, 0],
    [4, 5],
    [5, 6],
    [6, 7],
    [7, 4],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

impl Block {
    pub fn new(
        name: &'static str,
        first: usize,
        cells: [usize; 3],
        origin: [f64; 3],
        size: [f64; 3],
    ) -> Block {
        Block {
            name,
            first,
            cells,
            origin,
            size,
            slope: 0.0,
            quadratic: false,
        }
    }

    pub fn sloping(self, slope: f64) -> Block {
        Block { slope, ..self }
    }

    pub fn quadratic(self) -> Block {
        Block {
            quadratic: true,
            ..self
        }
    }

    fn node(&self, [i, j, k]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.cells;
        self.first + i + (nx + 1) * (j + (ny + 1) * k)
    }

    fn places(most: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
        let [nx, ny, nz] = most;
        let each = move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k]));
        (0..nz).flat_map(each)
    }

    /// Its nodes, elements, sets and surfaces.
    fn text(&self) -> String {
        let mut at: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
        for place in Block::places(self.cells.map(|n| n + 1)) {
            let part = |d: usize| self.size[d] * place[d] as f64 / self.cells[d] as f64;
            let [x, y, z] = [0, 1, 2].map(|d| self.origin[d] + part(d));
            at.insert(self.node(place), [x, y, z + self.slope * x]);
        }
        let mut cells = String::new();
        let mut middle: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for (c, [i, j, k]) in Block::places(self.cells).enumerate() {
            let corner = |[a, b, c]: [usize; 3]| self.node([i + a, j + b, k + c]);
            let square = |k| [[0, 0, k], [1, 0, k], [1, 1, k], [0, 1, k]];
            let mut nodes: Vec<usize> = [square(0), square(1)]
                .concat()
                .into_iter()
                .map(corner)
                .collect();
            for [a, b] in EDGES.into_iter().take(if self.quadratic { 12 } else { 0 }) {
                let (a, b) = (nodes[a], nodes[b]);
                let next = self.first + 1000 + middle.len();
                let node = *middle.entry([a.min(b), a.max(b)]).or_insert(next);
                let half = |d: usize| 0.5 * (at[&a][d] + at[&b][d]);
                let half = [0, 1, 2].map(half);
                at.insert(node, half);
                nodes.push(node);
            }
            let list: Vec<String> = nodes.iter().map(usize::to_string).collect();
            let lines: Vec<String> = list.chunks(10).map(|line| line.join(",")).collect();
            cells += &format!("{},{}\n", self.first + c, lines.join(",\n"));
        }
        let nodes: String = at
            .iter()
            .map(|(n, [x, y, z])| format!("{n},{x:.12},{y:.12},{z:.12}\n"))
            .collect();
        let kind = if self.quadratic { "C3D20" } else { "C3D8" };
        let name = self.name;
        let mut out = format!("*NODE,NSET=NALL\n{nodes}*ELEMENT,TYPE={kind},ELSET={name}\n{cells}");
        let labels = [["S6", "S4"], ["S3", "S5"], ["S1", "S2"]];
        for (d, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
            for (end, label) in labels[d].iter().enumerate() {
                let own: Vec<String> = Block::places(self.cells.map(|n| n + 1))
                    .filter(|p| p[d] == end * self.cells[d])
                    .map(|p| self.node(p).to_string())
                    .collect();
                let lines: Vec<String> = own.chunks(10).map(|line| line.join(",")).collect();
                out += &format!("*NSET,NSET=N{name}{axis}{end}\n{}\n", lines.join("\n"));
                out += &format!("*SURFACE,NAME=S{name}{axis}{end}\n");
                for (c, place) in Block::places(self.cells).enumerate() {
                    if place[d] == end * (self.cells[d] - 1) {
                        out += &format!("{},{}\n", self.first + c, label);
                    }
                }
            }
        }
        out + &format!("*SOLID SECTION,ELSET={name},MATERIAL=M\n")
    }
}

/// A deck of blocks of one material, with Young's modulus 1000 and Poisson's ratio 0.3, and what follows.
pub fn deck(blocks: &[Block], rest: &str) -> String {
    let blocks: String = blocks.iter().map(Block::text).collect();
    format!("{blocks}*MATERIAL,NAME=M\n*ELASTIC\n1000.,0.3\n{rest}")
}

/// What a run of a deck printed.
pub struct Ran {
    pub code: i32,
    /// Standard output and standard error.
    pub said: String,
    /// The displacements of the last table, by node.
    pub u: BTreeMap<u64, [f64; 3]>,
}

impl Ran {
    /// Checks a component of the displacement of a node against a value to some digits.
    pub fn expect(&self, node: u64, component: usize, value: f64) {
        assert_eq!(self.code, 0, "{}", self.said);
        let found = self.u[&node][component];
        assert!(
            (found - value).abs() <= 5e-6 * value.abs(),
            "node {node}: {found}, not {value}\n{}",
            self.said
        );
    }

    /// Checks that a sentence was said.
    pub fn says(&self, sentence: &str) {
        assert!(self.said.contains(sentence), "{sentence}\n{}", self.said);
    }
}

/// Solves a deck on some ranks.
pub fn solve(name: &str, text: &str, ranks: usize) -> Ran {
    let scratch = Scratch::new(&format!("cases_{name}_{ranks}"));
    let out = scratch.path("out");
    let file = scratch.file("deck.inp", text);
    let args = ["solve", &file, "--out", &out, "-fetifeti_ksp_rtol", "1e-11"];
    let run = run_fetifeti(ranks, &args);
    let printed = std::fs::read_to_string(format!("{out}/deck.dat")).unwrap_or_default();
    let tables = read_dat(&printed).into_iter();
    let mut moves = tables.filter(|table| table.quantity == DatQuantity::Displacement);
    let rows = moves.next_back().into_iter().flat_map(|table| table.rows);
    Ran {
        code: run.code,
        said: run.all(),
        u: rows.map(|row| (row.id, row.vector)).collect(),
    }
}
