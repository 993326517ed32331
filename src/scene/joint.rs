//! From a scene to [`Substructures`]: subdomain by subdomain, row by row.

use super::field::{At, Field};
use super::steps::Factors;
use super::validate::{bad_load, checked_rho};
use super::{Body, Scene, Variables};
use crate::error::Result;
use crate::fem;
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
        let local: Result<Vec<Subdomain>> = mine.par_iter().map(|&s| self.subdomain(s)).collect();
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
        let (mut dofs, mut rho, mut coordinates) = (
            Vec::with_capacity(n),
            Vec::with_capacity(n),
            Vec::with_capacity(n),
        );
        let mut primal = Vec::new();
        let [nx, ny] = mesh.elements;
        for (node, &dof) in mesh.dof.iter().enumerate() {
            if dof == SubdomainMesh::PRESCRIBED {
                continue;
            }
            let (i, j) = (node % (nx + 1), node / (nx + 1));
            let place = [block.first[0] + i, block.first[1] + j];
            dofs.push(body.first_dof + whole.node(place) as u64);
            // All blocks of a body are equal, so that vertices of the body's partition are corners of its blocks.
            if (i == 0 || i == nx) && (j == 0 || j == ny) {
                primal.push(dof);
            }
            let mut largest = 0.0_f64;
            for e in j.saturating_sub(1)..=j.min(ny - 1) {
                for &value in &mesh.rho[e * nx + i.saturating_sub(1)..=e * nx + i.min(nx - 1)] {
                    largest = largest.max(value);
                }
            }
            rho.push(largest);
            let [x, y] = mesh.points[node];
            coordinates.push([x, y, 0.0]);
        }
        Ok(Subdomain {
            index: mesh.index,
            body: mesh.body,
            k,
            f,
            dofs,
            rho,
            primal,
            entities: Vec::new(),
            near_kernel: Some(vec![vec![1.0; n]]),
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

    /// ∫ f over subdomain `index` at load step `step`, by the quadrature of its load.
    ///
    /// # Errors
    /// As [`Scene::loads`].
    pub fn resultant(&self, index: usize, step: usize) -> Result<f64> {
        let factors = Factors::of(&self.steps, step)?;
        let mesh = self.mesh_with(index, factors)?;
        let (body, block) = self.place(index);
        Ok(self.nodal_load(body, &block, &mesh, factors)?.iter().sum())
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
        let [nx, ny] = block.elements;
        let step = whole.step();
        let n = (nx + 1) * (ny + 1);
        let mut mesh = SubdomainMesh {
            index,
            body: self.body_of(index).0,
            elements: block.elements,
            step,
            points: Vec::with_capacity(n),
            dof: Vec::with_capacity(n),
            prescribed: vec![0.0; n],
            rho: Vec::with_capacity(nx * ny),
        };
        let mut next = 0;
        for j in block.first[1]..=block.first[1] + ny {
            for i in block.first[0]..=block.first[0] + nx {
                let place = [i, j];
                let on_boundary = whole.sides(place).next().is_some();
                let given = if on_boundary {
                    body.prescribed_at(whole.node(place))
                } else {
                    None
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
                mesh.points.push(whole.position(place));
            }
        }
        let rho = &body.spec.rho;
        let middle = |i: usize, j: usize| {
            let [x, y] = mesh.points[j * (nx + 1) + i];
            [x + 0.5 * step[0], y + 0.5 * step[1]]
        };
        if rho.is_constant_by_subdomain() {
            let point = middle(0, 0);
            let value = checked_rho(&body.spec, evaluate(body, &block, rho, point), point)?;
            mesh.rho = vec![value; nx * ny];
        } else {
            for j in 0..ny {
                for i in 0..nx {
                    let point = middle(i, j);
                    let value = evaluate(body, &block, rho, point);
                    mesh.rho.push(checked_rho(&body.spec, value, point)?);
                }
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
            let value = exact.eval_gradient(&at(body, &block, point).variables);
            (value.value, value.gradient)
        }))
    }

    fn place(&self, index: usize) -> (&Body, Block) {
        let (body, inside) = self.body_of(index);
        let body = &self.bodies[body];
        (body, body.mesh().block(inside))
    }

    /// The nodal load, checked.
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
        let mut checked = |value: f64, point: [f64; 2]| {
            let value = value * scale;
            if !value.is_finite() {
                bad.get_or_insert((value, point));
            }
            value
        };
        let out = if load.field.is_constant_by_subdomain() {
            let point = mesh.points[0];
            let value = checked(evaluate(body, block, &load.field, point), point);
            if value == 0.0 {
                vec![0.0; mesh.points.len()]
            } else {
                fem::load_vector(mesh, load.quadrature, |_, _| value)
            }
        } else {
            fem::load_vector(mesh, load.quadrature, |_, point| {
                checked(evaluate(body, block, &load.field, point), point)
            })
        };
        match bad {
            Some((value, point)) => bad_load(&body.spec, value, point),
            None => Ok(out),
        }
    }
}

fn at(body: &Body, block: &Block, point: [f64; 2]) -> At {
    At {
        variables: Variables {
            point,
            body: body.spec.place,
            subdomain: block.place,
        },
        subdomains: body.mesh().subdomains,
    }
}

fn evaluate(body: &Body, block: &Block, field: &Field, point: [f64; 2]) -> f64 {
    field.eval(&at(body, block, point))
}
