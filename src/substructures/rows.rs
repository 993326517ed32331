//! Rows of B_gl: as the problem gives them to the method, and as a solution returns them.

use std::cmp::Ordering;
use std::collections::HashMap;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::law::{Law, RowState, SentLaw};
use base::linalg::sorted::distinct;
use bytemuck::{Pod, Zeroable};
use parallel::exchange::{exchange, gather_all};

/// One row of B_gl: Σ coefficient · u(body dof), with right-hand side c.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Row {
    /// (body dof, coefficient) pairs; for matching scalar meshes (a, +1), (b, −1).
    pub terms: Vec<(u64, f64)>,
    /// Right-hand side c_r (the gap; zero on tied faces).
    pub gap: f64,
    /// Which multipliers it may have.
    pub law: Law,
    /// Z⁰: whether the row holds initially. A row that does not hold marks candidate contact nodes: the bodies are
    /// apart there, but the preconditioner and the interface are prepared for contact.
    pub holds: bool,
    /// Rows that share a body dof carry the same block number (unique over all ranks) and are provided by the same
    /// rank: the scaling B D⁻¹ Bᵀ is inverted block by block.
    pub block: u64,
    /// C ≥ 0, by how much a unit force compresses what the row stands for: (B u)_r − C λ_r takes the place of (B u)_r.
    /// 0 where it is rigid.
    pub compliance: f64,
    /// How far the direction of the row may be off, in radians, where it follows from coordinates with so many digits;
    /// 0 where it is exact. Work of the row on a rigid motion that is smaller, relative to the largest that it could
    /// be, is taken for rounding of the input if no other row resists the motion.
    pub rounding: f64,
    /// The origin of the row, for reports; the method does not use it.
    pub label: RowLabel,
}

/// A node of a body, in the numbering of the problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BodyNode {
    /// The body.
    pub body: usize,
    /// Its node; its unknown if a program gives matrices without nodes.
    pub node: usize,
}

/// The origin of a row, in the numbering of the problem. There are no others: whoever draws rows or sums them up must
/// know each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RowSource {
    /// Two bodies that meet; in a scene the index into `Scene::interfaces`.
    Interface(usize),
    /// A body beside a rigid obstacle; in a scene the index into `Scene::obstacles`.
    Obstacle(usize),
    /// An equation between unknowns; in a scene its number among those that given values do not decide.
    Equation(usize),
}

/// The origin of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RowLabel {
    /// The interface or obstacle of the row.
    pub source: RowSource,
    /// The nodes in the order of the row, including nodes with a given value; an obstacle has one node.
    pub members: [Option<BodyNode>; 2],
    /// Position of the first node, or of the one that carries the multiplier; 0 if it is not known.
    pub point: [f64; 3],
    /// Parameters along the common face or the side, 0 ≤ t ≤ 1; the second is 0 in the plane.
    pub t: [f64; 2],
    /// The unit vector n along which the row takes differences, out of the first body; 0 if it is not known.
    pub normal: [f64; 3],
    /// The nodal area on the first body's side; 0 if it has none or none is known.
    pub area: f64,
}

impl RowSource {
    /// A number for the kind, and the index, as ranks tell each other.
    pub fn code(self) -> [usize; 2] {
        match self {
            RowSource::Interface(k) => [0, k],
            RowSource::Obstacle(k) => [1, k],
            RowSource::Equation(k) => [2, k],
        }
    }

    /// The source with this [`code`](Self::code).
    pub fn of_code([kind, k]: [usize; 2]) -> RowSource {
        match kind {
            0 => RowSource::Interface(k),
            2 => RowSource::Equation(k),
            _ => RowSource::Obstacle(k),
        }
    }
}

impl RowLabel {
    /// The label of a row without geometric data.
    pub fn new(source: RowSource, members: [Option<BodyNode>; 2]) -> RowLabel {
        RowLabel {
            source,
            members,
            point: [0.0; 3],
            t: [0.0; 2],
            normal: [0.0; 3],
            area: 0.0,
        }
    }

    /// The source of the row and the bodies of its nodes, by numbers that differ from each other.
    /// The source takes the place of nodes that there are not.
    pub fn groups(&self) -> [[usize; 2]; 3] {
        let source = self.source.code();
        let [a, b] = self
            .members
            .map(|node| node.map_or(source, |node| [3, node.body]));
        [source, a, b]
    }

    /// This label with the position of the node that carries the multiplier, and its parameters along the side.
    pub fn at(mut self, point: [f64; 3], t: [f64; 2]) -> RowLabel {
        (self.point, self.t) = (point, t);
        self
    }

    /// This label with the unit vector n out of the first body and the nodal area, 0 where none is known.
    pub fn along(mut self, normal: [f64; 3], area: f64) -> RowLabel {
        (self.normal, self.area) = (normal, area);
        self
    }
}

/// A row of B_gl after a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SolvedRow {
    /// Its origin.
    pub label: RowLabel,
    /// Which multipliers it may have.
    pub law: Law,
    /// Whether it holds.
    pub state: RowState,
    /// λ: the force along the normal with which the first body presses on the other side.
    pub multiplier: f64,
    /// c − B u: the remaining gap; negative where the sides overlap.
    pub gap: f64,
    /// The block of the row. Rows of several ranks, sorted by block, have the order that one rank gives.
    pub block: u64,
}

