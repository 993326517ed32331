//! A scene as plain data: what a file says, or what a program builds. Nothing here has been checked yet;
//! [`Scene::new`](crate::scene::Scene::new) does that.

use std::collections::HashMap;
use std::sync::Arc;

use super::expr::{Expr, Variables};
use super::field::{Field, Region};
use super::joints::{AutoContact, ContactSpec, EquationSpec, Extent, ObstacleSpec, Pair, TieSpec};
use super::map::Map;
use super::motion::Motion;
use super::ramp::{Ramp, StepsSpec};
use crate::fem::element::Integration;
use crate::fem::Form;
use crate::fem::Quadrature;
pub use crate::mesh::SIDES;
use crate::mesh::{places, BoxMesh, Mesh};

/// The load of a body: a source, or a force per volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// f(x, y, z), one field per component; a single field stands for the first component.
    pub fields: Vec<Field>,
    /// How ∫ f N_a is computed.
    pub quadrature: Quadrature,
}

impl Load {
    /// The constant scalar load `value`.
    pub fn constant(value: f64) -> Load {
        Load::scalar(Field::constant(value))
    }

    /// A scalar load, by the midpoint rule.
    pub fn scalar(field: Field) -> Load {
        Load {
            fields: vec![field],
            quadrature: Quadrature::Midpoint,
        }
    }
}

/// A load on a side of a body: a flux, or a force per area.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceLoad {
    /// The side of the mesh.
    pub side: usize,
    /// The force.
    pub force: Force,
}

/// A force per area.
#[derive(Debug, Clone, PartialEq)]
pub enum Force {
    /// By components; in a scalar problem the flux into the body.
    Traction(Vec<Field>),
    /// Against the outer normal.
    Pressure(Field),
}

/// Given values by side of the mesh ([`Mesh::side_name`]) and component; `None`: the component is free there. Sides
/// beyond the end of the list are free. A scalar problem uses the first component only.
pub type Sides = Vec<[Option<Field>; 3]>;

/// No side of a box is held.
pub fn free_all_round() -> Sides {
    vec![[const { None }; 3]; SIDES.len()]
}

/// u = 0 on all sides of a box, in all components.
pub fn held_all_round() -> Sides {
    vec![held(); SIDES.len()]
}

/// u = 0 on a side, in all components.
pub fn held() -> [Option<Field>; 3] {
    [(); 3].map(|()| Some(Field::constant(0.0)))
}

/// The subdomains of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cut {
    /// Those that the mesh has.
    AsItIs,
    /// As many as the cost model finds best, made by the partitioner.
    Auto,
    /// This many, made by the partitioner.
    Into(usize),
}

/// One body.
#[derive(Debug, Clone, PartialEq)]
pub struct BodySpec {
    /// Its name, unique in the scene.
    pub name: String,
    /// Elements and subdomains.
    pub mesh: Mesh,
    /// The order of the elements of a box, 1 or 2; meshes of cells have their own.
    pub order: usize,
    /// The subdomains of a mesh of cells.
    pub cut: Cut,
    /// How the box is bent into shape; `None`: not at all.
    pub map: Option<Map>,
    /// How the nodes of the mesh, bent into shape, come to their places; `None`: they are there.
    pub motion: Option<Motion>,
    /// How the coordinates of its coefficients lie in space: a copy takes them along. `None`: as those of space.
    pub frame: Option<Motion>,
    /// Coefficient ρ, in elasticity Young's modulus, > 0; taken at element midpoints.
    pub rho: Field,
    /// Poisson's ratio, between −1 and ½; ignored in scalar problems.
    pub poisson: Field,
    /// Load f.
    pub load: Load,
    /// Loads on its sides.
    pub surface: Vec<SurfaceLoad>,
    /// Elastic foundations: k on a side of the mesh adds ∫ k u·v to the bilinear form, a force −k u per area.
    pub springs: Vec<(usize, Field)>,
    /// Factor of the loads over the load steps; `None`: the factor of all loads of the scene.
    pub ramp: Option<Ramp>,
    /// How the stiffness of every cell of a mesh is integrated; empty: in full.
    pub integration: Vec<Integration>,
    /// Forces at nodes, by degree of freedom C k + c of the body.
    pub forces: Vec<(usize, f64)>,
    /// Given values besides those of sides, by degree of freedom C k + c of the body.
    pub given: Vec<(usize, f64)>,
    /// Dirichlet conditions.
    pub dirichlet: Sides,
    /// Place in its grid, (0, 0, 0) outside a grid: the variables `bi`, `bj`, `bk`.
    pub place: [usize; 3],
    /// The displacements of nodes at which the body is looked at, while contacts are renewed; `None`: undeformed.
    pub moved: Option<Arc<HashMap<usize, [f64; 3]>>>,
    /// Where it was written ("scene.toml:12: "), or empty.
    pub written: String,
}

