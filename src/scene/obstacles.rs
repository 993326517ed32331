//! Rigid obstacles: one-sided bounds on u at the boundary of a body.

use super::entries::some_names;
use super::profile::{Limit, Limits};
use super::select::pick;
use super::spec::{Extent, ObstacleSpec, SIDES};
use super::{Body, Variables};
use crate::error::{Error, Result};
use crate::mesh::BoxMesh;
use std::collections::BTreeMap;

/// One bound beside one side of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// The body.
    pub body: usize,
    /// The side, an index into [`SIDES`].
    pub side: usize,
    /// u ≤ above; otherwise u ≥ below.
    pub upper: bool,
    /// Its name in reports, such as "left.top above".
    pub name: String,
    /// Right-hand sides of the rows u ≤ above and −u ≤ −below, by node of the body.
    pub limits: Limits,
}

impl Obstacle {
    /// Parameter of a node of the body along the side, 0 ≤ t ≤ 1.
    pub fn t(&self, mesh: &BoxMesh, node: usize) -> f64 {
        let along = along(self.side);
        mesh.place(node)[along] as f64 / mesh.elements[along] as f64
    }
}

/// The direction of a side: left and right run along y.
fn along(side: usize) -> usize {
    usize::from(side < 2)
}

/// The nodes of a side by increasing x or y.
fn nodes(mesh: &BoxMesh, side: usize) -> Vec<usize> {
    let along = along(side);
    let mut place = [0; 2];
    place[1 - along] = [0, mesh.elements[1 - along]][side % 2];
    let node = |k: usize| {
        place[along] = k;
        mesh.node(place)
    };
    (0..=mesh.elements[along]).map(node).collect()
}

/// The obstacles of a scene, by body, side and bound; `first` is the number of the first entry.
pub(super) fn find(
    bodies: &[Body],
    entries: &[ObstacleSpec],
    first: usize,
) -> Result<Vec<Obstacle>> {
    let mut found: BTreeMap<(usize, usize, bool), Vec<Limit>> = BTreeMap::new();
    for (k, entry) in entries.iter().enumerate() {
        let fail = |message: String| Err(Error::Input(format!("{}{message}", entry.written)));
        if entry.below.is_none() && entry.above.is_none() {
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
        for b in chosen {
            for &side in &entry.sides {
                let selected = select(&bodies[b], side, entry)?;
                for (upper, bound) in [(false, &entry.below), (true, &entry.above)] {
                    let Some(bound) = bound else { continue };
                    let list = found.entry((b, side, upper)).or_default();
                    for &(node, t) in &selected {
                        let spec = &bodies[b].spec;
                        let point = spec.mesh.position(spec.mesh.place(node));
                        let at = Variables {
                            point,
                            body: spec.place,
                            subdomain: [0, 0],
                        };
                        let value = bound.eval(t, &at);
                        if !value.is_finite() {
                            let key = ["below", "above"][usize::from(upper)];
                            let ([x, y], name) = (point, &spec.name);
                            return fail(format!(
                                "the bound `{key}` of body `{name}` is {value} at ({x}, {y}) where a finite number was \
                                 expected"
                            ));
                        }
                        list.push(Limit {
                            node,
                            value: if upper { value } else { 0.0 - value },
                            entry: Some(first + k),
                        });
                    }
                }
            }
        }
    }
    let named = |((body, side, upper), list): ((usize, usize, bool), Vec<Limit>)| Obstacle {
        body,
        side,
        upper,
        name: format!(
            "{}.{} {}",
            bodies[body].spec.name,
            SIDES[side],
            if upper { "above" } else { "below" }
        ),
        limits: Limits::new(list),
    };
    Ok(found.into_iter().map(named).collect())
}

/// The nodes that `entry` selects on a side, with their t.
fn select(body: &Body, side: usize, entry: &ObstacleSpec) -> Result<Vec<(usize, f64)>> {
    let nodes = nodes(body.mesh(), side);
    let last = (nodes.len() - 1) as f64;
    let t: Vec<f64> = (0..nodes.len()).map(|k| k as f64 / last).collect();
    let (name, side) = (&body.spec.name, SIDES[side]);
    let picked = pick(&entry.extent, &t).map_err(|missing| {
        Error::Input(format!(
            "{}the obstacle of body `{name}` names the node with {missing}, but its side {side} has {} nodes and none \
             like that",
            entry.written,
            nodes.len()
        ))
    })?;
    if picked.is_empty() && entry.extent != Extent::None {
        return Err(Error::Input(format!(
            "{}the obstacle of body `{name}` selects no node of its side {side}",
            entry.written
        )));
    }
    Ok(picked.into_iter().map(|k| (nodes[k], t[k])).collect())
}
