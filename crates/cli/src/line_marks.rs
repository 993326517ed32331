//! Contact along the lines where plane bodies may touch, for `solution.png`: zones, and tractions with friction.

use std::collections::HashMap;

use super::contact::{by_source, side, with_inequalities};
use super::friction::{self, FrictionRows};
use fetifeti::solution::SolvedRow;
use mesh::Mesh as BodyMesh;
use report::pictures::field::{Arrow, ContactMark, Touch};
use scene::Scene;

/// The segments between neighbouring nodes that may touch, and whether and how they do. `at` is the place of the
/// node of one of the two sides of a row.
pub(super) fn marks(
    scene: &Scene,
    rows: &[SolvedRow],
    friction: &FrictionRows,
    at: &dyn Fn(&SolvedRow, usize) -> [f64; 2],
) -> Vec<ContactMark> {
    let mut out = Vec::new();
    for all in by_source(rows) {
        let states = friction::along(all, friction);
        // Zones of friction lie where its arrows begin: at the nodes with multipliers.
        let member = match states.is_empty() {
            true => 0,
            false => scene.carrier(all[0].label.source),
        };
        let at = |row: &SolvedRow| at(row, member);
        let states = { all.iter().enumerate() }.map(|(k, row)| {
            let state = states.get(k).map(|f| f.state);
            (row, Touch::of_state(state, row.holds()))
        });
        let rows: Vec<(&SolvedRow, Touch)> =
            states.filter(|(row, _)| row.is_inequality()).collect();
        if let [(only, touch)] = rows[..] {
            out.push(ContactMark {
                from: at(only),
                to: at(only),
                touch,
            });
        }
        let mut mark = |(a, of_a): (&SolvedRow, Touch), (b, of_b): (&SolvedRow, Touch)| {
            let (from, to) = (at(a), at(b));
            let mut push = |from, to, touch| out.push(ContactMark { from, to, touch });
            if of_a == of_b {
                push(from, to, of_a);
            } else if of_a == Touch::Open || of_b == Touch::Open {
                push(from, to, Touch::Open);
            } else {
                // Zones end half-way between nodes, as those of the profiles do.
                let middle = [0, 1].map(|c| 0.5 * (from[c] + to[c]));
                push(from, middle, of_a);
                push(middle, to, of_b);
            }
        };
        let side = side(scene, all).map(|(body, side)| (&scene.bodies[body].spec, side));
        match side.filter(|(spec, _)| matches!(spec.mesh, BodyMesh::Cells(_))) {
            // Along the side of a box nodes follow each other; elsewhere its cells say which are neighbours.
            None => rows.windows(2).for_each(|pair| mark(pair[0], pair[1])),
            Some((spec, side)) => {
                let node = |row: &SolvedRow| Some(row.label.members[member]?.node);
                let of_node = rows.iter().filter_map(|r| Some((node(r.0)?, *r)));
                let of_node: HashMap<usize, (&SolvedRow, Touch)> = of_node.collect();
                for face in spec.faces(side) {
                    let rows = face.nodes.iter().map(|node| of_node.get(node).copied());
                    match rows.collect::<Option<Vec<_>>>().as_deref() {
                        Some(&[a, b]) => mark(a, b),
                        Some(&[a, b, middle]) => {
                            mark(a, middle);
                            mark(middle, b);
                        }
                        _ => {}
                    }
                }
            }
        }
    }
    out
}

/// The stresses on the first body at the nodes with friction that touch: the pressure and the shear stress together.
pub(super) fn tractions(
    scene: &Scene,
    rows: &[SolvedRow],
    friction: &FrictionRows,
    at: &dyn Fn(&SolvedRow, usize) -> [f64; 2],
) -> Vec<Arrow> {
    let mut out = Vec::new();
    for (rows, smoothed) in with_inequalities(scene, rows) {
        let friction = friction::along(rows, friction);
        for (k, (row, friction)) in rows.iter().zip(friction).enumerate() {
            let pressure = smoothed.get(k).copied().or(row.pressure());
            if let Some(pressure) = pressure.filter(|_| row.is_inequality() && row.holds()) {
                let normal = row.normal();
                out.push(Arrow {
                    at: at(row, scene.carrier(row.label.source)),
                    stress: [0, 1].map(|c| friction.shear[c] - pressure * normal[c]),
                });
            }
        }
    }
    out
}
