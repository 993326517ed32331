//! Pairs of surfaces that mortar rows join, and what the host gives for them.

use std::collections::BTreeMap;

use super::laws::ContactLaw;
use super::surface::HostSurface;
use crate::substructures::{Law, SentLaw};
use crate::Result;
use base::Fault;
use bytemuck::{bytes_of, Pod, Zeroable};
use elements::mortar::{self, reach, MortarSample, MortarSide};
use parallel::exchange::gather_all;
use parallel::parcels::Parcels;
use petsc::{PetscInt, Session};

/// The data that one rank gives for a pair of surfaces.
pub struct GivenMortar<'a> {
    /// Numbers of the surfaces; the first one carries the multipliers.
    pub surfaces: [PetscInt; 2],
    pub law: Law,
    /// How far apart they may be; 0 or less: a few edges.
    pub reach: f64,
    /// Distances up to this one count as none.
    pub adjust: f64,
    /// A clearance everywhere.
    pub gap: f64,
    /// More of it at the nodes that this rank gave of the first surface; or empty.
    pub gaps: &'a [f64],
    /// Which of these nodes are to carry no multiplier; or empty.
    pub without: &'a [PetscInt],
}

/// A pair of surfaces, on all ranks.
pub struct HostMortar {
    pub surfaces: [usize; 2],
    pub law: Law,
    pub adjust: f64,
    /// The clearance at each node of the first surface.
    pub gaps: Vec<f64>,
    /// Whether a node of the first surface must not carry a multiplier.
    pub without: Vec<bool>,
    pub samples: Vec<MortarSample>,
    /// The law of contact, by unit area.
    pub contact: ContactLaw,
    /// Where the sides stand without a slip, at each node of the first surface.
    pub slipped: Vec<[f64; 3]>,
}

/// The surfaces that have been added, on a rank.
pub struct HostSurfaces<'a> {
    pub session: &'a Session,
    pub list: &'a [HostSurface],
}

impl HostSurfaces<'_> {
    /// One of them.
    ///
    /// # Errors
    /// A number that there is not.
    fn surface(&self, number: PetscInt) -> Result<&HostSurface> {
        let found = usize::try_from(number).ok().and_then(|k| self.list.get(k));
        found.ok_or_else(|| {
            Fault::OutOfRange.error(format!(
                "a mortar names surface {number} but {} have been added so far, expected one of these (from 0)",
                self.list.len()
            ))
        })
    }

    /// The mortar of two surfaces. Collective.
    ///
    /// # Errors
    /// Surfaces that do not face each other, and numbers that are not admissible; the same on all ranks.
    pub fn mortar(&self, given: &GivenMortar<'_>) -> Result<HostMortar> {
        self.session.agree(self.check(given))?;
        let all = self.sent(given).gather_all(self.session.comm());
        let facts = |k: usize| all[k].get(0).0;
        if (0..all.len()).any(|k| bytes_of(&facts(k)) != bytes_of(&facts(0))) {
            return Err(Fault::Wrong.error(
                "ranks give a mortar different surfaces, kinds, reaches, values of adjust or gaps, \
                 expected the same (gaps by node go into the array)",
            ));
        }
        let pair = given.surfaces.map(|k| k as usize);
        let [first, second] = pair.map(|k| &self.list[k]);
        let n = first.dofs.len();
        let mut at: BTreeMap<usize, (f64, bool)> = BTreeMap::new();
        for node in all.iter().flat_map(|given| given.get(0).1) {
            let new = (node.gap, node.without != 0);
            let known = *at.entry(node.node as usize).or_insert(new);
            if known != new {
                let x = first.side.points()[node.node as usize];
                return Err(Fault::Wrong.error(format!(
                    "ranks give the node at {:?} of surface {} different gaps, or only one of them leaves it \
                     without a multiplier, expected the same",
                    &x[..first.side.dim()],
                    pair[0]
                )));
            }
        }
        let of = |k: usize| at.get(&k).copied().unwrap_or_default();
        Ok(HostMortar {
            surfaces: pair,
            law: given.law,
            adjust: given.adjust.max(0.0),
            gaps: (0..n).map(|k| given.gap + of(k).0).collect(),
            without: (0..n).map(|k| of(k).1).collect(),
            contact: ContactLaw::default(),
            slipped: vec![[0.0; 3]; n],
            samples: samples(pair, &first.side, &second.side, given.reach)?,
        })
    }

    fn check(&self, given: &GivenMortar<'_>) -> Result<()> {
        let [a, b] = given.surfaces;
        let (first, second) = (self.surface(a)?, self.surface(b)?);
        if a == b {
            return Err(Fault::Wrong.error(format!(
                "a mortar joins surface {a} with itself, expected two surfaces"
            )));
        }
        let facts = [first, second].map(|s| (s.side.dim(), s.components));
        if facts[0] != facts[1] {
            return Err(Fault::Wrong.error(format!(
                "surface {a} is of dimension {} with {} unknowns in a node and surface {b} of dimension {} with {}, \
                 expected the same",
                facts[0].0, facts[0].1, facts[1].0, facts[1].1
            )));
        }
        let finite = [given.gap, given.adjust]
            .into_iter()
            .chain(given.gaps.iter().copied());
        let finite = finite.clone().all(f64::is_finite) && !given.reach.is_nan();
        if !finite {
            return Err(Fault::Wrong.error(format!(
                "a mortar of surfaces {a} and {b} has a gap, reach or adjust that is not finite, \
                 expected finite numbers"
            )));
        }
        let clear = given.gap != 0.0 || given.gaps.iter().any(|g| *g != 0.0);
        if !given.law.is_inequality() && first.components > 1 && clear {
            return Err(Fault::Wrong.error(format!(
                "the tie of surfaces {a} and {b} has a gap, expected none where a node has several unknowns"
            )));
        }
        Ok(())
    }

    /// The data of a mortar that must be the same on all ranks, with this rank's nodes.
    fn sent(&self, given: &GivenMortar<'_>) -> Parcels<MortarFacts, MortarNode> {
        let facts = MortarFacts {
            surfaces: given.surfaces,
            law: given.law.sent(),
            reach: given.reach,
            adjust: given.adjust,
            gap: given.gap,
        };
        let nodes = &self.list[given.surfaces[0] as usize].mine;
        let nodes = nodes.iter().enumerate().filter_map(|(i, node)| {
            Some(MortarNode {
                node: (*node)?,
                without: given.without.get(i).is_some_and(|&w| w != 0).into(),
                // 0 and -0 are one gap.
                gap: given.gaps.get(i).copied().unwrap_or_default() + 0.0,
            })
        });
        let mut out = Parcels::default();
        out.push(facts, nodes);
        out
    }
}

