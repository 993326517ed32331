//! Equations between displacements, beside those of ties: rows of B_gl with any number of terms.

use crate::rows::at_node::AtNode;
use std::collections::HashMap;

use super::points::InterfacePoint;
use crate::body::Body;
use crate::model::entry::EntryId;
use crate::model::joints::EquationSpec;
use crate::validate::agree;
use base::linalg::union_find::UnionFind;
use base::{Error, Result};

/// An equation Σ coefficient · u(body dof) = value.
#[derive(Debug, Clone, PartialEq)]
pub struct Equation {
    /// (body dof, coefficient) of the free degrees of freedom.
    pub terms: Vec<(u64, f64)>,
    /// (body dof, coefficient) of those that are given.
    pub held: Vec<(u64, f64)>,
    /// Whether it is a given displacement along an oblique axis: its forces are reactions.
    pub support: bool,
    /// The right-hand side without the given values.
    pub value: f64,
    /// Σ coefficient · u of the given values, without the factors of load steps.
    pub given: f64,
    /// One unit in the last digit of its coefficients; 0 where they are exact.
    pub resolution: f64,
    /// Its block: rows with a degree of freedom in common have the same.
    pub block: u64,
    /// The subdomain of lowest index that has a degree of freedom of the block.
    pub subdomain: usize,
}

/// The equations of a scene, each a block of its own.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) where all terms of an equation are given and contradict it.
pub(crate) fn collect(bodies: &[Body], specs: &[EquationSpec]) -> Result<Vec<Equation>> {
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
        out.push(Equation {
            terms,
            held,
            support: spec.support,
            value: spec.value,
            given,
            resolution: spec.resolution,
            block,
            subdomain,
        });
    }
    Ok(out)
}

/// A row of many terms, with the block and the subdomain that it gets.
pub(crate) struct Chain<'a> {
    pub terms: &'a [(u64, f64)],
    pub block: &'a mut u64,
    pub subdomain: &'a mut usize,
}

/// Gives rows with common degrees of freedom one block and one subdomain, the lowest of each.
pub(crate) fn join(bodies: &[Body], points: &mut [InterfacePoint], chains: &mut [Chain<'_>]) {
    if chains.is_empty() {
        return;
    }
    let mut sets = UnionFind::new(points.len() + chains.len());
    let mut of_dof: HashMap<u64, usize> = HashMap::new();
    for (p, point) in points.iter().enumerate() {
        for member in &point.members {
            for c in 0..bodies[member.body].components {
                of_dof.insert(member.dof(bodies, c), p);
            }
        }
    }
    for (e, chain) in chains.iter().enumerate() {
        for (dof, _) in chain.terms {
            let known = *of_dof.entry(*dof).or_insert(points.len() + e);
            sets.join(known, points.len() + e);
        }
    }
    let n = points.len();
    let mut lowest: HashMap<usize, (u64, usize)> = HashMap::new();
    let each = points.iter().map(|p| (p.block, p.subdomain));
    let all = each.chain(chains.iter().map(|c| (*c.block, *c.subdomain)));
    for (k, (block, subdomain)) in all.enumerate() {
        let low = lowest.entry(sets.find(k)).or_insert((block, subdomain));
        *low = (low.0.min(block), low.1.min(subdomain));
    }
    for (p, point) in points.iter_mut().enumerate() {
        (point.block, point.subdomain) = lowest[&sets.find(p)];
    }
    for (e, chain) in chains.iter_mut().enumerate() {
        (*chain.block, *chain.subdomain) = lowest[&sets.find(n + e)];
    }
    points.sort_by_key(|p| p.block);
}
