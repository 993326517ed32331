//! Additional vertices: enough that each large subdomain in space is held by them alone.
//!
//! Averages hold a subdomain in S_Π, but not in K_rr, which is K without the vertices. Without enough of these K_rr is
//! singular, so that the method needs dense matrices of the subdomain, which take far longer where it is large. Parts
//! of a mesh at the surface of a body may have one or two vertices. Nodes of their faces are added one by one; each is
//! the node that moves most in the motions that no vertex detects, which spreads the nodes.

use std::collections::BTreeSet;

use super::classes::InterfaceClass;
use super::motions::NearKernels;
use super::parts::TornSubdomain;
use super::rigid_constraints::{moves_most, norm, ConstraintContext, Span, SEEN};
use super::sharing::Sharers;
use super::torn::Torn;
use crate::feti::cost::forms::is_short;
use base::linalg::sorted::distinct;

impl NearKernels {
    /// Adds to the dofs `nodes` of every local subdomain that are primal beside the vertices of `classes`.
    pub fn hold_alone(
        &self,
        torn: &Torn,
        parts: &[TornSubdomain],
        sharers: &Sharers,
        classes: &[Vec<InterfaceClass>],
        shape: &ConstraintContext,
        nodes: &mut [BTreeSet<u32>],
    ) {
        if !shape.space {
            return;
        }
        for (j, part) in parts.iter().enumerate() {
            let interface: usize = classes[j].iter().map(|c| c.dofs.len()).sum();
            // Those with a small interface have dense matrices anyway.
            if is_short(interface) {
                continue;
            }
            let free = self.free(j);
            let body = shape.bodies.of((sharers.first + j) as u32);
            let inside = |class: &&InterfaceClass| {
                let same = |s: &&u32| shape.bodies.of(**s) == body;
                class.sharers.iter().filter(same).count() > 1
            };
            let row = |i: u32| -> Vec<f64> { free.iter().map(|x| x[i as usize]).collect() };
            let mut span = Span::default();
            let shared = classes[j].iter().filter(inside);
            let vertices = shared.clone().filter(|c| c.is_vertex());
            let vertices = vertices.flat_map(|c| &c.dofs).chain(&nodes[j]);
            vertices.for_each(|&i| span.add(row(i), SEEN));
            let faces = shared.filter(|c| c.sharers.len() == 2);
            let dofs = distinct(faces.flat_map(|c| &c.dofs).copied());
            while span.rank() < free.len() {
                let seen = |i: u32| norm(&span.rest(row(i)));
                let best = moves_most(torn, part, &dofs, seen);
                let Some(best) = best.filter(|node| node.iter().any(|&i| seen(i) > SEEN)) else {
                    break;
                };
                for &i in best {
                    span.add(row(i), SEEN);
                    nodes[j].insert(i);
                }
            }
        }
    }
}
