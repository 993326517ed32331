//! The fields of the solution on rank 0, and as VTU.

use std::collections::HashMap;
use std::iter::repeat_n;
use std::path::Path;

use crate::fem::cell::{centre_stress, CellStress};
use crate::fem::{element, Elements, SubdomainMesh};
use crate::mesh::{CellKind, Cells};
use crate::parallel::exchange::exchange_words;
use crate::petsc::Session;
use crate::report::paraview::contact_fields::ContactFields;
use crate::report::paraview::vtu::Vtu;
use crate::scene::{Scene, SteppedMesh};
use crate::substructures::{BodyNode, SolvedRow};
use crate::{FetiFeti, Result, Solution};

/// The meshes and the solution of the whole scene on rank 0, subdomain after subdomain; empty on the other ranks.
/// Meshes are built once, and every load step brings its u and stress.
#[derive(Default)]
pub struct Gathered {
    meshes: Vec<SteppedMesh>,
    pub(super) points: Vec<[f64; 3]>,
    pub(super) cells: Cells,
    pub(super) body: Vec<u32>,
    pub(super) subdomain: Vec<u32>,
    /// C components per point.
    pub(super) u: Vec<f64>,
    /// ρ, or Young's modulus.
    pub(super) rho: Vec<f64>,
    /// Poisson's ratio and stress by cell, in elasticity.
    poisson: Vec<f64>,
    pub(super) stress: Vec<CellStress>,
    /// Body of each point.
    owner: Vec<u32>,
}

impl Gathered {
    /// The meshes of a scene, without a solution. Collective.
    ///
    /// # Errors
    /// As [`Scene::subdomain_mesh`].
    pub fn new(session: &Session, scene: &Scene) -> Result<Gathered> {
        let mine = match session.rank() {
            0 => scene.n_subdomains(),
            _ => 0,
        };
        session.agree(Gathered::of(scene, mine))
    }

    fn of(scene: &Scene, n_subdomains: usize) -> Result<Gathered> {
        let mut all = Gathered::default();
        for index in 0..n_subdomains {
            let mut stepped = SteppedMesh::new(scene, index)?;
            let mesh = stepped.at(1.0);
            let (first, cells) = (all.points.len(), mesh.n_elements());
            let body = mesh.body as u32;
            all.points.extend(&mesh.points);
            all.owner.extend(repeat_n(body, mesh.points.len()));
            all.body.extend(repeat_n(body, cells));
            all.subdomain.extend(repeat_n(index as u32, cells));
            for (kind, nodes) in mesh.cells().iter() {
                let shifted: Vec<u32> = nodes.iter().map(|p| first as u32 + p).collect();
                all.cells.push(kind, &shifted);
            }
            all.rho.extend(&mesh.rho);
            all.poisson.extend(&mesh.poisson);
            all.meshes.push(stepped);
        }
        Ok(all)
    }

