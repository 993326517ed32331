//! Sides of meshes of cells that face each other: each node with the node opposite.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use super::facing::{interface, share};
use super::interface::{BodyInterface, InterfaceShape};
use super::mortar::interface as interface_of_mortar;
use super::surface::Surface;
use super::sweep::{are_disjoint, extent};
use crate::body::Body;
use elements::form::Form;

/// Two nodes are opposite each other if they differ, across the normal, by no more than this fraction of the shortest
/// edge around the first of them.
pub(crate) const MATCH: f64 = 0.01;

/// A node may lie opposite the inside of a face if it is no more than this many of its shortest edges away.
pub(crate) const FAR: f64 = 4.0;

/// Why two sides have no interface: the end of a sentence.
pub(crate) enum Mismatch {
    /// They do not face each other.
    Apart(String),
    /// A node of one of them lies opposite the inside of a face of the other.
    Lonely,
}

/// Two bodies, a side of each, and the bits of the reach.
type MatchKey = ([usize; 2], [usize; 2], u64);

/// The search for nodes that face each other. It keeps the surfaces that it builds and the interfaces that it finds: a
/// body has several neighbours, and who finds contacts asks for the same pair as who makes interfaces of them.
pub(crate) struct NodeMatching<'a> {
    bodies: &'a [Body],
    surfaces: HashMap<(usize, usize), Rc<Surface>>,
    found: HashMap<MatchKey, BodyInterface>,
    mortar: HashMap<(MatchKey, usize), Option<BodyInterface>>,
}

impl<'a> NodeMatching<'a> {
    pub fn new(bodies: &'a [Body]) -> NodeMatching<'a> {
        NodeMatching {
            bodies,
            surfaces: HashMap::new(),
            found: HashMap::new(),
            mortar: HashMap::new(),
        }
    }

    /// A side of a body.
    pub fn surface(&mut self, body: usize, side: usize) -> Rc<Surface> {
        let build = || Rc::new(Surface::new(&self.bodies[body].spec, side));
        self.surfaces
            .entry((body, side))
            .or_insert_with(build)
            .clone()
    }

    /// The interface of two sides, of which one at least belongs to a mesh of cells, where they are at most `reach`
    /// apart. Nodes beyond the edge of the other side have no partner.
    pub fn find(
        &mut self,
        pair: [usize; 2],
        sides: [usize; 2],
        reach: f64,
    ) -> Result<&BodyInterface, Mismatch> {
        let key = (pair, sides, reach.to_bits());
        if !self.found.contains_key(&key) {
            let surfaces = [0, 1].map(|k| self.surface(pair[k], sides[k]));
            let interface = join(
                self.bodies,
                pair,
                sides,
                [&surfaces[0], &surfaces[1]],
                reach,
            )?;
            self.found.insert(key, interface);
        }
        Ok(&self.found[&key])
    }

    /// The interface of two sides whose nodes do not match, of which number `which` carries the multipliers; `None` if
    /// they do not face each other.
    pub fn mortar(
        &mut self,
        form: &Form,
        (pair, sides): ([usize; 2], [usize; 2]),
        which: usize,
        reach: f64,
    ) -> &mut Option<BodyInterface> {
        let key = ((pair, sides, reach.to_bits()), which);
        let find = || interface_of_mortar(self.bodies, form, pair, sides, which, reach);
        self.mortar.entry(key).or_insert_with(find)
    }
}

/// How far from the box of a surface nodes of another one may be that have something opposite on it.
fn slack(surface: &Surface, other: &Surface, reach: f64) -> f64 {
    // Nodes have partners a little beside their normals, and faces count as a little larger than they are.
    let edge = other.edges.iter().copied().fold(0.0, f64::max);
    reach + MATCH * edge + 0.1 * extent(surface)
}

fn join(
    bodies: &[Body],
    pair: [usize; 2],
    sides: [usize; 2],
    [a, b]: [&Surface; 2],
    reach: f64,
) -> Result<BodyInterface, Mismatch> {
    let specs = pair.map(|k| &bodies[k].spec);
    // Far apart the nearest nodes say nothing about the faces opposite.
    let near = |surface: &Surface, i: usize| reach.min(FAR * surface.edges[i]);
    let slacks = [slack(a, b, reach), slack(b, a, reach)];
    let may_meet_a = |x: [f64; 3]| !are_disjoint(&[x, x], &a.bounds, slacks[0]);
    let may_meet_b = |x: [f64; 3]| !are_disjoint(&[x, x], &b.bounds, slacks[1]);
    // Two sides of one body may have common nodes, as at the tip of a crack: these have nothing opposite.
    let common =
        |node: &usize, of: &Surface| pair[0] == pair[1] && of.nodes.binary_search(node).is_ok();
    let mut pairs = Vec::new();
    let mut lonely = false;
    for (i, &node) in a.nodes.iter().enumerate() {
        if !may_meet_b(a.points[i]) || common(&node, b) {
            continue;
        }
        let (point, normals) = (a.points[i], &a.normals[i]);
        match b.opposite(point, normals, MATCH * a.edges[i], reach) {
            Some(other) if common(&b.nodes[other], a) => {}
            Some(other) => pairs.push([node, b.nodes[other]]),
            None if b.covers(point, normals, near(a, i), 2.0 * MATCH) => {
                lonely = true;
            }
            None => {}
        }
    }
    let mut taken = HashSet::new();
    lonely |= pairs.iter().any(|p| !taken.insert(p[1]));
    for (j, &node) in b.nodes.iter().enumerate() {
        let normals = &b.normals[j];
        if !may_meet_a(b.points[j]) || common(&node, a) {
            continue;
        }
        if !taken.contains(&node) && a.covers(b.points[j], normals, near(b, j), 2.0 * MATCH) {
            lonely = true;
        }
    }
    if lonely {
        Err(Mismatch::Lonely)
    } else if pairs.is_empty() {
        Err(Mismatch::Apart(apart(bodies, pair, sides)))
    } else {
        let shared = share(specs[0], sides[0], pairs);
        Ok(interface(bodies, pair, sides, InterfaceShape::Face, shared))
    }
}

/// The end of a sentence on sides that do not face each other.
pub(crate) fn apart(bodies: &[Body], pair: [usize; 2], sides: [usize; 2]) -> String {
    let [a, b] = pair.map(|k| &bodies[k].spec);
    format!(
        "side `{}` of `{}` and side `{}` of `{}` do not face each other: no node of one lies opposite the other, \
         with the opposite normal",
        a.mesh.side_name(sides[0]),
        a.name,
        b.mesh.side_name(sides[1]),
        b.name
    )
}
