//! A scene as plain data: what a file says, or what a program builds. Nothing here has been checked yet;
//! [`Scene::new`](super::Scene::new) does that.

use super::expr::Expr;
use super::field::{Field, Region};
use super::profile::Profile;
use super::steps::{Ramp, StepsSpec};
use crate::fem::Quadrature;
use crate::mesh::BoxMesh;

/// The load f of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// f(x, y).
    pub field: Field,
    /// How ∫ f N_a is computed.
    pub quadrature: Quadrature,
}

impl Load {
    /// The constant load `value`.
    pub fn constant(value: f64) -> Load {
        Load {
            field: Field::constant(value),
            quadrature: Quadrature::Midpoint,
        }
    }
}

/// Dirichlet values on the sides left, right, bottom, top; `None`: the side is free.
pub type Sides = [Option<Field>; 4];

/// Names of the sides, in the order of [`Sides`].
pub const SIDES: [&str; 4] = ["left", "right", "bottom", "top"];

/// u = 0 on all four sides.
pub fn held_all_round() -> Sides {
    [(); 4].map(|()| Some(Field::constant(0.0)))
}

/// One body.
#[derive(Debug, Clone, PartialEq)]
pub struct BodySpec {
    /// Its name, unique in the scene.
    pub name: String,
    /// Box, elements and subdomains.
    pub mesh: BoxMesh,
    /// Coefficient ρ, > 0; taken at element midpoints.
    pub rho: Field,
    /// Load f.
    pub load: Load,
    /// Factor of the load over the load steps; `None`: that of all loads.
    pub ramp: Option<Ramp>,
    /// Dirichlet conditions.
    pub dirichlet: Sides,
    /// Column and row in its grid, (0, 0) outside a grid: the variables `bi` and `bj`.
    pub place: [usize; 2],
    /// Where it was written ("scene.toml:12: "), or empty.
    pub written: String,
}

impl BodySpec {
    /// A body with ρ = 1, no load and no Dirichlet side.
    pub fn new(name: impl Into<String>, mesh: BoxMesh) -> BodySpec {
        BodySpec {
            name: name.into(),
            mesh,
            rho: Field::constant(1.0),
            load: Load::constant(0.0),
            ramp: None,
            dirichlet: [None, None, None, None],
            place: [0, 0],
            written: String::new(),
        }
    }
}

/// A rectangle cut into `bodies[0]` × `bodies[1]` equal bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct GridSpec {
    /// Bodies are named `<name><i>_<j>`, column i and row j.
    pub name: String,
    /// Bodies in x and y.
    pub bodies: [usize; 2],
    /// Lower left corner of the whole grid.
    pub origin: [f64; 2],
    /// Width and height of the whole grid.
    pub size: [f64; 2],
    /// Elements of every body.
    pub elements: [usize; 2],
    /// Subdomains of every body.
    pub subdomains: [usize; 2],
    /// Coefficient ρ.
    pub rho: Field,
    /// Load f.
    pub load: Load,
    /// Factor of the load over the load steps; `None`: that of all loads.
    pub ramp: Option<Ramp>,
    /// Dirichlet conditions on the outer sides of the whole grid.
    pub dirichlet: Sides,
    /// Where it was written, or empty.
    pub written: String,
}

impl GridSpec {
    /// The unit square, held all round, with ρ = 1 and f = 1.
    pub fn unit_square(bodies: [usize; 2], subdomains: [usize; 2], elements: [usize; 2]) -> Self {
        GridSpec {
            name: "b".into(),
            bodies,
            origin: [0.0, 0.0],
            size: [1.0, 1.0],
            elements,
            subdomains,
            rho: Field::constant(1.0),
            load: Load::constant(1.0),
            ramp: None,
            dirichlet: held_all_round(),
            written: String::new(),
        }
    }

    /// Its bodies, row by row.
    pub fn expand(&self) -> Vec<BodySpec> {
        // The same bits for every body: equal subdomains then have equal matrices.
        let size = [0, 1].map(|d| self.size[d] / self.bodies[d] as f64);
        let mut out = Vec::with_capacity(self.bodies[0] * self.bodies[1]);
        for j in 0..self.bodies[1] {
            for i in 0..self.bodies[0] {
                let place = [i, j];
                let outer = [
                    i == 0,
                    i + 1 == self.bodies[0],
                    j == 0,
                    j + 1 == self.bodies[1],
                ];
                let side = |s: usize| self.dirichlet[s].clone().filter(|_| outer[s]);
                out.push(BodySpec {
                    name: format!("{}{i}_{j}", self.name),
                    mesh: BoxMesh {
                        origin: [0, 1].map(|d| {
                            self.origin[d]
                                + self.size[d] * (place[d] as f64 / self.bodies[d] as f64)
                        }),
                        size,
                        elements: self.elements,
                        subdomains: self.subdomains,
                    },
                    rho: self.rho.clone(),
                    load: self.load.clone(),
                    ramp: self.ramp.clone(),
                    dirichlet: [side(0), side(1), side(2), side(3)],
                    place,
                    written: self.written.clone(),
                });
            }
        }
        out
    }
}

