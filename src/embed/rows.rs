//! Ties: where several bodies hold a global dof, their displacements are equal.

use super::parts::Part;
use super::sharing::Sharers;
use crate::substructures::{InterfaceRow, RowKind};

/// The number of a global dof as one body sees it.
pub fn body_dof(n_global: usize, body: usize, dof: u32) -> u64 {
    body as u64 * n_global as u64 + u64::from(dof)
}

/// u_a − u_b = 0 for every pair of bodies a < b at every dof; provided by the rank of the dof's lowest subdomain.
pub fn rows(
    n_global: usize,
    parts: &[Part],
    sharers: &Sharers,
    body_of: &[usize],
) -> Vec<InterfaceRow> {
    let mut out = Vec::new();
    for (j, part) in parts.iter().enumerate() {
        let me = (sharers.first + j) as u32;
        for &dof in &part.dofs {
            let who = sharers.of(dof);
            if who.first() != Some(&me) {
                continue;
            }
            let mut bodies: Vec<usize> = who.iter().map(|&s| body_of[s as usize]).collect();
            bodies.sort_unstable();
            bodies.dedup();
            for (k, &a) in bodies.iter().enumerate() {
                for &b in &bodies[k + 1..] {
                    out.push(InterfaceRow {
                        terms: vec![
                            (body_dof(n_global, a, dof), 1.0),
                            (body_dof(n_global, b, dof), -1.0),
                        ],
                        gap: 0.0,
                        kind: RowKind::Equality,
                        holds: true,
                        block: u64::from(dof),
                    });
                }
            }
        }
    }
    out
}
