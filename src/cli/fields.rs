//! The solution as VTU and PNG, gathered on rank 0.

use std::collections::HashMap;
use std::path::Path;

use super::contact::ContactRow;
use crate::feti::exchange::exchange_words;
use crate::feti::{FetiFeti, Solution};
use crate::petsc::Session;
use crate::report::contact_fields::ContactFields;
use crate::report::field::{self, ContactMark, Mesh};
use crate::report::vtu::{Shape, Vtu};
use crate::scene::Scene;
use crate::Result;

/// The whole solution, subdomain after subdomain.
#[derive(Default)]
pub struct Gathered {
    points: Vec<[f64; 3]>,
    /// Corners of each cell as VTK numbers them, one cell after the other.
    cells: Vec<u32>,
    body: Vec<u32>,
    subdomain: Vec<u32>,
    u: Vec<f64>,
    rho: Vec<f64>,
    /// Body of each point.
    owner: Vec<u32>,
}

impl Gathered {
    /// Gathers the solution of load step `step`; `None` on all ranks but the first. Collective.
    pub fn new(
        session: &Session,
        scene: &Scene,
        solver: &FetiFeti,
        solution: &Solution,
        step: usize,
    ) -> Result<Option<Gathered>> {
        // [subdomain, n, u × n] to rank 0
        let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); session.size()];
        for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
            outgoing[0].extend([sub.index as u64, u.len() as u64]);
            outgoing[0].extend(u.iter().map(|v| v.to_bits()));
        }
        let received = exchange_words(session.comm(), outgoing).concat();
        if session.rank() > 0 {
            return Ok(None);
        }
        Gathered::assemble(scene, &received, step).map(Some)
    }

    fn assemble(scene: &Scene, words: &[u64], step: usize) -> Result<Gathered> {
        let mut parts: Vec<(usize, &[u64])> = Vec::new();
        let mut rest = words;
        while let [index, n, tail @ ..] = rest {
            let (values, tail) = tail.split_at(*n as usize);
            parts.push((*index as usize, values));
            rest = tail;
        }
        parts.sort_unstable_by_key(|p| p.0);
        let mut all = Gathered::default();
        // Meshes have the given values of the last load step.
        let last = scene.prescribed_factor(scene.n_steps() - 1);
        let now = scene.prescribed_factor(step);
        for (index, values) in parts {
            let mut mesh = scene.subdomain_mesh(index)?;
            if now != last {
                let scale = if last != 0.0 { now / last } else { 0.0 };
                mesh.prescribed.iter_mut().for_each(|v| *v *= scale);
            }
            let u: Vec<f64> = values.iter().map(|&w| f64::from_bits(w)).collect();
            let first = all.points.len();
            all.u.extend(mesh.nodal(&u));
            all.points.extend(&mesh.points);
            let owner = std::iter::repeat_n(mesh.body as u32, mesh.points.len());
            all.owner.extend(owner);
            let cells = mesh.n_elements();
            let body = std::iter::repeat_n(mesh.body as u32, cells);
            all.body.extend(body);
            let subdomain = std::iter::repeat_n(index as u32, cells);
            all.subdomain.extend(subdomain);
            let shifted = mesh.cells().into_iter().map(|p| (first + p) as u32);
            all.cells.extend(shifted);
            all.rho.extend(&mesh.rho);
        }
        Ok(all)
    }

    /// Multiplier, gap and contact at the points, on every copy of a node.
    fn contact_fields(&self, scene: &Scene, rows: &[ContactRow]) -> Result<Option<ContactFields>> {
        if rows.iter().all(|r| !r.inequality) {
            return Ok(None);
        }
        let key = |body: u32, point: [f64; 3]| (body, point.map(f64::to_bits));
        let mut copies: HashMap<(u32, [u64; 3]), Vec<usize>> = HashMap::new();
        for (p, (&body, &point)) in self.owner.iter().zip(&self.points).enumerate() {
            copies.entry(key(body, point)).or_default().push(p);
        }
        let mut fields = ContactFields::new(self.points.len());
        for row in rows.iter().filter(|r| r.inequality) {
            for &(body, node) in row.members.iter().flatten() {
                let spec = &scene.bodies[body].spec;
                let point = spec.position(spec.mesh.place(node));
                for &p in copies.get(&key(body as u32, point)).into_iter().flatten() {
                    fields.add(p, row.multiplier, row.distance, row.active)?;
                }
            }
        }
        Ok(Some(fields))
    }

    /// Writes `NAME.vtu` into `dir`.
    pub fn write_vtu(
        &self,
        scene: &Scene,
        rows: &[ContactRow],
        dir: &Path,
        name: &str,
    ) -> Result<()> {
        let shape = [Shape::Quad, Shape::Hexahedron][scene.dim() - 2];
        let c = scene.components();
        let body: Vec<i32> = self.body.iter().map(|&b| b as i32).collect();
        let subdomain: Vec<i32> = self.subdomain.iter().map(|&s| s as i32).collect();
        let contact = self.contact_fields(scene, rows)?;
        let mut grid = Vtu::new(&self.points, shape, &self.cells).point_data("u", c, &self.u[..]);
        if let Some(contact) = &contact {
            grid = contact.on(grid);
        }
        grid.cell_data("rho", 1, &self.rho[..])
            .cell_data("body", 1, &body[..])
            .cell_data("subdomain", 1, &subdomain[..])
            .write(&dir.join(format!("{name}.vtu")))
    }

    /// Writes `solution.png` into `dir`.
    pub fn write_picture(&self, title: &str, marks: &[ContactMark], dir: &Path) -> Result<()> {
        let points: Vec<[f64; 2]> = self.points.iter().map(|p| [p[0], p[1]]).collect();
        let quads: Vec<[u32; 4]> = self
            .cells
            .chunks_exact(4)
            .map(|q| [q[0], q[1], q[2], q[3]])
            .collect();
        let mesh = Mesh {
            points: &points,
            quads: &quads,
            body: &self.body,
            subdomain: &self.subdomain,
        };
        let path = dir.join("solution.png");
        field::write_solution(&mesh, &self.u, &self.rho, marks, title, &path)
    }
}
