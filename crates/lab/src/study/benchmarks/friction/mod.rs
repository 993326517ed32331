//! Problems with Coulomb friction whose answers follow from a formula or from equilibrium.

pub mod arch;
mod arch_statics;
pub mod bar;
pub mod belt;
pub mod cylinders;
pub mod incline;
mod mindlin;
pub mod plate;
pub mod roller;
pub mod shoe;
pub mod spheres;

use std::collections::HashMap;

use super::runner::SolvedStep;
use fetifeti::solution::{RowState, SolvedRow};

/// The tractions between the sides at a node.
#[derive(Debug, Clone, Copy)]
pub struct NodeTraction {
    /// Its position.
    pub point: [f64; 3],
    /// The pressure.
    pub pressure: f64,
    /// The shear stress of friction on the first body, or on the body of an obstacle.
    pub shear: [f64; 3],
    /// The slip of the first body in the load step.
    pub slip: [f64; 3],
    /// Whether it sticks, slips or is apart.
    pub state: RowState,
    /// The part of the side that belongs to it.
    pub area: f64,
    /// The normal out of the first body.
    pub normal: [f64; 3],
}

impl NodeTraction {
    /// The force on the first body.
    pub fn force(&self) -> [f64; 3] {
        std::array::from_fn(|c| self.area * (self.shear[c] - self.pressure * self.normal[c]))
    }
}

/// All nodes with friction.
pub fn tractions(step: &SolvedStep) -> Vec<NodeTraction> {
    let key = |row: &SolvedRow| {
        let members = row.label.members.map(|m| m.map(|m| (m.body, m.node)));
        (row.label.source.code(), members)
    };
    let mut nodes: HashMap<_, NodeTraction> = HashMap::new();
    for row in &step.tangential {
        let node = nodes.entry(key(row)).or_insert(NodeTraction {
            point: row.label.point,
            pressure: 0.0,
            shear: [0.0; 3],
            slip: [0.0; 3],
            state: RowState::Open,
            area: row.label.area,
            normal: [0.0; 3],
        });
        for (c, t) in row.normal().into_iter().enumerate() {
            node.shear[c] -= row.multiplier * t / node.area;
            node.slip[c] -= row.gap * t;
        }
        if row.state != RowState::Open {
            node.state = row.state;
        }
    }
    // In the order of the normal rows, which is the same on any number of ranks.
    let with_normal = step.rows.iter().filter_map(|row| {
        let node = nodes.get(&key(row))?;
        Some(NodeTraction {
            pressure: row.multiplier / node.area,
            normal: row.normal(),
            ..*node
        })
    });
    with_normal.collect()
}

/// The force of all these nodes on the first body.
pub fn resultant(nodes: &[NodeTraction]) -> [f64; 3] {
    nodes.iter().fold([0.0; 3], |mut sum, node| {
        for (s, f) in sum.iter_mut().zip(node.force()) {
            *s += f;
        }
        sum
    })
}

/// The area of the nodes that stick.
pub fn sticking(nodes: &[NodeTraction]) -> f64 {
    let stuck = nodes.iter().filter(|n| n.state == RowState::Sticks);
    stuck.map(|n| n.area).sum()
}
