//! Subdomains of [`Problem`](crate::Problem), from parts, classes and additional constraints.

use super::classes::InterfaceClass;
use super::kernels::KernelVectors;
use super::parts::{body_dof, TornSubdomain};
use super::rigid_constraints::ConstraintContext;
use crate::substructures::{Entity, EntityKind, Subdomain};
use std::collections::BTreeSet;

/// Properties of a part besides its matrix.
pub struct SubdomainProperties<'a> {
    /// Its number among the subdomains of all ranks.
    pub index: usize,
    /// Motions without energy.
    pub near_kernel: Option<KernelVectors>,
    /// Where they are not known, those of its matrix.
    pub own_kernel: KernelVectors,
    /// Vertices, edges and faces.
    pub classes: &'a [InterfaceClass],
    /// Pairs of subdomains whose common faces get an average, as edges do.
    pub averaged: &'a BTreeSet<(u32, u32)>,
    /// Local dofs that are primal in addition to the vertices.
    pub nodes: &'a BTreeSet<u32>,
}

/// The subdomain, without a load; `n_global` is the number of global dofs. The matrix is taken out of the part.
pub fn subdomain(
    n_global: usize,
    part: &mut TornSubdomain,
    shape: &ConstraintContext,
    known: SubdomainProperties,
) -> Subdomain {
    let body = shape.bodies.of(known.index as u32);
    let (vertices, others): (Vec<&InterfaceClass>, Vec<&InterfaceClass>) =
        known.classes.iter().partition(|c| c.is_vertex());
    let vertices = vertices.iter().flat_map(|c| &c.dofs);
    let primal: BTreeSet<u32> = vertices.chain(known.nodes).copied().collect();
    let entity = |c: &&InterfaceClass| Entity {
        kind: match c.sharers[..] {
            [a, b] if known.averaged.contains(&(a, b)) => EntityKind::Edge,
            _ => c.kind(shape.space),
        },
        key: body_dof(n_global, body, c.root),
        dofs: c.dofs.clone(),
        whole: c.whole.into(),
    };
    let number = |&dof: &u32| body_dof(n_global, body, dof);
    Subdomain {
        idle: Vec::new(),
        index: known.index,
        body,
        f: vec![0.0; part.dofs.len()],
        dofs: part.dofs.iter().map(number).collect(),
        rho: part.k.diagonal(),
        k: std::mem::take(&mut part.k).into(),
        primal: primal.into_iter().collect(),
        entities: others.iter().map(entity).collect(),
        near_kernel: known.near_kernel,
        own_kernel: known.own_kernel,
        coordinates: None,
    }
}
