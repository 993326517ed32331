//! Motions without energy of a mesh that are not rigid: those that all cells agree on.
//!
//! A motion of the mesh has no energy if it has none in every cell. Cells whose stiffness sees all but rigid motions,
//! and that share sides, move as one; the others have motions of their own ([`element::slack`]). Piece by piece the
//! motions of what is there so far are joined with those of the next piece, where both have nodes: the solutions of a
//! small system. Mostly nothing but rigid motions is left at once; in a column of one wedge after the other every
//! triangle turns about the axis.

use std::collections::BinaryHeap;

use base::linalg::lists::Lists;
use base::linalg::null_space::null_space;
use base::linalg::union_find::UnionFind;
use elements::element::{self, Integration};
use elements::form::Form;
use elements::kind::CellKind;
use mesh::CellMesh;

/// Differences between motions of two pieces at their common nodes that count as none, beside motions of order one.
const NONE: f64 = 1e-4;

/// Entries of a motion below this are rounding.
const ROUNDING: f64 = 1e-9;

/// A motion: (degree of freedom C k + c, displacement), by increasing degree of freedom; of order one.
pub type ZeroEnergyMode = Vec<(u32, f64)>;

/// The motions without energy of a mesh of cells beyond the rigid ones; `place` gives the position of a node. A basis
/// together with the rigid motions, each vector with few entries where that is possible.
pub fn slack(
    form: &Form,
    mesh: &CellMesh,
    rules: &[Integration],
    place: &dyn Fn(usize) -> [f64; 3],
) -> Vec<ZeroEnergyMode> {
    let rule = |c: usize| rules.get(c).copied().unwrap_or(Integration::Full);
    let weak = |c: usize| element::may_slack(mesh.cells.kind(c), rule(c));
    if !form.is_elastic() || !(0..mesh.cells.len()).any(weak) {
        return Vec::new();
    }
    let pieces = Pieces::new(mesh, &weak);
    let mut search = ZeroEnergySearch::new(form, mesh, &pieces, place);
    while let Some(piece) = search.next() {
        let own = match pieces.cells.at(piece) {
            [cell] if weak(*cell as usize) => {
                let c = *cell as usize;
                let nodes = mesh.cells.nodes(c).iter();
                let points: Vec<[f64; 3]> = nodes.map(|&k| place(k as usize)).collect();
                if search.is_held((mesh.cells.kind(c), rule(c)), piece, &points) {
                    Vec::new()
                } else {
                    element::slack(form, mesh.cells.kind(c), &points, rule(c))
                }
            }
            _ => Vec::new(),
        };
        search.add(piece, &own);
    }
    search.motions
}

/// The parts of a mesh that are joined one by one: weak cells, and other cells that share sides with each other.
struct Pieces {
    cells: Lists,
    /// The nodes of each piece: of a weak cell in its own order.
    nodes: Lists,
    /// The pieces at each node.
    at: Lists,
}

impl Pieces {
    fn new(mesh: &CellMesh, weak: &dyn Fn(usize) -> bool) -> Pieces {
        let (n, adjacency) = (mesh.cells.len(), mesh.adjacency());
        let mut sets = UnionFind::new(n);
        for c in (0..n).filter(|&c| !weak(c)) {
            for side in 0..mesh.cells.kind(c).sides().len() {
                let other = adjacency.across(c, side).map(|o| o as usize);
                if let Some(other) = other.filter(|&o| !weak(o)) {
                    sets.join(c, other);
                }
            }
        }
        let mut number = vec![u32::MAX; n];
        let mut count = 0;
        let of: Vec<(usize, u32)> = (0..n)
            .map(|c| {
                let root = sets.find(c);
                if number[root] == u32::MAX {
                    number[root] = count;
                    count += 1;
                }
                (number[root] as usize, c as u32)
            })
            .collect();
        let cells = Lists::of(count as usize, of.into_iter());
        let mut nodes = Lists::default();
        let mut seen = vec![u32::MAX; mesh.points.len()];
        for (p, list) in (0..).zip(cells.iter()) {
            let all = list.iter().flat_map(|&c| mesh.cells.nodes(c as usize));
            let fresh = |k: &u32| std::mem::replace(&mut seen[*k as usize], p) != p;
            let own: Vec<u32> = all.copied().filter(fresh).collect();
            nodes.push(own);
        }
        let at = nodes.iter().enumerate();
        let at = at.flat_map(|(p, list)| list.iter().map(move |&k| (k as usize, p as u32)));
        let at = Lists::of(mesh.points.len(), at.collect::<Vec<_>>().into_iter());
        Pieces { cells, nodes, at }
    }
}

