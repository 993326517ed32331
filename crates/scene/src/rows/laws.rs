//! The laws of nodes in contact: softness; friction, with tangential rows beside the normal ones and the bounds of
//! their forces.
//!
//! A node with friction has d − 1 tangential rows in the block of its normal row. They come after all other rows of a
//! scene, in the order of the normal rows.

use super::at_node::AtNode;
use super::mortar::merged;
use super::row::{Bound, Combination, Row};
use crate::body::Body;
use crate::model::entry::EntryId;
use crate::model::friction::{ContactLaw, FrictionSpec};
use crate::model::profile::Profile;
use crate::model::spec::SceneSpec;
use crate::model::steps::Factors;
use base::linalg::vec3::{dot, tangents};
use base::{Error, Result};
use fetifeti::problem::{FrictionBound, Law, RowSource};

/// The law at a node, where it is not hard contact without friction.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeLaw {
    /// The index of the normal row in [`Scene::rows`](crate::Scene::rows).
    pub normal: usize,
    /// Soft contact: the pressure over the overclosure.
    stiffness: Option<f64>,
    /// Friction.
    pub friction: Option<NodeFriction>,
}

/// Friction at a node.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeFriction {
    /// The tangential rows.
    pub tangential: Vec<Row>,
    /// The bound of the shear stress.
    stress: ShearBound,
    /// Elastic slip: the shear stress over the slip.
    stick_stiffness: Option<f64>,
    /// The way of the obstacle, without the factors of load steps.
    motion: [f64; 3],
}

/// The bound of the shear stress at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ShearBound {
    Coulomb {
        coefficient: f64,
        limit: Option<f64>,
    },
    Tresca(f64),
}

/// The nodes with a law of their own among `rows`.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for a coefficient, bound or stiffness out of range somewhere.
pub(crate) fn collect(
    bodies: &[Body],
    spec: &SceneSpec,
    rows: &[Row],
    t: &dyn Fn(RowSource, usize) -> f64,
    motion: &dyn Fn(RowSource) -> [f64; 3],
) -> Result<Vec<NodeLaw>> {
    let mut out = Vec::new();
    for (normal, row) in rows.iter().enumerate() {
        let Some((entry, law)) = of_row(spec, bodies, row)? else {
            continue;
        };
        let place = Place {
            bodies,
            row,
            entry,
            spec,
            t: t(row.source, row.node),
        };
        let stiffness = |profile: &Option<Profile>, key| {
            let value = profile.as_ref().map(|p| place.value(p, key, true));
            value.transpose()
        };
        let friction = match &law.friction {
            None => None,
            Some(friction) => place.friction(
                friction,
                stiffness(&law.stick_stiffness, "stick_stiffness")?,
                motion(row.source),
            )?,
        };
        out.push(NodeLaw {
            normal,
            stiffness: stiffness(&law.stiffness, "stiffness")?,
            friction,
        });
    }
    Ok(out)
}

/// The law of a row, with one of the entries that select it; `None` for hard contact without friction.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for entries with different laws.
fn of_row<'s>(
    spec: &'s SceneSpec,
    bodies: &[Body],
    row: &Row,
) -> Result<Option<(EntryId, &'s ContactLaw)>> {
    let mut entries = row.limits().iter().filter_map(|l| l.entry);
    let Some(first) = entries.next() else {
        return Ok(None);
    };
    let law = of_entry(spec, first);
    if let Some(other) = entries.find(|&other| of_entry(spec, other) != law) {
        let node = row.members[0].expect("a contact has a first node");
        let [here, there] = [first, other].map(|entry| spec.location_of(entry));
        return Err(Error::input(format!(
            "{} and {} both select the node at {} of body `{}` and have different laws (friction, stiffness), \
             expected one law at a node",
            first.named(Some(here)),
            other.named(Some(there)),
            node.spot(bodies),
            bodies[node.body].spec.name
        ))
        .at(there));
    }
    Ok(law.map(|law| (first, law)))
}

/// The law of an entry, if it is not hard contact without friction.
fn of_entry(spec: &SceneSpec, entry: EntryId) -> Option<&ContactLaw> {
    let law = match entry {
        EntryId::Contact(k) => &spec.contacts[k].law,
        EntryId::Obstacle(k) => &spec.obstacles[k].law,
        EntryId::Tie(_) | EntryId::Equation(_) => return None,
    };
    (*law != ContactLaw::default()).then_some(law)
}

/// Where a profile is evaluated.
struct Place<'a> {
    bodies: &'a [Body],
    row: &'a Row,
    entry: EntryId,
    spec: &'a SceneSpec,
    t: f64,
}

