//! The fields of the solution: u, and stress and strain at the nodes of bodies; as VTU.
//!
//! A node of a body is one point, whatever the number of subdomains around it. Stress jumps where materials meet: a
//! body of a few materials has a point per node and material. In a body of more the coefficient is a field of its own,
//! and stress is averaged over all cells around a node.

pub(super) mod discretisation;
mod materials;
mod shared;
mod vtu;

use std::collections::HashMap;

use base::Result;
use elements::cell::CellStress;
use elements::element::{von_mises, NodeStress};
use fetifeti::problem::BodyNode;
use fetifeti::solution::SolvedRow;
use fetifeti::{FetiFeti, Solution};
use materials::Materials;
use mesh::Cells;
use parallel::exchange::exchange_by_rank;
use parallel::parcels::Parcels;
use petsc::Session;
use scene::assembly::recovery::{cell_stresses, for_each_cell, NodalStressSum};
use scene::{Scene, SteppedMesh};

/// Where fields come together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GatherTarget {
    /// The fields of the whole scene come together on rank 0.
    #[default]
    FirstRank,
    /// The fields of a rank's subdomains come together on this rank.
    EachRank,
}

/// The meshes and the solution of subdomains, merged to bodies. Meshes are built once, and every load step brings its u
/// and stress.
#[derive(Default)]
pub struct Gathered {
    place: GatherTarget,
    /// The subdomains, by number.
    parts: Vec<SteppedMesh>,
    pub(super) points: Vec<[f64; 3]>,
    /// The node of each point.
    nodes: Vec<BodyNode>,
    /// The material of each point.
    material: Vec<u32>,
    pub(super) cells: Cells,
    pub(super) body: Vec<u32>,
    pub(super) subdomain: Vec<u32>,
    /// The rank of each cell.
    rank: Vec<u32>,
    /// C components per point.
    pub(super) u: Vec<f64>,
    /// ρ, or Young's modulus.
    pub(super) rho: Vec<f64>,
    /// Poisson's ratio and stress by cell, in elasticity.
    poisson: Vec<f64>,
    cell_stress: Vec<CellStress>,
    /// Strain and stress by point, in elasticity.
    stress: Vec<NodeStress>,
}

impl Gathered {
    /// The meshes of a scene, without a solution. Collective.
    ///
    /// # Errors
    /// As [`Scene::subdomain_mesh`].
    pub fn new(
        session: &Session,
        scene: &Scene,
        solver: &FetiFeti,
        place: GatherTarget,
    ) -> Result<Gathered> {
        let mine: Vec<usize> = match (place, session.rank()) {
            (GatherTarget::EachRank, _) => solver.problem().local.iter().map(|s| s.index).collect(),
            (GatherTarget::FirstRank, 0) => (0..scene.n_subdomains()).collect(),
            (GatherTarget::FirstRank, _) => Vec::new(),
        };
        let parts = mine.iter().map(|&index| SteppedMesh::new(scene, index));
        let mut all = Gathered {
            place,
            parts: session.agree(parts.collect::<Result<_>>())?,
            ..Gathered::default()
        };
        all.parts.sort_by_key(|part| part.mesh().index);
        let materials = Materials::new(session, scene, &all.parts, place);
        all.merge(scene, &materials);
        Ok(all)
    }

    /// Numbers the points, subdomain after subdomain.
    fn merge(&mut self, scene: &Scene, materials: &Materials) {
        // By body: the point of each material and node.
        let mut known: HashMap<usize, Vec<u32>> = HashMap::new();
        let parts = std::mem::take(&mut self.parts);
        for mesh in parts.iter().map(SteppedMesh::mesh) {
            let (body, inside) = scene.body_of(mesh.index);
            let whole = scene.bodies[body].mesh();
            let n = whole.n_nodes();
            let of_body = materials.of(body);
            let known = known
                .entry(body)
                .or_insert_with(|| vec![u32::MAX; n * of_body.count()]);
            let nodes = whole.subdomain_nodes(inside);
            for (e, (kind, local)) in mesh.cells().iter().enumerate() {
                let material = of_body.number(mesh, e);
                let point = |&k: &u32| {
                    let node = nodes[k as usize];
                    let place = &mut known[material * n + node];
                    if *place == u32::MAX {
                        *place = self.points.len() as u32;
                        self.points.push(mesh.points[k as usize]);
                        self.nodes.push(BodyNode { body, node });
                        self.material.push(material as u32);
                    }
                    *place
                };
                let corners: Vec<u32> = local.iter().map(point).collect();
                self.cells.push(kind, &corners);
                self.body.push(body as u32);
                self.subdomain.push(mesh.index as u32);
            }
            self.rho.extend(&mesh.rho);
            self.poisson.extend(&mesh.poisson);
        }
        self.parts = parts;
    }

