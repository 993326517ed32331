//! The rows of mortars on the ranks that give them, and their results at the nodes of surfaces, on all ranks.

use std::collections::BTreeMap;

use super::tangential::{ContactResult, RowState};
use crate::embed::GivenResults;
use bytemuck::{Pod, Zeroable};
use parallel::exchange::gather_all;
use petsc::Session;

/// Where a row belongs, on the rank that gives it.
#[derive(Debug, Clone, Copy)]
pub struct MortarRowOwner {
    pub mortar: usize,
    /// The node of its first surface.
    pub node: u32,
    /// The component that a tie is about; 0 in contact.
    pub component: usize,
    pub area: f64,
}

/// The result at a node, one component.
#[derive(Debug, Clone, Copy)]
pub struct NodeResult {
    pub multiplier: f64,
    pub area: f64,
    pub gap: f64,
    pub contact: ContactResult,
}

/// Results by mortar, node of the first surface and component, on all ranks.
pub type AtNodes = BTreeMap<(usize, u32, usize), NodeResult>;

/// A result at a node on its way to other ranks.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct SentResult {
    mortar: usize,
    component: usize,
    node: u64,
    state: i64,
    multiplier: f64,
    area: f64,
    gap: f64,
    force: [f64; 3],
    slip: [f64; 3],
}

/// Results of all mortars, on all ranks: `given` from number `first` on has those of the rows of this rank. Collective.
pub fn at_nodes(
    session: &Session,
    placed: &[MortarRowOwner],
    (given, first): (&GivenResults, usize),
    contact: &[ContactResult],
) -> AtNodes {
    let rows = placed.iter().zip(contact).zip(first..);
    let sent = rows.map(|((at, contact), k)| SentResult {
        mortar: at.mortar,
        component: at.component,
        node: at.node.into(),
        state: contact.state as i64,
        multiplier: given.multipliers[k],
        area: at.area,
        gap: given.gaps[k],
        force: contact.force,
        slip: contact.slip,
    });
    let all = gather_all(session.comm(), &sent.collect::<Vec<_>>()).concat();
    let one = |w: SentResult| {
        let at = NodeResult {
            multiplier: w.multiplier,
            area: w.area,
            gap: w.gap,
            contact: ContactResult {
                force: w.force,
                slip: w.slip,
                state: w.state as RowState,
            },
        };
        ((w.mortar, w.node as u32, w.component), at)
    };
    all.into_iter().map(one).collect()
}
