//! The solution by bodies and nodes on rank 0, and probes.

use super::course::Course;
use super::fields::to_first_rank;
use super::row_forces::RowForces;
use base::{Error, Result};
use bytemuck::{Pod, Zeroable};
use elements::element;
use fetifeti::problem::BodyNode;
use fetifeti::{FetiFeti, Solution};
use parallel::exchange::exchange;
use petsc::Session;
use report::json::probes::ProbeValue;
use scene::assembly::recovery;
use scene::assembly::{internal_force, SubdomainMesh};
use scene::{Scene, SteppedMesh};

/// Values at all nodes of every body, C components each, on rank 0; nothing on the other ranks.
pub(super) struct NodalValues {
    by_body: Vec<Vec<f64>>,
    components: usize,
}

/// The force of a row on a node of a body.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct NodeForce {
    body: usize,
    node: usize,
    force: [f64; 3],
}

impl NodalValues {
    /// The displacements of a solution at load step `step`. Collective.
    pub fn displacements(
        session: &Session,
        scene: &Scene,
        solver: &FetiFeti,
        solution: &Solution,
        step: usize,
    ) -> Result<NodalValues> {
        let of = |_: &SubdomainMesh, nodal: Vec<f64>| nodal;
        let put = |to: &mut f64, u: f64| *to = u;
        NodalValues::gather(session, scene, solver, (solution, step), &of, &put)
    }

    /// The forces that act on the nodes from outside, as CalculiX prints them (RF): K u without the forces of contact.
    /// They are loads and reactions, and the forces of ties and equations. Collective.
    pub fn forces(
        session: &Session,
        scene: &Scene,
        solver: &FetiFeti,
        course: &Course,
    ) -> Result<NodalValues> {
        let add = |to: &mut f64, force: f64| *to += force;
        let of = |mesh: &SubdomainMesh, nodal: Vec<f64>| internal_force(mesh, &nodal);
        let solved = (&course.solution, course.step);
        let mut all = NodalValues::gather(session, scene, solver, solved, &of, &add)?;
        // Rows between sides whose nodes do not match have forces at many nodes.
        let mut outgoing = vec![Vec::new(); session.size()];
        RowForces::new(session, scene)?.each(&course.solution, |row, _, at, force| {
            if row.is_inequality() || row.law.is_friction() {
                let BodyNode { body, node } = at;
                outgoing[0].push(NodeForce { body, node, force });
            }
        });
        for NodeForce { body, node, force } in exchange(session.comm(), outgoing) {
            let first = all.components * node;
            let to = &mut all.by_body[body][first..first + all.components];
            to.iter_mut().zip(force).for_each(|(to, f)| *to -= f);
        }
        Ok(all)
    }

    /// Values `of` every subdomain, which `put` puts to the nodes of the bodies. Collective.
    fn gather(
        session: &Session,
        scene: &Scene,
        solver: &FetiFeti,
        (solution, step): (&Solution, usize),
        of: &dyn Fn(&SubdomainMesh, Vec<f64>) -> Vec<f64>,
        put: &dyn Fn(&mut f64, f64),
    ) -> Result<NodalValues> {
        let local = solver.problem().local.iter().map(|sub| sub.index);
        let nodal = local.clone().zip(&solution.u).map(|(index, u)| {
            let mut part = SteppedMesh::new(scene, index)?;
            let mesh = part.at(scene, step);
            Ok(of(mesh, mesh.nodal(u)))
        });
        let nodal: Vec<Vec<f64>> = session.agree(nodal.collect::<Result<_>>())?;
        let mut received = to_first_rank(session, local.zip(&nodal));
        // Sums are taken in the same order on any number of ranks.
        received.sort_unstable_by_key(|part| part.0);
        let c = scene.components();
        let mut by_body = Vec::new();
        if session.rank() == 0 {
            by_body = scene
                .bodies
                .iter()
                .map(|b| vec![0.0; c * b.mesh().n_nodes()])
                .collect();
        }
        for (index, _, values) in received {
            let (body, inside) = scene.body_of(index);
            let nodes = scene.bodies[body].mesh().subdomain_nodes(inside);
            for (node, part) in nodes.into_iter().zip(values.chunks_exact(c)) {
                let to = by_body[body][c * node..c * (node + 1)].iter_mut();
                to.zip(part).for_each(|(to, &value)| put(to, value));
            }
        }
        Ok(NodalValues {
            by_body,
            components: c,
        })
    }

    /// The value at a node, with zeros for the components that the scene does not have.
    pub fn at(&self, body: usize, node: usize) -> [f64; 3] {
        let c = self.components;
        let mut out = [0.0; 3];
        out[..c].copy_from_slice(&self.by_body[body][c * node..c * (node + 1)]);
        out
    }

    /// u, and in elasticity the stress, at the probes of a scene in this load step. On rank 0.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a probe that lies in no body.
    pub fn probes(&self, scene: &Scene, step: usize) -> Result<Vec<ProbeValue>> {
        scene
            .probes
            .iter()
            .map(|probe| self.probe(scene, probe, step))
            .collect()
    }

    fn probe(&self, scene: &Scene, probe: &scene::ProbeSpec, step: usize) -> Result<ProbeValue> {
        let c = self.components;
        for (b, body) in scene.bodies.iter().enumerate() {
            if probe
                .body
                .as_ref()
                .is_some_and(|name| *name != body.spec.name)
            {
                continue;
            }
            let [low, high] = body.bounds;
            let slack = (0..3)
                .map(|d| 1e-6 * (high[d] - low[d]))
                .fold(0.0, f64::max);
            let x = probe.point;
            if (0..scene.dim()).any(|d| x[d] < low[d] - slack || x[d] > high[d] + slack) {
                continue;
            }
            for inside in 0..body.mesh().n_subdomains() {
                let mut part = SteppedMesh::new(scene, body.first_subdomain + inside)?;
                let mesh = part.at(scene, step);
                let nodes = body.mesh().subdomain_nodes(inside);
                for (e, (kind, cell)) in mesh.cells().iter().enumerate() {
                    let points: Vec<[f64; 3]> =
                        cell.iter().map(|&k| mesh.points[k as usize]).collect();
                    let Some(weights) = element::locate(kind, &points, x) else {
                        continue;
                    };
                    let values: Vec<[f64; 3]> = cell
                        .iter()
                        .map(|&k| self.at(b, nodes[k as usize]))
                        .collect();
                    let u =
                        (0..c).map(|d| weights.iter().zip(&values).map(|(w, v)| w * v[d]).sum());
                    let stress = scene.form.is_elastic().then(|| {
                        let nodal: Vec<f64> = values.iter().flat_map(|v| v[..c].to_vec()).collect();
                        let mut at = vec![element::NodeStress::default(); points.len()];
                        recovery::at_nodes(mesh, (e, kind, cell), &nodal, &mut at);
                        let sum =
                            |k: usize| weights.iter().zip(&at).map(|(w, s)| w * s.stress[k]).sum();
                        (0..6).map(sum).collect::<Vec<f64>>()
                    });
                    return Ok(ProbeValue {
                        name: probe.name.clone(),
                        body: body.spec.name.clone(),
                        point: x[..scene.dim()].to_vec(),
                        u: u.collect(),
                        stress: stress.unwrap_or_default(),
                    });
                }
            }
        }
        let place = match &probe.body {
            Some(name) => format!("not in body `{name}`"),
            None => "in no body".into(),
        };
        Err(Error::input(format!(
            "the probe `{}` at {:?} is {place}",
            probe.name,
            &probe.point[..scene.dim()]
        ))
        .at(&probe.location))
    }
}
