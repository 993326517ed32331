//! An estimate of the discretisation error by body, from recovered stresses (Zienkiewicz and Zhu 1987).
//!
//! ```text
//!     η² = Σ_e ∫ (σ* − σ_h) : (ε* − ε_h)          over the cells e of a body
//! ```
//!
//! σ* and ε* are continuous in each material of a body: at a node the mean of its cells, weighted by their volumes. It
//! is an estimate and no bound. Where σ* is one order better than σ_h, as on regular meshes of smooth solutions, η over
//! the error tends to one.

use std::collections::HashMap;

use super::materials::Materials;
use super::{shared, GatherTarget};
use base::Result;
use fetifeti::problem::BodyNode;
use fetifeti::FetiFeti;
use parallel::exchange::sum_all;
use petsc::Session;
use scene::assembly::recovery::{for_each_cell, squares, NodalStressSum};
use scene::{Scene, SteppedMesh};

/// The meshes of this rank, with a place for each node and material of a body.
pub struct Estimator {
    parts: Vec<SteppedMesh>,
    nodes: Vec<BodyNode>,
    material: Vec<u32>,
    /// For each subdomain the places of its cells' nodes, cell after cell.
    places: Vec<Vec<u32>>,
}

/// The discretisation error of a body.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BodyError {
    /// η.
    pub error: f64,
    /// The energy norm of the displacements.
    pub size: f64,
}

impl Estimator {
    /// Builds the meshes of this rank's subdomains. Collective.
    ///
    /// # Errors
    /// As [`Scene::subdomain_mesh`].
    pub fn new(session: &Session, scene: &Scene, solver: &FetiFeti) -> Result<Estimator> {
        let local = solver.problem().local.iter().map(|s| s.index);
        let parts = local.map(|index| SteppedMesh::new(scene, index));
        let parts: Vec<SteppedMesh> = session.agree(parts.collect::<Result<_>>())?;
        let materials = Materials::told_apart(session, &parts, GatherTarget::EachRank);
        let mut out = Estimator {
            parts: Vec::new(),
            nodes: Vec::new(),
            material: Vec::new(),
            places: Vec::new(),
        };
        // By body: the place of each material and node.
        let mut known: HashMap<usize, Vec<u32>> = HashMap::new();
        for mesh in parts.iter().map(SteppedMesh::mesh) {
            let (body, inside) = scene.body_of(mesh.index);
            let of_body = materials.of(body);
            let whole = scene.bodies[body].mesh();
            let (n, nodes) = (whole.n_nodes(), whole.subdomain_nodes(inside));
            let none = || vec![u32::MAX; n * of_body.count()];
            let known = known.entry(body).or_insert_with(none);
            let mut places = Vec::new();
            for (e, (_, local)) in mesh.cells().iter().enumerate() {
                let material = of_body.number(mesh, e);
                for &k in local {
                    let node = nodes[k as usize];
                    let place = &mut known[material * n + node];
                    if *place == u32::MAX {
                        *place = out.nodes.len() as u32;
                        out.nodes.push(BodyNode { body, node });
                        out.material.push(material as u32);
                    }
                    places.push(*place);
                }
            }
            out.places.push(places);
        }
        out.parts = parts;
        Ok(out)
    }

    /// The errors by body of displacements u, by local dof of each local subdomain, in load step `step`. Collective.
    pub fn by_body(
        &mut self,
        session: &Session,
        scene: &Scene,
        u: &[Vec<f64>],
        step: usize,
    ) -> Vec<BodyError> {
        let mut sums = vec![NodalStressSum::default(); self.nodes.len()];
        for ((part, places), u) in self.parts.iter_mut().zip(&self.places).zip(u) {
            let mesh = part.at(scene, step);
            let mut places = places.iter();
            for_each_cell(mesh, &mesh.nodal(u), |_, volume, at| {
                for (node, &p) in at.iter().zip(&mut places) {
                    sums[p as usize].add(volume, node);
                }
            });
        }
        shared::add(session, scene, &self.nodes, &self.material, &mut sums);
        let n = scene.n_bodies();
        let mut all = vec![0.0; 2 * n];
        for ((part, places), u) in self.parts.iter().zip(&self.places).zip(u) {
            let mesh = part.mesh();
            let recovered = |k: usize| sums[places[k] as usize].mean();
            let [error, size] = squares(mesh, &mesh.nodal(u), recovered);
            all[2 * mesh.body] += error;
            all[2 * mesh.body + 1] += size;
        }
        sum_all(session.comm(), &mut all);
        let of = |s: &[f64]| BodyError {
            error: s[0].max(0.0).sqrt(),
            size: s[1].max(0.0).sqrt(),
        };
        all.chunks_exact(2).map(of).collect()
    }
}

/// The error of all bodies together.
pub fn total(bodies: &[BodyError]) -> f64 {
    let squares = bodies.iter().map(|b| b.error * b.error);
    squares.sum::<f64>().sqrt()
}
