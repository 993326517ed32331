//! Scenes: what the user writes, and everything that follows from it before a matrix is solved with.
//!
//! ```text
//! TOML ── read ──> SceneSpec ── Scene::new ──> Scene ──┬─> Substructures   (the method)
//!                     ▲                                ├─> Numbering       (assembled baselines)
//!      a program ─────┘                                ├─> SubdomainMesh   (output, error norms)
//!                                                      └─> Plan            (what will be built)
//! ```
//!
//! A [`SceneSpec`] is unchecked data, a [`Scene`] is checked and has every default filled in. A scene is small: it holds
//! what happens on the boundaries of bodies, O(boundary nodes), and is the same on every rank; matrices are made
//! subdomain by subdomain, on the rank that owns the subdomain. Coefficients from arrays in files are read there, too.

mod coefficient;
pub(crate) mod distribution;
pub(crate) mod geometry;
mod joint;
pub(crate) mod model;
mod numbering;
mod plan;
mod read;
pub(crate) mod rows;
mod validate;

pub use geometry::interface::{Interface, Link, Shape, SharedNode};
pub use model::cells::{Cells, NumberFormat, Tone};
pub use model::expr::gradient::Dual;
pub use model::expr::{Expr, Variables};
pub use model::field::{At, By, Field, Region};
pub use model::map::{BodyShape, Map, Round};
pub use model::profile::{Limit, Limits, Profile};
pub use model::rigid::Rigid;
pub use model::spec::{
    free_all_round, held_all_round, lee, BodySpec, ByDefault, ContactSpec, Extent, Faces, Force,
    GridSpec, Load, ObstacleSpec, Pair, SceneSpec, Sides, SurfaceLoad, TieSpec, SIDES,
};
pub use model::steps::{Ramp, Steps, StepsSpec};
pub use numbering::Numbering;
pub use plan::{BodyPlan, InterfacePlan, Plan};
pub use rows::obstacles::Obstacle;
pub use rows::points::{Direction, Member, Point, PointBound, PointRow};
pub use rows::table::{RowLabel, RowSource};

use crate::error::{Error, Result};
use crate::fem::Form;
use crate::linalg::vec3::ball;
use crate::mesh::BoxMesh;
use std::path::Path;

/// A body of a checked scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// What was written about it.
    pub spec: BodySpec,
    /// Number C of components of the field.
    pub components: usize,
    /// Body dof of its first degree of freedom; component c of its node k has the number `first_dof + C k + c`.
    pub first_dof: u64,
    /// Global index of its subdomain 0.
    pub first_subdomain: usize,
    /// Degrees of freedom C k + c with a given value, in increasing order: Dirichlet sides, and nodes that are tied to such a node of
    /// another body. Values are those before any factor of a load step.
    pub prescribed: Vec<(usize, f64)>,
    /// Least and greatest coordinates of its nodes.
    pub bounds: [[f64; 3]; 2],
}

impl Body {
    /// Its mesh.
    pub fn mesh(&self) -> &BoxMesh {
        &self.spec.mesh
    }

    /// Centre and radius of the ball around its [`Body::bounds`].
    pub fn ball(&self) -> ([f64; 3], f64) {
        ball(self.bounds)
    }

    /// The given value of degree of freedom `dof` = C k + c, if there is one.
    pub fn prescribed_at(&self, dof: usize) -> Option<f64> {
        self.prescribed
            .binary_search_by_key(&dof, |&(n, _)| n)
            .ok()
            .map(|k| self.prescribed[k].1)
    }
}

/// A checked scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Title for reports.
    pub title: String,
    /// What is solved, and by which elements.
    pub form: Form,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// Pairs of bodies that touch, by increasing numbers, and the nodes at which they meet.
    pub interfaces: Vec<Interface>,
    /// Points at which nodes of several bodies coincide or meet an obstacle, by increasing [`Point::block`].
    pub points: Vec<Point>,
    /// Rigid obstacles, by body, side and bound.
    pub obstacles: Vec<Obstacle>,
    /// Load steps; `None`: everything is applied at once.
    pub steps: Option<Steps>,
    /// The exact solution by components, if it is known.
    pub exact: Option<Vec<Expr>>,
    /// PETSc options (without the dash) that hold unless the command line says otherwise.
    pub options: Vec<(String, String)>,
    /// Number of subdomains.
    n_subdomains: usize,
}

