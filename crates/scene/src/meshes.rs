//! The mesh of a subdomain, with coefficients, springs and given values.

use super::body::Body;
use super::checked::Scene;
use super::coefficient::{by_element, evaluate};
use super::element_laws::{heat_by_element, laws_by_element};
use super::model::field::Field;
use super::model::steps::Factors;
use super::quantity::{Quantity, RATIO, SPRING};
use crate::assembly::{self, ElementLaws, Grid, SidePart, SubdomainElements, SubdomainMesh};
use base::Result;
use elements::element::Integration;
use mesh::{Cells, Mesh};

impl Scene {
    /// The mesh of subdomain `index`: nodes, which of them are free, values given at the last load step, ρ by element.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for ρ ≤ 0 or not finite, with body and point.
    pub fn subdomain_mesh(&self, index: usize) -> Result<SubdomainMesh> {
        self.mesh_with(index, Factors::last(&self.steps))
    }

    pub(super) fn mesh_with(&self, index: usize, factors: Factors<'_>) -> Result<SubdomainMesh> {
        let scale = factors.dirichlet();
        let (body, inside) = self.place(index);
        let whole = body.mesh();
        let c = body.components;
        let nodes = whole.subdomain_nodes(inside);
        let n = nodes.len();
        let mut mesh = SubdomainMesh {
            index,
            body: self.body_of(index).0,
            dim: whole.dim(),
            form: self.form,
            elements: elements(body, inside, &nodes),
            points: Vec::with_capacity(n),
            dof: Vec::with_capacity(c * n),
            prescribed: vec![0.0; c * n],
            rho: Vec::new(),
            poisson: Vec::new(),
            laws: ElementLaws::default(),
            heat: None,
            integration: integration(body, inside),
            spring: Vec::new(),
        };
        let mut next = 0;
        for node in nodes {
            let first = node * c;
            for component in 0..c {
                match body.prescribed_at(first + component) {
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
            mesh.points.push(body.spec.position(node));
        }
        mesh.rho = by_element(body, inside, &mesh, &body.spec.rho, |value, point| {
            Quantity::coefficient(&self.form).at(&body.spec, value, point)
        })?;
        if self.form.is_elastic() {
            mesh.poisson = by_element(body, inside, &mesh, &body.spec.poisson, |value, point| {
                RATIO.at(&body.spec, value, point)
            })?;
        }
        if let Some(law) = &body.spec.law {
            mesh.laws = laws_by_element(body, inside, &mesh, law);
        }
        let heat = body.spec.heat.as_ref();
        if let Some(given) = heat.and_then(|heat| Some((heat, heat.temperature.as_ref()?))) {
            let mut heat = heat_by_element(body, inside, &mesh, given)?;
            heat.factor = factors.load(body.spec.ramp.as_ref());
            mesh.heat = Some(heat);
        }
        for (side, stiffness) in &body.spec.springs {
            if whole.reaches(inside, *side) {
                add_spring(body, inside, &mut mesh, *side, stiffness)?;
            }
        }
        Ok(mesh)
    }

    /// The nodes of a body that springs support.
    pub fn sprung(&self, body: &Body) -> Vec<usize> {
        let mesh = body.mesh();
        let held = |stiffness: &Field, node: &usize| {
            let inside = mesh.owner(*node);
            evaluate(body, inside, stiffness, body.spec.position(*node)) > 0.0
        };
        let mut out = Vec::new();
        for (side, k) in &body.spec.springs {
            out.extend(mesh.side_nodes(*side).into_iter().filter(|n| held(k, n)));
        }
        out
    }

    /// The body of subdomain `index`, and the subdomain's number in it.
    pub(super) fn place(&self, index: usize) -> (&Body, usize) {
        let (body, inside) = self.body_of(index);
        (&self.bodies[body], inside)
    }
}

/// The elements of subdomain `inside` of a body; `nodes` are its nodes in the body, increasing.
fn elements(body: &Body, inside: usize, nodes: &[usize]) -> SubdomainElements {
    match body.mesh() {
        Mesh::Grid(grid) => SubdomainElements::Grid(Grid {
            elements: grid.block_elements(),
            step: body.spec.is_straight().then(|| grid.step()),
        }),
        Mesh::Cells(mesh) => {
            let mut cells = Cells::default();
            let mut local = Vec::new();
            for &c in mesh.parts.cells(inside) {
                let place = |k: &u32| nodes.partition_point(|&n| n < *k as usize) as u32;
                local.clear();
                local.extend(mesh.cells.nodes(c as usize).iter().map(place));
                cells.push(mesh.cells.kind(c as usize), &local);
            }
            SubdomainElements::Cells(cells)
        }
    }
}

/// How the cells of a subdomain are integrated; empty: in full.
fn integration(body: &Body, inside: usize) -> Vec<Integration> {
    match (body.mesh(), &body.spec.integration[..]) {
        (Mesh::Cells(mesh), rules @ [_, ..]) => {
            let cells = mesh.parts.cells(inside).iter();
            cells.map(|&c| rules[c as usize]).collect()
        }
        _ => Vec::new(),
    }
}

/// The part of a side that belongs to subdomain `inside`.
pub(super) fn side_part(body: &Body, inside: usize, side: usize) -> SidePart {
    match body.mesh() {
        Mesh::Grid(_) => SidePart::OfGrid(side),
        Mesh::Cells(mesh) => {
            let cells = mesh.parts.cells(inside);
            let local = |&(cell, face): &(u32, u8)| {
                let place = cells.binary_search(&cell).ok()?;
                Some((place as u32, face))
            };
            SidePart::Faces(mesh.sides[side].faces.iter().filter_map(local).collect())
        }
    }
}

/// Adds ∫ k N_a over a side to the springs of a mesh.
fn add_spring(
    body: &Body,
    inside: usize,
    mesh: &mut SubdomainMesh,
    side: usize,
    stiffness: &Field,
) -> Result<()> {
    let c = mesh.components();
    let mut sums = vec![0.0; mesh.dof.len()];
    let mut bad = None;
    let value = |point: [f64; 3], _normal: [f64; 3]| {
        let k = evaluate(body, inside, stiffness, point);
        if !(SPRING.good)(k) {
            bad.get_or_insert((k, point));
        }
        [k, 0.0, 0.0]
    };
    assembly::add_side_load(mesh, &side_part(body, inside, side), value, &mut sums);
    if let Some((k, point)) = bad {
        SPRING.at(&body.spec, k, point)?;
    }
    mesh.spring.resize(mesh.points.len(), 0.0);
    for (spring, sum) in mesh.spring.iter_mut().zip(sums.chunks_exact(c)) {
        *spring += sum[0];
    }
    Ok(())
}
