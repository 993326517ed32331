//! Equations between displacements, beside those of ties: rows of B_gl with any number of terms.

use crate::rows::at_node::AtNode;
use std::collections::HashMap;

use super::points::InterfacePoint;
use super::row::{Combination, Row};
use crate::body::Body;
use crate::model::entry::EntryId;
use crate::model::joints::EquationSpec;
use crate::validate::agree;
use base::linalg::union_find::UnionFind;
use base::{Error, Result};
use fetifeti::problem::RowSource;

/// The equations of a scene, each a block of its own.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) where all terms of an equation are given and contradict it.
pub(crate) fn collect(bodies: &[Body], specs: &[EquationSpec]) -> Result<Vec<Row>> {
    let mut out = Vec::with_capacity(specs.len());
    if specs.is_empty() {
        return Ok(out);
    }
    for (number, spec) in specs.iter().enumerate() {
        let mut terms: Vec<(u64, f64)> = Vec::new();
        let (mut held, mut given) = (Vec::new(), 0.0);
        let mut first: Option<(u64, usize)> = None;
        for &(b, dof, factor) in &spec.terms {
            let body = &bodies[b];
            let of_body = body.first_dof + dof as u64;
            if let Some(value) = body.prescribed_at(dof) {
                given += factor * value;
                held.push((of_body, factor));
                continue;
            }
            match terms.iter_mut().find(|t| t.0 == of_body) {
                Some(term) => term.1 += factor,
                None => terms.push((of_body, factor)),
            }
            let owner = body.first_subdomain + body.mesh().owner(dof / body.components);
            first = Some(match first {
                None => (of_body, owner),
                Some((low, s)) => (low.min(of_body), s.min(owner)),
            });
        }
        let Some((block, subdomain)) = first else {
            if !agree(given, spec.value) {
                return Err(Error::input(format!(
                    "the given values make {given} of {}, which asks for {}",
                    EntryId::Equation(number),
                    spec.value
                ))
                .at(&spec.location));
            }
            continue;
        };
        let source = RowSource::Equation(out.len());
        let tie = Row::tie(source, 0, [None; 2], [0.0; 3], (block, subdomain));
        let row = tie.equal_to(spec.value, [given, 0.0]);
        out.push(row.with_terms(Combination {
            terms,
            held,
            support: spec.support,
            resolution: spec.resolution,
            ..Combination::default()
        }));
    }
    Ok(out)
}

/// Gives rows with common degrees of freedom one block and one subdomain, the lowest of each. `rows` are those at the
/// points, and stay in their order; `chained` lead from point to point, and those that slide have tangential rows, with
/// all components at their nodes.
pub(crate) fn join(
    bodies: &[Body],
    points: &mut [InterfacePoint],
    rows: &mut [Row],
    chained: &mut [Row],
    slides: impl Fn(&Row) -> bool,
) {
    if chained.is_empty() {
        return;
    }
    let mut sets = UnionFind::new(points.len() + chained.len());
    let mut of_dof: HashMap<u64, usize> = HashMap::new();
    for (p, point) in points.iter().enumerate() {
        for member in &point.members {
            for c in 0..bodies[member.body].components {
                of_dof.insert(member.dof(bodies, c), p);
            }
        }
    }
    for (e, row) in chained.iter().enumerate() {
        let mut dofs: Vec<u64> = row.terms(bodies).iter().map(|t| t.0).collect();
        if slides(row) {
            let nodes = [0, 1].into_iter().flat_map(|side| row.side(side));
            for (node, _) in nodes {
                let components = 0..bodies[node.body].components;
                dofs.extend(components.map(|c| node.dof(bodies, c)));
            }
        }
        for dof in dofs {
            let known = *of_dof.entry(dof).or_insert(points.len() + e);
            sets.join(known, points.len() + e);
        }
    }
    let n = points.len();
    let mut lowest: HashMap<usize, (u64, usize)> = HashMap::new();
    let each = points.iter().map(|p| (p.block, p.subdomain));
    let all = each.chain(chained.iter().map(|r| (r.block, r.subdomain)));
    for (k, (block, subdomain)) in all.enumerate() {
        let low = lowest.entry(sets.find(k)).or_insert((block, subdomain));
        *low = (low.0.min(block), low.1.min(subdomain));
    }
    let mut joined: HashMap<u64, (u64, usize)> = HashMap::new();
    for (p, point) in points.iter_mut().enumerate() {
        let low = lowest[&sets.find(p)];
        joined.insert(point.block, low);
        (point.block, point.subdomain) = low;
    }
    for row in rows.iter_mut() {
        (row.block, row.subdomain) = joined[&row.block];
    }
    for (e, row) in chained.iter_mut().enumerate() {
        (row.block, row.subdomain) = lowest[&sets.find(n + e)];
    }
    rows.sort_by_key(|row| row.block);
    points.sort_by_key(|p| p.block);
}