impl BodySpec {
    /// A body with ρ = 1 (ν = 0.3), no load and no Dirichlet side.
    pub fn new(name: impl Into<String>, mesh: impl Into<Mesh>) -> BodySpec {
        BodySpec {
            name: name.into(),
            mesh: mesh.into(),
            order: 1,
            cut: Cut::AsItIs,
            map: None,
            motion: None,
            frame: None,
            rho: Field::constant(1.0),
            poisson: Field::constant(POISSON),
            load: Load::constant(0.0),
            surface: Vec::new(),
            springs: Vec::new(),
            ramp: None,
            integration: Vec::new(),
            forces: Vec::new(),
            given: Vec::new(),
            dirichlet: free_all_round(),
            place: [0; 3],
            moved: None,
            written: String::new(),
        }
    }

    /// A copy of this body at another place. Mesh and coefficients go with it, and share memory where they can.
    /// Components of loads and given values, and the places at which their expressions are evaluated, are those of
    /// space.
    #[must_use]
    pub fn placed(&self, name: impl Into<String>, motion: &Motion) -> BodySpec {
        let mut copy = self.clone();
        copy.name = name.into();
        let after = |own: &Option<Motion>| Some(own.map_or(*motion, |own| motion.after(&own)));
        copy.frame = after(&self.frame);
        match &mut copy.mesh {
            // A box that is only shifted stays one along the axes.
            Mesh::Grid(grid) if self.is_straight() && self.order == 1 && motion.is_shift() => {
                grid.origin = motion.apply(grid.origin);
            }
            _ => copy.motion = after(&self.motion),
        }
        copy
    }

    /// A point of space in the coordinates of the coefficients.
    pub(crate) fn own(&self, point: [f64; 3]) -> [f64; 3] {
        self.frame.map_or(point, |frame| frame.invert(point))
    }

    /// Whether the nodes are where the mesh has them: a box has its sides along the axes.
    pub(crate) fn is_straight(&self) -> bool {
        self.map.is_none() && self.motion.is_none()
    }

    /// Position of a node.
    pub fn position(&self, node: usize) -> [f64; 3] {
        let u = self.displacement(node);
        let x = self.undeformed(node);
        match &self.moved {
            None => x,
            Some(_) => [0, 1, 2].map(|d| x[d] + u[d]),
        }
    }

    /// Position of a node of the undeformed body.
    pub(crate) fn undeformed(&self, node: usize) -> [f64; 3] {
        let point = self.mesh.position(node);
        let point = self.map.as_ref().map_or(point, |map| map.apply(point));
        self.motion.map_or(point, |motion| motion.apply(point))
    }

    /// The displacement of a node from [`BodySpec::undeformed`] to [`BodySpec::position`].
    pub(crate) fn displacement(&self, node: usize) -> [f64; 3] {
        let moved = self.moved.as_ref().and_then(|m| m.get(&node));
        moved.copied().unwrap_or_default()
    }

    /// The grid of the body, if its cells are equal boxes.
    pub(crate) fn unbent(&self) -> Option<&BoxMesh> {
        let grid = self.mesh.grid();
        grid.filter(|_| self.is_straight() && self.moved.is_none())
    }

    /// The given value of a component on a side, if there is one.
    pub(crate) fn given_on(&self, side: usize, component: usize) -> Option<&Field> {
        self.dirichlet.get(side)?[component].as_ref()
    }

    /// Whether a component is given on a side.
    pub(crate) fn holds(&self, side: usize) -> bool {
        let fields = self.dirichlet.get(side);
        fields.is_some_and(|fields| fields.iter().any(Option::is_some))
    }

