//! From a scene to [`Substructures`]: subdomain by subdomain, row by row.

use super::coefficient::{by_element, stiffest};
use super::geometry::topology::{entities, rigid_motions};
use super::model::field::{At, Field};
use super::model::spec::Force;
use super::model::steps::Factors;
use super::validate::{bad_load, bad_spring, checked_poisson, checked_rho};
use super::{Body, Scene, Variables};
use crate::error::Result;
use crate::fem;
use crate::linalg::vec3::{cross, minus};
use crate::mesh::{Block, SubdomainMesh};
use crate::substructures::{Subdomain, Substructures};
use rayon::prelude::*;

impl Scene {
    /// The part of the problem that belongs to the subdomains for which `owns` holds: their matrices, and the rows at
    /// points whose lowest subdomain is among them. With a partition of the subdomains over ranks every row is
    /// provided exactly once.
    ///
    /// Subdomains are assembled in the caller's rayon pool.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for ρ ≤ 0 or a value that is not finite, with body and point.
    pub fn substructures(&self, owns: &dyn Fn(usize) -> bool) -> Result<Substructures> {
        let mine: Vec<usize> = (0..self.n_subdomains()).filter(|&s| owns(s)).collect();
        // All first, then the first error: which one a parallel search meets first is chance.
        let local: Vec<Result<Subdomain>> = mine.par_iter().map(|&s| self.subdomain(s)).collect();
        let local: Result<Vec<Subdomain>> = local.into_iter().collect();
        Ok(Substructures {
            n_bodies: self.n_bodies(),
            n_subdomains: self.n_subdomains(),
            body_names: self.bodies.iter().map(|b| b.spec.name.clone()).collect(),
            local: local?,
            rows: self.rows(owns),
        })
    }

    /// Subdomain `index`: matrix, load of the last load step, numbering, primal vertices. A pure function of the scene.
    ///
    /// # Errors
    /// As [`Scene::substructures`].
    pub fn subdomain(&self, index: usize) -> Result<Subdomain> {
        let mesh = self.subdomain_mesh(index)?;
        self.assemble(&mesh)
    }

    /// Subdomain `mesh.index` on its mesh, for callers that keep the mesh.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for a load that is not finite.
    pub fn assemble(&self, mesh: &SubdomainMesh) -> Result<Subdomain> {
        let (body, block) = self.place(mesh.index);
        let load = self.nodal_load(body, &block, mesh, Factors::last(&self.steps))?;
        let (k, f) = fem::assemble(mesh, &load);
        let whole = body.mesh();
        let n = f.len();
        let c = body.components;
        let mut dofs = Vec::with_capacity(n);
        let mut rho = Vec::with_capacity(n);
        let mut coordinates = Vec::with_capacity(n);
        let mut primal = Vec::new();
        for (node, place) in block.places().enumerate() {
            let own = &mesh.dof[c * node..c * (node + 1)];
            if own.iter().all(|&d| d == SubdomainMesh::PRESCRIBED) {
                continue;
            }
            let stiffest = stiffest(mesh, [0, 1, 2].map(|d| place[d] - block.first[d]));
            let first = body.first_dof + (whole.node(place) * c) as u64;
            for (component, &dof) in own.iter().enumerate() {
                if dof == SubdomainMesh::PRESCRIBED {
                    continue;
                }
                dofs.push(first + component as u64);
                // All blocks of a body are equal, so that vertices of the body's partition are corners of its blocks.
                if whole.is_vertex(place) {
                    primal.push(dof);
                }
                rho.push(stiffest);
                coordinates.push(mesh.points[node]);
            }
        }
        let near_kernel = match c {
            1 => vec![vec![1.0; n]],
            _ => rigid_motions(body, mesh),
        };
        Ok(Subdomain {
            index: mesh.index,
            body: mesh.body,
            entities: entities(mesh, &dofs),
            k,
            f,
            dofs,
            rho,
            primal,
            near_kernel: Some(near_kernel),
            coordinates: Some(coordinates),
        })
    }

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

    /// The mesh of subdomain `index`: nodes, which of them are free, values given at the last load step, ρ by element.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for ρ ≤ 0 or not finite, with body and point.
    pub fn subdomain_mesh(&self, index: usize) -> Result<SubdomainMesh> {
        self.mesh_with(index, Factors::last(&self.steps))
    }

    fn mesh_with(&self, index: usize, factors: Factors<'_>) -> Result<SubdomainMesh> {
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
            checked_rho(&body.spec, &self.form, value, point)
        })?;
        if self.form.is_elastic() {
            mesh.poisson = by_element(body, &block, &mesh, &body.spec.poisson, |value, point| {
                checked_poisson(&body.spec, value, point)
            })?;
        }
        for (side, stiffness) in &body.spec.springs {
            if reaches(body, &block, *side) {
                add_spring(body, &block, &mut mesh, *side, stiffness)?;
            }
        }
        Ok(mesh)
    }

    /// Squares of the error norms (L², H¹ seminorm, energy) of the nodal values on `mesh` against the exact solution;
    /// `None` where the scene has none.
    pub fn error_squares(&self, mesh: &SubdomainMesh, nodal: &[f64]) -> Option<[f64; 3]> {
        let exact = self.exact.as_ref()?;
        let (body, block) = self.place(mesh.index);
        Some(fem::error_squares(mesh, nodal, |point| {
            let at = at(body, &block, point).variables;
            let mut out = ([0.0; 3], [[0.0; 3]; 3]);
            for (i, e) in exact.iter().enumerate() {
                let value = e.eval_gradient(&at);
                (out.0[i], out.1[i]) = (value.value, value.gradient);
            }
            out
        }))
    }

    /// The body of subdomain `index`, and its elements.
    pub(super) fn place(&self, index: usize) -> (&Body, Block) {
        let (body, inside) = self.body_of(index);
        let body = &self.bodies[body];
        (body, body.mesh().block(inside))
    }

    /// The nodal load, checked: what acts inside, and on the sides of the body.
    fn nodal_load(
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

/// Whether a subdomain has elements at a side of its body.
fn reaches(body: &Body, block: &Block, side: usize) -> bool {
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
        if !(k >= 0.0 && k.is_finite()) {
            bad.get_or_insert((k, point));
        }
        [k, 0.0, 0.0]
    };
    fem::add_side_load(mesh, side, value, &mut sums);
    if let Some((k, point)) = bad {
        return bad_spring(&body.spec, k, point);
    }
    mesh.spring.resize(mesh.points.len(), 0.0);
    for (spring, sum) in mesh.spring.iter_mut().zip(sums.chunks_exact(c)) {
        *spring += sum[0];
    }
    Ok(())
}

fn at(body: &Body, block: &Block, point: [f64; 3]) -> At {
    At {
        variables: Variables {
            point,
            body: body.spec.place,
            subdomain: block.place,
        },
        subdomains: body.mesh().subdomains,
    }
}

/// The value of a field at a point of a subdomain.
pub(super) fn evaluate(body: &Body, block: &Block, field: &Field, point: [f64; 3]) -> f64 {
    field.eval(&at(body, block, point))
}
