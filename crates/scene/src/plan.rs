//! The sizes of the problem that a scene describes, counted without assembling it.

use super::body::Body;
use super::checked::Scene;
use super::geometry::interface::{InterfaceShape, Link};
use super::numbering::Numbering;
use super::rows::row::Row;
use base::Result;
use fetifeti::problem::RowSource;
use mesh::Mesh;
use std::collections::HashSet;

/// The sizes of one body.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyPlan {
    /// Its name.
    pub name: String,
    /// Lower left corner of its box.
    pub origin: [f64; 3],
    /// Edge lengths of its box.
    pub size: [f64; 3],
    /// Elements in x, y and z (0 in the plane); of a mesh of cells all in x.
    pub elements: [usize; 3],
    /// Subdomains in x, y and z; of a mesh of cells all in x.
    pub subdomains: [usize; 3],
    /// Free degrees of freedom.
    pub dofs: usize,
    /// Degrees of freedom with a given value.
    pub prescribed: usize,
    /// Free degrees of freedom at vertices that subdomains share: primal constraints. Edges add further constraints.
    pub primal: usize,
    /// Edges with free degrees of freedom that subdomains share, by component: primal averages of a solid.
    pub edges: usize,
    /// Rows of B_loc.
    pub local_multipliers: usize,
}

/// The sizes of one pair of bodies that touch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InterfacePlan {
    /// The bodies.
    pub bodies: [usize; 2],
    /// Whether they meet in a corner only.
    pub corner: bool,
    /// Number of common nodes.
    pub nodes: usize,
    /// Nodes of one body without a partner in the other.
    pub unmatched: usize,
    /// Nodes that are tied.
    pub tied: usize,
    /// Nodes that are in contact.
    pub contact: usize,
    /// The body that carries the multipliers where nodes do not match.
    pub multipliers: Option<usize>,
}

/// The sizes of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenePlan {
    /// Title of the scene.
    pub title: String,
    /// Its bodies.
    pub bodies: Vec<BodyPlan>,
    /// Its pairs of bodies.
    pub interfaces: Vec<InterfacePlan>,
    /// Number of subdomains.
    pub subdomains: usize,
    /// Number of elements.
    pub elements: usize,
    /// Free degrees of freedom, counted once in every body.
    pub dofs: usize,
    /// Unknowns of the assembled problem.
    pub assembled: u64,
    /// Primal constraints.
    pub primal: usize,
    /// Rows of B_loc.
    pub local_multipliers: usize,
    /// Rows of B_gl that hold initially, inequalities included, without equations.
    pub global_multipliers: usize,
    /// Rows of B_gl that do not hold initially: candidate contact nodes of faces that are tied in part.
    pub open_rows: usize,
    /// Pairs of bodies in contact.
    pub contact_pairs: usize,
    /// Rows u_a − u_b ≤ g: candidate contact nodes.
    pub contact_rows: usize,
    /// Obstacles: sides of bodies with a bound; lower and upper bounds count separately.
    pub obstacles: usize,
    /// Rows of obstacles.
    pub obstacle_rows: usize,
    /// Load steps, `None` without `[steps]`.
    pub steps: Option<usize>,
}

impl Scene {
    /// Counts the sizes.
    pub fn plan(&self) -> ScenePlan {
        debug_assert!(self.is_whole, "a part has no counts of the whole");
        let bodies: Vec<BodyPlan> = (0..self.n_bodies()).map(|b| self.body_plan(b)).collect();
        let interfaces = self
            .interfaces
            .iter()
            .map(|i| InterfacePlan {
                bodies: i.bodies,
                corner: i.shape == InterfaceShape::Corner,
                nodes: i.shared.len(),
                unmatched: i.unmatched.len(),
                tied: i.shared.iter().filter(|s| s.link == Link::Tied).count(),
                contact: i.shared.iter().filter(|s| s.link.is_contact()).count(),
                multipliers: i.mortar.as_ref().map(|m| i.bodies[m.multipliers]),
            })
            .collect();
        ScenePlan {
            title: self.title.clone(),
            interfaces,
            subdomains: self.n_subdomains(),
            elements: self.bodies.iter().map(|b| b.mesh().n_elements()).sum(),
            dofs: self.dofs(),
            assembled: Numbering::new(self).len(),
            primal: bodies.iter().map(|b| b.primal).sum(),
            local_multipliers: bodies.iter().map(|b| b.local_multipliers).sum(),
            global_multipliers: self
                .rows_that(|r| r.holds && !matches!(r.source, RowSource::Equation(_))),
            open_rows: self.rows_that(|r| !r.holds && !r.law.is_inequality()),
            contact_pairs: self.interfaces.iter().filter(|i| i.has_contact()).count(),
            contact_rows: self.rows_that(|r| r.law.is_inequality() && !r.is_beside_obstacle()),
            obstacles: self.obstacles.len(),
            obstacle_rows: self.rows_that(Row::is_beside_obstacle),
            steps: self.steps.as_ref().map(|s| s.times.len()),
            bodies,
        }
    }

