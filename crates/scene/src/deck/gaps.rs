//! Gap elements of a deck: pairs of nodes that may touch, and nodes beside the ground.
//!
//! A node that no element has is ground: it is where *BOUNDARY puts it. The contacts and obstacles of all steps have
//! one order, so that slip goes on where it was ([`SlipHistory`](super::SlipHistory)).

use std::collections::BTreeMap;

use super::bodies::axis;
use super::joints::at;
use super::numbers::DeckNumbering;
use crate::checked::Scene;
use crate::model::body::BodySpec;
use crate::model::friction::{ContactLaw, FrictionSpec};
use crate::model::joints::{ContactSpec, Extent, ObstacleSpec, OpposedNodes, PairSelector};
use crate::model::profile::Profile;
use crate::model::rigid::Rigid;
use crate::rows::obstacles::Obstacle;
use base::linalg::vec3::{dot, minus, norm};
use base::Result;
use deck::{Deck, Gap, GapElement, Overclosure};
use fetifeti::problem::{BodyNode, RowSource};
use fetifeti::solution::SolvedRow;

/// Components of a direction that are rounding.
const NOTHING: f64 = 1e-12;

/// The pairs of bodies, or the body and the ground node, with the bits of the direction.
type Opposed<K> = BTreeMap<(K, [u64; 3]), Vec<[usize; 2]>>;

/// The contacts and obstacles of the gap elements in a step, beside the bodies of the deck.
pub(super) fn of(
    deck: &Deck,
    numbers: &DeckNumbering,
    bodies: &[BodySpec],
    step: usize,
) -> Result<(Vec<ContactSpec>, Vec<ObstacleSpec>)> {
    let (mut contacts, mut obstacles) = (Vec::new(), Vec::new());
    for gap in &deck.gaps {
        let (mut pairs, mut grounded): (Opposed<[usize; 2]>, Opposed<(usize, u32)>) =
            Default::default();
        for element in &gap.elements {
            let n = direction(deck, gap, element);
            // One zero, so that equal directions have equal bits.
            let bits = |n: [f64; 3]| n.map(|x| (x + 0.0).to_bits());
            match element.nodes.map(|k| numbers.node(k)) {
                [Some(a), Some(b)] => {
                    let list = pairs.entry(([a.body, b.body], bits(n))).or_default();
                    list.push([a.node, b.node]);
                }
                [Some(a), None] => {
                    let place = on_skin(deck, element, a, bodies)?;
                    let key = ((a.body, element.nodes[1]), bits(n.map(|x| 0.0 - x)));
                    grounded.entry(key).or_default().push([place, 0]);
                }
                [None, Some(b)] => {
                    let place = on_skin(deck, element, b, bodies)?;
                    let key = ((b.body, element.nodes[0]), bits(n));
                    grounded.entry(key).or_default().push([place, 0]);
                }
                [None, None] => {
                    return fail(deck, element, "joins two nodes that no other element has")
                }
            }
        }
        let law = law(deck, gap, step);
        let each = pairs
            .into_iter()
            .flat_map(|(key, all)| layers(all).map(move |one| (key, one)));
        for (([a, b], bits), pairs) in each {
            contacts.push(ContactSpec {
                pair: PairSelector::Named(bodies[a].name.clone(), bodies[b].name.clone()),
                sides: None,
                extent: Extent::All,
                gap: Profile::constant(gap.clearance),
                distance: None,
                multipliers: None,
                adjust: 0.0,
                adjusted: Vec::new(),
                opposed: Some(OpposedNodes {
                    pairs,
                    normal: bits.map(f64::from_bits),
                    area: gap.area,
                }),
                law: law.clone(),
                ramp: None,
                location: at(deck, gap.place),
            });
        }
        let each = grounded.into_iter();
        let each = each.flat_map(|(key, all)| layers(all).map(move |one| (key, one)));
        for (((body, ground), bits), nodes) in each {
            let normal = bits.map(f64::from_bits);
            obstacles.push(ObstacleSpec {
                body: Some(bodies[body].name.clone()),
                sides: bodies[body]
                    .mesh
                    .cells()
                    .map(|mesh| mesh.skin())
                    .into_iter()
                    .collect(),
                extent: Extent::Nodes(nodes.into_iter().map(|[node, _]| node).collect()),
                below: None,
                above: None,
                rigid: Some(Rigid::Behind { normal, ground }),
                surface: None,
                gap: Profile::constant(gap.clearance),
                motion: motion(deck, gap, (ground, normal), law.friction.is_some(), step)?,
                distance: None,
                adjust: 0.0,
                area: Some(gap.area),
                law: law.clone(),
                ramp: None,
                location: at(deck, gap.place),
            });
        }
    }
    Ok((contacts, obstacles))
}

