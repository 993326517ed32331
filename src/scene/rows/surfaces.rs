//! Entries that name surfaces, and contacts that are found: both become entries that name bodies and their sides.

use crate::error::{Error, Result};
use crate::scene::body::Body;
use crate::scene::geometry::matching::{matching, Mismatch};
use crate::scene::geometry::surface::Surface;
use crate::scene::model::profile::Profile;
use crate::scene::model::spec::{AutoContact, ContactSpec, Extent, Pair, SceneSpec, TieSpec};

/// Where nothing is said, sides of bodies are in contact if their distance is at most this fraction of their edges.
const NEAR: f64 = 0.1;

/// Replaces the surfaces in the entries by bodies and sides, and adds the contacts that `auto` finds.
pub(crate) fn expand(bodies: &[Body], spec: &mut SceneSpec) -> Result<()> {
    let mut ties = Vec::with_capacity(spec.ties.len());
    for tie in std::mem::take(&mut spec.ties) {
        match &tie.pair {
            Pair::Surfaces(a, b) => {
                let found = pairs(bodies, [a, b], tie.adjust.max(0.0), &tie.written)?;
                ties.extend(found.into_iter().map(|(pair, sides)| TieSpec {
                    pair,
                    sides: Some(sides),
                    ..tie.clone()
                }));
            }
            _ => ties.push(tie),
        }
    }
    spec.ties = ties;
    let mut contacts = Vec::with_capacity(spec.contacts.len());
    for contact in std::mem::take(&mut spec.contacts) {
        match &contact.pair {
            Pair::Surfaces(a, b) => {
                let reach = contact.distance.unwrap_or(f64::INFINITY);
                let found = pairs(bodies, [a, b], reach, &contact.written)?;
                contacts.extend(found.into_iter().map(|(pair, sides)| ContactSpec {
                    pair,
                    sides: Some(sides),
                    ..contact.clone()
                }));
            }
            _ => contacts.push(contact),
        }
    }
    if let Some(auto) = spec.auto.clone() {
        contacts.extend(found(bodies, &auto)?);
    }
    spec.contacts = contacts;
    Ok(())
}

type Found = (Pair, [usize; 2]);

/// The pairs of bodies that have the surfaces, and whose nodes there face each other.
fn pairs(bodies: &[Body], names: [&String; 2], reach: f64, written: &str) -> Result<Vec<Found>> {
    let with = |name: &String| {
        let side = |b: usize| {
            let mesh = bodies[b].mesh();
            mesh.cells()?;
            Some((b, mesh.side_of_name(name)?))
        };
        (0..bodies.len())
            .filter_map(side)
            .collect::<Vec<(usize, usize)>>()
    };
    let lists = names.map(with);
    let same = names[0] == names[1];
    let mut candidates = Vec::new();
    for &(a, side_a) in &lists[0] {
        for &(b, side_b) in &lists[1] {
            if a != b && !(same && b < a) {
                candidates.push(([a, b], [side_a, side_b]));
            }
        }
    }
    let alone = candidates.len() == 1;
    let mut out = Vec::new();
    let mut why = None;
    for (pair, sides) in candidates {
        let named = || {
            Pair::Named(
                bodies[pair[0]].spec.name.clone(),
                bodies[pair[1]].spec.name.clone(),
            )
        };
        let reach = if reach > 0.0 { reach } else { f64::INFINITY };
        match (alone, matching(bodies, pair, sides, reach)) {
            (_, Ok(_)) | (true, Err(_)) => out.push((named(), sides)),
            (_, Err(Mismatch::Lonely(message))) => {
                return Err(Error::Input(format!("{written}{message}")))
            }
            (_, Err(Mismatch::Apart(message))) => why = Some(message),
        }
    }
    if out.is_empty() {
        let why = why.unwrap_or_else(|| "no two bodies have them".into());
        return Err(Error::Input(format!(
            "{written}the surfaces `{}` and `{}` do not meet: {why}",
            names[0], names[1]
        )));
    }
    Ok(out)
}

/// Contacts between all bodies whose skins are near each other.
fn found(bodies: &[Body], auto: &AutoContact) -> Result<Vec<ContactSpec>> {
    let mut out = Vec::new();
    for a in 0..bodies.len() {
        for b in a + 1..bodies.len() {
            if bodies[a].mesh().cells().is_none() || bodies[b].mesh().cells().is_none() {
                continue;
            }
            let reach = auto
                .distance
                .unwrap_or_else(|| default_reach(&bodies[a]).min(default_reach(&bodies[b])));
            let apart = (0..3).any(|d| {
                let [x, y] = [&bodies[a].bounds, &bodies[b].bounds];
                x[0][d] > y[1][d] + reach || y[0][d] > x[1][d] + reach
            });
            if apart {
                continue;
            }
            let sides = [a, b].map(|k| bodies[k].mesh().outer_sides().start);
            let names = [a, b].map(|k| bodies[k].spec.name.clone());
            match matching(bodies, [a, b], sides, reach) {
                Err(Mismatch::Apart(_)) => {}
                Err(Mismatch::Lonely(message)) => {
                    return Err(Error::Input(format!("{}{message}", auto.written)))
                }
                Ok(_) => {
                    let [first, second] = names;
                    out.push(ContactSpec {
                        pair: Pair::Named(first, second),
                        sides: Some(sides),
                        extent: Extent::All,
                        gap: Profile::constant(0.0),
                        distance: Some(reach),
                        adjust: auto.adjust,
                        ramp: None,
                        written: auto.written.clone(),
                    });
                }
            }
        }
    }
    match out.is_empty() {
        true => Err(Error::Input(format!(
            "{}no two bodies are near each other with opposite normals (a larger `distance` was expected)",
            auto.written
        ))),
        false => Ok(out),
    }
}

fn default_reach(body: &Body) -> f64 {
    let side = body.mesh().outer_sides().start;
    let surface = Surface::new(&body.spec, side);
    NEAR * surface.edges.iter().copied().fold(f64::INFINITY, f64::min)
}