    /// Evaluates ρ and the load in every element, as assembly will, and reports the first bad value.
    ///
    /// # Errors
    /// As [`Scene::substructures`].
    pub fn check_values(&self) -> Result<()> {
        (0..self.n_subdomains()).try_for_each(|s| self.subdomain(s).map(drop))
    }

    fn rows_that(&self, is: impl Fn(&Row) -> bool) -> usize {
        self.rows.iter().filter(|r| is(r)).count()
    }

    fn body_plan(&self, b: usize) -> BodyPlan {
        let body = &self.bodies[b];
        let mesh = body.mesh();
        let mut counts = EntityCounts::default();
        for node in mesh.shared_nodes() {
            counts.add(body, node);
        }
        let (origin, size, elements) = match mesh {
            Mesh::Grid(grid) => (grid.origin, grid.size, grid.elements),
            Mesh::Cells(mesh) => {
                let [low, high] = body.bounds;
                let size = [0, 1, 2].map(|d| high[d] - low[d]);
                (low, size, [mesh.cells.len(), 0, 0])
            }
        };
        BodyPlan {
            name: body.spec.name.clone(),
            origin,
            size,
            elements,
            subdomains: mesh.subdomain_counts(),
            dofs: mesh.n_nodes() * body.components - body.prescribed.len(),
            prescribed: body.prescribed.len(),
            primal: counts.primal,
            edges: counts.edges.len() + entities_of_cells(body),
            local_multipliers: counts.multipliers,
        }
    }
}

/// Numbers of shared entities inside a body.
#[derive(Default)]
struct EntityCounts {
    primal: usize,
    multipliers: usize,
    edges: HashSet<([usize; 3], usize)>,
}

impl EntityCounts {
    fn add(&mut self, body: &Body, node: usize) {
        let mesh = body.mesh();
        let copies = mesh.multiplicity(node);
        let vertex = mesh.is_vertex(node);
        // The directions along which the node lies inside an edge or face of its subdomains.
        let grid = mesh
            .grid()
            .map(|grid| (grid.block_elements(), grid.place(node)));
        let inner: Vec<usize> = match grid {
            Some((each, place)) => (0..mesh.dim())
                .filter(|&d| place[d] % each[d] != 0)
                .collect(),
            None => Vec::new(),
        };
        for c in 0..body.components {
            if body.prescribed_at(node * body.components + c).is_some() {
                continue;
            }
            if vertex {
                self.primal += 1;
                continue;
            }
            self.multipliers += copies * (copies - 1) / 2;
            if let (3, &[along], Some((each, place))) = (mesh.dim(), &inner[..], grid) {
                let mut edge = place;
                edge[along] = place[along] / each[along] * each[along];
                // The direction is part of the key: edges along different directions may start at one vertex.
                edge[along] = edge[along] * 3 + along;
                self.edges.insert((edge, c));
            }
        }
    }
}

/// Shared edges with free degrees of freedom of a mesh of cells, by component.
fn entities_of_cells(body: &Body) -> usize {
    let Some(mesh) = body.mesh().cells() else {
        return 0;
    };
    let c = body.components;
    let free = |nodes: &[u32], component: usize| {
        let given = |&k: &u32| body.prescribed_at(k as usize * c + component).is_some();
        !nodes.iter().all(given)
    };
    let edges = mesh
        .parts
        .all_entities()
        .iter()
        .filter(|(dim, _)| *dim == 1);
    edges
        .map(|(_, nodes)| (0..c).filter(|&k| free(nodes, k)).count())
        .sum()
}
