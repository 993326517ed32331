//! Properties of the node of a body in a scene.

use super::points::DirectionalValue;
use crate::body::Body;
use fetifeti::problem::BodyNode;

/// Properties of a node, as the `bodies` of a scene have them.
pub trait AtNode {
    /// u along `direction` at this member.
    fn along(&self, bodies: &[Body], direction: [f64; 3]) -> DirectionalValue;

    /// The given value, if there is one.
    fn given(&self, bodies: &[Body], component: usize) -> Option<f64>;

    /// Its position.
    fn position(&self, bodies: &[Body]) -> [f64; 3];

    /// Its body dof.
    fn dof(&self, bodies: &[Body], component: usize) -> u64;

    /// The position as messages name it.
    fn spot(&self, bodies: &[Body]) -> String;
}

impl AtNode for BodyNode {
    fn along(&self, bodies: &[Body], direction: [f64; 3]) -> DirectionalValue {
        let mut out = DirectionalValue {
            terms: Vec::new(),
            given: 0.0,
        };
        for (c, n) in direction.into_iter().enumerate() {
            // Components of this size are rounding errors in the normals of curved sides.
            if c >= bodies[self.body].components || n.abs() < 1e-14 {
                continue;
            }
            match self.given(bodies, c) {
                Some(value) => out.given += n * value,
                None => out.terms.push((self.dof(bodies, c), n)),
            }
        }
        out
    }

    fn given(&self, bodies: &[Body], component: usize) -> Option<f64> {
        let body = &bodies[self.body];
        body.prescribed_at(self.node * body.components + component)
    }

    fn position(&self, bodies: &[Body]) -> [f64; 3] {
        bodies[self.body].spec.position(self.node)
    }

    fn dof(&self, bodies: &[Body], component: usize) -> u64 {
        let body = &bodies[self.body];
        body.first_dof + (self.node * body.components + component) as u64
    }

    fn spot(&self, bodies: &[Body]) -> String {
        bodies[self.body].spec.spot(self.node)
    }
}
