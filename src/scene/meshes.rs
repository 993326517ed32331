//! The mesh of a subdomain, with coefficients, springs and given values.

use super::body::Body;
use super::checked::Scene;
use super::coefficient::{by_element, evaluate};
use super::model::field::Field;
use super::model::steps::Factors;
use super::validate::{Quantity, RATIO, SPRING};
use crate::error::Result;
use crate::fem::{self, SubdomainMesh};
use crate::mesh::Block;

impl Scene {
    /// The mesh of subdomain `index`: nodes, which of them are free, values given at the last load step, ρ by element.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for ρ ≤ 0 or not finite, with body and point.
    pub fn subdomain_mesh(&self, index: usize) -> Result<SubdomainMesh> {
        self.mesh_with(index, Factors::last(&self.steps))
    }

    pub(super) fn mesh_with(&self, index: usize, factors: Factors<'_>) -> Result<SubdomainMesh> {
        let scale = factors.dirichlet();
        let (body, block) = self.place(index);
        let whole = body.mesh();
        let c = body.components;
        let n = block.nodes().iter().product::<usize>();
        let mut mesh = SubdomainMesh {
            index,
            body: self.body_of(index).0,
            dim: whole.dim(),
            form: self.form,
            elements: block.elements,
            step: body.spec.map.is_none().then(|| whole.step()),
            points: Vec::with_capacity(n),
            dof: Vec::with_capacity(c * n),
            prescribed: vec![0.0; c * n],
            rho: Vec::new(),
            poisson: Vec::new(),
            spring: Vec::new(),
        };
        let mut next = 0;
        for place in block.places() {
            let on_boundary = whole.sides(place).next().is_some();
            let first = whole.node(place) * c;
            for component in 0..c {
                let given = match on_boundary {
                    true => body.prescribed_at(first + component),
                    false => None,
                };
                match given {
                    Some(value) => {
                        mesh.prescribed[mesh.dof.len()] = value * scale;
                        mesh.dof.push(SubdomainMesh::PRESCRIBED);
                    }
                    None => {
                        mesh.dof.push(next);
                        next += 1;
                    }
                }
            }
            mesh.points.push(body.spec.position(place));
        }
        mesh.rho = by_element(body, &block, &mesh, &body.spec.rho, |value, point| {
            Quantity::coefficient(&self.form).at(&body.spec, value, point)
        })?;
        if self.form.is_elastic() {
            mesh.poisson = by_element(body, &block, &mesh, &body.spec.poisson, |value, point| {
                RATIO.at(&body.spec, value, point)
            })?;
        }
        for (side, stiffness) in &body.spec.springs {
            if reaches(body, &block, *side) {
                add_spring(body, &block, &mut mesh, *side, stiffness)?;
            }
        }
        Ok(mesh)
    }

    /// The nodes of a body that springs support.
    #[cfg(feature = "cli")]
    pub(crate) fn sprung(&self, body: &Body) -> Vec<[usize; 3]> {
        let mesh = body.mesh();
        let held = |stiffness: &Field, place: &[usize; 3]| {
            let block = mesh.block(mesh.owner(*place));
            evaluate(body, &block, stiffness, body.spec.position(*place)) > 0.0
        };
        let sides = body.spec.springs.iter();
        let nodes = sides.flat_map(|(side, k)| mesh.side_nodes(*side).filter(move |p| held(k, p)));
        nodes.collect()
    }

    /// The body of subdomain `index`, and its elements.
    pub(super) fn place(&self, index: usize) -> (&Body, Block) {
        let (body, inside) = self.body_of(index);
        let body = &self.bodies[body];
        (body, body.mesh().block(inside))
    }
}

/// Whether a subdomain has elements at a side of its body.
pub(super) fn reaches(body: &Body, block: &Block, side: usize) -> bool {
    let d = side / 2;
    block.place[d] == [0, body.mesh().subdomains[d] - 1][side % 2]
}

/// Adds ∫ k N_a over a side to the springs of a mesh.
fn add_spring(
    body: &Body,
    block: &Block,
    mesh: &mut SubdomainMesh,
    side: usize,
    stiffness: &Field,
) -> Result<()> {
    let c = mesh.components();
    let mut sums = vec![0.0; mesh.dof.len()];
    let mut bad = None;
    let value = |point: [f64; 3], _normal: [f64; 3]| {
        let k = evaluate(body, block, stiffness, point);
        if !(SPRING.good)(k) {
            bad.get_or_insert((k, point));
        }
        [k, 0.0, 0.0]
    };
    fem::add_side_load(mesh, side, value, &mut sums);
    if let Some((k, point)) = bad {
        SPRING.at(&body.spec, k, point)?;
    }
    mesh.spring.resize(mesh.points.len(), 0.0);
    for (spring, sum) in mesh.spring.iter_mut().zip(sums.chunks_exact(c)) {
        *spring += sum[0];
    }
    Ok(())
}
