//! Rows between bodies as C sees them.

use petsc::PetscInt;
use std::collections::HashMap;

use fetifeti::problem::{BodyNode, RowSource};
use fetifeti::solution::{RowState, SolvedRow};

/// A row holds, or a node of it: FETIFETI_OPEN and the others of `wrappers/step/fetifeti_step.h`.
const OPEN: PetscInt = 0;
const HOLDS: PetscInt = 1;
const STICKS: PetscInt = 2;
const SLIPS: PetscInt = 3;

/// FetiFetiStepRow of `wrappers/step/fetifeti_step.h`.
#[repr(C)]
pub struct ContactRow {
    body: [PetscInt; 2],
    node: [PetscInt; 2],
    x: [f64; 3],
    normal: [f64; 3],
    multiplier: f64,
    gap: f64,
    area: f64,
    friction: [f64; 3],
    slip: [f64; 3],
    inequality: PetscInt,
    active: PetscInt,
    state: PetscInt,
}

impl ContactRow {
    /// A row in the form of C, with the tangential rows at its node.
    fn new(row: &SolvedRow, tangential: &[SolvedRow]) -> ContactRow {
        let members = row.label.members;
        let mut out = ContactRow {
            body: members.map(|m| m.map_or(-1, |m| m.body as PetscInt)),
            node: members.map(|m| m.map_or(-1, |m| m.node as PetscInt)),
            x: row.label.point,
            normal: row.normal(),
            multiplier: row.multiplier,
            gap: row.gap,
            area: row.label.area,
            friction: [0.0; 3],
            slip: [0.0; 3],
            inequality: row.is_inequality().into(),
            active: row.holds().into(),
            state: if row.holds() { HOLDS } else { OPEN },
        };
        for along in tangential {
            for (c, t) in along.normal().into_iter().enumerate() {
                out.friction[c] += along.multiplier * t;
                out.slip[c] -= along.gap * t;
            }
            match along.state {
                RowState::Sticks => out.state = STICKS,
                RowState::Slips => out.state = SLIPS,
                _ => {}
            }
        }
        out
    }

    /// Rows in the form of C, with those `tangential` rows that are at their nodes.
    pub fn all(rows: &[SolvedRow], tangential: &[SolvedRow]) -> Vec<ContactRow> {
        type Sides = (RowSource, [Option<BodyNode>; 2]);
        let sides = |row: &SolvedRow| -> Sides { (row.label.source, row.label.members) };
        let mut beside: HashMap<Sides, Vec<SolvedRow>> = HashMap::new();
        for row in tangential {
            beside.entry(sides(row)).or_default().push(*row);
        }
        let of = |row: &SolvedRow| {
            let found = beside.get(&sides(row)).filter(|_| row.is_inequality());
            ContactRow::new(row, found.map_or(&[], |found| found))
        };
        rows.iter().map(of).collect()
    }
}