    /// The variables of expressions at a node.
    pub(crate) fn variables(&self, node: usize) -> Variables {
        Variables {
            point: self.undeformed(node),
            body: self.place,
            subdomain: [0; 3],
        }
    }

    /// The position of a node in the notation of messages: "(x, y)" or "(x, y, z)".
    pub(crate) fn spot(&self, node: usize) -> String {
        self.spot_at(self.position(node))
    }

    /// A point in the notation of messages.
    pub(crate) fn spot_at(&self, [x, y, z]: [f64; 3]) -> String {
        match self.mesh.dim() {
            2 => format!("({x}, {y})"),
            _ => format!("({x}, {y}, {z})"),
        }
    }
}

/// Poisson's ratio where none is given.
pub const POISSON: f64 = 0.3;

/// A box cut into `bodies[0]` × `bodies[1]` (× `bodies[2]`) equal bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct GridSpec {
    /// Bodies in x, y and z.
    pub bodies: [usize; 3],
    /// The whole grid: its box, its map and its outer sides. Elements and subdomains are those of every body. Bodies
    /// are named `<name><i>_<j>` (`<name><i>_<j>_<k>` in three dimensions), column i, row j and layer k.
    pub whole: BodySpec,
}

impl GridSpec {
    /// The unit square, held all round, with ρ = 1 and f = 1.
    pub fn unit_square(bodies: [usize; 2], subdomains: [usize; 2], elements: [usize; 2]) -> Self {
        let mesh = BoxMesh::plane([0.0; 2], [1.0; 2], elements, subdomains);
        GridSpec::held([bodies[0], bodies[1], 1], mesh)
    }

    /// The unit cube, held all round, with ρ = 1 and f = 1.
    pub fn unit_cube(bodies: [usize; 3], subdomains: [usize; 3], elements: [usize; 3]) -> Self {
        let mesh = BoxMesh {
            origin: [0.0; 3],
            size: [1.0; 3],
            elements,
            subdomains,
        };
        GridSpec::held(bodies, mesh)
    }

    fn held(bodies: [usize; 3], mesh: BoxMesh) -> Self {
        let whole = BodySpec {
            load: Load::constant(1.0),
            dirichlet: held_all_round(),
            ..BodySpec::new("b", mesh)
        };
        GridSpec { bodies, whole }
    }

    /// Its bodies, layer by layer and row by row.
    pub fn expand(&self) -> Vec<BodySpec> {
        let GridSpec { bodies, whole } = self;
        let grid = whole
            .mesh
            .grid()
            .expect("a grid of bodies is cut from a box");
        let BoxMesh { origin, size, .. } = *grid;
        let body = |place: [usize; 3]| {
            let outer = |s: usize| place[s / 2] == [0, bodies[s / 2] - 1][s % 2];
            let mut body = whole.clone();
            let [i, j, k] = place;
            body.name = match whole.mesh.dim() {
                2 => format!("{}{i}_{j}", whole.name),
                _ => format!("{}{i}_{j}_{k}", whole.name),
            };
            body.place = place;
            let mut mesh = *grid;
            for d in 0..3 {
                mesh.origin[d] = origin[d] + size[d] * (place[d] as f64 / bodies[d] as f64);
                // The same to the last bit for every body: equal subdomains then have equal matrices.
                mesh.size[d] = size[d] / bodies[d] as f64;
            }
            body.mesh = mesh.into();
            body.rho = whole.rho.over(*bodies);
            body.poisson = whole.poisson.over(*bodies);
            body.surface.retain(|load| outer(load.side));
            body.springs.retain(|(side, _)| outer(*side));
            for (s, given) in body.dirichlet.iter_mut().enumerate() {
                if !outer(s) {
                    *given = [const { None }; 3];
                }
            }
            body
        };
        places(*bodies).map(body).collect()
    }
}

/// A point at which displacement and stress are reported.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeSpec {
    /// Its name.
    pub name: String,
    /// The body; `None`: the first that contains the point.
    pub body: Option<String>,
    /// The point.
    pub point: [f64; 3],
    /// Where it was written, or empty.
    pub written: String,
}

