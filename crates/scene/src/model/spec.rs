//! A scene as plain data: what a file says, or what a program builds. Nothing here has been checked yet;
//! [`Scene::new`](crate::Scene::new) does that.

use super::body::{BodySpec, Load};
use super::entry::EntryId;
use super::expr::Expr;
use super::field::{Field, Region};
use super::grid::GridSpec;
use super::joints::{
    AutoContact, ContactSpec, EquationSpec, Extent, ObstacleSpec, PairSelector, TieSpec,
};
use super::ramp::StepsSpec;
use base::Location;
use elements::form::Form;
use elements::q1::Quadrature;

/// A point at which displacement and stress are reported.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeSpec {
    /// Its name.
    pub name: String,
    /// The body; `None`: the first that contains the point.
    pub body: Option<String>,
    /// The point.
    pub point: [f64; 3],
    /// Where it was written, if it was.
    pub location: Location,
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
    /// Sentences on parts of the input that are left out, ignored or replaced.
    pub notes: Vec<String>,
    /// Further remarks for users: parts that entries leave out in many scenes, such as boundary groups that none names.
    pub asides: Vec<String>,
}

impl SceneSpec {
    /// Where an entry was written.
    pub(crate) fn location_of(&self, entry: EntryId) -> &Location {
        match entry {
            EntryId::Tie(k) => &self.ties[k].location,
            EntryId::Contact(k) => &self.contacts[k].location,
            EntryId::Obstacle(k) => &self.obstacles[k].location,
            EntryId::Equation(k) => &self.equations[k].location,
        }
    }

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
            asides: Vec::new(),
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
                pair: PairSelector::All,
                sides: None,
                extent: Extent::Range([[1.0 / 3.0, 2.0 / 3.0], [0.0, 1.0]]),
                multipliers: None,
                adjust: 0.0,
                location: Location::default(),
            });
        }
    }
    spec
}
