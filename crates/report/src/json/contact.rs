//! The record of a contact solve: key `contact` of [`super::SolveReport`].
//!
//! Forces are sums of multipliers, in the units of the loads; a multiplier of an inequality is positive where the
//! bodies press against each other. In elasticity forces have directions: `force` is still the sum of the multipliers,
//! `resultant` is their vector sum. As in [`crate::json`], a number that is unknown or not finite is `null` and
//! never NaN.

use super::friction::{FrictionExtremes, FrictionForce};
use super::number;
use super::spectrum::Spectrum;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The course of the contact loop, and the contact forces.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactReport {
    /// The methods that made the steps, in order: `active_set`; `active_set, then augmented_lagrangian, …` where the
    /// first one gave up; or `smalbe, then active_set`, whose steps solve for the set of SMALBE to the last digits.
    pub method: String,
    /// Number of inequalities: pairs of nodes, or nodes at an obstacle, that may touch.
    pub candidates: usize,
    /// Number of inequalities that are active.
    pub active: usize,
    /// Numerical factorisations of subdomain matrices over the whole run.
    pub factorisations: usize,
    /// Number of subdomains with different matrices; `factorisations` must be equal to it.
    pub distinct_subdomains: usize,
    /// The outer iteration, over all load steps.
    pub steps: Vec<OuterStep>,
    /// The interfaces between bodies, and the obstacles.
    pub interfaces: Vec<InterfaceForce>,
    /// Equilibrium of every body.
    pub bodies: Vec<BodyBalance>,
    /// One record per load step; empty without load steps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub load_steps: Vec<LoadStep>,
    /// Whether normals, pairing and gaps are renewed at each load step.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub updated: bool,
    /// Whether they are not, but could be.
    #[serde(skip)]
    pub renewable: bool,
}

/// Sliding by more than this part of a face is not small: a node is then nearer to a neighbour of the node that it is
/// paired with.
pub const SLIDING: f64 = 0.5;

/// Faces that turn by more than this, in degrees, differ from those of the undeformed bodies: pressures point 9 % to
/// the side, and linear strains are wrong by half the square of the angle, 0.4 %.
pub const TURN: f64 = 5.0;

/// One step of the outer iteration.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct OuterStep {
    /// The load step, from 1; 0 without load steps.
    pub load_step: usize,
    /// Number of the step, from 1 in every load step.
    pub step: usize,
    /// `active_set`, `augmented_lagrangian` or `smalbe`.
    pub method: String,
    /// Active inequalities in this step.
    pub active: usize,
    /// Inequalities that became active in this step.
    pub entered: usize,
    /// Inequalities that were active in the step before and no longer are.
    pub left: usize,
    /// Inner iterations.
    pub iterations: usize,
    /// The inner iteration's estimate of the spectrum; `null` where it gives none.
    pub estimate: Option<Spectrum>,
    /// The exact spectrum for these active rows; `null` where it was not asked for.
    pub exact: Option<Spectrum>,
    /// Number of wrong rows at the end of the step: violated, or with a pulling multiplier.
    pub wrong: usize,
    /// Residual at the end of the step, relative to the start of the first step.
    #[serde(with = "number")]
    pub residual: f64,
    /// Relative tolerance of the inner iteration.
    #[serde(with = "number")]
    pub tolerance: f64,
    /// Wall-clock time.
    #[serde(with = "number")]
    pub seconds: f64,
}

/// The kind of connection between the two sides of an interface.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum InterfaceKind {
    /// Inequalities between two bodies.
    #[default]
    Contact,
    /// Equations between two bodies.
    Tied,
    /// Inequalities between a body and something rigid.
    Obstacle,
    /// Equations and inequalities on one face.
    Mixed,
}

impl InterfaceKind {
    /// The word in JSON.
    pub fn name(self) -> &'static str {
        match self {
            InterfaceKind::Contact => "contact",
            InterfaceKind::Tied => "tied",
            InterfaceKind::Obstacle => "obstacle",
            InterfaceKind::Mixed => "mixed",
        }
    }
}

