//! Rigid surfaces beside bodies: the part that lies opposite a side, and the rows that follow.

use crate::rows::at_node::AtNode;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use super::obstacles::Obstacle;
use super::row::{Bound, Combination, Row};
use crate::body::Body;
use crate::geometry::mortar::surface;
use crate::geometry::mortar_sides::{BodyRow, Surfaces};
use crate::geometry::normals::of_side;
use crate::geometry::overlap;
use crate::model::body::BodySpec;
use crate::model::rigid::Rigid;
use crate::model::rigid_surface::RigidSurface;
use base::linalg::vec3::{dot, minus, norm};
use elements::form::Form;
use elements::mortar::MortarFace;
use fetifeti::problem::{BodyNode, RowSource};

/// The part of a rigid surface that lies opposite a side of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Opposite {
    /// The name of the surface; `None`: a plane, a cylinder or a sphere.
    pub name: Option<String>,
    /// The area (in the plane the length) of the side that lies opposite it.
    pub area: f64,
    /// The faces of the surface, as polygons of their corners.
    pub polygons: Vec<Vec<[f64; 3]>>,
    /// The distance of each node that carries a multiplier, and the unit vector into the body.
    pub(super) nearest: BTreeMap<usize, (f64, [f64; 3])>,
    /// The pairing, until rows are made of it.
    surfaces: Option<Box<Surfaces>>,
    /// The points of the surface.
    points: Vec<[f64; 3]>,
}

impl Opposite {
    /// A sentence if a side of a body lies too far inside; overlaps up to `adjust` do not count.
    pub(super) fn overlap(&self, body: &Body, side: usize, adjust: f64) -> Option<String> {
        let deepest = self.nearest.values().min_by(|a, b| a.0.total_cmp(&b.0));
        let &(distance, normal) = deepest.filter(|n| n.0 < -adjust)?;
        overlap::sentence(self.names(body, side), -distance, body, normal)
    }

    /// The side of a body and this surface, by name.
    pub(crate) fn names(&self, body: &Body, side: usize) -> [String; 2] {
        let (name, side) = (&body.spec.name, body.spec.mesh.side_name(side));
        [
            format!("side `{side}` of `{name}`"),
            format!(
                "the rigid surface `{}`",
                self.name.as_deref().unwrap_or_default()
            ),
        ]
    }

    /// The nodes that carry multipliers, and their distances.
    pub(crate) fn distances(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.nearest
            .iter()
            .map(|(&node, &(distance, _))| (node, distance))
    }
}

/// The part of a surface, which has moved by `way`, at a distance of `reach` at most, that lies opposite some nodes of
/// a side; `None` if there is none. Distances are those from the surface as it is given.
pub(super) fn find_facing_surfaces(
    spec: &BodySpec,
    form: &Form,
    side: usize,
    (rigid, way): (&RigidSurface, [f64; 3]),
    reach: Option<f64>,
    nodes: impl Iterator<Item = usize>,
) -> Option<Opposite> {
    let own = surface(spec, side, form.element);
    let moved = if way == [0.0; 3] {
        rigid.side.clone()
    } else {
        Arc::new(rigid.side.moved(way))
    };
    let reach = reach.unwrap_or_else(|| {
        // Any distance.
        let [low, high] = rigid.bounds();
        let far = own.0.points().iter().fold(0.0_f64, |far, x| {
            far.max(norm(minus(*x, low))).max(norm(minus(*x, high)))
        });
        far + rigid.size() + norm(way)
    });
    let points = rigid.side.points().to_vec();
    let all = (0..points.len()).collect();
    let surfaces = Surfaces::new([own, (moved, all)], reach);
    let meant: HashSet<usize> = nodes.collect();
    let rows = surfaces.rows(form, &|node| !meant.contains(&node));
    let nodes: Vec<usize> = rows.iter().map(|r| r.node).collect();
    let out = of_side(spec, side, &nodes);
    let nearest = rows.iter().zip(out).map(|(row, n)| {
        let distance = row.distance(spec, &|k| points[k], n);
        (row.node, (distance, n.map(|v| 0.0 - v)))
    });
    let nearest: BTreeMap<usize, (f64, [f64; 3])> = nearest.collect();
    let polygon = |face: &MortarFace| {
        let corners = &face.nodes[..face.kind.corners()];
        let at = |&k: &u32| rigid.side.points()[k as usize];
        corners.iter().map(at).collect()
    };
    (!rows.is_empty()).then(|| Opposite {
        name: Some(rigid.name.clone()),
        area: rows.iter().map(|r| r.area).sum(),
        polygons: rigid.side.faces().iter().map(polygon).collect(),
        nearest,
        surfaces: Some(Box::new(surfaces)),
        points,
    })
}

