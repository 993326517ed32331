//! Friction in the report: forces, states and slips of the nodes of an interface.

use std::collections::HashMap;

use fetifeti::problem::{BodyNode, RowSource};
use fetifeti::solution::{RowState, SolvedRow};
use fetifeti::Solution;
use petsc::Session;
use report::interfaces::NodeFriction;
use report::json::friction::{FrictionExtremes, FrictionForce};
use scene::Scene;

/// All tangential rows on rank 0, ordered as the rows of the report are; empty on the other ranks. Collective.
pub fn tangential(session: &Session, solution: &Solution) -> Vec<SolvedRow> {
    let mut rows = SolvedRow::on_first_rank(session.comm(), solution.tangential_rows());
    rows.sort_by(SolvedRow::by_place);
    rows
}

/// A node with friction.
#[derive(Debug, Clone, Copy)]
pub struct FrictionAt {
    /// The force with which the first body drags the other side along.
    pub drag: [f64; 3],
    /// The slip of the load step: of the first body beside the other side.
    pub slip: [f64; 3],
    /// Whether it sticks, slips or is apart.
    pub state: RowState,
    /// Its area; 0 where none is known.
    area: f64,
}

/// The node of tangential rows with the same members.
fn node(rows: &[SolvedRow]) -> FrictionAt {
    let mut out = FrictionAt {
        drag: [0.0; 3],
        slip: [0.0; 3],
        state: RowState::Open,
        area: rows[0].label.area,
    };
    for row in rows {
        for (c, t) in row.normal().into_iter().enumerate() {
            out.drag[c] += row.multiplier * t;
            out.slip[c] -= row.gap * t;
        }
        if row.state != RowState::Open {
            out.state = row.state;
        }
    }
    out
}

/// The nodes of these tangential rows, in order.
pub fn nodes(rows: &[SolvedRow]) -> impl Iterator<Item = FrictionAt> + '_ {
    let same = |a: &SolvedRow, b: &SolvedRow| {
        (a.label.source, a.label.members) == (b.label.source, b.label.members)
    };
    rows.chunk_by(same).map(node)
}

/// The rows of one interface or obstacle.
pub fn of_source(rows: &[SolvedRow], source: RowSource) -> &[SolvedRow] {
    let first = rows.partition_point(|r| r.label.source < source);
    let n = rows[first..].partition_point(|r| r.label.source == source);
    &rows[first..first + n]
}

/// The friction of these tangential rows; `None` without any.
pub fn force(scene: &Scene, rows: &[SolvedRow]) -> Option<FrictionForce> {
    if rows.is_empty() {
        return None;
    }
    let mut out = FrictionForce {
        friction: vec![0.0; scene.dim()],
        ..FrictionForce::default()
    };
    for node in nodes(rows) {
        for (f, drag) in out.friction.iter_mut().zip(node.drag) {
            *f -= drag;
        }
        match node.state {
            RowState::Sticks => out.sticking += 1,
            RowState::Slips => out.slipping += 1,
            _ => {}
        }
        let work = node.drag.iter().zip(node.slip).map(|(f, w)| f * w);
        out.dissipated += work.sum::<f64>();
    }
    Some(out)
}

/// The largest values of these tangential rows; `None` without any.
pub fn extremes(rows: &[SolvedRow]) -> Option<FrictionExtremes> {
    if rows.is_empty() {
        return None;
    }
    let length = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let with_area = nodes(rows).filter(|n| n.area > 0.0);
    Some(FrictionExtremes {
        largest_shear: with_area.map(|n| length(n.drag) / n.area).reduce(f64::max),
        largest_slip: nodes(rows).map(|n| length(n.slip)).fold(0.0, f64::max),
    })
}

/// Friction at the node of each of these rows of one source; empty without friction.
pub fn along(rows: &[SolvedRow], tangential: &[SolvedRow]) -> Vec<NodeFriction> {
    let own = match rows.first() {
        Some(row) => of_source(tangential, row.label.source),
        None => &[],
    };
    if own.is_empty() {
        return Vec::new();
    }
    let same = |a: &SolvedRow, b: &SolvedRow| a.label.members == b.label.members;
    let groups = own
        .chunk_by(same)
        .map(|rows| (rows[0].label.members, node(rows)));
    let known: HashMap<[Option<BodyNode>; 2], FrictionAt> = groups.collect();
    let of = |row: &SolvedRow| {
        let at = known.get(&row.label.members);
        let state = match (row.is_inequality(), at.map(|f| f.state)) {
            (false, _) => "tied",
            (true, Some(RowState::Sticks)) => "stick",
            (true, Some(RowState::Slips)) => "slip",
            (true, _) => "open",
        };
        let shear = |c: usize| at.map_or(0.0, |f| -f.drag[c] / f.area);
        NodeFriction {
            state,
            shear: std::array::from_fn(|c| shear(c) + 0.0),
            slip: std::array::from_fn(|c| at.map_or(0.0, |f| f.slip[c] + 0.0)),
        }
    };
    rows.iter().map(of).collect()
}
