//! Meshes of bodies before anything is counted: elements of second order on boxes, and subdomains of meshes of cells.

use super::model::body::{BodySpec, Cut};
use super::model::map::Map;
use crate::assembly::zero_energy::{self, ZeroEnergyMode};
use base::linalg::sorted::distinct;
use base::Result;
use elements::cell::{Element, Material};
use elements::element::{self, Doubt, Integration};
use elements::form::Form;
use mesh::partition::{subdomains_for, Interface, Partition, Sharing};
use mesh::{congruent, second_order, BoxMesh, CellMesh, Mesh, MeshFingerprint, MeshPartition};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Gives a body its final mesh. A copy of a mesh in `before`, also a turned or mirrored one, is cut as that is, so that
/// the subdomains of both are alike.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for cells that are inverted or degenerate, or that the form has no
/// element for.
pub(super) fn prepare(body: &mut BodySpec, form: &Form, before: &mut Cuts) -> Result<()> {
    if let (Mesh::Grid(grid), 2) = (&body.mesh, body.order) {
        let simplices = form.element == Element::P1;
        let mesh = match &before.of_box {
            // Copies of a body come one after the other.
            Some((like, map, mesh)) if like == grid && *map == body.map => mesh.clone(),
            _ => {
                let place = |point| body.map.as_ref().map_or(point, |map| map.apply(point));
                let mesh = Arc::new(second_order(grid, simplices, place));
                before.of_box = Some((*grid, body.map.clone(), mesh.clone()));
                mesh
            }
        };
        body.mesh = Mesh::Cells(mesh);
        // The nodes have been mapped. What copies share stays one where nothing changes.
        if body.map.is_some() {
            body.map = None;
        }
        if body.cut != Cut::AsItIs {
            body.cut = Cut::AsItIs;
        }
    }
    let Mesh::Cells(mesh) = &body.mesh else {
        return Ok(());
    };
    let n = wanted(body, mesh, form);
    let whole = body.integration.is_empty();
    let key = (Arc::as_ptr(mesh) as usize, n);
    if let (true, Some((_, done))) = (whole, before.copies.get(&key)) {
        body.mesh = Mesh::Cells(done.clone());
        return Ok(());
    }
    let name = &body.name;
    match check(mesh, form, &body.integration) {
        Err(message) => {
            return body.error(message);
        }
        Ok(doubts) => {
            let about = |doubt| format!("body `{name}`: {doubt}");
            before.warnings.extend(doubts.map(about));
        }
    }
    let (whole_mesh, mut mesh) = (mesh.clone(), mesh.clone());
    if n > 0 {
        before.cut(&mut mesh, n);
    }
    if whole {
        before.copies.insert(key, (whole_mesh, mesh.clone()));
    }
    body.mesh = Mesh::Cells(mesh);
    Ok(())
}

/// The number of subdomains into which a mesh is to be cut; 0 if it stays as it is.
fn wanted(body: &BodySpec, mesh: &CellMesh, form: &Form) -> usize {
    match body.cut {
        Cut::AsItIs => 0,
        Cut::Auto => subdomains_for(mesh.points.len() * form.components(mesh.dim), mesh.dim),
        Cut::Into(n) => n,
    }
}

/// The motions without energy of a body's mesh beyond the rigid ones. Where subdomains share nodes that they move,
/// these become vertices, so that no subdomain has such a motion by itself.
pub(super) fn slack(body: &mut BodySpec, form: &Form) -> Vec<ZeroEnergyMode> {
    let Mesh::Cells(mesh) = &body.mesh else {
        return Vec::new();
    };
    if body.integration.is_empty() {
        return Vec::new();
    }
    let found = zero_energy::slack(form, mesh, &body.integration, &|node| body.position(node));
    let c = form.components(mesh.dim) as u32;
    let moves = found.iter().flatten().map(|e| e.0 / c);
    let shared = |k: &u32| mesh.parts.sharers(*k as usize).len() > 1;
    let shared: Vec<u32> = distinct(moves.filter(shared));
    if !shared.is_empty() {
        let mut mesh = mesh.clone();
        Arc::make_mut(&mut mesh).parts.make_vertices(&shared);
        body.mesh = Mesh::Cells(mesh);
    }
    found
}

/// The meshes that are known so far.
#[derive(Default)]
pub(super) struct Cuts {
    /// The meshes that have been cut.
    cut: Vec<KnownCut>,
    /// Meshes that copies share, by where they are in memory: as they were, and what has become of them. The number is
    /// 0 for those that stay as they are.
    copies: HashMap<(usize, usize), (Arc<CellMesh>, Arc<CellMesh>)>,
    /// Warnings, a sentence for each circumstance that makes cells of the meshes doubtful.
    pub warnings: Vec<String>,
    /// The last box that has got elements of second order.
    of_box: Option<(BoxMesh, Option<Map>, Arc<CellMesh>)>,
}

/// A mesh that has been cut.
struct KnownCut {
    /// Number of subdomains that it was to have.
    n: usize,
    outline: MeshFingerprint,
    /// The mesh as it was.
    whole: Arc<CellMesh>,
    /// The mesh with its subdomains.
    mesh: Arc<CellMesh>,
}

