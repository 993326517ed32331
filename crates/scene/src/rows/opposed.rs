//! The interfaces of pairs of nodes that an entry of [[contact]] names, as gap elements of decks do.

use crate::body::Body;
use crate::geometry::interface::{BodyInterface, InterfaceShape, Link, SharedNode};
use crate::model::entry::EntryId;
use crate::model::joints::PairSelector;
use crate::model::profile::Limits;
use crate::model::spec::SceneSpec;

/// Adds the interface of each entry that names nodes. Other interfaces of its bodies stay.
pub(super) fn add(bodies: &[Body], spec: &SceneSpec, interfaces: &mut Vec<BodyInterface>) {
    let before = interfaces.len();
    for (k, contact) in spec.contacts.iter().enumerate() {
        let (Some(opposed), PairSelector::Named(first, second)) = (&contact.opposed, &contact.pair)
        else {
            continue;
        };
        let find = |name: &String| bodies.iter().position(|b| b.spec.name == *name);
        let (Some(a), Some(b)) = (find(first), find(second)) else {
            // The check of entries that name bodies reports this error.
            continue;
        };
        let turned = a > b;
        let shared = |nodes: &[usize; 2]| SharedNode {
            nodes: if turned { [nodes[1], nodes[0]] } else { *nodes },
            t: [0.0; 2],
            link: Link::Free,
        };
        let normal = opposed.normal.map(|n| if turned { 0.0 - n } else { n });
        let n = opposed.pairs.len();
        interfaces.push(BodyInterface {
            bodies: [a.min(b), a.max(b)],
            shape: InterfaceShape::Corner,
            sides: [0; 2],
            shared: opposed.pairs.iter().map(shared).collect(),
            unmatched: Vec::new(),
            order: [0, 1],
            normals: vec![normal; n],
            entry: Some(EntryId::Contact(k)),
            // Their clearance is the gap of the entry, wherever they lie.
            distances: vec![0.0; n],
            adjusted: Default::default(),
            limits: Limits::default(),
            area: Some(opposed.area),
            mortar: None,
        });
    }
    if interfaces.len() > before {
        interfaces.sort_by_key(|i| i.bodies);
    }
}
