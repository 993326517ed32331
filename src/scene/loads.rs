//! Loads of a subdomain, step by step.

use super::body::Body;
use super::checked::Scene;
use super::coefficient::evaluate;
use super::meshes::reaches;
use super::model::field::Field;
use super::model::spec::Force;
use super::model::steps::Factors;
use super::validate::bad_load;
use crate::error::Result;
use crate::fem;
use crate::linalg::vec3::{cross, minus};
use crate::mesh::{Block, SubdomainMesh};

impl Scene {
    /// The load f of subdomain `index` at load step `step` (0 is the only one without `[steps]`), given values eliminated;
    /// at the last step that of [`Scene::subdomain`] to the last bit.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for a load that is not finite, or a step that the scene does not have.
    pub fn loads(&self, index: usize, step: usize) -> Result<Vec<f64>> {
        let factors = Factors::of(&self.steps, step)?;
        let mesh = self.mesh_with(index, factors)?;
        let (body, block) = self.place(index);
        let load = self.nodal_load(body, &block, &mesh, factors)?;
        Ok(fem::free_load(&mesh, &load))
    }

    /// The sum of all loads on subdomain `index` at load step `step`, by components, those of its sides included, and their moment
    /// about `centre`.
    ///
    /// # Errors
    /// As [`Scene::loads`].
    pub fn wrench(
        &self,
        index: usize,
        step: usize,
        centre: [f64; 3],
    ) -> Result<([f64; 3], [f64; 3])> {
        let factors = Factors::of(&self.steps, step)?;
        let mesh = self.mesh_with(index, factors)?;
        let (body, block) = self.place(index);
        let load = self.nodal_load(body, &block, &mesh, factors)?;
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for (node, at) in load.chunks_exact(body.components).zip(&mesh.points) {
            let mut f = [0.0; 3];
            f[..node.len()].copy_from_slice(node);
            let turn = cross(minus(*at, centre), f);
            for d in 0..3 {
                force[d] += f[d];
                moment[d] += turn[d];
            }
        }
        Ok((force, moment))
    }

    /// The factor of given values at load step `step` ([`SubdomainMesh::prescribed`] has that of the last step).
    ///
    /// # Panics
    /// For a step that the scene does not have.
    pub fn prescribed_factor(&self, step: usize) -> f64 {
        let factors = Factors::of(&self.steps, step);
        factors.expect("the step exists").dirichlet()
    }

    /// Number of load steps; 1 without `[steps]`.
    pub fn n_steps(&self) -> usize {
        self.steps.as_ref().map_or(1, |s| s.times.len())
    }

    /// The nodal load, checked: what acts inside, and on the sides of the body.
    pub(super) fn nodal_load(
        &self,
        body: &Body,
        block: &Block,
        mesh: &SubdomainMesh,
        factors: Factors<'_>,
    ) -> Result<Vec<f64>> {
        let load = &body.spec.load;
        let scale = factors.load(body.spec.ramp.as_ref());
        let mut bad = None;
        let mut value = |fields: &[Field], point: [f64; 3]| {
            let mut out = [0.0; 3];
            for (o, field) in out.iter_mut().zip(fields) {
                *o = evaluate(body, block, field, point) * scale;
                if !o.is_finite() {
                    bad.get_or_insert((*o, point));
                }
            }
            out
        };
        let fields = &load.fields;
        let mut out = if fields.iter().all(Field::is_constant_by_subdomain) {
            let constant = value(fields, mesh.points[0]);
            if constant == [0.0; 3] {
                vec![0.0; mesh.dof.len()]
            } else {
                fem::load_vector(mesh, load.quadrature, |_, _| constant)
            }
        } else {
            fem::load_vector(mesh, load.quadrature, |_, point| value(fields, point))
        };
        for load in &body.spec.surface {
            if !reaches(body, block, load.side) {
                continue;
            }
            let force = |point: [f64; 3], normal: [f64; 3]| match &load.force {
                Force::Traction(fields) => value(fields, point),
                Force::Pressure(p) => {
                    let [p, ..] = value(std::slice::from_ref(p), point);
                    normal.map(|n| 0.0 - p * n)
                }
            };
            fem::add_side_load(mesh, load.side, force, &mut out);
        }
        match bad {
            Some((value, point)) => bad_load(&body.spec, value, point),
            None => Ok(out),
        }
    }
}
