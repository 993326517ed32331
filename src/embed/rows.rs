//! Ties between bodies: where several bodies share a global dof, their displacements are equal.

use super::bodies::Bodies;
use super::contact::HostContact;
use super::parts::{body_dof, TornSubdomain};
use super::sharing::Sharers;
use crate::substructures::{BodyNode, Law, Row, RowLabel, RowSource};
use base::linalg::sorted::distinct;
use parallel::exchange::exchange;
use petsc::Session;

/// The rows u_a − u_b = 0 for every pair of bodies a < b at every dof. The rank of the dof's lowest subdomain provides
/// them, or the rank that holds the host's rows with this dof. Collective.
pub fn rows(
    session: &Session,
    n_global: usize,
    parts: &[TornSubdomain],
    sharers: &Sharers,
    bodies: &Bodies,
    contact: &HostContact,
) -> Vec<Row> {
    let tie = |a: u32, b: u32, dof: u32| Row {
        terms: vec![
            (body_dof(n_global, a as usize, dof), 1.0),
            (body_dof(n_global, b as usize, dof), -1.0),
        ],
        gap: 0.0,
        law: Law::Tie,
        holds: true,
        block: u64::from(contact.block(dof).unwrap_or(dof)),
        compliance: 0.0,
        rounding: 0.0,
        label: RowLabel::new(
            RowSource::Interface(dof as usize),
            [a, b].map(|body| {
                Some(BodyNode {
                    body: body as usize,
                    node: dof as usize,
                })
            }),
        ),
    };
    let mut out = Vec::new();
    let mut elsewhere: Vec<Vec<[u32; 3]>> = vec![Vec::new(); session.size()];
    for (j, part) in parts.iter().enumerate() {
        let me = (sharers.first + j) as u32;
        for &dof in &part.dofs {
            let who = sharers.of(dof);
            if who.first() != Some(&me) {
                continue;
            }
            let here = distinct(who.iter().map(|&s| bodies.of(s) as u32));
            for (k, &a) in here.iter().enumerate() {
                for &b in &here[k + 1..] {
                    match contact.block(dof) {
                        None => out.push(tie(a, b, dof)),
                        Some(root) => {
                            elsewhere[root as usize % session.size()].push([a, b, dof]);
                        }
                    }
                }
            }
        }
    }
    if contact.n_global > 0 {
        let received = exchange(session.comm(), elsewhere).into_iter();
        out.extend(received.map(|[a, b, dof]| tie(a, b, dof)));
    }
    out
}
