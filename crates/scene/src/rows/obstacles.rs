//! Rigid obstacles: one-sided bounds on u at the boundary of a body.

use super::entry::some_names;
use super::facing_surfaces::Opposite;
use super::select::pick;
use crate::body::Body;
use crate::geometry::mortar::lacks_signs;
use crate::geometry::normals::parameters;
use crate::model::entry::EntryId;
use crate::model::joints::{Extent, ObstacleSpec};
use crate::model::profile::{Limit, Limits};
use crate::model::rigid::Rigid;
use crate::model::steps::Factors;
use crate::quantity::unfit_length;
use crate::rows::facing_surfaces;
use base::linalg::vec3::{dot, minus};
use base::{Error, Result};
use elements::form::Form;
use std::collections::{BTreeMap, HashMap};

/// One bound on one side of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// The body.
    pub body: usize,
    /// The side of its mesh.
    pub side: usize,
    /// u ≤ above; otherwise u ≥ below.
    pub upper: bool,
    /// Its name in reports, such as "left.top above".
    pub name: String,
    /// Right-hand sides of the rows u ≤ above and −u ≤ −below, by node of the body.
    pub limits: Limits,
    /// In elasticity, the rigid body: the rows are n·u ≤ distance + gap, and `limits` has the gaps.
    pub rigid: Option<Rigid>,
    /// In elasticity, in place of `rigid`, the part of the rigid body's surface that lies opposite the side: the rows
    /// are those of [`Scene::mortar_rows`].
    ///
    /// [`Scene::mortar_rows`]: crate::Scene::mortar_rows
    pub surface: Option<Opposite>,
    /// The way that the rigid body moves, without the factors of load steps.
    pub motion: [f64; 3],
    /// The area that belongs to each node; `None`: that of its faces.
    pub area: Option<f64>,
    /// The distance of each of these nodes from the rigid body, and the unit vector away from it.
    nearest: BTreeMap<usize, (f64, [f64; 3])>,
    /// The way from each node that `adjust` counts as touching to the place at which it would touch.
    pub(super) adjusted: BTreeMap<usize, [f64; 3]>,
    /// The parameters of each of these nodes along the side.
    parameters: BTreeMap<usize, [f64; 2]>,
}

/// Where obstacles are looked at: where they are to begin with, or where they stand at the end of a load step.
#[derive(Clone, Copy)]
pub(crate) struct Standing<'a> {
    factors: Option<Factors<'a>>,
    adjusted: Option<&'a Adjusted>,
}

impl<'a> Standing<'a> {
    /// To begin with: distances up to `adjust` count as touching.
    pub const START: Standing<'static> = Standing {
        factors: None,
        adjusted: None,
    };

    /// At the end of the load step of the factors; nodes that were adjusted at the start stay so.
    pub fn after(factors: Factors<'a>, adjusted: &'a Adjusted) -> Standing<'a> {
        Standing {
            factors: Some(factors),
            adjusted: Some(adjusted),
        }
    }

    /// How far the obstacle of an entry has moved.
    fn way(&self, spec: &ObstacleSpec, entry: EntryId) -> [f64; 3] {
        let factor = self.factors.map_or(0.0, |f| f.gap(Some(entry)));
        spec.motion.map(|m| m * factor)
    }
}

/// The ways of nodes that count as touching, by entry, body, side and node.
pub(crate) type Adjusted = HashMap<(EntryId, usize, usize, usize), [f64; 3]>;

/// The ways of nodes that count as touching the obstacles of a scene.
pub(crate) fn adjusted(obstacles: &[Obstacle]) -> Adjusted {
    let mut out = Adjusted::new();
    for obstacle in obstacles {
        let Some(entry) = obstacle.entry() else {
            continue;
        };
        let nodes = obstacle.adjusted.iter();
        out.extend(nodes.map(|(&node, &way)| ((entry, obstacle.body, obstacle.side, node), way)));
    }
    out
}

impl Obstacle {
    /// Its entry; the first one, where several bound u itself.
    pub(crate) fn entry(&self) -> Option<EntryId> {
        self.limits.all().first().and_then(|l| l.entry)
    }

    /// Whether it has one row with another one at a node that both have. Planes behind single nodes have rows of their
    /// own: two springs are not one.
    pub(super) fn is_one_with(&self, other: &Obstacle) -> bool {
        let own = matches!(self.rigid, Some(Rigid::Behind { .. }));
        !own && (self.upper, self.rigid) == (other.upper, other.rigid)
    }

    /// Parameters of one of the nodes along the side, 0 ≤ t ≤ 1.
    pub fn t(&self, node: usize) -> [f64; 2] {
        self.parameters.get(&node).copied().unwrap_or_default()
    }

