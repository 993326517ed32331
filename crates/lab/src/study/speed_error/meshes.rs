//! The discretisation error: the distance of the exact solution of a mesh from that of the continuous problem.

use super::{MeshError, SpeedErrorCase};
use crate::study::solved::Solved;
use base::{Error, Result};
use fetifeti::settings::MethodSettings;
use fetifeti::Subdomain;
use mesh::BoxMesh;
use petsc::Session;
use scene::Body;

/// Our solution with a tight tolerance. On one rank.
struct Tight {
    solved: Solved,
    /// uᵀKu.
    size: f64,
}

/// The discretisation errors of the meshes.
///
/// # Errors
/// Those of the method; [`ErrorKind::NotConverged`](base::ErrorKind::NotConverged) where it stops early.
pub fn errors(session: &Session, case: SpeedErrorCase, meshes: &[usize]) -> Result<Vec<MeshError>> {
    let finest = meshes[meshes.len() - 1];
    let fine = match case {
        SpeedErrorCase::Contact => Some(Tight::new(session, case, 2 * finest)?),
        _ => None,
    };
    let mut out = Vec::new();
    for &elements in meshes {
        let tight = Tight::new(session, case, elements)?;
        let square = match &fine {
            None => tight.exact_square()?,
            Some(fine) => fine.square_from(&tight)?,
        };
        out.push(MeshError {
            elements,
            dofs: tight.solved.dofs(),
            error: (square / tight.size).sqrt(),
        });
    }
    if fine.is_some() {
        // The reference mesh is twice as fine as the finest one. Its error is taken as half of e, the error of the
        // finest mesh: there d² = e² − (e/2)², and (e/2)² is missing from d² on every mesh.
        let missing = out[out.len() - 1].error.powi(2) / 3.0;
        out.iter_mut()
            .for_each(|m| m.error = (m.error.powi(2) + missing).sqrt());
    }
    Ok(out)
}

impl Tight {
    fn new(session: &Session, case: SpeedErrorCase, n: usize) -> Result<Tight> {
        let settings = MethodSettings::default().rtol(1e-10);
        let name = format!("{}_{n}.toml", case.name());
        let solved = Solved::new(session, &name, &case.scene(n), &settings)?;
        if !solved.solution.converged() {
            return Err(Error::not_converged(format!(
                "{name}: {}",
                solved.solution.status
            )));
        }
        let local = solved.solver.problem().local.iter();
        let size = local
            .zip(&solved.solution.u)
            .map(|(sub, u)| energy(sub, u))
            .sum();
        Ok(Tight { solved, size })
    }

    /// ‖u_h − u‖² against the known solution.
    fn exact_square(&self) -> Result<f64> {
        let mut sum = 0.0;
        let local = self.solved.solver.problem().local.iter();
        for (sub, u) in local.zip(&self.solved.solution.u) {
            let mesh = self.solved.scene.subdomain_mesh(sub.index)?;
            let squares = self.solved.scene.error_squares(&mesh, &mesh.nodal(u));
            sum += squares.map_or(f64::NAN, |[_, _, energy]| energy);
        }
        Ok(sum)
    }

    /// ‖u − u_h‖² on this mesh for u_h of a coarser one, whose nodes are nodes here.
    fn square_from(&self, coarse: &Tight) -> Result<f64> {
        let values = coarse.by_body()?;
        let scene = &self.solved.scene;
        let c = scene.components();
        let mut sum = 0.0;
        let local = self.solved.solver.problem().local.iter();
        for (sub, u) in local.zip(&self.solved.solution.u) {
            let body = &scene.bodies[sub.body];
            let (mesh, from) = (grid(body), grid(&coarse.solved.scene.bodies[sub.body]));
            let ratio = mesh.elements[0] / from.elements[0];
            let difference = sub.dofs.iter().zip(u).map(|(&dof, u)| {
                let inside = (dof - body.first_dof) as usize;
                let [i, j, _] = mesh.place(inside / c);
                // The corners of the coarse element around the node, and the position of the node in it.
                let line = |k: usize, d: usize| (k / ratio).min(from.elements[d] - 1);
                let [p, q] = [line(i, 0), line(j, 1)];
                let part = |k: usize, line: usize| k as f64 / ratio as f64 - line as f64;
                let [s, t] = [part(i, p), part(j, q)];
                let at = |p, q| values[sub.body][c * from.node([p, q, 0]) + inside % c];
                let below = (1.0 - s) * at(p, q) + s * at(p + 1, q);
                let above = (1.0 - s) * at(p, q + 1) + s * at(p + 1, q + 1);
                u - ((1.0 - t) * below + t * above)
            });
            sum += energy(sub, &difference.collect::<Vec<f64>>());
        }
        Ok(sum)
    }

    /// Values at all nodes of every body.
    fn by_body(&self) -> Result<Vec<Vec<f64>>> {
        let scene = &self.solved.scene;
        let c = scene.components();
        let sizes = scene.bodies.iter().map(|b| c * b.mesh().n_nodes());
        let mut out: Vec<Vec<f64>> = sizes.map(|n| vec![0.0; n]).collect();
        let local = self.solved.solver.problem().local.iter();
        for (sub, u) in local.zip(&self.solved.solution.u) {
            let (body, inside) = scene.body_of(sub.index);
            let mesh = scene.bodies[body].mesh();
            let nodal = scene.subdomain_mesh(sub.index)?.nodal(u);
            let nodes = mesh.subdomain_nodes(inside);
            for (node, values) in nodes.into_iter().zip(nodal.chunks_exact(c)) {
                let first = c * node;
                out[body][first..first + c].copy_from_slice(values);
            }
        }
        Ok(out)
    }
}

/// The bodies of this study are boxes.
fn grid(body: &Body) -> &BoxMesh {
    body.mesh().grid().expect("a box")
}

/// uᵀKu of a subdomain.
fn energy(sub: &Subdomain, u: &[f64]) -> f64 {
    let mut ku = vec![0.0; u.len()];
    sub.k.mul(u, &mut ku);
    u.iter().zip(&ku).map(|(a, b)| a * b).sum()
}
