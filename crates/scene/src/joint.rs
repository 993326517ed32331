//! From a scene to [`Problem`]: subdomain by subdomain, row by row.

use super::checked::Scene;
use super::coefficient::{at, stiffest};
use super::geometry::topology::{entities, rigid_motions};
use super::matrices::MatrixCache;
use super::model::steps::Factors;
use crate::assembly::{self, SubdomainMesh};
use base::Result;
use fetifeti::{Problem, Subdomain};
use rayon::prelude::*;

impl Scene {
    /// The part of the problem that belongs to the subdomains for which `owns` holds: their matrices, and the rows at
    /// points whose lowest subdomain is among them. With a partition of the subdomains over ranks every row is
    /// provided exactly once.
    ///
    /// Subdomains are assembled in the caller's rayon pool.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for ρ ≤ 0 or a value that is not finite, with body and point.
    pub fn substructures(&self, owns: &dyn Fn(usize) -> bool) -> Result<Problem> {
        self.check_areas(owns)?;
        let mine: Vec<usize> = (0..self.n_subdomains()).filter(|&s| owns(s)).collect();
        let matrices = MatrixCache::default();
        // Assembles all subdomains, then reports the first error in their order: the first error in time would be
        // random.
        let local: Vec<Result<Subdomain>> = mine
            .par_iter()
            .map(|&s| self.assemble_with(&self.subdomain_mesh(s)?, &matrices))
            .collect();
        let local: Result<Vec<Subdomain>> = local.into_iter().collect();
        let names = self.bodies.iter().map(|b| b.spec.name.as_str());
        let mut problem = Problem::new(names, self.n_subdomains())
            .with_subdomains(local?)
            .with_rows(self.solver_rows(owns))
            .with_friction(self.friction_nodes(owns));
        (problem.ragged, problem.weak) = (self.is_ragged(), self.weak_bodies());
        Ok(problem)
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
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a load that is not finite.
    pub fn assemble(&self, mesh: &SubdomainMesh) -> Result<Subdomain> {
        self.assemble_with(mesh, &MatrixCache::default())
    }

    /// Subdomain `mesh.index` on its mesh; `matrices` may have its stiffness matrix already.
    fn assemble_with(&self, mesh: &SubdomainMesh, matrices: &MatrixCache) -> Result<Subdomain> {
        let (body, inside) = self.place(mesh.index);
        let load = self.nodal_load(mesh, Factors::last(&self.steps))?;
        let f = if mesh.prescribed.iter().all(|u| *u == 0.0) {
            mesh.free(&load)
        } else {
            assembly::free_load(mesh, &assembly::given_columns(mesh), &load)
        };
        let whole = body.mesh();
        let nodes = whole.subdomain_nodes(inside);
        let k = matrices.of(body, mesh, &nodes);
        let n = f.len();
        let c = body.components;
        let mut dofs = Vec::with_capacity(n);
        let mut rho = Vec::with_capacity(n);
        let mut coordinates = Vec::with_capacity(n);
        let mut primal = Vec::new();
        let stiffest = stiffest(mesh);
        for (node, of_body) in nodes.into_iter().enumerate() {
            let own = &mesh.dof[c * node..c * (node + 1)];
            if own.iter().all(|&d| d == SubdomainMesh::PRESCRIBED) {
                continue;
            }
            let first = body.first_dof + (of_body * c) as u64;
            for (component, &dof) in own.iter().enumerate() {
                if dof == SubdomainMesh::PRESCRIBED {
                    continue;
                }
                dofs.push(first + component as u64);
                if whole.is_vertex(of_body) {
                    primal.push(dof);
                }
                rho.push(stiffest[node]);
                coordinates.push(mesh.points[node]);
            }
        }
        let mut near_kernel = match c {
            1 => vec![vec![1.0; n]],
            _ => rigid_motions(body, mesh),
        };
        let (mut k, mut idle) = (k, Vec::new());
        if let Some(slack) = self.slack_of(mesh.body) {
            k = slack.held(k, body, &dofs);
            near_kernel = slack.near_kernel(near_kernel, body, &dofs);
            idle = slack.parts(body, mesh, &whole.subdomain_nodes(inside));
        }
        let entities = entities(body, inside, mesh, &dofs);
        Ok(Subdomain::new(mesh.index, mesh.body, k, f, dofs)
            .with_rho(rho)
            .with_primal(primal)
            .with_entities(entities)
            .with_near_kernel(near_kernel)
            .with_coordinates(coordinates)
            .with_idle(idle))
    }

    /// Squares of the error norms (L², H¹ seminorm, energy) of the nodal values on `mesh` against the exact solution;
    /// `None` if the scene has no exact solution.
    pub fn error_squares(&self, mesh: &SubdomainMesh, nodal: &[f64]) -> Option<[f64; 3]> {
        let exact = self.exact.as_ref()?;
        let (body, inside) = self.place(mesh.index);
        Some(assembly::error_squares(mesh, nodal, |point| {
            let at = at(body, inside, point).variables;
            let mut out = ([0.0; 3], [[0.0; 3]; 3]);
            for (i, e) in exact.iter().enumerate() {
                let value = e.eval_gradient(&at);
                (out.0[i], out.1[i]) = (value.value, value.gradient);
            }
            out
        }))
    }
}
