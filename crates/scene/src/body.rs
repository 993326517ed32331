//! A body of a checked scene.

use std::ops::Range;

use super::model::body::BodySpec;
use base::linalg::vec3::ball;
use mesh::Mesh;

/// A body of a checked scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Its specification as written.
    pub spec: BodySpec,
    /// Number C of components of the field.
    pub components: usize,
    /// Body dof of its first degree of freedom; component c of its node k has the number `first_dof + C k + c`.
    pub first_dof: u64,
    /// Global index of its subdomain 0.
    pub first_subdomain: usize,
    /// Degrees of freedom C k + c with a given value, in increasing order: Dirichlet sides, and nodes that are tied to
    /// such a node of another body. The values do not include the factors of load steps.
    pub prescribed: Vec<(usize, f64)>,
    /// Least and greatest coordinates of its nodes.
    pub bounds: [[f64; 3]; 2],
}

impl Body {
    /// Its mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.spec.mesh
    }

    /// The numbers of its subdomains in the scene.
    pub(super) fn subdomains(&self) -> Range<usize> {
        self.first_subdomain..self.first_subdomain + self.mesh().n_subdomains()
    }

    /// Centre and radius of the ball around its [`Body::bounds`].
    pub fn ball(&self) -> ([f64; 3], f64) {
        ball(self.bounds)
    }

    /// The given value of degree of freedom `dof` = C k + c, if there is one.
    pub fn prescribed_at(&self, dof: usize) -> Option<f64> {
        self.prescribed
            .binary_search_by_key(&dof, |&(n, _)| n)
            .ok()
            .map(|k| self.prescribed[k].1)
    }
}

/// Least and greatest coordinates of the nodes of a body.
pub(super) fn bounds_of(body: &BodySpec) -> [[f64; 3]; 2] {
    if let Some(grid) = body.unbent() {
        return [grid.origin, grid.end()];
    }
    let mut out = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for node in body.mesh.boundary() {
        let point = body.position(node);
        for d in 0..3 {
            out[0][d] = out[0][d].min(point[d]);
            out[1][d] = out[1][d].max(point[d]);
        }
    }
    out
}