struct ZeroEnergySearch<'a> {
    form: &'a Form,
    dim: usize,
    pieces: &'a Pieces,
    place: &'a dyn Fn(usize) -> [f64; 3],
    /// Whether a node, and a piece, is there.
    node: Vec<bool>,
    done: Vec<bool>,
    /// Whether nothing is there yet.
    empty: bool,
    /// Nodes of each piece that are there, and pieces by that number.
    met: Vec<u32>,
    queue: BinaryHeap<(u32, std::cmp::Reverse<u32>)>,
    /// Pieces at each node that are not there yet.
    open: Vec<u32>,
    /// The motions so far. Those that vanish at nodes of other pieces come before `moving`.
    motions: Vec<ZeroEnergyMode>,
    moving: usize,
}

impl<'a> ZeroEnergySearch<'a> {
    fn new(
        form: &'a Form,
        mesh: &CellMesh,
        pieces: &'a Pieces,
        place: &'a dyn Fn(usize) -> [f64; 3],
    ) -> ZeroEnergySearch<'a> {
        let n = pieces.cells.len();
        ZeroEnergySearch {
            form,
            dim: mesh.dim,
            pieces,
            place,
            node: vec![false; mesh.points.len()],
            done: vec![false; n],
            empty: true,
            met: vec![0; n],
            queue: BinaryHeap::from([(0, std::cmp::Reverse(0))]),
            open: pieces.at.iter().map(|list| list.len() as u32).collect(),
            motions: Vec::new(),
            moving: 0,
        }
    }

    /// The piece that shares most nodes with what is there.
    fn next(&mut self) -> Option<usize> {
        while let Some((met, std::cmp::Reverse(piece))) = self.queue.pop() {
            let piece = piece as usize;
            if !self.done[piece] && self.met[piece] == met {
                self.done[piece] = true;
                return Some(piece);
            }
        }
        None
    }

    /// Whether a weak cell has no motion of its own beside what is there: where this moves rigidly at the nodes that
    /// both have, the cell sees all motions of the others. Most cells of a solid mesh bring few new nodes.
    fn is_held(
        &self,
        (kind, rule): (CellKind, Integration),
        piece: usize,
        points: &[[f64; 3]],
    ) -> bool {
        let (c, nodes) = (self.dim, self.pieces.nodes.at(piece));
        let mut moving = self.motions[self.moving..].iter().flatten();
        if moving.any(|e| nodes.contains(&(e.0 / c as u32))) {
            return false;
        }
        let (known, new): (Vec<usize>, Vec<usize>) =
            (0..nodes.len()).partition(|&i| self.node[nodes[i] as usize]);
        let rigid = element::rigid_of(self.form, self.dim, points);
        let dofs = known.iter().flat_map(|&i| c * i..c * (i + 1));
        let rows = dofs
            .map(|dof| rigid.iter().map(|x| x[dof]).collect())
            .collect();
        null_space(rows, std::slice::from_ref(&(0..rigid.len())), NONE).is_empty()
            && element::sees(self.form, kind, points, rule, &new)
    }

    /// Joins a piece with its own motions beyond the rigid ones.
    fn add(&mut self, piece: usize, own: &[Vec<f64>]) {
        let (c, nodes) = (self.dim, self.pieces.nodes.at(piece));
        let points: Vec<[f64; 3]> = nodes.iter().map(|&k| (self.place)(k as usize)).collect();
        let rigid = element::rigid_of(self.form, self.dim, &points);
        let at_node: rustc_hash::FxHashMap<u32, usize> =
            nodes.iter().enumerate().map(|(i, &k)| (k, i)).collect();
        // The motions that are not zero at the common nodes, as values there.
        let mut reaching: Vec<(ZeroEnergyMode, Vec<f64>)> = Vec::new();
        let mut rest = Vec::new();
        for motion in self.motions.drain(self.moving..) {
            let mut values = vec![0.0; c * nodes.len()];
            let mut largest = 0.0_f64;
            for &(dof, v) in &motion {
                if let Some(i) = at_node.get(&(dof / c as u32)) {
                    values[c * i + dof as usize % c] = v;
                    largest = largest.max(v.abs());
                }
            }
            if largest > NONE {
                reaching.push((motion, values))
            } else {
                rest.push(motion)
            }
        }
        let common: Vec<usize> = (0..nodes.len())
            .filter(|&i| self.node[nodes[i] as usize])
            .collect();
        let first = std::mem::replace(&mut self.empty, false);
        let (e, r, m) = (reaching.len(), rigid.len(), own.len());
        let normal = |x: &Vec<f64>| x.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        let sizes: Vec<f64> = own.iter().map(normal).collect();
        let mut fresh: Vec<ZeroEnergyMode> = Vec::new();
        let column = |values: &[f64], fresh: &mut ZeroEnergyMode, factor: f64, only_new: bool| {
            for (i, &k) in nodes.iter().enumerate() {
                if only_new && self.node[k as usize] {
                    continue;
                }
                for d in 0..c {
                    let v = factor * values[c * i + d];
                    if v != 0.0 {
                        fresh.push(((c as u32) * k + d as u32, v));
                    }
                }
            }
        };
        if first {
            for (x, size) in own.iter().zip(&sizes) {
                let mut motion = ZeroEnergyMode::new();
                column(x, &mut motion, 1.0 / size, false);
                fresh.push(tidy(motion));
            }
        } else {
            // A motion of what is there, less one of the piece, at the common nodes.
            let row = |i: usize, d: usize| -> Vec<f64> {
                let at = c * i + d;
                let there = reaching.iter().map(|(_, v)| v[at]);
                let here = rigid.iter().map(|x| -x[at]);
                let more = own.iter().zip(&sizes).map(|(x, s)| -x[at] / s);
                there.chain(here).chain(more).collect()
            };
            let rows = common.iter().flat_map(|&i| (0..c).map(move |d| (i, d)));
            let rows: Vec<Vec<f64>> = rows.map(|(i, d)| row(i, d)).collect();
            let groups = [0..0, e..e + r, 0..e, e + r..e + r + m];
            for (_, x) in null_space_in(rows, &groups, e + r + m) {
                let mut motion = ZeroEnergyMode::new();
                for ((known, _), factor) in reaching.iter().zip(&x) {
                    motion.extend(known.iter().map(|&(dof, v)| (dof, factor * v)));
                }
                for (values, factor) in rigid.iter().zip(&x[e..]) {
                    column(values, &mut motion, *factor, true);
                }
                for ((values, size), factor) in own.iter().zip(&sizes).zip(&x[e + r..]) {
                    column(values, &mut motion, factor / size, true);
                }
                fresh.push(tidy(motion));
            }
        }
        for &k in nodes {
            self.open[k as usize] -= 1;
            if !std::mem::replace(&mut self.node[k as usize], true) {
                for &other in self.pieces.at.at(k as usize) {
                    self.met[other as usize] += 1;
                    if !self.done[other as usize] {
                        let entry = (self.met[other as usize], std::cmp::Reverse(other));
                        self.queue.push(entry);
                    }
                }
            }
        }
        rest.extend(fresh.into_iter().filter(|motion| !motion.is_empty()));
        self.sort(rest);
    }

    /// Keeps as few motions as possible that are not zero at nodes of pieces that are still to come.
    fn sort(&mut self, motions: Vec<ZeroEnergyMode>) {
        let c = self.dim as u32;
        let is_open = |dof: &u32| self.open[(dof / c) as usize] > 0;
        let mut dofs: Vec<u32> = motions
            .iter()
            .flatten()
            .map(|e| e.0)
            .filter(is_open)
            .collect();
        dofs.sort_unstable();
        dofs.dedup();
        let mut rows = vec![vec![0.0; motions.len()]; dofs.len()];
        for (j, motion) in motions.iter().enumerate() {
            for &(dof, v) in motion {
                if let Ok(i) = dofs.binary_search(&dof) {
                    rows[i][j] = v;
                }
            }
        }
        let n = motions.len();
        let mut closed = Vec::new();
        let mut is_closed = vec![false; n];
        for (free, x) in null_space_in(rows, std::slice::from_ref(&(0..n)), n) {
            is_closed[free] = true;
            let mut motion = ZeroEnergyMode::new();
            for (known, factor) in motions.iter().zip(&x).filter(|(_, f)| **f != 0.0) {
                let open = |dof: u32| self.open[(dof / c) as usize] > 0;
                let entries = known.iter().filter(|e| !open(e.0));
                motion.extend(entries.map(|&(dof, v)| (dof, factor * v)));
            }
            closed.push(tidy(motion));
        }
        let closed = closed.into_iter().filter(|motion| !motion.is_empty());
        self.motions.extend(closed);
        self.moving = self.motions.len();
        let moving = motions.into_iter().zip(is_closed);
        self.motions.extend(
            moving
                .filter(|(_, closed)| !closed)
                .map(|(motion, _)| motion),
        );
    }
}