impl SolvedRow {
    /// The row with this multiplier and B u − c = `excess`; `holds` is its state.
    pub(crate) fn new(row: &Row, multiplier: f64, excess: f64, holds: bool) -> SolvedRow {
        SolvedRow {
            label: row.label,
            law: row.law,
            state: row.law.state(multiplier, holds),
            multiplier,
            gap: -excess,
            block: row.block,
        }
    }

    /// The first body, if it is known.
    pub fn body(&self) -> Option<usize> {
        self.label.members[0].map(|m| m.body)
    }

    /// The node of the first body, if it is known.
    pub fn node(&self) -> Option<usize> {
        self.label.members[0].map(|m| m.node)
    }

    /// The unit vector along which the row takes differences, out of the first body.
    pub fn normal(&self) -> [f64; 3] {
        self.label.normal
    }

    /// The forces of the row on its nodes, along the normal.
    pub fn forces(&self) -> impl Iterator<Item = (BodyNode, [f64; 3])> + '_ {
        let members = [-1.0, 1.0].into_iter().zip(self.label.members);
        members.filter_map(|(sign, member)| {
            let force = self.normal().map(|n| sign * self.multiplier * n);
            Some((member?, force))
        })
    }

    /// Force per area; `None` where no area is known.
    pub fn pressure(&self) -> Option<f64> {
        (self.label.area > 0.0).then(|| self.multiplier / self.label.area)
    }

    /// Whether it is an inequality.
    pub fn is_inequality(&self) -> bool {
        self.law.is_inequality()
    }

    /// Whether it holds, as an equation or as an inequality.
    pub fn holds(&self) -> bool {
        matches!(
            self.state,
            RowState::Holds | RowState::Tied | RowState::Sticks
        )
    }

    /// The rows of all ranks on the first one, by rank; none on the others. Collective.
    pub fn on_first_rank(comm: &SimpleCommunicator, rows: &[SolvedRow]) -> Vec<SolvedRow> {
        let mut outgoing = vec![Vec::new(); comm.size() as usize];
        outgoing[0] = rows.iter().map(SentRow::new).collect();
        let rows = exchange(comm, outgoing);
        rows.iter().map(SentRow::row).collect()
    }

    /// On each rank the rows with a node of a body that it has, in order of their blocks; `ranks_of` gives the ranks
    /// that have a body. Collective.
    pub fn near_bodies(
        comm: &SimpleCommunicator,
        rows: &[SolvedRow],
        ranks_of: impl Fn(usize) -> Vec<usize>,
    ) -> Vec<SolvedRow> {
        let mut outgoing = vec![Vec::new(); comm.size() as usize];
        let mut known: HashMap<usize, Vec<usize>> = HashMap::new();
        for row in rows {
            let mut to: Vec<usize> = Vec::new();
            for member in row.label.members.into_iter().flatten() {
                let ranks = known
                    .entry(member.body)
                    .or_insert_with(|| ranks_of(member.body));
                to.extend(ranks.iter());
            }
            distinct(to)
                .into_iter()
                .for_each(|r| outgoing[r].push(SentRow::new(row)));
        }
        let rows = exchange(comm, outgoing);
        let mut rows: Vec<SolvedRow> = rows.iter().map(SentRow::row).collect();
        rows.sort_by_key(|row| row.block);
        rows
    }

    /// The order of rows in reports: by their source, and along the common face or side.
    pub fn by_place(&self, other: &SolvedRow) -> Ordering {
        let (a, b) = (&self.label, &other.label);
        let by_t = |k: usize| a.t[k].total_cmp(&b.t[k]);
        a.source.cmp(&b.source).then(by_t(1)).then(by_t(0))
    }

    /// The rows of all ranks on every one, in order of their blocks. Collective.
    pub fn on_all_ranks(comm: &SimpleCommunicator, rows: &[SolvedRow]) -> Vec<SolvedRow> {
        let mine: Vec<SentRow> = rows.iter().map(SentRow::new).collect();
        let rows = gather_all(comm, &mine).concat();
        let mut rows: Vec<SolvedRow> = rows.iter().map(SentRow::row).collect();
        rows.sort_by_key(|row| row.block);
        rows
    }
}

/// A [`SolvedRow`] on its way to other ranks.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct SentRow {
    source: [usize; 2],
    block: u64,
    law: SentLaw,
    holds: u64,
    /// Body and node; the largest numbers where there is none.
    members: [[usize; 2]; 2],
    point: [f64; 3],
    t: [f64; 2],
    normal: [f64; 3],
    area: f64,
    multiplier: f64,
    gap: f64,
}

impl SentRow {
    fn new(row: &SolvedRow) -> SentRow {
        let member = |m: Option<BodyNode>| m.map_or([usize::MAX; 2], |m| [m.body, m.node]);
        let label = &row.label;
        SentRow {
            source: label.source.code(),
            block: row.block,
            law: row.law.sent(),
            holds: row.holds().into(),
            members: label.members.map(member),
            point: label.point,
            t: label.t,
            normal: label.normal,
            area: label.area,
            multiplier: row.multiplier,
            gap: row.gap,
        }
    }

    fn row(&self) -> SolvedRow {
        let member =
            |[body, node]: [usize; 2]| (body != usize::MAX).then_some(BodyNode { body, node });
        let law = self.law.law();
        SolvedRow {
            label: RowLabel {
                source: RowSource::of_code(self.source),
                members: self.members.map(member),
                point: self.point,
                t: self.t,
                normal: self.normal,
                area: self.area,
            },
            law,
            state: law.state(self.multiplier, self.holds != 0),
            multiplier: self.multiplier,
            gap: self.gap,
            block: self.block,
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/substructures/rows.rs"]
mod tests;