/// The pairs in lists that have each of them once: two elements at the same nodes are two springs.
fn layers(mut all: Vec<[usize; 2]>) -> impl Iterator<Item = Vec<[usize; 2]>> {
    all.sort_unstable();
    let mut out: Vec<Vec<[usize; 2]>> = Vec::new();
    for same in all.chunk_by(|a, b| a == b) {
        for (layer, pair) in same.iter().enumerate() {
            match out.get_mut(layer) {
                Some(list) => list.push(*pair),
                None => out.push(vec![*pair]),
            }
        }
    }
    out.into_iter()
}

fn fail<T>(deck: &Deck, element: &GapElement, why: &str) -> Result<T> {
    let message = format!("gap element {} {why}", element.id);
    Err(deck.files.error(element.place, message))
}

/// The direction of an element, of length 1.
fn direction(deck: &Deck, gap: &Gap, element: &GapElement) -> [f64; 3] {
    gap.direction.unwrap_or_else(|| {
        let [a, b] = element.nodes.map(|k| deck.mesh.points[k as usize]);
        let mut along = minus(b, a);
        if deck.dim() == 2 {
            along[2] = 0.0;
        }
        let length = norm(along);
        along.map(|x| x / length)
    })
}

/// The place of a node on the surface of its body.
fn on_skin(
    deck: &Deck,
    element: &GapElement,
    node: BodyNode,
    bodies: &[BodySpec],
) -> Result<usize> {
    let mesh = bodies[node.body].mesh.cells();
    let nodes = mesh.map(|mesh| &mesh.sides[mesh.skin()].nodes);
    let place = nodes.and_then(|nodes| nodes.binary_search(&(node.node as u32)).ok());
    let why = "leads from the ground to a node inside a body (one on its surface was expected)";
    place.map_or_else(|| fail(deck, element, why), Ok)
}

/// Where *BOUNDARY puts a ground node in a step. It must say so along the normal, and with friction in all directions.
fn motion(
    deck: &Deck,
    gap: &Gap,
    (ground, normal): (u32, [f64; 3]),
    slides: bool,
    step: usize,
) -> Result<[f64; 3]> {
    let mut motion = [0.0; 3];
    for dof in 0..deck.dim() {
        let axis = axis(deck, ground, dof);
        let supports = deck.steps[step].supports.iter();
        let mut own = supports.filter(|s| s.node == ground && usize::from(s.dof) == dof);
        match own.next() {
            Some(given) => (0..3).for_each(|d| motion[d] += given.value * axis[d]),
            None if slides || dot(axis, normal).abs() > NOTHING => {
                let message = format!(
                    "*GAP: no element has node {}, and *BOUNDARY does not hold it in direction {} (the ground of gap \
                     elements is held along their direction, with friction in all)",
                    deck.mesh.node_ids[ground as usize],
                    dof + 1
                );
                return Err(deck.files.error(gap.place, message));
            }
            None => {}
        }
    }
    Ok(motion)
}

/// The law of a *GAP in a step.
fn law(deck: &Deck, gap: &Gap, step: usize) -> ContactLaw {
    let at = gap.interaction as usize;
    let friction = deck.steps[step].friction.get(at).and_then(Option::as_ref);
    ContactLaw {
        friction: friction.map(|f| FrictionSpec::Coulomb {
            coefficient: Profile::constant(f.coefficient),
            limit: f.limit.map(Profile::constant),
        }),
        stiffness: match deck.interactions[at].overclosure {
            Overclosure::Linear { slope } => Some(Profile::constant(slope)),
            _ => None,
        },
        stick_stiffness: friction.and_then(|f| f.stick_slope).map(Profile::constant),
    }
}

/// The motions of ground nodes, and the forces that hold them: those on the bodies, by these normal and tangential
/// rows. Both are by the nodes of the deck.
pub(super) fn on_ground<'r>(
    scene: &Scene,
    rows: impl Iterator<Item = &'r SolvedRow>,
    motions: &mut [[f64; 3]],
    forces: &mut [[f64; 3]],
) {
    let ground = |obstacle: &Obstacle| match obstacle.rigid {
        Some(Rigid::Behind { ground, .. }) => Some(ground as usize),
        _ => None,
    };
    for obstacle in &scene.obstacles {
        if let Some(k) = ground(obstacle) {
            motions[k] = obstacle.motion;
        }
    }
    for row in rows {
        let RowSource::Obstacle(o) = row.label.source else {
            continue;
        };
        if let Some(k) = ground(&scene.obstacles[o]) {
            let along = row.normal().into_iter();
            (forces[k].iter_mut().zip(along)).for_each(|(f, n)| *f -= row.multiplier * n);
        }
    }
}
