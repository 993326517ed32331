//! Friction in the report: forces, states and slips of the nodes of an interface.

use std::collections::HashMap;

use fetifeti::problem::{BodyNode, FrictionNode, RowSource};
use fetifeti::solution::{RowState, SolvedRow};
use fetifeti::{FetiFeti, Solution};
use petsc::Session;
use report::interfaces::NodeFriction;
use report::json::friction::{FrictionExtremes, FrictionForce};
use report::paraview::friction_fields::{ContactState, PointFriction};
use scene::Scene;

/// The rows of friction on rank 0, ordered as the rows of the report are; none on the other ranks.
pub struct FrictionRows {
    /// All tangential rows.
    pub rows: Vec<SolvedRow>,
    /// The normal row of each node with friction, with the bound of the force of friction as its multiplier.
    bounds: Vec<SolvedRow>,
}

impl FrictionRows {
    /// The rows of friction of a solution. Collective.
    pub fn new(session: &Session, solver: &FetiFeti, solution: &Solution) -> FrictionRows {
        let normal = solution.rows();
        let bound = |node: &FrictionNode| {
            let mut row = *normal.get(node.normal)?;
            row.multiplier = node.bound.at(row.multiplier);
            Some(row)
        };
        let bounds: Vec<SolvedRow> = { solver.problem().friction.iter() }
            .filter_map(bound)
            .collect();
        let sorted = |rows: &[SolvedRow]| {
            let mut rows = SolvedRow::on_first_rank(session.comm(), rows);
            rows.sort_by(SolvedRow::by_place);
            rows
        };
        FrictionRows {
            rows: sorted(solution.tangential_rows()),
            bounds: sorted(&bounds),
        }
    }
}

/// A node with friction.
#[derive(Debug, Clone, Copy)]
pub struct FrictionAt {
    /// The nodes of both sides; an obstacle has none.
    members: [Option<BodyNode>; 2],
    /// The force with which the first body drags the other side along.
    pub drag: [f64; 3],
    /// The slip of the load step: of the first body beside the other side.
    pub slip: [f64; 3],
    /// Whether it sticks, slips or is apart.
    pub state: RowState,
    /// Its area; 0 where none is known.
    area: f64,
}

impl FrictionAt {
    /// Friction on the body of each side: the sides feel opposite forces and slips.
    pub fn on_bodies(&self) -> impl Iterator<Item = (BodyNode, PointFriction)> + '_ {
        let sides = self.members.into_iter().zip([1.0, -1.0]);
        sides.filter_map(|(member, sign)| {
            let at = PointFriction {
                force: self.drag.map(|f| 0.0 - sign * f),
                slip: self.slip.map(|w| 0.0 + sign * w),
                state: match self.state {
                    RowState::Sticks => ContactState::Stick,
                    RowState::Slips => ContactState::Slip,
                    _ => ContactState::Open,
                },
            };
            Some((member?, at))
        })
    }
}

/// The node of tangential rows with the same members.
fn node(rows: &[SolvedRow]) -> FrictionAt {
    let mut out = FrictionAt {
        members: rows[0].label.members,
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
pub fn along(rows: &[SolvedRow], friction: &FrictionRows) -> Vec<NodeFriction> {
    let Some(source) = rows.first().map(|row| row.label.source) else {
        return Vec::new();
    };
    let own = of_source(&friction.rows, source);
    if own.is_empty() {
        return Vec::new();
    }
    let bounds = of_source(&friction.bounds, source).iter();
    let bounds: HashMap<[Option<BodyNode>; 2], f64> = bounds
        .map(|row| (row.label.members, row.multiplier))
        .collect();
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
        let bound = bounds.get(&row.label.members).zip(at);
        NodeFriction {
            state,
            shear: std::array::from_fn(|c| shear(c) + 0.0),
            bound: bound.map_or(0.0, |(force, f)| force / f.area),
            slip: std::array::from_fn(|c| at.map_or(0.0, |f| f.slip[c] + 0.0)),
        }
    };
    rows.iter().map(of).collect()
}