    /// Whether `adjust` takes a node as touching.
    pub(crate) fn counts_as_touching(&self, node: usize) -> bool {
        self.adjusted.contains_key(&node)
    }

    /// The distance of a node from the rigid body, and the direction towards it. An obstacle that bounds u itself has
    /// distance 0: u ≤ g and −u ≤ −g are rows along ±1.
    pub(crate) fn ahead(&self, node: usize) -> (f64, [f64; 3]) {
        match self.nearest.get(&node) {
            Some((distance, normal)) => (*distance, normal.map(|v| 0.0 - v)),
            None => (0.0, [if self.upper { 1.0 } else { -1.0 }, 0.0, 0.0]),
        }
    }
}

/// The obstacles of a scene, by body, side and bound, where they stand.
pub(crate) fn find_obstacles(
    bodies: &[Body],
    entries: &[ObstacleSpec],
    form: &Form,
    standing: Standing<'_>,
) -> Result<Vec<Obstacle>> {
    // Bounds on u from several entries are combined; every rigid body is an obstacle of its own.
    let mut found: BTreeMap<ObstacleKey, SideObstacleData> = BTreeMap::new();
    // Bodies that have moved may have left an obstacle.
    let moved = bodies.iter().any(|b| b.spec.moved.is_some());
    for (k, entry) in entries.iter().enumerate() {
        let id = EntryId::Obstacle(k);
        let fail = |message: String| Err(Error::input(message).at(&entry.location));
        let (below, above) = (entry.below.as_ref(), entry.above.as_ref());
        let elastic = entry.rigid.is_some() || entry.surface.is_some();
        let bounds = if elastic {
            [("", false, None), ("gap", true, Some(&entry.gap))]
        } else {
            [("below", false, below), ("above", true, above)]
        };
        if bounds.iter().all(|(_, _, bound)| bound.is_none()) {
            return fail(
                "an obstacle without a bound (`below`, `above` or both were expected)".into(),
            );
        }
        let chosen = match &entry.body {
            None => 0..bodies.len(),
            Some(name) => match bodies.iter().position(|b| b.spec.name == *name) {
                Some(b) => b..b + 1,
                None => {
                    return fail(format!(
                        "an obstacle names body `{name}`, which the scene does not have (bodies are {})",
                        some_names(bodies)
                    ))
                }
            },
        };
        let own = elastic.then_some(k);
        let mut missed = None;
        let before = found.len();
        let way = standing.way(entry, id);
        for (b, &side) in chosen.flat_map(|b| entry.sides.iter().map(move |side| (b, side))) {
            let (mut selected, spec) = (select(&bodies[b], side, entry)?, &bodies[b].spec);
            let mut near = BTreeMap::new();
            if let Some(rigid) = &entry.surface {
                let nodes = selected.iter().map(|s| s.0);
                let Some(opposite) = facing_surfaces::find_facing_surfaces(
                    spec,
                    form,
                    side,
                    (rigid, way),
                    entry.distance,
                    nodes,
                ) else {
                    missed.get_or_insert((b, side));
                    continue;
                };
                near.clone_from(&opposite.nearest);
                let overlap = opposite.overlap(&bodies[b], side, entry.adjust);
                if let Some(why) = overlap.filter(|_| !moved) {
                    return fail(why);
                }
                selected.retain(|(node, _)| near.contains_key(node));
                let of_side = found.entry((b, side, own, true)).or_default();
                of_side.surface = Some(opposite);
            }
            if let Some(rigid) = &entry.rigid {
                let nodes = || selected.iter().map(|s| s.0);
                let by_faces = entry.area.is_none();
                let opposite = if by_faces && lacks_signs(&bodies[b], side, nodes()) {
                    facing_surfaces::beneath(spec, form, side, (rigid, way), nodes())
                } else {
                    None
                };
                if let Some(opposite) = opposite {
                    near.clone_from(&opposite.nearest);
                    let of_side = found.entry((b, side, own, true)).or_default();
                    of_side.surface = Some(opposite);
                }
            }
            for (key, upper, bound) in bounds {
                let Some(bound) = bound else { continue };
                let of_side = found.entry((b, side, own, upper)).or_default();
                for &(node, t) in &selected {
                    let (at, spot, name) = (spec.variables(node), || spec.spot(node), &spec.name);
                    if let Some(rigid) = &entry.rigid {
                        let from = minus(spec.position(node), way);
                        let Some((ahead, normal)) = rigid.distance(from) else {
                            return fail(format!(
                                "no point of the obstacle is nearest to the node {} of body `{name}` \
                                 (on its axis or in its centre)",
                                spot()
                            ));
                        };
                        // The row is about displacements from the undeformed body, and of the obstacle as given.
                        let since = minus(spec.displacement(node), way);
                        let distance = ahead - dot(normal, since);
                        near.entry(node).or_insert((distance, normal));
                    }
                    let mut value = bound.eval(t[0], &at);
                    if let Some(&(distance, normal)) = near.get(&node) {
                        let ahead = distance + dot(normal, minus(spec.displacement(node), way));
                        if entry.distance.is_some_and(|most| ahead > most) {
                            continue;
                        }
                        let adjusted = match standing.adjusted {
                            Some(known) => known.get(&(id, b, side, node)).copied(),
                            None if distance.abs() <= entry.adjust => {
                                Some(normal.map(|n| 0.0 - n * distance))
                            }
                            None => None,
                        };
                        let mut near = distance;
                        if let Some(way) = adjusted {
                            of_side.adjusted.insert(node, way);
                            near += dot(way, normal);
                        }
                        if standing.adjusted.is_none() && adjusted.is_some() {
                            near = 0.0;
                        }
                        of_side.nearest.insert(node, (near, normal));
                        // An obstacle that moves towards the body takes from the gap.
                        value -= dot(entry.motion, normal);
                    }
                    of_side.parameters.insert(node, t);
                    if let Some(expected) = unfit_length(value) {
                        return fail(format!(
                            "the bound `{key}` of body `{name}` is {value:e} at {} where {expected}",
                            spot()
                        ));
                    }
                    of_side.limits.push(Limit {
                        node,
                        value: if upper { value } else { 0.0 - value },
                        entry: Some(id),
                    });
                }
            }
        }
        if let (Some((b, side)), Some(rigid), true) =
            (missed, &entry.surface, found.len() == before && !moved)
        {
            let why = facing_surfaces::apart(&bodies[b].spec, form, side, rigid, entry.distance);
            return fail(why);
        }
    }
    let named = |(key, of_side): (ObstacleKey, SideObstacleData)| {
        let surface = of_side.surface.as_ref().and_then(|s| s.name.as_ref());
        let (body, side, own, upper) = key;
        let what = match (own, upper) {
            (None, false) => "below".to_string(),
            (None, true) => "above".to_string(),
            (Some(k), _) => {
                surface.map_or_else(|| EntryId::Obstacle(k).to_string(), |name| name.clone())
            }
        };
        let place = match own.and_then(|k| entries[k].rigid) {
            Some(Rigid::Behind { .. }) => bodies[body].spec.name.clone(),
            _ => format!(
                "{}.{}",
                bodies[body].spec.name,
                bodies[body].mesh().side_name(side)
            ),
        };
        Obstacle {
            body,
            side,
            upper,
            name: format!("{place} {what}"),
            limits: Limits::new(of_side.limits),
            rigid: own.and_then(|k| entries[k].rigid),
            surface: of_side.surface,
            motion: own.map_or([0.0; 3], |k| entries[k].motion),
            area: own.and_then(|k| entries[k].area),
            nearest: of_side.nearest,
            adjusted: of_side.adjusted,
            parameters: of_side.parameters,
        }
    };
    Ok(found.into_iter().map(named).collect())
}