impl Scene {
    /// Reads and checks the scene in the file `path`.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line and what was expected.
    pub fn load(path: impl AsRef<Path>) -> Result<Scene> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path)
            .map_err(|e| Error::Input(format!("{file}: the scene cannot be read: {e}")))?;
        Scene::parse(&file, &text)
    }

    /// Checks the scene in `text`; `file` names it in messages.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn parse(file: &str, text: &str) -> Result<Scene> {
        Scene::new(read::read(file, text)?)
    }

    /// Checks a scene that a program has built.
    ///
    /// # Errors
    /// [`Error::Input`] for overlapping bodies, non-matching nodes on tied faces, values out of range, ….
    pub fn new(mut spec: SceneSpec) -> Result<Scene> {
        validate::check(&spec)?;
        let steps = Steps::new(&spec)?;
        let mut bodies = Vec::with_capacity(spec.bodies.len());
        let (mut first_dof, mut first_subdomain) = (0, 0);
        for body in std::mem::take(&mut spec.bodies) {
            let components = spec.form.components(body.mesh.dim());
            let (nodes, subdomains) = (body.mesh.n_nodes(), body.mesh.n_subdomains());
            bodies.push(Body {
                components,
                prescribed: validate::dirichlet_dofs(&body, components)?,
                bounds: bounds_of(&body),
                spec: body,
                first_dof,
                first_subdomain,
            });
            first_dof += (nodes * components) as u64;
            first_subdomain += subdomains;
        }
        let interfaces = rows::entries::find(&bodies, &spec, &steps)?;
        let obstacles = rows::obstacles::find(&bodies, &spec.obstacles, spec.contacts.len())?;
        let mut points = rows::points::collect(&mut bodies, &interfaces)?;
        rows::bounds::Checks::new(&bodies, &interfaces, &obstacles, &spec, &steps)
            .apply(&mut points)?;
        validate::check_unknowns(&bodies)?;
        Ok(Scene {
            title: spec.title,
            form: spec.form,
            bodies,
            interfaces,
            points,
            obstacles,
            steps,
            exact: spec.exact,
            options: spec.options,
            n_subdomains: first_subdomain,
        })
    }

    /// The experiment of Table 1 of \[Lee\]; see [`lee`].
    ///
    /// # Errors
    /// [`Error::Input`] when a count is zero, or when no node lies in the middle third of any face.
    pub fn lee(bodies: usize, subdomains: usize, elements: usize, faces: Faces) -> Result<Scene> {
        Scene::new(lee(bodies, subdomains, elements, faces))
    }

    /// A grid of equal bodies, tied wherever they touch.
    ///
    /// # Errors
    /// As [`Scene::new`].
    pub fn grid(title: impl Into<String>, grid: &GridSpec) -> Result<Scene> {
        Scene::new(SceneSpec::tied(title, grid.expand()))
    }

    /// The dimension, 2 or 3.
    pub fn dim(&self) -> usize {
        self.bodies[0].mesh().dim()
    }

    /// Number C of components of the field.
    pub fn components(&self) -> usize {
        self.bodies[0].components
    }

    /// Number of bodies.
    pub fn n_bodies(&self) -> usize {
        self.bodies.len()
    }

    /// Number of subdomains of all bodies.
    pub fn n_subdomains(&self) -> usize {
        self.n_subdomains
    }

    /// The body that subdomain `index` belongs to, and the subdomain's number inside it.
    pub fn body_of(&self, index: usize) -> (usize, usize) {
        let body = self
            .bodies
            .partition_point(|b| b.first_subdomain <= index)
            .saturating_sub(1);
        (body, index - self.bodies[body].first_subdomain)
    }
}

/// Least and greatest coordinates of the nodes of a body.
fn bounds_of(body: &BodySpec) -> [[f64; 3]; 2] {
    if body.map.is_none() {
        return [body.mesh.origin, body.mesh.end()];
    }
    let mut out = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for place in body.mesh.boundary() {
        let point = body.position(place);
        for d in 0..3 {
            out[0][d] = out[0][d].min(point[d]);
            out[1][d] = out[1][d].max(point[d]);
        }
    }
    out
}