impl Place<'_> {
    fn refused(&self, why: &str) -> Error {
        let location = self.spec.location_of(self.entry);
        let entry = self.entry.named(Some(location));
        Error::input(format!("friction of {entry} {why}")).at(location)
    }

    /// Friction at the node, along the tangents along which given values leave something to slide; none without any.
    fn friction(
        &self,
        spec: &FrictionSpec,
        stick_stiffness: Option<f64>,
        motion: [f64; 3],
    ) -> Result<Option<NodeFriction>> {
        let stress = match spec {
            FrictionSpec::Coulomb { coefficient, limit } => ShearBound::Coulomb {
                coefficient: self.value(coefficient, "friction", false)?,
                limit: match limit {
                    Some(limit) => Some(self.value(limit, "friction_limit", false)?),
                    None => None,
                },
            },
            FrictionSpec::Tresca(bound) => ShearBound::Tresca(self.value(bound, "tresca", false)?),
        };
        let tangents = tangents(self.row.direction, self.bodies[0].mesh().dim());
        let rows = tangents.into_iter();
        let rows = rows.map(|t| tangential(self.bodies, self.row, t));
        let (rows, held): (Vec<Row>, Vec<Row>) =
            rows.partition(|row| !row.terms(self.bodies).is_empty());
        if rows.is_empty() {
            return Ok(None);
        }
        // A node on a plane of symmetry slides along the other tangent.
        let slides = |row: &Row| {
            let given = row.bound.as_ref().map_or([0.0; 2], |bound| bound.given);
            given[0] != given[1] || dot(motion, row.direction) != 0.0
        };
        if held.iter().any(slides) {
            return Err(self.refused(
                "at a node whose slip is given along one tangent, and free along the other, expected both given or \
                 both free",
            ));
        }
        Ok(Some(NodeFriction {
            tangential: rows,
            stress,
            stick_stiffness,
            motion,
        }))
    }

    /// The value of a profile, which must not be negative; nor zero if it is to be `positive`.
    fn value(&self, profile: &Profile, key: &str, positive: bool) -> Result<f64> {
        let node = self.row.members[0].expect("a contact has a first node");
        let body = &self.bodies[node.body].spec;
        let value = profile.eval(self.t, &body.variables(node.node));
        if value >= 0.0 && value.is_finite() && !(positive && value == 0.0) {
            return Ok(value);
        }
        let expected = if positive {
            "a positive number"
        } else {
            "a number that is not negative"
        };
        let location = self.spec.location_of(self.entry).with_key(key);
        Err(Error::input(format!(
            "`{key}` is {value} at {} of body `{}`, expected {expected}",
            node.spot(self.bodies),
            body.name
        ))
        .at(&location))
    }
}

/// The tangential row beside a normal one, between the same nodes with the same weights.
fn tangential(bodies: &[Body], normal: &Row, direction: [f64; 3]) -> Row {
    let mut given = [0.0; 2];
    let mut terms: Vec<(u64, f64)> = Vec::new();
    for (side, sign) in [(0, 1.0), (1, -1.0)] {
        for (node, weight) in normal.side(side) {
            let along = node.along(bodies, direction);
            given[side] += weight * along.given;
            let all = along.terms.into_iter();
            terms.extend(all.map(|(dof, n)| (dof, sign * weight * n)));
        }
    }
    let combination = normal.combination.as_ref().map(|combination| {
        Box::new(Combination {
            terms: merged(terms),
            ..(**combination).clone()
        })
    });
    Row {
        law: Law::Friction,
        holds: true,
        direction,
        bound: Some(Box::new(Bound {
            limits: Vec::new(),
            value: 0.0,
            given,
        })),
        combination,
        ..normal.clone()
    }
}

/// Whether a row is soft: it has a force by its overclosure and its area.
pub(crate) fn is_soft(spec: &SceneSpec, row: &Row) -> bool {
    let entries = row.limits().iter().filter_map(|l| l.entry);
    let mut laws = entries.filter_map(|entry| of_entry(spec, entry));
    laws.any(|law| law.stiffness.is_some())
}

/// Whether a row has friction: its tangential rows have terms in all components at its nodes.
pub(crate) fn has_friction(spec: &SceneSpec, row: &Row) -> bool {
    let entries = row.limits().iter().filter_map(|l| l.entry);
    let mut laws = entries.filter_map(|entry| of_entry(spec, entry));
    laws.any(|law| law.friction.is_some())
}

impl NodeLaw {
    /// C of the normal row of a node of this area.
    pub(crate) fn compliance(&self, area: f64) -> f64 {
        self.stiffness.map_or(0.0, |k| 1.0 / (k * area))
    }

    /// Whether its rows need an area.
    pub(crate) fn needs_area(&self) -> bool {
        let stick = self.friction.as_ref().and_then(|f| f.stick_stiffness);
        self.stiffness.or(stick).is_some()
    }
}

impl NodeFriction {
    /// C of the tangential rows of a node of this area.
    pub(crate) fn compliance(&self, area: f64) -> f64 {
        self.stick_stiffness.map_or(0.0, |k| 1.0 / (k * area))
    }

    /// The bound of the force of friction at a node of this area.
    pub(crate) fn bound(&self, area: f64) -> FrictionBound {
        match self.stress {
            ShearBound::Coulomb { coefficient, limit } => FrictionBound::Coulomb {
                coefficient,
                limit: limit.map_or(f64::INFINITY, |limit| limit * area),
            },
            ShearBound::Tresca(stress) => FrictionBound::Tresca(stress * area),
        }
    }

    /// How far the obstacle of `entry` drags the node along each tangential row, from the load step before, if there is
    /// one, to this one.
    pub(crate) fn drags(
        &self,
        (before, now): &(Option<Factors<'_>>, Factors<'_>),
        entry: Option<EntryId>,
    ) -> Vec<f64> {
        let way = now.gap(entry) - before.as_ref().map_or(0.0, |f| f.gap(entry));
        let rows = self.tangential.iter();
        rows.map(|row| way * dot(self.motion, row.direction))
            .collect()
    }
}