    /// Brings the solution of load step `step` here. Collective.
    pub fn gather(
        &mut self,
        session: &Session,
        scene: &Scene,
        solver: &FetiFeti,
        solution: &Solution,
        step: usize,
    ) {
        let local = solver.problem().local.iter().map(|s| s.index);
        let mut solved = match self.place {
            GatherTarget::EachRank => local
                .zip(&solution.u)
                .map(|(index, u)| (index, session.rank(), u.clone()))
                .collect(),
            GatherTarget::FirstRank => to_first_rank(session, local.zip(&solution.u)),
        };
        solved.sort_unstable_by_key(|part| part.0);
        let c = scene.components();
        let elastic = scene.form.is_elastic();
        self.u.clear();
        self.u.resize(c * self.points.len(), 0.0);
        self.cell_stress.clear();
        self.rank.clear();
        let mut sums = vec![NodalStressSum::default(); if elastic { self.points.len() } else { 0 }];
        let mut first = 0;
        for (part, (_, rank, u)) in self.parts.iter_mut().zip(solved) {
            let mesh = part.at(scene, step);
            let nodal = mesh.nodal(&u);
            let cells = mesh.cells();
            for (e, (_, local)) in cells.iter().enumerate() {
                for (&k, &p) in local.iter().zip(self.cells.nodes(first + e)) {
                    let (k, p) = (c * k as usize, c * p as usize);
                    self.u[p..p + c].copy_from_slice(&nodal[k..k + c]);
                }
            }
            if elastic {
                for_each_cell(mesh, &nodal, |e, volume, at| {
                    for (&p, node) in self.cells.nodes(first + e).iter().zip(at) {
                        sums[p as usize].add(volume, node);
                    }
                });
                self.cell_stress.extend(cell_stresses(mesh, &nodal));
            }
            self.rank.resize(first + cells.len(), rank as u32);
            first += cells.len();
        }
        if self.place == GatherTarget::EachRank && elastic {
            shared::add(session, scene, &self.nodes, &self.material, &mut sums);
        }
        self.stress = sums.iter().map(NodalStressSum::mean).collect();
    }

    /// The displacement of a point; zero in scalar problems.
    pub(super) fn displacement(&self, scene: &Scene, point: usize) -> [f64; 3] {
        let mut out = [0.0; 3];
        let c = scene.components();
        if c > 1 {
            out[..c].copy_from_slice(&self.u[c * point..c * (point + 1)]);
        }
        out
    }

    /// Von Mises stress by point; empty in scalar problems.
    pub(super) fn von_mises(&self) -> Vec<f64> {
        self.stress.iter().map(|s| von_mises(&s.stress)).collect()
    }

    /// The points of the nodes of the rows.
    pub(super) fn copies(&self, rows: &[SolvedRow]) -> HashMap<BodyNode, Vec<usize>> {
        let members = rows.iter().flat_map(|r| r.label.members.iter().flatten());
        let mut out: HashMap<BodyNode, Vec<usize>> = members.map(|&m| (m, Vec::new())).collect();
        if !out.is_empty() {
            for (p, node) in self.nodes.iter().enumerate() {
                if let Some(points) = out.get_mut(node) {
                    points.push(p);
                }
            }
        }
        out
    }
}

/// Values of all subdomains on rank 0, with number and rank; none on the others. Collective.
pub(super) fn to_first_rank<'a>(
    session: &Session,
    local: impl Iterator<Item = (usize, &'a Vec<f64>)>,
) -> Vec<(usize, usize, Vec<f64>)> {
    let mut outgoing: Vec<Parcels<usize, f64>> = Parcels::for_each_rank(session.comm());
    for (index, values) in local {
        outgoing[0].push(index, values.iter().copied());
    }
    let mut out = Vec::new();
    let received = exchange_by_rank(session.comm(), outgoing);
    for (rank, parts) in received.iter().enumerate() {
        let parts = parts.iter();
        out.extend(parts.map(|(index, values)| (index, rank, values.to_vec())));
    }
    out
}