/// Which pairs of bodies an entry speaks of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Pair {
    /// All pairs that touch.
    All,
    /// Two bodies by name.
    Named(String, String),
}

/// Which nodes of a common face (or of a side) an entry speaks of. The parameter t runs from 0 to 1 along the common face, in the direction
/// of increasing x or y.
#[derive(Debug, Clone, PartialEq)]
pub enum Extent {
    /// All nodes, and corners at which bodies only meet in a point.
    All,
    /// None.
    None,
    /// Nodes with t0 ≤ t ≤ t1.
    Range([f64; 2]),
    /// The nodes at these t.
    Points(Vec<f64>),
    /// The nodes with these numbers, counted from 0 along the common face.
    Nodes(Vec<usize>),
}

/// A tie: u is continuous across (part of) a common face.
#[derive(Debug, Clone, PartialEq)]
pub struct TieSpec {
    /// The bodies.
    pub pair: Pair,
    /// The part of their common face.
    pub extent: Extent,
    /// Where it was written, or empty.
    pub written: String,
}

/// A unilateral contact: u_first − u_second ≤ g on (part of) a common face, so that the second body stays above the first.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSpec {
    /// The bodies; the order of the names is that of the inequality, the lower number is first where none are named.
    pub pair: Pair,
    /// The part of their common face.
    pub extent: Extent,
    /// The gap g, of either sign.
    pub gap: Profile,
    /// Factor of the gap over the load steps; `None`: that of all gaps.
    pub ramp: Option<Ramp>,
    /// Where it was written, or empty.
    pub written: String,
}

/// Rigid obstacles beside a body: below ≤ u ≤ above on (part of) its sides.
#[derive(Debug, Clone, PartialEq)]
pub struct ObstacleSpec {
    /// Name of the body; `None`: all bodies.
    pub body: Option<String>,
    /// Indices into [`SIDES`].
    pub sides: Vec<usize>,
    /// The part of each side; t runs from 0 to 1 along it in the direction of increasing x or y.
    pub extent: Extent,
    /// The lower bound, if there is one.
    pub below: Option<Profile>,
    /// The upper bound, if there is one.
    pub above: Option<Profile>,
    /// Factor of the bounds over the load steps; `None`: that of all gaps.
    pub ramp: Option<Ramp>,
    /// Where it was written, or empty.
    pub written: String,
}

/// What becomes of bodies that touch and that no entry speaks of.
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
    /// The bodies, in the order of their numbers.
    pub bodies: Vec<BodySpec>,
    /// Bodies that touch and that no entry of `ties` or `contacts` speaks of.
    pub default: ByDefault,
    /// Entries for single pairs; entries for the same pair add up, and together they replace the default.
    pub ties: Vec<TieSpec>,
    /// Unilateral contacts. An entry that names a pair beats the contacts of all pairs, and a contact that names it beats
    /// the ties of all pairs.
    pub contacts: Vec<ContactSpec>,
    /// Rigid obstacles.
    pub obstacles: Vec<ObstacleSpec>,
    /// Load steps; `None`: everything is applied at once.
    pub steps: Option<StepsSpec>,
    /// The exact solution, if it is known.
    pub exact: Option<Expr>,
    /// PETSc options (without the dash) that hold unless the command line says otherwise.
    pub options: Vec<(String, String)>,
}

impl SceneSpec {
    /// Bodies that are tied wherever they touch.
    pub fn tied(title: impl Into<String>, bodies: Vec<BodySpec>) -> SceneSpec {
        SceneSpec {
            title: title.into(),
            bodies,
            default: ByDefault::Tied,
            ties: Vec::new(),
            contacts: Vec::new(),
            obstacles: Vec::new(),
            steps: None,
            exact: None,
            options: Vec::new(),
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

/// The experiment of Table 1 of \[Lee\]: the unit square, held all round, of `bodies`² bodies of `subdomains`² subdomains of
/// `elements`² elements, with the load of (3.3) rescaled: −3 on x < 1/2, y > 3/4; −1 on x > 1/2, y < 1/4.
pub fn lee(bodies: usize, subdomains: usize, elements: usize, faces: Faces) -> SceneSpec {
    let mut grid = GridSpec::unit_square([bodies; 2], [subdomains; 2], [subdomains * elements; 2]);
    let region = |x, y, value| Region {
        x: Some(x),
        y: Some(y),
        value: Expr::constant(value),
    };
    grid.load = Load {
        field: Field::Regions {
            list: vec![
                region([0.0, 0.5], [0.75, 1.0], -3.0),
                region([0.5, 1.0], [0.0, 0.25], -1.0),
            ],
            otherwise: Expr::constant(0.0),
        },
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
        // With a single body there is no pair to tie, and nothing to select from.
        if bodies > 1 {
            spec.ties.push(TieSpec {
                pair: Pair::All,
                extent: Extent::Range([1.0 / 3.0, 2.0 / 3.0]),
                written: String::new(),
            });
        }
    }
    spec
}