impl KnownCut {
    /// Whether another mesh that is to have `n` subdomains is a copy of this one.
    fn is_of(&self, mesh: &CellMesh, outline: &MeshFingerprint, n: usize) -> bool {
        self.n == n && self.outline.may_be(outline) && congruent(&self.whole, mesh)
    }
}

impl Cuts {
    /// Cuts the meshes of bodies, one of those that are copies of each other; with all threads if `alone` on the
    /// machine.
    pub fn ahead(&mut self, bodies: &[BodySpec], form: &Form, alone: bool) {
        let mut seen = HashSet::new();
        for body in bodies {
            let Mesh::Cells(mesh) = &body.mesh else {
                continue;
            };
            let n = wanted(body, mesh, form);
            if n == 0 || !seen.insert((Arc::as_ptr(mesh), n)) {
                continue;
            }
            let outline = MeshFingerprint::new(mesh);
            if !self.cut.iter().any(|k| k.is_of(mesh, &outline, n)) {
                self.cut.push(KnownCut {
                    n,
                    outline,
                    whole: mesh.clone(),
                    mesh: mesh.clone(),
                });
            }
        }
        let cut = |known: &mut KnownCut| cut(Arc::make_mut(&mut known.mesh), known.n);
        match alone && self.cut.len() > 1 {
            true => self.cut.par_iter_mut().with_max_len(1).for_each(cut),
            false => self.cut.iter_mut().for_each(cut),
        }
    }

    /// Cuts a mesh as the first of its copies was cut, [ahead](Self::ahead).
    fn cut(&self, mesh: &mut Arc<CellMesh>, n: usize) {
        let own = |k: &&KnownCut| k.n == n && Arc::ptr_eq(&k.whole, mesh);
        if let Some(known) = self.cut.iter().find(own) {
            *mesh = known.mesh.clone();
            return;
        }
        let outline = MeshFingerprint::new(mesh);
        let known = self.cut.iter().find(|k| k.is_of(mesh, &outline, n));
        let known = known.expect("a copy of a mesh that has been cut");
        let mesh = Arc::make_mut(mesh);
        mesh.parts = known.mesh.parts.clone();
        mesh.forget_adjacency();
    }
}

/// Cuts a mesh into `n` subdomains of about equal work.
fn cut(mesh: &mut CellMesh, n: usize) {
    let adjacency = mesh.adjacency();
    let work: Vec<f64> = mesh
        .cells
        .kinds()
        .iter()
        .map(|k| k.nodes() as f64)
        .collect();
    let partition = Partition::new(&mesh.cells, &adjacency, &work, n);
    let (cells, points) = (&mesh.cells, &mesh.points);
    let sharing = Sharing::new(cells, &partition.part, partition.n, points.len());
    let interface = Interface::new(cells, &adjacency, points, &partition.part, &sharing, true);
    mesh.parts = MeshPartition::new(partition.part, sharing, interface);
    mesh.forget_adjacency();
}

/// Checks every cell: its shape, and whether the form has an element of its kind. Returns a sentence on cells that are
/// sound where they are integrated and not at their nodes, if there are any.
fn check(
    mesh: &CellMesh,
    form: &Form,
    rules: &[Integration],
) -> std::result::Result<Option<String>, String> {
    let material: Material = form.material(1.0, 0.3);
    let mut known = None;
    let mut worst: Option<(usize, Doubt)> = None;
    let mut doubtful = 0;
    for c in 0..mesh.cells.len() {
        let (kind, id) = (mesh.cells.kind(c), mesh.cell_ids[c]);
        let rule = rules.get(c).copied().unwrap_or(Integration::Full);
        if known != Some((kind, rule)) {
            element::check(kind, mesh.dim, &material, rule)
                .map_err(|message| format!("cell {id} is a {}: {message}", kind.name()))?;
            known = Some((kind, rule));
        }
        let found = element::check_jacobian(kind, mesh.dim, &mesh.cell_points(c), rule)
            .map_err(|bad| format!("cell {id}, a {}, {bad}", kind.name()))?;
        if let Some(doubt) = found {
            doubtful += 1;
            if worst.is_none_or(|(_, last)| doubt.jacobian < last.jacobian) {
                worst = Some((c, doubt));
            }
        }
    }
    Ok(worst.map(|(c, doubt)| doubts(mesh, c, doubt, doubtful)))
}

/// The sentence on `n` doubtful cells, of which `c` is the worst.
fn doubts(mesh: &CellMesh, c: usize, doubt: Doubt, n: usize) -> String {
    let (kind, id) = (mesh.cells.kind(c).name(), mesh.cell_ids[c]);
    let place = match doubt.node {
        Some(k) => {
            let node = mesh.cells.nodes(c)[k] as usize;
            format!("at its node {}", mesh.node_ids[node])
        }
        None => "near its boundary".into(),
    };
    let what = match doubt.jacobian {
        j if j < 0.0 => format!("is folded {place}, where its Jacobian is {j:.2e} of its mean"),
        _ => format!("has no volume {place}"),
    };
    let of = match n {
        1 => String::new(),
        n => format!(" (the worst of {n} such cells)"),
    };
    format!(
        "cell {id}, a {kind}, {what}{of}; it is sound at all points of integration and is solved as it is, but its \
         stresses are doubtful"
    )
}
