//! A body as plain data: mesh, coefficients, loads and given values.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::expr::Variables;
use super::field::Field;
use super::heat::HeatSpec;
use super::law::LawSpec;
use super::map::Map;
use super::motion::Isometry;
use super::ramp::Ramp;
use base::Location;
use elements::element::Integration;
use elements::q1::Quadrature;
pub use mesh::SIDES;
use mesh::{BoxMesh, Mesh};

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
/// beyond the end of the list are free. A scalar problem uses the first component only. Copies share the list until one
/// of them changes it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GivenSides(Arc<Vec<[Option<Field>; 3]>>);

impl From<Vec<[Option<Field>; 3]>> for GivenSides {
    fn from(list: Vec<[Option<Field>; 3]>) -> GivenSides {
        GivenSides(list.into())
    }
}

impl Deref for GivenSides {
    type Target = Vec<[Option<Field>; 3]>;
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for GivenSides {
    fn deref_mut(&mut self) -> &mut Self::Target {
        Arc::make_mut(&mut self.0)
    }
}

/// No side of a box is held.
pub fn free_all_round() -> GivenSides {
    vec![[const { None }; 3]; SIDES.len()].into()
}

/// u = 0 on all sides of a box, in all components.
pub fn held_all_round() -> GivenSides {
    vec![held(); SIDES.len()].into()
}

/// u = 0 on a side, in all components.
pub fn held() -> [Option<Field>; 3] {
    [(); 3].map(|()| Some(Field::constant(0.0)))
}

/// The subdomains of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cut {
    /// The subdomains that the mesh has already.
    AsItIs,
    /// As many as the cost model finds best, made by the partitioner.
    Auto,
    /// This many, made by the partitioner.
    Into(usize),
}

/// One body: what each copy has by itself, and what copies share ([`BodyKind`], whose fields are read and changed as if
/// they were its own).
#[derive(Debug, Clone, PartialEq)]
pub struct BodySpec {
    /// Its name, unique in the scene.
    pub name: String,
    /// Elements and subdomains.
    pub mesh: Mesh,
    /// How the nodes of the mesh, bent into shape, come to their places; `None`: they are there.
    pub motion: Option<Isometry>,
    /// How the coordinates of its coefficients lie in space: a copy takes them along. `None`: as those of space.
    pub frame: Option<Isometry>,
    /// Place in its grid, (0, 0, 0) outside a grid: the variables `bi`, `bj`, `bk`.
    pub place: [usize; 3],
    /// The displacements of nodes at which the body is looked at, while contacts are renewed; `None`: undeformed.
    pub moved: Option<Arc<FxHashMap<usize, [f64; 3]>>>,
    /// Where it was written, if it was.
    pub location: Location,
    /// Copies share it until one of them changes it.
    kind: Arc<BodyKind>,
}

/// The properties that copies of a body have in common, apart from their mesh: many copies take the memory of one.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyKind {
    /// The order of the elements of a box, 1 or 2; meshes of cells have their own.
    pub order: usize,
    /// The subdomains of a mesh of cells.
    pub cut: Cut,
    /// How the box is bent into shape; `None`: not at all.
    pub map: Option<Map>,
    /// Coefficient ρ, in elasticity Young's modulus, > 0; taken at element midpoints.
    pub rho: Field,
    /// Poisson's ratio, between −1 and ½; ignored in scalar problems.
    pub poisson: Field,
    /// The laws that are not isotropic; `rho` and `poisson` then have their means over all directions. `None`: E and ν
    /// are the law.
    pub law: Option<LawSpec>,
    /// Expansion by heat, with the ramp of the loads; `None`: there is none.
    pub heat: Option<HeatSpec>,
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
    pub dirichlet: GivenSides,
}

impl Deref for BodySpec {
    type Target = BodyKind;
    fn deref(&self) -> &BodyKind {
        &self.kind
    }
}

impl DerefMut for BodySpec {
    fn deref_mut(&mut self) -> &mut BodyKind {
        Arc::make_mut(&mut self.kind)
    }
}

impl BodySpec {
    /// A body with ρ = 1 (ν = 0.3), no load and no Dirichlet side.
    pub fn new(name: impl Into<String>, mesh: impl Into<Mesh>) -> BodySpec {
        BodySpec {
            name: name.into(),
            mesh: mesh.into(),
            motion: None,
            frame: None,
            place: [0; 3],
            moved: None,
            location: Location::default(),
            kind: Arc::new(BodyKind {
                order: 1,
                cut: Cut::AsItIs,
                map: None,
                rho: Field::constant(1.0),
                poisson: Field::constant(POISSON),
                law: None,
                heat: None,
                load: Load::constant(0.0),
                surface: Vec::new(),
                springs: Vec::new(),
                ramp: None,
                integration: Vec::new(),
                forces: Vec::new(),
                given: Vec::new(),
                dirichlet: free_all_round(),
            }),
        }
    }

    /// A copy of this body at another place. Mesh and coefficients go with it, and share memory where they can.
    /// Components of loads and given values, and the places at which their expressions are evaluated, are those of
    /// space.
    #[must_use]
    pub fn placed(&self, name: impl Into<String>, motion: &Isometry) -> BodySpec {
        let mut copy = self.clone();
        copy.name = name.into();
        let after = |own: &Option<Isometry>| Some(own.map_or(*motion, |own| motion.after(&own)));
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
    pub fn is_straight(&self) -> bool {
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
        let point = self.shaped(node);
        self.motion.map_or(point, |motion| motion.apply(point))
    }

    /// Position of a node of the mesh, bent into shape and not yet at its place.
    pub(crate) fn shaped(&self, node: usize) -> [f64; 3] {
        let point = self.mesh.position(node);
        self.map.as_ref().map_or(point, |map| map.apply(point))
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
