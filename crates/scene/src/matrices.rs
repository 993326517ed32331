//! The matrices of the subdomains: those of subdomains that are alike are one matrix.
//!
//! K follows from elements, coefficients, springs and given degrees of freedom, and does not change with the place. It
//! is made from coordinates before the body is put to its place, so that copies have the same bits.

use std::borrow::Cow;
use std::collections::hash_map::DefaultHasher;
use std::collections::HashMap;
use std::hash::{Hash, Hasher};
use std::sync::{Arc, Mutex, PoisonError};

use super::body::Body;
use super::model::motion::Isometry;
use crate::assembly::{self, SubdomainElements, SubdomainMesh};
use base::linalg::csr::Csr;

/// The matrices that have been made, by hashes of what they follow from. Threads share it.
#[derive(Default)]
pub(super) struct MatrixCache {
    known: Mutex<HashMap<u64, Vec<CachedMatrix>>>,
}

/// A matrix, and what it follows from.
struct CachedMatrix {
    mesh: SubdomainMesh,
    k: Arc<Csr>,
}

impl MatrixCache {
    /// K of a subdomain of `body` on its mesh.
    pub(super) fn of(&self, body: &Body, mesh: &SubdomainMesh, nodes: &[usize]) -> Arc<Csr> {
        let mesh = unplaced(body, mesh, nodes);
        let hash = hash(&mesh);
        let find = |known: &HashMap<u64, Vec<CachedMatrix>>| {
            let mut like = known.get(&hash).into_iter().flatten();
            like.find(|k| is_alike(&k.mesh, &mesh)).map(|k| k.k.clone())
        };
        // A thread that panics does so outside of the lock.
        let lock = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(k) = find(&lock()) {
            return k;
        }
        let k = Arc::new(assembly::matrix(&mesh));
        let mut known = lock();
        // Another thread may have made it meanwhile, with the same bits.
        if let Some(k) = find(&known) {
            return k;
        }
        let mesh = SubdomainMesh {
            prescribed: Vec::new(),
            heat: None,
            ..mesh.into_owned()
        };
        let k_too = k.clone();
        known
            .entry(hash)
            .or_default()
            .push(CachedMatrix { mesh, k });
        k_too
    }
}

/// The mesh of a copy where its body's file or shape has it, and only turned as it is: K does not depend on the shift.
fn unplaced<'m>(body: &Body, mesh: &'m SubdomainMesh, nodes: &[usize]) -> Cow<'m, SubdomainMesh> {
    let spec = &body.spec;
    let Some(motion) = spec.motion.filter(|_| spec.moved.is_none()) else {
        return Cow::Borrowed(mesh);
    };
    let turn = Isometry {
        shift: [0.0; 3],
        ..motion
    };
    let points = nodes.iter().map(|&node| turn.apply(spec.shaped(node)));
    Cow::Owned(SubdomainMesh {
        points: points.collect(),
        ..mesh.clone()
    })
}

/// The positions on which K depends; none for a grid of equal boxes.
fn places(mesh: &SubdomainMesh) -> &[[f64; 3]] {
    match &mesh.elements {
        SubdomainElements::Grid(grid) if grid.step.is_some() => &[],
        _ => &mesh.points,
    }
}

/// A hash of what [`is_alike`] compares.
fn hash(mesh: &SubdomainMesh) -> u64 {
    let mut state = DefaultHasher::new();
    let numbers = |numbers: &[f64], state: &mut DefaultHasher| {
        numbers.len().hash(state);
        numbers.iter().for_each(|v| v.to_bits().hash(state));
    };
    match &mesh.elements {
        SubdomainElements::Grid(grid) => grid.elements.hash(&mut state),
        SubdomainElements::Cells(cells) => cells.len().hash(&mut state),
    }
    mesh.dof.hash(&mut state);
    for point in places(mesh) {
        numbers(point, &mut state);
    }
    mesh.laws.of.hash(&mut state);
    for tangent in &mesh.laws.tangents {
        numbers(tangent.0.as_flattened(), &mut state);
    }
    for coefficients in [&mesh.rho, &mesh.poisson, &mesh.spring] {
        numbers(coefficients, &mut state);
    }
    state.finish()
}

/// Whether two subdomains have the same matrix, to the last bit.
fn is_alike(a: &SubdomainMesh, b: &SubdomainMesh) -> bool {
    (a.dim, a.form) == (b.dim, b.form)
        && a.elements == b.elements
        && a.dof == b.dof
        && places(a) == places(b)
        && a.rho == b.rho
        && a.poisson == b.poisson
        && a.laws == b.laws
        && a.spring == b.spring
        && a.integration == b.integration
}

#[cfg(test)]
#[path = "../tests/matrices.rs"]
mod tests;
