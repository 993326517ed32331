//! The entries of [[tie]] and [[contact]] that name sides, as they were written: for sentences on what they leave out.

use std::collections::HashMap;
use std::ops::Range;

use crate::body::Body;
use crate::model::entry::EntryId;
use crate::model::joints::{ContactSpec, Extent, PairSelector, TieSpec};
use base::Location;

/// An entry that names sides.
pub(crate) struct SideOrigin {
    /// The names in the entry: of two surfaces, or of sides of bodies.
    pub names: [String; 2],
    /// Where it was written, if it was.
    pub location: Location,
    /// The bodies that have each of the two, with their sides.
    pub lists: [Vec<(usize, usize)>; 2],
    /// Which of the two carries the multipliers.
    pub which: usize,
    /// How far apart the sides may be, if it says so.
    pub reach: Option<f64>,
    /// Of a tie, how far its nodes may be.
    pub tolerance: Option<f64>,
    pub is_contact: bool,
    /// Whether its gap replaces that of the bodies, whatever that is.
    pub replaces_gap: bool,
    /// The numbers of the entries that it has become.
    pub entries: Range<usize>,
}

/// The bodies by their names.
pub(crate) struct BodyNames<'b> {
    bodies: &'b [Body],
    numbers: HashMap<&'b str, usize>,
}

impl<'b> BodyNames<'b> {
    pub fn of(bodies: &'b [Body]) -> BodyNames<'b> {
        let numbers = bodies.iter().enumerate();
        BodyNames {
            numbers: numbers.map(|(k, b)| (b.spec.name.as_str(), k)).collect(),
            bodies,
        }
    }

    /// The names in a pair, and the bodies and sides that have each of them; `None` for a pair without sides.
    fn find(&self, pair: &PairSelector, sides: Option<[usize; 2]>) -> Option<NamedSides> {
        match (pair, sides) {
            (PairSelector::Surfaces(a, b), _) => Some((
                [a.clone(), b.clone()],
                [with(self.bodies, a), with(self.bodies, b)],
            )),
            (PairSelector::Named(a, b), Some(sides)) => {
                let of = |name: &String, side: usize| {
                    let body = *self.numbers.get(name.as_str())?;
                    let own = self.bodies[body].mesh().side_name(side);
                    Some((format!("{name}.{own}"), vec![(body, side)]))
                };
                let (first, second) = (of(a, sides[0])?, of(b, sides[1])?);
                Some(([first.0, second.0], [first.1, second.1]))
            }
            _ => None,
        }
    }
}

/// Two names, and the bodies with the sides that have each.
type NamedSides = ([String; 2], [Vec<(usize, usize)>; 2]);

impl SideOrigin {
    /// The entries that it has become.
    pub fn ids(&self) -> impl Iterator<Item = EntryId> {
        let id = if self.is_contact {
            EntryId::Contact
        } else {
            EntryId::Tie
        };
        self.entries.clone().map(id)
    }

    /// That of a tie which has become some entries.
    pub fn of_tie(
        names: &BodyNames<'_>,
        tie: &TieSpec,
        entries: Range<usize>,
    ) -> Option<SideOrigin> {
        let (both, lists) = names.find(&tie.pair, tie.sides)?;
        let tolerance = match tie.extent {
            Extent::Within { distance, .. } => Some(distance),
            _ => None,
        };
        // Who ties a part of a face leaves out the rest.
        (tolerance.is_some() || tie.extent == Extent::All).then(|| SideOrigin {
            names: both,
            location: tie.location.clone(),
            lists,
            which: tie.multipliers.unwrap_or(0),
            reach: None,
            tolerance,
            is_contact: false,
            replaces_gap: false,
            entries,
        })
    }

    /// That of a contact.
    pub fn of_contact(
        names: &BodyNames<'_>,
        contact: &ContactSpec,
        entries: Range<usize>,
    ) -> Option<SideOrigin> {
        let (both, lists) = names.find(&contact.pair, contact.sides)?;
        let whole = matches!(contact.extent, Extent::All | Extent::Within { .. });
        whole.then(|| SideOrigin {
            names: both,
            location: contact.location.clone(),
            lists,
            which: contact.multipliers.unwrap_or(0),
            reach: contact.distance,
            tolerance: None,
            is_contact: true,
            replaces_gap: contact.adjust.is_infinite(),
            entries,
        })
    }
}

/// The bodies whose meshes have the boundary group `name`, with the side that it is.
pub(super) fn with(bodies: &[Body], name: &str) -> Vec<(usize, usize)> {
    let side = |(b, body): (usize, &Body)| {
        body.mesh().cells()?;
        Some((b, body.mesh().side_of_name(name)?))
    };
    bodies.iter().enumerate().filter_map(side).collect()
}
