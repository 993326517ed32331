//! Joints between bodies and restraints from outside, as plain data: ties, contacts, obstacles, equations.

use super::friction::ContactLaw;
use super::profile::Profile;
use super::ramp::Ramp;
use super::rigid::Rigid;
use super::rigid_surface::RigidSurface;
use base::Location;
use fetifeti::problem::BodyNode;

/// The pairs of bodies to which an entry applies.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PairSelector {
    /// All pairs that touch.
    All,
    /// Two bodies by name.
    Named(String, String),
    /// Two boundary groups by name: all bodies that have them, and whose nodes there match.
    Surfaces(String, String),
}

/// The nodes of a common face (or of a side) to which an entry applies. The parameters run from 0 to 1 along the common
/// face, in the directions of increasing x, y or z: one (t) in the plane, two in three dimensions.
#[derive(Debug, Clone, PartialEq)]
pub enum Extent {
    /// All nodes, and corners where bodies meet only in a point.
    All,
    /// None.
    None,
    /// Nodes with t0 ≤ t ≤ t1, for each parameter.
    Range([[f64; 2]; 2]),
    /// The nodes at these parameters (the second is 0 in the plane).
    Points(Vec<[f64; 2]>),
    /// The nodes with these numbers, counted from 0 along the common face.
    Nodes(Vec<usize>),
    /// The nodes of the side with the multipliers that are near the other side. It is for entries that name sides.
    Within {
        /// How far they may be from its faces.
        distance: f64,
        /// Whether each has a row of its own wherever the nodes of the two sides do not lie opposite each other.
        singly: bool,
    },
}

/// A tie: u is continuous across (part of) a common face.
#[derive(Debug, Clone, PartialEq)]
pub struct TieSpec {
    /// The bodies.
    pub pair: PairSelector,
    /// The sides that are tied, in the order of the names; `None`: wherever the bodies touch.
    pub sides: Option<[usize; 2]>,
    /// The part of their common face.
    pub extent: Extent,
    /// Which of the two carries the multipliers where nodes do not match, 0 or 1 in the order of the names; `None`: the
    /// first.
    pub multipliers: Option<usize>,
    /// Initial gaps and overclosures up to this length count as touching; ties close them all.
    pub adjust: f64,
    /// Where it was written, if it was.
    pub location: Location,
}

/// A unilateral contact: u_first − u_second ≤ g on (part of) a common face, so that the second body stays above the
/// first; in elasticity n·(u_first − u_second) ≤ g with the normal n that points out of the first body.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSpec {
    /// The bodies, in the order of the inequality. With [`PairSelector::All`] the lower number comes first.
    pub pair: PairSelector,
    /// The sides that face each other, in the order of the names, if the bodies do not touch; `None`: their common
    /// faces.
    pub sides: Option<[usize; 2]>,
    /// The part of their common face.
    pub extent: Extent,
    /// The gap g, of either sign; it adds to the distance of the sides.
    pub gap: Profile,
    /// The largest distance of the sides of meshes at which they may touch; `None`: any.
    pub distance: Option<f64>,
    /// Which of the two carries the multipliers where nodes do not match, 0 or 1 in the order of the names; `None`: the
    /// first.
    pub multipliers: Option<usize>,
    /// Initial gaps and overclosures up to this length count as touching.
    pub adjust: f64,
    /// Nodes of the first body that count as touching, whatever their gap is.
    pub adjusted: Vec<BodyNode>,
    /// The pairs of nodes that may touch, in place of what lies opposite each other.
    pub opposed: Option<OpposedNodes>,
    /// Friction and softness.
    pub law: ContactLaw,
    /// Factor of the gap over the load steps; `None`: the factor of all gaps.
    pub ramp: Option<Ramp>,
    /// Where it was written, if it was.
    pub location: Location,
}

/// Pairs of nodes that may touch along a direction, wherever they lie.
#[derive(Debug, Clone, PartialEq)]
pub struct OpposedNodes {
    /// The nodes, of the first body and of the second.
    pub pairs: Vec<[usize; 2]>,
    /// The unit vector out of the first body.
    pub normal: [f64; 3],
    /// The area that belongs to each pair.
    pub area: f64,
}

/// Rigid obstacles beside a body: below ≤ u ≤ above on (part of) its sides.
#[derive(Debug, Clone, PartialEq)]
pub struct ObstacleSpec {
    /// Name of the body; `None`: all bodies.
    pub body: Option<String>,
    /// The sides of the mesh.
    pub sides: Vec<usize>,
    /// The part of each side; t runs from 0 to 1 along it in the direction of increasing x or y.
    pub extent: Extent,
    /// The lower bound, if there is one.
    pub below: Option<Profile>,
    /// The upper bound, if there is one.
    pub above: Option<Profile>,
    /// In elasticity, the rigid body that the sides cannot enter.
    pub rigid: Option<Rigid>,
    /// In elasticity, the surface of the rigid body as faces of a mesh, in place of `rigid`.
    pub surface: Option<RigidSurface>,
    /// The gap that is added to the distance from the rigid body.
    pub gap: Profile,
    /// The way that the rigid body moves.
    pub motion: [f64; 3],
    /// The largest distance from the rigid body at which nodes may touch it; `None`: any.
    pub distance: Option<f64>,
    /// Initial distances and overclosures up to this length count as touching.
    pub adjust: f64,
    /// The area that belongs to each node; `None`: that of its faces.
    pub area: Option<f64>,
    /// Friction on the rigid body, and its softness.
    pub law: ContactLaw,
    /// Factor of the bounds, of the gap and of the motion over the load steps; `None`: the factor of all gaps.
    pub ramp: Option<Ramp>,
    /// Where it was written, if it was.
    pub location: Location,
}

/// Contacts between all sides that are near each other and have opposite normals.
#[derive(Debug, Clone, PartialEq)]
pub struct AutoContact {
    /// The largest gap; `None`: a fraction of the edges there.
    pub distance: Option<f64>,
    /// Initial gaps and overclosures up to this length count as touching.
    pub adjust: f64,
    /// Friction and softness.
    pub law: ContactLaw,
    /// Where it was written, if it was.
    pub location: Location,
}

/// An equation Σ factor · u = value.
#[derive(Debug, Clone, PartialEq)]
pub struct EquationSpec {
    /// Number of the body, degree of freedom C k + c in it, factor.
    pub terms: Vec<(usize, usize, f64)>,
    /// The right-hand side.
    pub value: f64,
    /// One unit in the last digit of the factors; 0 where they are exact.
    pub resolution: f64,
    /// Whether it is a given displacement along an oblique axis: its forces are reactions.
    pub support: bool,
    /// Where it was written, if it was.
    pub location: Location,
}