/// The force through one interface.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct InterfaceForce {
    /// `left|right` for two bodies, `left.top above` for an obstacle.
    pub name: String,
    /// The kind of its rows.
    pub kind: InterfaceKind,
    /// Number of rows, equations included.
    pub candidates: usize,
    /// Number of rows that hold.
    pub active: usize,
    /// Sum of the multipliers.
    #[serde(with = "number")]
    pub force: f64,
    /// Largest remaining distance; 0 for equations.
    #[serde(with = "number")]
    pub largest_gap: f64,
    /// Smallest remaining distance; negative where the sides overlap.
    #[serde(with = "number")]
    pub smallest_gap: f64,
    /// Smallest multiplier.
    #[serde(with = "number")]
    pub min_multiplier: f64,
    /// Largest multiplier.
    #[serde(with = "number")]
    pub max_multiplier: f64,
    /// Elasticity: Σ λ n by components, the force with which the first body presses on the second, or on the obstacle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resultant: Option<Vec<f64>>,
    /// Elasticity and solids, where sides may touch: the largest multiplier over its nodal area.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_pressure: Option<f64>,
    /// Elasticity and solids, where sides may touch: sum of the nodal areas of the rows that hold.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// Elasticity, where sides may touch: how far they slide.
    #[serde(flatten)]
    pub slid: Slid,
    /// Where there is friction: its force and the states of nodes.
    #[serde(flatten)]
    pub friction: Option<FrictionForce>,
    /// Where there is friction: its largest values.
    #[serde(flatten)]
    pub extremes: Option<FrictionExtremes>,
}

/// How far sides that touch slide along each other and turn.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Slid {
    /// The largest displacement of two sides along each other at nodes that touch, at the end and since the pairing was
    /// made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_sliding: Option<f64>,
    /// The largest such displacement over the size of the faces at its node.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sliding_over_face: Option<f64>,
    /// The largest angle in degrees by which a face with a node that touches has turned since the pairing was made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_turn: Option<f64>,
}

/// A force: a number in scalar problems, a list of components in elasticity.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Amount(pub Vec<f64>);

impl From<f64> for Amount {
    fn from(x: f64) -> Amount {
        Amount(vec![x])
    }
}

/// The form of [`Amount`] in JSON.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum WrittenContact {
    Number(Option<f64>),
    List(Vec<Option<f64>>),
}

impl Serialize for Amount {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let finite = |x: &f64| x.is_finite().then_some(*x);
        match &self.0[..] {
            [] => WrittenContact::Number(Some(0.0)),
            [x] => WrittenContact::Number(finite(x)),
            list => WrittenContact::List(list.iter().map(finite).collect()),
        }
        .serialize(s)
    }
}

impl<'de> Deserialize<'de> for Amount {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        let number = |x: Option<f64>| x.unwrap_or(f64::NAN);
        Ok(match WrittenContact::deserialize(d)? {
            WrittenContact::Number(x) => number(x).into(),
            WrittenContact::List(list) => Amount(list.into_iter().map(number).collect()),
        })
    }
}

/// Equilibrium of one body: its loads, springs, contacts and reactions add up to nothing.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyBalance {
    /// Name of the body.
    pub name: String,
    /// Whether only its neighbours hold it.
    pub floating: bool,
    /// Resultant of its loads.
    pub load: Amount,
    /// Resultant of the springs that it stands on; absent where it stands on none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub springs: Option<Amount>,
    /// Resultant of the forces on its interfaces, at its obstacles and in its equations.
    pub contact: Amount,
    /// Resultant of the reactions at prescribed displacements, as the elements have them, less what the iteration
    /// leaves (`imbalance`) where that is within the tolerance; `null` for a body without any.
    pub reaction: Option<Amount>,
    /// The resultant of all forces, relative to the largest sum of the sizes of loads, springs, contacts or reactions;
    /// of rings along the axis.
    #[serde(with = "number")]
    pub imbalance: f64,
    /// In elasticity, for bodies without prescribed displacements: imbalance of the moments about the body's centre,
    /// relative to the moments of the single forces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moment_imbalance: Option<f64>,
    /// The point that moments are about: the centre of the box around the body. Absent where moments say nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre: Option<Vec<f64>>,
    /// The moment of the reactions about it: in the plane a number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reaction_moment: Option<Amount>,
    /// As `moment_imbalance`, for bodies with prescribed displacements: the moment of the reactions counts, too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_moment_imbalance: Option<f64>,
}

/// One load step.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadStep {
    /// Time, or load parameter.
    #[serde(with = "number")]
    pub t: f64,
    /// Outer steps.
    pub outer_iterations: usize,
    /// Inner iterations.
    pub iterations: usize,
    /// Active inequalities at the end of the step.
    pub active: usize,
    /// As [`super::SolveReport::energy`].
    #[serde(with = "number")]
    pub energy: f64,
    /// Sum of the multipliers of all inequalities.
    #[serde(with = "number")]
    pub contact_force: f64,
    /// Where contacts are renewed: the seconds of set-up for the new rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub setup_seconds: Option<f64>,
    /// Where contacts are renewed: number of subdomains that were factored for the new rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factored: Option<usize>,
    /// Elasticity: the largest values of all interfaces at the end of the step.
    #[serde(flatten)]
    pub slid: Slid,
    /// Where there is friction: that of all interfaces.
    #[serde(flatten)]
    pub friction: Option<FrictionForce>,
}

#[cfg(test)]
#[path = "../../tests/json/contact.rs"]
mod tests;
