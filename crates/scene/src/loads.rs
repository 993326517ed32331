//! Loads of a subdomain, step by step.

use super::body::Body;
use super::checked::Scene;
use super::coefficient::evaluate;
use super::meshes::side_part;
use super::model::body::Force;
use super::model::field::Field;
use super::model::steps::Factors;
use super::quantity::LOAD;
use crate::assembly::{self, SubdomainMesh};
use base::linalg::csr::Csr;
use base::linalg::vec3::{cross, minus};
use base::Result;

/// The loads of some subdomains over the load steps. The meshes, and the columns of K at given values, are built once;
/// each step evaluates loads and scales given values.
pub struct Stepping {
    subdomains: Vec<Stepped>,
}

struct Stepped {
    mesh: SteppedMesh,
    columns: Csr,
}

/// The mesh of a subdomain, built once; its given values follow the load steps.
pub struct SteppedMesh {
    mesh: SubdomainMesh,
    /// Given values without the factors of load steps.
    given: Vec<f64>,
}

impl SteppedMesh {
    /// Builds the mesh of subdomain `index`.
    ///
    /// # Errors
    /// As [`Scene::subdomain_mesh`].
    pub fn new(scene: &Scene, index: usize) -> Result<SteppedMesh> {
        let mesh = scene.mesh_with(index, Factors::none())?;
        Ok(SteppedMesh {
            given: mesh.prescribed.clone(),
            mesh,
        })
    }

    /// The mesh, with given values as they were last.
    pub fn mesh(&self) -> &SubdomainMesh {
        &self.mesh
    }

    /// The mesh with the given values and temperatures of a load step of its scene.
    ///
    /// # Panics
    /// For a step that the scene does not have.
    pub fn at(&mut self, scene: &Scene, step: usize) -> &SubdomainMesh {
        let factors = Factors::of(&scene.steps, step).expect("the step exists");
        let scale = factors.dirichlet();
        for (now, given) in self.mesh.prescribed.iter_mut().zip(&self.given) {
            *now = given * scale;
        }
        if let Some(heat) = &mut self.mesh.heat {
            let (body, _) = scene.place(self.mesh.index);
            heat.factor = factors.load(body.spec.ramp.as_ref());
        }
        &self.mesh
    }
}

impl Stepping {
    /// Builds the meshes of some subdomains of a scene.
    ///
    /// # Errors
    /// As [`Scene::subdomain_mesh`].
    pub fn new(scene: &Scene, subdomains: impl IntoIterator<Item = usize>) -> Result<Stepping> {
        let build = |index| {
            let mesh = SteppedMesh::new(scene, index)?;
            let columns = assembly::given_columns(&mesh.mesh);
            Ok(Stepped { mesh, columns })
        };
        let subdomains: Result<Vec<Stepped>> = subdomains.into_iter().map(build).collect();
        Ok(Stepping {
            subdomains: subdomains?,
        })
    }

    /// The loads of the subdomains of this scene at load step `step` (without `[steps]` the only step is 0), with given
    /// values eliminated. At the last step they are those of [`Scene::subdomain`] to the last bit.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a load that is not finite, or a step that the scene does not
    /// have.
    pub fn loads(&mut self, scene: &Scene, step: usize) -> Result<Vec<Vec<f64>>> {
        let factors = Factors::of(&scene.steps, step)?;
        let load = |s: &mut Stepped| {
            let mesh = s.mesh.at(scene, step);
            let load = scene.nodal_load(mesh, factors)?;
            Ok(assembly::free_load(mesh, &s.columns, &load))
        };
        self.subdomains.iter_mut().map(load).collect()
    }
}

/// Whether a subdomain has a degree of freedom with a given value that is not zero.
fn is_moved(body: &Body, inside: usize) -> bool {
    if body.prescribed.iter().all(|(_, u)| *u == 0.0) {
        return false;
    }
    let c = body.components;
    let given = |dof: usize| body.prescribed_at(dof).is_some_and(|u| u != 0.0);
    let mut nodes = body.mesh().subdomain_nodes(inside).into_iter();
    nodes.any(|node| (c * node..c * (node + 1)).any(given))
}

/// The values of loads by cell, where all are.
fn by_cell(fields: &[Field]) -> Option<[Option<&[f64]>; 3]> {
    let mut out = [None; 3];
    for (o, field) in out.iter_mut().zip(fields) {
        match field {
            Field::ByCell(values) => *o = Some(&values[..]),
            _ => return None,
        }
    }
    Some(out)
}