/// [`null_space`] whose groups need not be in the order of the columns.
fn null_space_in(
    rows: Vec<Vec<f64>>,
    groups: &[std::ops::Range<usize>],
    n: usize,
) -> Vec<(usize, Vec<f64>)> {
    let order: Vec<usize> = groups.iter().flat_map(Clone::clone).collect();
    let permuted = |row: Vec<f64>| order.iter().map(|&j| row[j]).collect();
    let rows: Vec<Vec<f64>> = rows.into_iter().map(permuted).collect();
    let mut start = 0;
    let ranges: Vec<std::ops::Range<usize>> = groups
        .iter()
        .map(|g| {
            start += g.len();
            start - g.len()..start
        })
        .collect();
    let back = |(free, x): (usize, Vec<f64>)| {
        let mut out = vec![0.0; n];
        order.iter().zip(x).for_each(|(&j, v)| out[j] = v);
        (order[free], out)
    };
    let found = null_space(rows, &ranges, NONE);
    found.into_iter().map(back).collect()
}

/// Sums by degree of freedom, without rounding, of largest entry one; empty if nothing is left.
pub fn tidy(mut motion: ZeroEnergyMode) -> ZeroEnergyMode {
    motion.sort_by_key(|e| e.0);
    let sum = |s: &[(u32, f64)]| (s[0].0, s.iter().map(|e| e.1).sum::<f64>());
    let mut out: ZeroEnergyMode = motion.chunk_by(|a, b| a.0 == b.0).map(sum).collect();
    let largest = out.iter().fold(0.0_f64, |a, e| a.max(e.1.abs()));
    if largest <= ROUNDING {
        return ZeroEnergyMode::new();
    }
    out.retain(|e| e.1.abs() > ROUNDING * largest);
    out.iter_mut().for_each(|e| e.1 /= largest);
    out
}

#[cfg(test)]
#[path = "../../tests/assembly/zero_energy.rs"]
mod tests;