/// Where the sides stand without a slip at a node of the first surface, as a rank says it.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Pod, Zeroable)]
struct SlippedNode {
    node: u64,
    slip: [f64; 3],
}

/// Where the sides stand without a slip at each node of `surface`, by what ranks say of the nodes that they gave; zero
/// where nobody says anything. Collective.
///
/// # Errors
/// Ranks that say different things of a node.
pub fn slips(
    session: &Session,
    (number, surface): (usize, &HostSurface),
    given: &[f64],
) -> Result<Vec<[f64; 3]>> {
    let components = surface.components;
    let nodes = surface.mine.iter().zip(given.chunks(components));
    let sent = nodes.filter_map(|(node, along)| {
        // 0 and -0 are one slip.
        let slip = std::array::from_fn(|c| along.get(c).copied().unwrap_or(0.0) + 0.0);
        let node = u64::from((*node)?);
        Some(SlippedNode { node, slip })
    });
    let all = gather_all(session.comm(), &sent.collect::<Vec<_>>()).concat();
    let mut at: BTreeMap<u64, [f64; 3]> = BTreeMap::new();
    for SlippedNode { node, slip } in all {
        if *at.entry(node).or_insert(slip) != slip {
            let x = surface.side.points()[node as usize];
            return Err(Fault::Wrong.error(format!(
                "ranks give the node at {:?} of surface {number} different slips, expected the same",
                &x[..surface.side.dim()]
            )));
        }
    }
    let nodes = 0..surface.dofs.len() as u64;
    Ok(nodes
        .map(|k| at.get(&k).copied().unwrap_or_default())
        .collect())
}

/// The data of a mortar that must be the same on all ranks.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct MortarFacts {
    surfaces: [PetscInt; 2],
    law: SentLaw,
    reach: f64,
    adjust: f64,
    gap: f64,
}

/// The data that a rank gives for a node of the first surface.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct MortarNode {
    node: u32,
    without: u32,
    gap: f64,
}

/// The points of quadrature.
///
/// # Errors
/// Sides that do not face each other; if they would with the faces of one of them the other way round, it is said.
fn samples(
    numbers: [usize; 2],
    first: &MortarSide,
    second: &MortarSide,
    wanted: f64,
) -> Result<Vec<MortarSample>> {
    let reach = if wanted > 0.0 {
        reach(first, second, wanted)
    } else {
        reach(first, second, f64::INFINITY)
    };
    let found = mortar::samples(first, second, reach);
    if !found.is_empty() {
        return Ok(found);
    }
    let [a, b] = numbers;
    let back = first.reversed();
    let tries = [
        (second, "one of them"),
        (&second.reversed(), "both of them"),
    ];
    let why = tries
        .iter()
        .find(|(other, _)| !mortar::samples(&back, other, reach).is_empty())
        .map(|(_, which)| format!("they would if {which} went around the other way"));
    let why = why.unwrap_or_else(|| {
        "expected sides with normals towards each other, within reach along the normals of the first".into()
    });
    Err(Fault::Wrong.error(format!(
        "the faces of surface {a} and surface {b} do not face each other within {reach:.6}: {why}"
    )))
}