/// The joint of touching bodies that no entry mentions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ByDefault {
    /// They are tied, in corners too.
    #[default]
    Tied,
    /// Nothing joins them.
    Free,
    /// Their faces are in contact with gap 0.
    Contact,
}

/// A whole scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneSpec {
    /// A title for reports.
    pub title: String,
    /// The equation and its finite elements.
    pub form: Form,
    /// The bodies, in the order of their numbers.
    pub bodies: Vec<BodySpec>,
    /// The joint of touching bodies that no entry of `ties` or `contacts` mentions.
    pub default: ByDefault,
    /// Entries for single pairs; entries for the same pair add up, and together they replace the default.
    pub ties: Vec<TieSpec>,
    /// Unilateral contacts. An entry that names a pair overrides the contacts of all pairs; a contact that names a pair
    /// overrides the ties of all pairs.
    pub contacts: Vec<ContactSpec>,
    /// Equations between displacements.
    pub equations: Vec<EquationSpec>,
    /// Contacts that are found, where they are wanted.
    pub auto: Option<AutoContact>,
    /// Points of interest.
    pub probes: Vec<ProbeSpec>,
    /// Rigid obstacles.
    pub obstacles: Vec<ObstacleSpec>,
    /// Load steps; `None`: everything is applied at once.
    pub steps: Option<StepsSpec>,
    /// The exact solution by components, if it is known.
    pub exact: Option<Vec<Expr>>,
    /// PETSc options (without the dash) that hold unless the command line says otherwise.
    pub options: Vec<(String, String)>,
    /// What of the input is left out, ignored or replaced: a sentence each.
    pub notes: Vec<String>,
}

impl SceneSpec {
    /// A scene whose bodies are tied wherever they touch.
    pub fn tied(title: impl Into<String>, bodies: Vec<BodySpec>) -> SceneSpec {
        SceneSpec {
            title: title.into(),
            form: Form::default(),
            bodies,
            default: ByDefault::Tied,
            ties: Vec::new(),
            contacts: Vec::new(),
            equations: Vec::new(),
            auto: None,
            probes: Vec::new(),
            obstacles: Vec::new(),
            steps: None,
            exact: None,
            options: Vec::new(),
            notes: Vec::new(),
        }
    }
}

/// The two columns of Table 1 of \[Lee\].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Faces {
    /// Column (I): bodies are tied along their whole interface, cross points with all six rows.
    Whole,
    /// Column (II): bodies are tied where 1/3 ≤ t ≤ 2/3, cross points excluded.
    MiddleThird,
}

/// The experiment of Table 1 of \[Lee\]: the unit square, held all round, of `bodies`² bodies of `subdomains`²
/// subdomains of `elements`² elements, with the load of (3.3) rescaled: −3 on x < 1/2, y > 3/4; −1 on x > 1/2, y < 1/4.
pub fn lee(bodies: usize, subdomains: usize, elements: usize, faces: Faces) -> SceneSpec {
    let mut grid = GridSpec::unit_square([bodies; 2], [subdomains; 2], [subdomains * elements; 2]);
    let region = |x, y, value| Region {
        x: Some(x),
        y: Some(y),
        z: None,
        value: Expr::constant(value),
    };
    grid.whole.load = Load {
        fields: vec![Field::Regions {
            list: vec![
                region([0.0, 0.5], [0.75, 1.0], -3.0),
                region([0.5, 1.0], [0.0, 0.25], -1.0),
            ],
            otherwise: Expr::constant(0.0),
        }],
        quadrature: Quadrature::Midpoint,
    };
    let column = match faces {
        Faces::Whole => "I",
        Faces::MiddleThird => "II",
    };
    let title = format!("Lee, Table 1 ({column}): {bodies}, {subdomains}, {elements}");
    let mut spec = SceneSpec::tied(title, grid.expand());
    if faces == Faces::MiddleThird {
        spec.default = ByDefault::Free;
        // A single body has no pair to tie and no nodes to select from.
        if bodies > 1 {
            spec.ties.push(TieSpec {
                pair: Pair::All,
                sides: None,
                extent: Extent::Range([[1.0 / 3.0, 2.0 / 3.0], [0.0, 1.0]]),
                multipliers: None,
                adjust: 0.0,
                written: String::new(),
            });
        }
    }
    spec
}
