//! Friction at nodes in contact: tangential rows beside the normal ones, and the bounds of their forces.
//!
//! A node with friction has d − 1 tangential rows in the block of its normal row. They come after all other rows of a
//! scene, in the order of the normal rows.

use super::at_node::AtNode;
use super::row::{Bound, Row};
use crate::body::Body;
use crate::model::entry::EntryId;
use crate::model::friction::FrictionSpec;
use crate::model::profile::Profile;
use crate::model::spec::SceneSpec;
use crate::model::steps::Factors;
use base::linalg::vec3::{cross, dot};
use base::{Error, Result};
use fetifeti::problem::{FrictionBound, Law, RowSource};

/// A node with friction.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeFriction {
    /// The index of the normal row in [`Scene::rows`](crate::Scene::rows).
    pub normal: usize,
    /// The tangential rows.
    pub tangential: Vec<Row>,
    /// The bound of the shear stress.
    stress: ShearBound,
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

/// The nodes with friction among `rows`.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for a coefficient or a bound that is negative or not finite somewhere.
pub(crate) fn collect(
    bodies: &[Body],
    spec: &SceneSpec,
    rows: &[Row],
    t: &dyn Fn(RowSource, usize) -> f64,
    motion: &dyn Fn(RowSource) -> [f64; 3],
) -> Result<Vec<NodeFriction>> {
    let mut out = Vec::new();
    let dim = bodies[0].mesh().dim();
    for (normal, row) in rows.iter().enumerate() {
        let entries = row.limits().iter().filter_map(|l| l.entry);
        let Some((entry, friction)) = entries
            .filter_map(|entry| Some((entry, of_entry(spec, entry)?)))
            .next()
        else {
            continue;
        };
        let update = spec.steps.as_ref().is_some_and(|s| s.update);
        let cannot = match () {
            () if dim == 3 => Some("in space, expected a scene in the plane"),
            () if row.combination.is_some() => {
                Some("between sides whose nodes do not match, expected nodes that lie opposite each other")
            }
            () if update => Some("with `update` in [steps], expected contacts that stay as they are"),
            () => None,
        };
        if let Some(why) = cannot {
            let location = spec.location_of(entry);
            let entry = entry.named(Some(location));
            return Err(Error::input(format!("friction of {entry} {why}")).at(location));
        }
        let tangents = tangents(row.direction, dim);
        let made: Vec<Row> = tangents
            .into_iter()
            .map(|t| tangential(bodies, row, t))
            .collect();
        // Given values on both sides leave nothing to slide.
        if made.iter().any(|row| row.terms(bodies).is_empty()) {
            continue;
        }
        let node = Place {
            bodies,
            row,
            entry,
            spec,
            t: t(row.source, row.node),
        };
        let stress = match friction {
            FrictionSpec::Coulomb { coefficient, limit } => ShearBound::Coulomb {
                coefficient: node.value(coefficient, "friction")?,
                limit: match limit {
                    Some(limit) => Some(node.value(limit, "friction_limit")?),
                    None => None,
                },
            },
            FrictionSpec::Tresca(bound) => ShearBound::Tresca(node.value(bound, "tresca")?),
        };
        out.push(NodeFriction {
            normal,
            tangential: made,
            stress,
            motion: motion(row.source),
        });
    }
    Ok(out)
}

/// The friction of an entry, if it has some.
pub(crate) fn of_entry(spec: &SceneSpec, entry: EntryId) -> Option<&FrictionSpec> {
    match entry {
        EntryId::Contact(k) => spec.contacts[k].friction.as_ref(),
        EntryId::Obstacle(k) => spec.obstacles[k].friction.as_ref(),
        EntryId::Tie(_) | EntryId::Equation(_) => None,
    }
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
    fn value(&self, profile: &Profile, key: &str) -> Result<f64> {
        let node = self.row.members[0].expect("a contact has a first node");
        let body = &self.bodies[node.body].spec;
        let value = profile.eval(self.t, &body.variables(node.node));
        if value >= 0.0 && value.is_finite() {
            return Ok(value);
        }
        let location = self.spec.location_of(self.entry).with_key(key);
        Err(Error::input(format!(
            "`{key}` is {value} at {} of body `{}`, expected a number that is not negative",
            node.spot(self.bodies),
            body.name
        ))
        .at(&location))
    }
}

/// The unit vectors that are perpendicular to the unit vector `n`: one in the plane, two in space. Along an axis they
/// are axes.
fn tangents(n: [f64; 3], dim: usize) -> Vec<[f64; 3]> {
    if dim == 2 {
        return vec![[0.0 - n[1], n[0], 0.0]];
    }
    let least = (0..3).min_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs()));
    let mut first = [0.0; 3];
    first[least.expect("three components")] = 1.0;
    let along = dot(first, n);
    let mut first: [f64; 3] = std::array::from_fn(|c| first[c] - along * n[c]);
    let size = dot(first, first).sqrt();
    first.iter_mut().for_each(|v| *v /= size);
    vec![first, cross(n, first)]
}

/// The tangential row beside a normal one.
fn tangential(bodies: &[Body], normal: &Row, direction: [f64; 3]) -> Row {
    let given = normal
        .members
        .map(|m| m.map_or(0.0, |m| m.along(bodies, direction).given));
    Row {
        law: Law::Friction,
        holds: true,
        direction,
        bound: Some(Box::new(Bound {
            limits: Vec::new(),
            value: 0.0,
            given,
        })),
        combination: None,
        ..normal.clone()
    }
}

impl NodeFriction {
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