    /// Brings the solution of load step `step` to rank 0. Collective.
    pub fn gather(
        &mut self,
        session: &Session,
        scene: &Scene,
        solver: &FetiFeti,
        solution: &Solution,
        step: usize,
    ) {
        // [subdomain, n, u × n] to rank 0
        let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); session.size()];
        for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
            outgoing[0].extend([sub.index as u64, u.len() as u64]);
            outgoing[0].extend(u.iter().map(|v| v.to_bits()));
        }
        let received = exchange_words(session.comm(), outgoing).concat();
        let mut parts: Vec<(usize, &[u64])> = Vec::new();
        let mut rest = &received[..];
        while let [index, n, tail @ ..] = rest {
            let (values, tail) = tail.split_at(*n as usize);
            parts.push((*index as usize, values));
            rest = tail;
        }
        parts.sort_unstable_by_key(|p| p.0);
        let scale = scene.prescribed_factor(step);
        self.u.clear();
        self.stress.clear();
        for (index, values) in parts {
            let mesh = self.meshes[index].at(scale);
            let u: Vec<f64> = values.iter().map(|&w| f64::from_bits(w)).collect();
            let nodal = mesh.nodal(&u);
            if scene.form.is_elastic() {
                self.stress.extend(stresses(mesh, &nodal));
            }
            self.u.extend(nodal);
        }
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

    /// For the nodes of the rows, the points that are copies of (body, node).
    pub(super) fn copies(
        &self,
        scene: &Scene,
        rows: &[SolvedRow],
    ) -> HashMap<BodyNode, Vec<usize>> {
        let key = |body: u32, point: [f64; 3]| (body, point.map(f64::to_bits));
        let mut wanted = HashMap::new();
        for &member in rows.iter().flat_map(|r| r.label.members.iter().flatten()) {
            let point = member.position(&scene.bodies);
            wanted.insert(key(member.body as u32, point), member);
        }
        let mut out: HashMap<BodyNode, Vec<usize>> = HashMap::new();
        for (p, (&body, &point)) in self.owner.iter().zip(&self.points).enumerate() {
            if let Some(&member) = wanted.get(&key(body, point)) {
                out.entry(member).or_default().push(p);
            }
        }
        out
    }

    /// Multiplier, gap and contact at the points; every copy of a node gets them.
    fn contact_fields(&self, scene: &Scene, rows: &[SolvedRow]) -> Result<Option<ContactFields>> {
        if rows.iter().all(|r| !r.is_inequality()) {
            return Ok(None);
        }
        let copies = self.copies(scene, rows);
        let mut fields = ContactFields::new(self.points.len());
        for row in rows.iter().filter(|r| r.is_inequality()) {
            for member in row.label.members.iter().flatten() {
                for &p in copies.get(member).into_iter().flatten() {
                    fields.add(p, row.multiplier, row.gap, row.holds())?;
                    if scene.has_pressure() {
                        fields.add_area(p, row.label.area)?;
                    }
                }
            }
        }
        fields.divide();
        Ok(Some(fields))
    }

    /// u in VTK's form: a number, or three components.
    fn vectors(&self, scene: &Scene) -> (usize, Vec<f64>) {
        match scene.components() {
            1 => (1, self.u.clone()),
            c => {
                let three = |u: &[f64]| [u[0], u[1], u.get(2).copied().unwrap_or(0.0)];
                (3, self.u.chunks_exact(c).flat_map(three).collect())
            }
        }
    }

    /// Writes `NAME.vtu` into `dir`.
    pub fn write_vtu(
        &self,
        scene: &Scene,
        rows: &[SolvedRow],
        dir: &Path,
        name: &str,
    ) -> Result<()> {
        let body: Vec<i32> = self.body.iter().map(|&b| b as i32).collect();
        let subdomain: Vec<i32> = self.subdomain.iter().map(|&s| s as i32).collect();
        let contact = self.contact_fields(scene, rows)?;
        let (c, u) = self.vectors(scene);
        let by_cell = |f: fn(&CellStress) -> f64| self.stress.iter().map(f).collect::<Vec<f64>>();
        let von_mises = by_cell(CellStress::von_mises);
        let pressure = by_cell(CellStress::pressure);
        let stress: Vec<f64> = self.stress.iter().flat_map(symmetric).collect();
        let mut grid = Vtu::new(&self.points, &self.cells).point_data("u", c, &u[..]);
        if let Some(contact) = &contact {
            grid = contact.on(grid);
        }
        grid = if scene.form.is_elastic() {
            grid.cell_data("young", 1, &self.rho[..])
                .cell_data("poisson", 1, &self.poisson[..])
                .cell_data("von_mises", 1, &von_mises[..])
                .cell_data("pressure", 1, &pressure[..])
                .cell_data("stress", 6, &stress[..])
        } else {
            grid.cell_data("rho", 1, &self.rho[..])
        };
        grid.cell_data("body", 1, &body[..])
            .cell_data("subdomain", 1, &subdomain[..])
            .write(&dir.join(format!("{name}.vtu")))
    }
}

/// Stress at the centres of the cells of a subdomain.
fn stresses(mesh: &SubdomainMesh, nodal: &[f64]) -> Vec<CellStress> {
    let c = mesh.components();
    let values = |nodes: &mut dyn Iterator<Item = usize>| -> Vec<f64> {
        nodes
            .flat_map(|k| &nodal[c * k..c * (k + 1)])
            .copied()
            .collect()
    };
    match &mesh.elements {
        Elements::Grid(grid) => {
            let n = grid.corners();
            let stress = |(e, place)| {
                let nodes = grid.element_nodes(place);
                let points = mesh.element_points(grid, place);
                let u = values(&mut nodes[..n].iter().copied());
                let element = mesh.form.element;
                centre_stress(mesh.dim, &points[..n], element, &mesh.material(e), &u)
            };
            grid.element_places().enumerate().map(stress).collect()
        }
        Elements::Cells(cells) => {
            let stress = |(e, (kind, nodes)): (usize, (_, &[u32]))| {
                let points: Vec<_> = nodes.iter().map(|&k| mesh.points[k as usize]).collect();
                let u = values(&mut nodes.iter().map(|&k| k as usize));
                mean_stress(mesh, e, kind, &points, &u)
            };
            cells.iter().enumerate().map(stress).collect()
        }
    }
}

/// The mean over its nodes of the stress of a cell.
fn mean_stress(
    mesh: &SubdomainMesh,
    e: usize,
    kind: CellKind,
    points: &[[f64; 3]],
    u: &[f64],
) -> CellStress {
    let mut at = vec![element::NodeStress::default(); points.len()];
    let (material, rule) = (mesh.material(e), mesh.integration(e));
    element::stress_at_nodes(kind, mesh.dim, points, &material, rule, u, &mut at);
    let mean = |of: fn(&element::NodeStress) -> &[f64; 6]| {
        let mut sum = [0.0; 6];
        for node in &at {
            sum.iter_mut()
                .zip(of(node))
                .for_each(|(s, v)| *s += v / at.len() as f64);
        }
        let [xx, yy, zz, xy, yz, xz] = sum;
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    };
    CellStress {
        strain: mean(|n| &n.strain),
        stress: mean(|n| &n.stress),
    }
}

/// The components of stress in ParaView's order: xx, yy, zz, xy, yz, xz.
fn symmetric(s: &CellStress) -> [f64; 6] {
    let s = &s.stress;
    [s[0][0], s[1][1], s[2][2], s[0][1], s[1][2], s[0][2]]
}
