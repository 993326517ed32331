//! Parts that entries with names of surfaces leave out: nodes beyond the tolerance of a tie, faces without a partner.

use std::collections::{HashMap, HashSet};

use super::origin::SideOrigin;
use crate::body::Body;
use crate::geometry::interface::BodyInterface;
use crate::model::entry::EntryId;
use fetifeti::problem::BodyNode;

/// Entries that have a sentence of their own.
const LIST: usize = 8;

/// Sentences on what entries leave out.
#[derive(Debug, Default)]
pub(crate) struct LeftOut {
    /// On nodes beyond a tolerance.
    pub notes: Vec<String>,
    /// On faces without a partner, and on gaps that count as none: many scenes have some.
    pub asides: Vec<String>,
}

/// A sentence for each entry that leaves something out. `far` has, by ties, the nodes that lie opposite the
/// other side but farther than the tolerance.
pub(super) fn sentences(
    bodies: &[Body],
    origins: &[SideOrigin],
    interfaces: &[BodyInterface],
    far: &[(EntryId, Vec<BodyNode>)],
) -> LeftOut {
    let mut out = LeftOut::default();
    if origins.is_empty() {
        return out;
    }
    let mut of_entry: HashMap<EntryId, Vec<&BodyInterface>> = HashMap::new();
    for interface in interfaces {
        let Some(entry) = interface.entry else {
            continue;
        };
        of_entry.entry(entry).or_default().push(interface);
    }
    let of_origin = |origin: &SideOrigin| -> Vec<&BodyInterface> {
        let own = origin
            .ids()
            .flat_map(|entry| of_entry.get(&entry).into_iter().flatten());
        own.copied().collect()
    };
    for origin in origins {
        let own = of_origin(origin);
        match origin.tolerance {
            Some(tolerance) => out
                .notes
                .extend(nodes(bodies, origin, &own, far, tolerance)),
            None => out.asides.extend(faces(bodies, origin, &own)),
        }
        out.asides.extend(touching(origin, &own));
    }
    for list in [&mut out.notes, &mut out.asides] {
        if list.len() > LIST {
            let more = list.split_off(LIST).len();
            list.push(format!(
                "{more} more entries of ties and contacts leave out nodes or faces of their surfaces."
            ));
        }
    }
    out
}

/// The sentence on a tie with a tolerance: how many nodes it does not hold.
fn nodes(
    bodies: &[Body],
    origin: &SideOrigin,
    interfaces: &[&BodyInterface],
    far: &[(EntryId, Vec<BodyNode>)],
    tolerance: f64,
) -> Option<String> {
    let mut held: HashSet<BodyNode> = HashSet::new();
    for interface in interfaces {
        for body in interface.bodies {
            // Nodes of the other side do no harm: they are not asked for.
            let k = usize::from(interface.bodies[0] != body);
            let nodes = interface.shared.iter().map(|s| s.nodes[k]);
            held.extend(nodes.map(|node| BodyNode { body, node }));
        }
    }
    let all = origin.lists[origin.which].iter();
    let all = all.flat_map(|&(body, side)| {
        let nodes = bodies[body].mesh().side_nodes(side).into_iter();
        nodes.map(move |node| BodyNode { body, node })
    });
    let all: HashSet<BodyNode> = all.collect();
    let left: HashSet<&BodyNode> = all.difference(&held).collect();
    if left.is_empty() {
        return None;
    }
    let mine = |(entry, _): &&(EntryId, Vec<BodyNode>)| origin.ids().any(|id| id == *entry);
    let far: HashSet<&BodyNode> = far.iter().filter(mine).flat_map(|f| &f.1).collect();
    let far = left.iter().filter(|node| far.contains(*node)).count();
    let (own, other) = (&origin.names[origin.which], &origin.names[1 - origin.which]);
    let mut why = Vec::new();
    if far > 0 {
        why.push(format!(
            "{} farther than the position tolerance {tolerance} from `{other}`",
            are(far)
        ));
    }
    if left.len() > far {
        let beside = left.len() - far;
        why.push(format!("{} opposite no face of `{other}`", lie(beside)));
    }
    Some(format!(
        "{}the tie of `{own}` and `{other}` leaves out {} of {} nodes of `{own}`: {}",
        origin.location,
        left.len(),
        all.len(),
        why.join(", ")
    ))
}

fn are(n: usize) -> String {
    match n {
        1 => "1 is".into(),
        n => format!("{n} are"),
    }
}

fn lie(n: usize) -> String {
    match n {
        1 => "1 lies".into(),
        n => format!("{n} lie"),
    }
}

/// The sentence on the nodes of a contact that count as touching though they do not.
fn touching(origin: &SideOrigin, interfaces: &[&BodyInterface]) -> Option<String> {
    let ways = interfaces.iter();
    let ways = ways.flat_map(|i| i.adjusted.values().map(|way| way.abs()));
    let ways = ways.filter(|way| *way > 0.0);
    let (moved, longest) = ways.fold((0, 0.0_f64), |(n, most), way| (n + 1, most.max(way)));
    let nodes = if moved == 1 { "node" } else { "nodes" };
    (moved > 0 && origin.is_contact && !origin.replaces_gap).then(|| {
        format!(
            "{}the contact of `{}` and `{}` takes {moved} {nodes} as touching that are up to {longest:.3e} apart or \
             overlap as much; coordinates stay as they are",
            origin.location, origin.names[0], origin.names[1]
        )
    })
}

/// The sentence on a contact, or on a tie without a tolerance: how many faces have no partner.
fn faces(bodies: &[Body], origin: &SideOrigin, interfaces: &[&BodyInterface]) -> Option<String> {
    let mut facing: HashMap<(usize, usize), HashSet<usize>> = HashMap::new();
    for interface in interfaces {
        let mut touched = match interface.mortar.as_ref() {
            Some(mortar) => {
                let mut both = mortar.surfaces.as_deref()?.facing();
                if mortar.multipliers == 1 {
                    both.reverse();
                }
                both
            }
            None => [0, 1].map(|k| interface.shared.iter().map(|s| s.nodes[k]).collect()),
        };
        for k in [0, 1] {
            let at = (interface.bodies[k], interface.sides[k]);
            let nodes = facing.entry(at).or_default();
            nodes.extend(std::mem::take(&mut touched[k]));
        }
    }
    let nothing = HashSet::new();
    let count = |list: &[(usize, usize)]| {
        let (mut lonely, mut all) = (0, 0);
        for at in list {
            let nodes = facing.get(at).unwrap_or(&nothing);
            for face in bodies[at.0].spec.faces(at.1) {
                all += 1;
                lonely += usize::from(!face.nodes.iter().all(|n| nodes.contains(n)));
            }
        }
        (lonely, all)
    };
    let same = origin.names[0] == origin.names[1];
    let mut parts = Vec::new();
    for k in 0..2 - usize::from(same) {
        let (lonely, all) = count(&origin.lists[k]);
        if lonely > 0 {
            parts.push(format!("{lonely} of {all} faces of `{}`", origin.names[k]));
        }
    }
    if parts.is_empty() {
        return None;
    }
    let what = if origin.is_contact { "contact" } else { "tie" };
    let within = origin.reach.map_or(String::new(), |reach| {
        format!(" within `distance` = {reach}")
    });
    Some(format!(
        "{}the {what} of `{}` and `{}` leaves out {}: they lie opposite nothing of the other side{within}",
        origin.location,
        origin.names[0],
        origin.names[1],
        parts.join(" and ")
    ))
}
