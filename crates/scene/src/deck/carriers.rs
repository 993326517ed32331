//! Which side of a contact pair of a deck carries the multipliers.
//!
//! A deck names the slave first. Where the slave has the finer mesh its nodes feel every face of the master, and
//! pressures oscillate from face to face (docs/benchmarks.md). The master then carries the multipliers, as the coarser
//! side does where contacts are found. Displacements and forces of bodies hardly feel the choice.

use crate::geometry::nearest::Nearest;
use base::linalg::vec3::{minus, norm};
use deck::{ContactPair, Deck, Overclosure};
use mesh::Members;
use std::collections::{BTreeMap, BTreeSet};

/// Up to this ratio of the distances of nodes the slave stays what it is, beside masters of first and of second order.
/// In space faces of second order never exchange: their pressures scatter less than the coarser side errs.
const FINER: [[f64; 2]; 2] = [[1.75, 2.5], [1.75, f64::INFINITY]];

/// Up to this ratio the coarser side was measured to be the better one.
const COARSEST: f64 = 8.0;

/// The coarser side has to have this many nodes opposite the other one, along each direction: fewer resolve nothing.
const ENOUGH: usize = 8;

/// Nodes have something opposite if it is no more than this many distances of nodes away.
const FAR: f64 = 4.0;

/// For each contact pair the ratio by which the slave is finer, where the master is to carry the multipliers.
pub(super) fn exchanged(deck: &Deck) -> Vec<Option<f64>> {
    deck.contacts.iter().map(|pair| finer(deck, pair)).collect()
}

/// A sentence for each pair of which the master carries the multipliers.
pub(super) fn notes(deck: &Deck, exchanged: &[Option<f64>]) -> Vec<String> {
    let pairs = deck.contacts.iter().zip(exchanged);
    let note = |(pair, ratio): (&ContactPair, &Option<f64>)| {
        let (slave, master) = (&pair.slave.name, &pair.master.name);
        Some(format!(
            "{}: *CONTACT PAIR: the slave surface {slave} is finer than {master} by a factor of {:.1}: {master} \
             carries the multipliers, since pressures on the finer side oscillate from face to face of the coarser one",
            deck.files.at(pair.place),
            (*ratio)?
        ))
    };
    pairs.filter_map(note).collect()
}

fn finer(deck: &Deck, pair: &ContactPair) -> Option<f64> {
    let interaction = &deck.interactions[pair.interaction as usize];
    let ties = matches!(interaction.overclosure, Overclosure::Tied { .. });
    // Nodes that are moved onto the master are nodes of the slave.
    let moved = matches!(pair.adjust, deck::Adjust::Nodes(_));
    if ties || moved || pair.slave.group == pair.master.group {
        return None;
    }
    let [slave, master] = [&pair.slave, &pair.master].map(|s| spacing(deck, s.group as usize));
    let ((slave, _), (master, second)) = (slave?, master?);
    let at = |k: &u32| deck.mesh.points[*k as usize];
    let nodes: Vec<(u32, f64)> = master.into_iter().collect();
    let nearest = Nearest::new(&nodes.iter().map(|(k, _)| at(k)).collect::<Vec<_>>());
    let mut met = BTreeSet::new();
    let mut ratios: Vec<f64> = Vec::new();
    for (k, own) in &slave {
        let (other, theirs) = nodes[nearest.find(at(k))?];
        if norm(minus(at(k), at(&other))) <= FAR * theirs.max(*own) {
            met.insert(other);
            ratios.push(theirs / own);
        }
    }
    ratios.sort_by(f64::total_cmp);
    let ratio = *ratios.get(ratios.len() / 2)?;
    let enough = met.len() >= ENOUGH.pow(deck.dim() as u32 - 1);
    let least = FINER[deck.dim() - 2][usize::from(second)];
    (enough && ratio > least && ratio <= COARSEST).then_some(ratio)
}

/// The mean distance of nodes on the faces around each node of a surface, and whether some faces are of second order;
/// `None` for a surface that is none of sides.
fn spacing(deck: &Deck, group: usize) -> Option<(BTreeMap<u32, f64>, bool)> {
    let Members::Sides(sides) = &deck.mesh.groups[group].members else {
        return None;
    };
    let mut sums: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
    let mut second = false;
    for &(cell, side) in sides {
        let nodes: Vec<u32> = deck
            .mesh
            .cells
            .side_nodes(cell as usize, side.into())
            .collect();
        let at = |k: &u32| deck.mesh.points[*k as usize];
        let from = |a: &u32| {
            nodes
                .iter()
                .map(|b| norm(minus(at(a), at(b))))
                .fold(0.0, f64::max)
        };
        let size = nodes.iter().map(from).fold(0.0, f64::max);
        // Lines of 3 nodes, triangles of 6, quadrilaterals of 8 or 9 have nodes in the middle of edges.
        let halves = match deck.dim() {
            2 => nodes.len() > 2,
            _ => nodes.len() > 4,
        };
        second |= halves;
        for node in nodes {
            let sum = sums.entry(node).or_default();
            sum.0 += if halves { 0.5 * size } else { size };
            sum.1 += 1.0;
        }
    }
    let mean = |(node, (sum, n)): (u32, (f64, f64))| (node, sum / n);
    Some((sums.into_iter().map(mean).collect(), second))
}