impl Scene {
    /// The load f of subdomain `index` at load step `step`; for many subdomains or steps use [`Stepping`].
    ///
    /// # Errors
    /// As [`Stepping::loads`].
    pub fn loads(&self, index: usize, step: usize) -> Result<Vec<f64>> {
        Ok(Stepping::new(self, [index])?.loads(self, step)?.remove(0))
    }

    /// The resultant force on subdomain `index` at load step `step`, by components and including its side loads, and
    /// the resultant moment about `centre`.
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
        let load = self.nodal_load(&mesh, factors)?;
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for (node, at) in load.chunks_exact(self.components()).zip(&mesh.points) {
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

    /// The energy of given values alone, ½ u_Dᵀ K_DD u_D − f_Dᵀ u_D, of the subdomains with these indices at load step
    /// `step`. The energy of a solution leaves it out, because given values are eliminated.
    ///
    /// # Errors
    /// As [`Stepping::loads`].
    pub fn given_energy(
        &self,
        subdomains: impl IntoIterator<Item = usize>,
        step: usize,
    ) -> Result<f64> {
        let factors = Factors::of(&self.steps, step)?;
        let mut energy = 0.0;
        for index in subdomains {
            let (body, inside) = self.place(index);
            // Only subdomains with given values need a mesh: on sides, at nodes, and at nodes that are tied to these.
            if !is_moved(body, inside) {
                continue;
            }
            let mesh = self.mesh_with(index, factors)?;
            let load = self.nodal_load(&mesh, factors)?;
            energy += assembly::given_energy(&mesh, &load);
        }
        Ok(energy)
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

    /// The scene up to load step `step`, which is then the last one.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a step that the scene does not have.
    pub fn until(&self, step: usize) -> Result<Scene> {
        Factors::of(&self.steps, step)?;
        let mut out = self.clone();
        if let Some(steps) = &mut out.steps {
            steps.times.truncate(step + 1);
        }
        Ok(out)
    }

    /// The nodal load from volume and side loads; an error if a value is not finite.
    pub(super) fn nodal_load(
        &self,
        mesh: &SubdomainMesh,
        factors: Factors<'_>,
    ) -> Result<Vec<f64>> {
        let (body, inside) = self.place(mesh.index);
        let load = &body.spec.load;
        let scale = factors.load(body.spec.ramp.as_ref());
        let mut bad = None;
        let mut value = |fields: &[Field], point: [f64; 3]| {
            let mut out = [0.0; 3];
            for (o, field) in out.iter_mut().zip(fields) {
                *o = evaluate(body, inside, field, point) * scale;
                if !(LOAD.good)(*o) {
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
                assembly::load_vector(mesh, load.quadrature, |_, _| constant)
            }
        } else if let (Some(by_cell), Some(cells)) = (by_cell(fields), body.mesh().cells()) {
            let of = cells.parts.cells(inside);
            assembly::load_vector(mesh, load.quadrature, |e, _| {
                by_cell.map(|v| v.map_or(0.0, |v| scale * v[of[e] as usize]))
            })
        } else {
            assembly::load_vector(mesh, load.quadrature, |_, point| value(fields, point))
        };
        let nodes = if body.spec.forces.is_empty() {
            Vec::new()
        } else {
            body.mesh().subdomain_nodes(inside)
        };
        for &(dof, force) in &body.spec.forces {
            let (node, component) = (dof / body.components, dof % body.components);
            // Subdomains share nodes; the owner of a node bears its force.
            if body.mesh().owner(node) == inside {
                let place = nodes.binary_search(&node).expect("a node of its owner");
                out[place * body.components + component] += scale * force;
            }
        }
        for load in &body.spec.surface {
            if !body.mesh().reaches(inside, load.side) {
                continue;
            }
            let force = |point: [f64; 3], normal: [f64; 3]| match &load.force {
                Force::Traction(fields) => value(fields, point),
                Force::Pressure(p) => {
                    let [p, ..] = value(std::slice::from_ref(p), point);
                    normal.map(|n| 0.0 - p * n)
                }
            };
            assembly::add_side_load(mesh, &side_part(body, inside, load.side), force, &mut out);
        }
        if let Some((value, point)) = bad {
            LOAD.at(&body.spec, value, point)?;
        }
        assembly::add_thermal_load(mesh, &mut out);
        Ok(out)
    }
}
