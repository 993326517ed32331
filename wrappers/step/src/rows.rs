//! Rows between bodies as C sees them.

use std::ffi::c_int;

use fetifeti::solution::SolvedRow;

/// FetiFetiStepRow of `wrappers/step/fetifeti_step.h`.
#[repr(C)]
pub struct ContactRow {
    body: [c_int; 2],
    node: [c_int; 2],
    x: [f64; 3],
    normal: [f64; 3],
    multiplier: f64,
    gap: f64,
    area: f64,
    inequality: c_int,
    active: c_int,
}

impl ContactRow {
    /// The row in the form of C.
    pub fn new(row: &SolvedRow) -> ContactRow {
        let members = row.label.members;
        ContactRow {
            body: members.map(|m| m.map_or(-1, |m| m.body as c_int)),
            node: members.map(|m| m.map_or(-1, |m| m.node as c_int)),
            x: row.label.point,
            normal: row.normal(),
            multiplier: row.multiplier,
            gap: row.gap,
            area: row.label.area,
            inequality: row.is_inequality().into(),
            active: row.holds().into(),
        }
    }
}
