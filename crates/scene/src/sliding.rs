//! How far the sides of a contact slide along each other, against the size of their faces, and how far faces turn:
//! both are small where the geometry of the undeformed bodies may stand for that of the deformed ones.

use crate::rows::at_node::AtNode;
use std::collections::{BTreeMap, BTreeSet};

use rustc_hash::{FxHashMap, FxHashSet};

use super::checked::Scene;
use super::displaced::Displaced;
use super::model::steps::Factors;
use super::rows::obstacles::Obstacle;
use super::rows::row::Row;
use base::linalg::vec3::{cross, dot, minus, norm};
use bytemuck::{Pod, Zeroable};
use elements::mortar::across;
use fetifeti::problem::{BodyNode, RowSource};
use fetifeti::solution::SolvedRow;
use parallel::exchange::exchange;
use petsc::Session;

/// The motion of two sides along each other, at nodes that touch.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
pub struct Sliding {
    /// The largest difference of their displacements along the face.
    pub largest: f64,
    /// The largest such difference over the size of the faces at its node.
    pub over_face: f64,
    /// The largest angle by which a face with a node that touches turns, in degrees.
    pub turned: f64,
}

/// The sliding of one source by the rows that a rank has.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct SourceSliding {
    source: [usize; 2],
    sliding: Sliding,
}

impl Sliding {
    /// The larger of both, value by value.
    pub fn max(self, other: Sliding) -> Sliding {
        Sliding {
            largest: self.largest.max(other.largest),
            over_face: self.over_face.max(other.over_face),
            turned: self.turned.max(other.turned),
        }
    }
}

/// The sliding of the interfaces and obstacles that touch at load step `step`, on rank 0, from the rows that each rank
/// has. `u` has the displacements since the pairing was made, of the bodies of these rows. Collective.
///
/// # Panics
/// For a step that the scene does not have.
pub fn slid(
    session: &Session,
    scene: &Scene,
    rows: &[SolvedRow],
    u: &Displaced,
    step: usize,
) -> BTreeMap<RowSource, Sliding> {
    let touching = rows.iter().filter(|r| r.is_inequality() && r.holds());
    let mut rows: Vec<SolvedRow> = touching.copied().collect();
    rows.sort_by_key(|r| r.label.source);
    let sliders = Sliders::new(scene, step, &bodies_of(&rows));
    let mut outgoing = vec![Vec::new(); session.size()];
    for rows in rows.chunk_by(|a, b| a.label.source == b.label.source) {
        let source = rows[0].label.source.code();
        let sliding = sliders.of(rows, u);
        outgoing[0].push(SourceSliding { source, sliding });
    }
    let mut all: BTreeMap<RowSource, Sliding> = BTreeMap::new();
    for SourceSliding { source, sliding } in exchange(session.comm(), outgoing) {
        let at = all.entry(RowSource::of_code(source)).or_default();
        *at = at.max(sliding);
    }
    all
}

/// The bodies with a node in these rows.
pub fn bodies_of(rows: &[SolvedRow]) -> BTreeSet<usize> {
    let members = rows.iter().flat_map(|r| r.label.members);
    members.flatten().map(|node| node.body).collect()
}

/// The search for the sliding of the contacts of some bodies. It keeps what does not change with the displacements.
struct Sliders<'a> {
    scene: &'a Scene,
    /// The faces of every side of the bodies that may touch, by their corners in order.
    faces: FxHashMap<(usize, usize), Vec<Vec<usize>>>,
    /// The size of the faces at every node of these sides.
    sizes: FxHashMap<BodyNode, f64>,
    /// How far every obstacle has moved.
    motions: Vec<[f64; 3]>,
    /// The weights of nodes in rows between sides whose nodes do not match.
    mortar: FxHashMap<(RowSource, [Option<BodyNode>; 2]), &'a Row>,
}

impl Scene {
    /// How far an obstacle has moved at load step `step`.
    ///
    /// # Panics
    /// For a step that the scene does not have.
    pub fn way_of(&self, obstacle: &Obstacle, step: usize) -> [f64; 3] {
        let factors = Factors::of(&self.steps, step).expect("the step exists");
        let factor = factors.gap(obstacle.entry());
        obstacle.motion.map(|m| m * factor)
    }
}