/// Body, side, number of the entry of a rigid body, and whether the bound is an upper one.
type ObstacleKey = (usize, usize, Option<usize>, bool);

/// The data of the entries for the nodes of one side.
#[derive(Default)]
struct SideObstacleData {
    surface: Option<Opposite>,
    limits: Vec<Limit>,
    nearest: BTreeMap<usize, (f64, [f64; 3])>,
    adjusted: BTreeMap<usize, [f64; 3]>,
    parameters: BTreeMap<usize, [f64; 2]>,
}

/// The nodes that `entry` selects on a side, with their t.
fn select(body: &Body, side: usize, entry: &ObstacleSpec) -> Result<Vec<(usize, [f64; 2])>> {
    let mesh = body.mesh();
    let nodes = mesh.side_nodes(side);
    let t = parameters(&body.spec, side, &nodes);
    let (name, side) = (&body.spec.name, mesh.side_name(side));
    let picked = pick(&entry.extent, &t).map_err(|missing| {
        Error::input(format!(
            "the obstacle of body `{name}` names the node with {missing}, but its side {side} has {} nodes and none \
             like that",
            nodes.len()
        ))
        .at(&entry.location)
    })?;
    if picked.is_empty() && entry.extent != Extent::None {
        return Err(Error::input(format!(
            "the obstacle of body `{name}` selects no node of its side {side}"
        ))
        .at(&entry.location));
    }
    Ok(picked.into_iter().map(|k| (nodes[k], t[k])).collect())
}