/// The part of a plane, a cylinder or a sphere that lies opposite some nodes of a side, for sides at which rows at
/// single nodes say nothing of pressures: the faces of the side, every node moved to the nearest point of the obstacle,
/// which has moved by `way`. Distances are those from the obstacle as it is given.
pub(super) fn beneath(
    spec: &BodySpec,
    form: &Form,
    side: usize,
    (rigid, way): (&Rigid, [f64; 3]),
    nodes: impl Iterator<Item = usize>,
) -> Option<Opposite> {
    let (own, list) = surface(spec, side, form.element);
    let copy = own.reversed();
    // A node at which no point is the nearest is refused if a row is asked for it.
    let foot = |x: &[f64; 3]| {
        let from = minus(*x, way);
        match rigid.distance(from) {
            Some((distance, normal)) => [0, 1, 2].map(|d| from[d] - distance * normal[d]),
            None => from,
        }
    };
    let points: Vec<[f64; 3]> = own.points().iter().map(foot).collect();
    let all = (0..points.len()).collect();
    // The side and its copy lie at one place.
    let reach = 0.01 * own.longest();
    let surfaces = Surfaces::new([(own, list), (Arc::new(copy), all)], reach);
    let meant: HashSet<usize> = nodes.collect();
    let rows = surfaces.rows(form, &|node| !meant.contains(&node));
    let nearest = rows.iter().filter_map(|row| {
        let (_, normal) = rigid.distance(minus(spec.position(row.node), way))?;
        let out = normal.map(|v| 0.0 - v);
        let distance = row.distance(spec, &|k| points[k], out);
        Some((row.node, (distance, normal)))
    });
    let nearest: BTreeMap<usize, (f64, [f64; 3])> = nearest.collect();
    (!rows.is_empty()).then(|| Opposite {
        name: None,
        area: rows.iter().map(|r| r.area).sum(),
        polygons: Vec::new(),
        nearest,
        surfaces: Some(Box::new(surfaces)),
        points,
    })
}

/// Why a side and a rigid surface have no rows.
pub(super) fn apart(
    spec: &BodySpec,
    form: &Form,
    side: usize,
    rigid: &RigidSurface,
    reach: Option<f64>,
) -> String {
    let nodes = || spec.mesh.side_nodes(side).into_iter();
    let names = format!(
        "side `{}` of body `{}` and the rigid surface `{}`",
        spec.mesh.side_name(side),
        spec.name,
        rigid.name
    );
    let reversed = rigid.reversed();
    if find_facing_surfaces(spec, form, side, (&reversed, [0.0; 3]), reach, nodes()).is_some() {
        return format!(
            "{names} do not face each other: the normals of the surface point away from the body (`reverse = true`, or \
             faces with normals to the free side, were expected)"
        );
    }
    let within = reach.map(|r| format!(" within `distance` = {r}"));
    format!(
        "{names} do not face each other{}: no normal of the side meets the surface, with the opposite normal and an \
         overlap of an edge at most",
        within.unwrap_or_default()
    )
}

impl Obstacle {
    /// Frees what only the making of rows needs.
    pub(crate) fn finish(&mut self) {
        if let Some(opposite) = &mut self.surface {
            opposite.surfaces = None;
            opposite.points = Vec::new();
        }
    }

    /// The rows beside a rigid surface; `number` is that of the obstacle. Nodes of which `taken`, called with their
    /// direction, holds carry none.
    pub(super) fn mortar_rows(
        &self,
        bodies: &[Body],
        form: &Form,
        number: usize,
        taken: &dyn Fn(BodyNode, [f64; 3]) -> bool,
    ) -> Vec<Row> {
        let Some(opposite) = &self.surface else {
            return Vec::new();
        };
        let Some(surfaces) = &opposite.surfaces else {
            return Vec::new();
        };
        let body = self.body;
        let node_of = |node: usize| BodyNode { body, node };
        let held = |node: usize| {
            if self.limits.at(node).is_empty() {
                return true;
            }
            let direction = self.ahead(node).1;
            let along = node_of(node).along(bodies, direction);
            along.terms.is_empty() || taken(node_of(node), direction)
        };
        let row = |row: BodyRow| {
            let node = row.node;
            let (known, direction) = self.ahead(node);
            // What counts as touching does.
            let adjusted = self.adjusted.get(&node).copied().unwrap_or_default();
            let distance = if known == 0.0 {
                0.0
            } else {
                let far = row.distance(&bodies[body].spec, &|k| opposite.points[k], direction);
                far - dot(adjusted, direction)
            };
            let (mut terms, mut given) = (Vec::new(), 0.0);
            for &(k, v) in &row.own {
                let along = node_of(k).along(bodies, direction);
                terms.extend(along.terms.into_iter().map(|(dof, n)| (dof, v * n)));
                given += v * along.given;
            }
            let place = (
                terms.iter().map(|t| t.0).min().unwrap_or_default(),
                bodies[body].first_subdomain + bodies[body].mesh().owner(node),
            );
            let source = RowSource::Obstacle(number);
            let tie = Row::tie(source, node, [Some(node_of(node)), None], direction, place);
            let in_contact = tie.in_contact(Bound {
                limits: self.limits.at(node).to_vec(),
                value: distance,
                given: [given, 0.0],
            });
            in_contact.with_terms(Combination {
                terms,
                weights: [row.own, Vec::new()],
                area: row.area,
                ..Combination::default()
            })
        };
        surfaces.rows(form, &held).into_iter().map(row).collect()
    }
}