impl<'a> Sliders<'a> {
    fn new(scene: &'a Scene, step: usize, bodies: &BTreeSet<usize>) -> Sliders<'a> {
        let motion = |o: &Obstacle| {
            let way = scene.way_of(o, step);
            // Where contacts are renewed, displacements are those since the last step.
            if scene.is_renewed() && step > 0 {
                minus(way, scene.way_of(o, step - 1))
            } else {
                way
            }
        };
        let (mut faces, mut sizes) = (FxHashMap::default(), FxHashMap::default());
        for (body, side) in scene.sides_that_may_touch(|b| bodies.contains(&b)) {
            let spec = &scene.bodies[body].spec;
            let mut outlines = Vec::new();
            for face in spec.faces(side) {
                let outline = face.outline();
                let x: Vec<[f64; 3]> = outline.iter().map(|&k| spec.position(k)).collect();
                let edge = |k: usize| norm(minus(x[k], x[(k + 1) % x.len()]));
                let size = (0..x.len()).map(edge).fold(0.0, f64::max);
                for &node in &face.nodes {
                    let at = sizes.entry(BodyNode { body, node }).or_insert(size);
                    *at = size.min(*at);
                }
                outlines.push(outline);
            }
            faces.insert((body, side), outlines);
        }
        let mortar = scene.mortar_rows().filter(|m| m.law.is_inequality());
        Sliders {
            scene,
            faces,
            sizes,
            motions: scene.obstacles.iter().map(motion).collect(),
            mortar: mortar.map(|m| ((m.source, m.members), m)).collect(),
        }
    }

    /// The motion since the displacements were zero, of rows that touch and come from one interface or obstacle.
    fn of(&self, rows: &[SolvedRow], u: &Displaced) -> Sliding {
        let mut out = Sliding::default();
        let mut touching: FxHashSet<BodyNode> = FxHashSet::default();
        let Some(source) = rows.first().map(|r| r.label.source) else {
            return out;
        };
        for row in rows {
            let members = row.label.members;
            let n = row.normal();
            let apart = self.apart(source, members, u);
            let across = dot(apart, n);
            let slid = norm(minus(apart, n.map(|v| across * v)));
            let sizes = members.iter().flatten().filter_map(|m| self.sizes.get(m));
            let size = sizes.copied().fold(f64::INFINITY, f64::min);
            out.largest = out.largest.max(slid);
            out.over_face = out.over_face.max(slid / size);
            touching.extend(members.into_iter().flatten());
        }
        for (body, side) in self.scene.sides_of(source) {
            for face in self.faces.get(&(body, side)).into_iter().flatten() {
                let nodes = face.iter().map(|&node| BodyNode { body, node });
                if nodes.clone().any(|node| touching.contains(&node)) {
                    out.turned = out.turned.max(self.turned(nodes, u));
                }
            }
        }
        out
    }

    /// u of the first side less u of the second one at a row.
    fn apart(&self, source: RowSource, members: [Option<BodyNode>; 2], u: &Displaced) -> [f64; 3] {
        let row = self.mortar.get(&(source, members));
        let mut out = match source {
            RowSource::Obstacle(k) => self.motions[k].map(|m| 0.0 - m),
            _ => [0.0; 3],
        };
        let mut add = |node: BodyNode, weight: f64| {
            let at = u.at(node);
            (0..3).for_each(|d| out[d] += weight * at[d]);
        };
        for ((k, sign), member) in [(0, 1.0), (1, -1.0)].into_iter().zip(members) {
            let Some(member) = member else { continue };
            match row {
                None => add(member, sign),
                Some(row) => row.side(k).for_each(|(node, w)| add(node, sign * w)),
            }
        }
        out
    }

    /// The angle in degrees by which a face turns.
    fn turned(&self, nodes: impl Iterator<Item = BodyNode> + Clone, u: &Displaced) -> f64 {
        let bodies = &self.scene.bodies;
        let before: Vec<[f64; 3]> = nodes.clone().map(|n| n.position(bodies)).collect();
        let moved = nodes.zip(&before).map(|(node, x)| {
            let u = u.at(node);
            [0, 1, 2].map(|d| x[d] + u[d])
        });
        let (a, b) = (across(&before), across(&moved.collect::<Vec<_>>()));
        norm(cross(a, b)).atan2(dot(a, b)).to_degrees()
    }
}
