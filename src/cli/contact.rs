//! What the report says of contact: rows with their places, forces per interface, the balance of every body.

use std::collections::BTreeMap;

use super::problem;
use crate::contact::Step;
use crate::feti::exchange::{exchange_words, sum_all};
use crate::feti::{FetiFeti, Solution};
use crate::petsc::Session;
use crate::report::contact::{BodyBalance, InterfaceForce, InterfaceKind, OuterStep};
use crate::report::field::ContactMark;
use crate::report::json;
use crate::report::profile::Profile;
use crate::scene::{Member, RowSource, Scene, Shape};
use crate::Result;

/// A row of B_gl with all that is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactRow {
    /// 0: an interface, 1: an obstacle; and its number in the scene.
    source: (u64, usize),
    /// Parameters along the face or side; the second is 0 in the plane.
    t: [f64; 2],
    point: [f64; 3],
    /// λ.
    pub multiplier: f64,
    /// c − B u: how far apart the sides are.
    pub distance: f64,
    /// Whether the row holds.
    pub active: bool,
    /// Whether it may be switched off.
    pub inequality: bool,
    /// (body, node) on either side.
    pub members: [Option<(usize, usize)>; 2],
}

const WORDS: usize = 14;

impl ContactRow {
    fn pack(&self, out: &mut Vec<u64>) {
        let flags = u64::from(self.active) | u64::from(self.inequality) << 1;
        out.extend([self.source.0, self.source.1 as u64, flags]);
        out.extend(self.t.map(f64::to_bits));
        out.extend(self.point.map(f64::to_bits));
        out.extend([self.multiplier, self.distance].map(f64::to_bits));
        for member in self.members {
            let (body, node) = member.unwrap_or((usize::MAX, usize::MAX));
            out.extend([body as u64, node as u64]);
        }
    }

    fn unpack(w: &[u64]) -> ContactRow {
        let number = |k: usize| f64::from_bits(w[k]);
        let member = |k: usize| (w[k] != u64::MAX).then_some((w[k] as usize, w[k + 1] as usize));
        ContactRow {
            source: (w[0], w[1] as usize),
            active: w[2] & 1 == 1,
            inequality: w[2] & 2 == 2,
            t: [3, 4].map(number),
            point: [5, 6, 7].map(number),
            multiplier: number(8),
            distance: number(9),
            members: [member(10), member(12)],
        }
    }
}

/// All rows on rank 0, by interface and t; empty on the others. Collective.
pub fn rows(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    solution: &Solution,
) -> Result<Vec<ContactRow>> {
    let owns = problem::owner(session, scene)?;
    let labels = scene.row_labels(&owns);
    let mut outgoing: Vec<Vec<u64>> = vec![Vec::new(); session.size()];
    let dual = solver.dual();
    let jump = &dual.stiffness.jump;
    for (k, &r) in jump.order.iter().enumerate() {
        let (label, i) = (&labels[r], jump.n_owned_local + k);
        let member = |m: Option<Member>| m.map(|m| (m.body, m.node));
        let row = ContactRow {
            source: match label.source {
                RowSource::Interface(k) => (0, k),
                RowSource::Obstacle(k) => (1, k),
            },
            t: label.t,
            point: label.point,
            multiplier: solution.lambda[i],
            distance: -solution.gaps[i],
            active: solution.active[i],
            inequality: jump.inequality[i],
            members: label.members.map(member),
        };
        row.pack(&mut outgoing[0]);
    }
    let received = exchange_words(session.comm(), outgoing).concat();
    let mut rows: Vec<ContactRow> = received
        .chunks_exact(WORDS)
        .map(ContactRow::unpack)
        .collect();
    let t = |r: &ContactRow| [r.t[1], r.t[0]];
    rows.sort_by(|a, b| {
        let by_t = t(a)[0]
            .total_cmp(&t(b)[0])
            .then(t(a)[1].total_cmp(&t(b)[1]));
        a.source.cmp(&b.source).then(by_t)
    });
    Ok(rows)
}

fn by_source(rows: &[ContactRow]) -> impl Iterator<Item = &[ContactRow]> {
    rows.chunk_by(|a, b| a.source == b.source)
}

fn name(scene: &Scene, (kind, k): (u64, usize)) -> String {
    if kind == 1 {
        return scene.obstacles[k].name.clone();
    }
    let interface = &scene.interfaces[k];
    let [a, b] = interface.order.map(|o| interface.bodies[o]);
    let body = |b: usize| &scene.bodies[b].spec.name;
    format!("{}|{}", body(a), body(b))
}

/// Forces per interface and obstacle.
pub fn forces(scene: &Scene, rows: &[ContactRow]) -> Vec<InterfaceForce> {
    by_source(rows)
        .map(|rows| {
            let some = rows.iter().any(|r| r.inequality);
            let all = rows.iter().all(|r| r.inequality);
            let least =
                |f: fn(&ContactRow) -> f64| rows.iter().map(f).fold(f64::INFINITY, f64::min);
            let most =
                |f: fn(&ContactRow) -> f64| rows.iter().map(f).fold(f64::NEG_INFINITY, f64::max);
            InterfaceForce {
                name: name(scene, rows[0].source),
                kind: match (rows[0].source.0, some, all) {
                    (1, ..) => InterfaceKind::Obstacle,
                    (_, false, _) => InterfaceKind::Tied,
                    (_, _, true) => InterfaceKind::Contact,
                    _ => InterfaceKind::Mixed,
                },
                candidates: rows.len(),
                active: rows.iter().filter(|r| r.active).count(),
                force: rows.iter().map(|r| r.multiplier).sum(),
                largest_gap: most(|r| r.distance),
                smallest_gap: least(|r| r.distance),
                min_multiplier: least(|r| r.multiplier),
                max_multiplier: most(|r| r.multiplier),
            }
        })
        .collect()
}

/// Multiplier and gap along every interface that has inequalities.
pub fn profiles(scene: &Scene, rows: &[ContactRow]) -> Vec<Profile> {
    by_source(rows)
        .filter(|rows| rows.iter().any(|r| r.inequality))
        .map(|rows| {
            let (kind, k) = rows[0].source;
            let along = match kind {
                1 => usize::from(scene.obstacles[k].side < 2),
                _ => match scene.interfaces[k].shape {
                    Shape::Face => usize::from(scene.interfaces[k].sides[0] < 2),
                    Shape::Corner => 0,
                },
            };
            let column = |f: fn(&ContactRow) -> f64| rows.iter().map(f).collect::<Vec<f64>>();
            Profile {
                name: name(scene, rows[0].source),
                label: ["x", "y"][along].into(),
                t: column(|r| r.t[0]),
                points: rows.iter().map(|r| [r.point[0], r.point[1]]).collect(),
                gap: column(|r| r.distance),
                multiplier: column(|r| r.multiplier),
                active: rows.iter().map(|r| r.active).collect(),
            }
        })
        .collect()
}

/// Where bodies may touch and do, from node to node.
pub fn marks(rows: &[ContactRow]) -> Vec<ContactMark> {
    let mut out = Vec::new();
    for rows in by_source(rows) {
        let rows: Vec<&ContactRow> = rows.iter().filter(|r| r.inequality).collect();
        if let [only] = rows[..] {
            out.push(ContactMark {
                from: [only.point[0], only.point[1]],
                to: [only.point[0], only.point[1]],
                closed: only.active,
            });
        }
        out.extend(rows.windows(2).map(|pair| ContactMark {
            from: [pair[0].point[0], pair[0].point[1]],
            to: [pair[1].point[0], pair[1].point[1]],
            closed: pair[0].active && pair[1].active,
        }));
    }
    out
}

/// Loads, forces of contact and reactions of every body. Collective.
pub fn balance(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    solution: &Solution,
    step: usize,
) -> Result<Vec<BodyBalance>> {
    let n = scene.n_bodies();
    // [load, contact, Σ |multiplier|] by body
    let mut sums = vec![0.0; 3 * n];
    for sub in &solver.problem().local {
        sums[sub.body] += scene.resultant(sub.index, step)?[0];
    }
    let dual = solver.dual();
    let jump = &dual.stiffness.jump;
    let body_of = |dof: u64| {
        let after = scene.bodies.partition_point(|b| b.first_dof <= dof);
        after - 1
    };
    for (k, &r) in jump.order.iter().enumerate() {
        let lambda = solution.lambda[jump.n_owned_local + k];
        for &(dof, coefficient) in &solver.problem().rows[r].terms {
            let body = body_of(dof);
            sums[n + body] -= coefficient * lambda;
            sums[2 * n + body] += (coefficient * lambda).abs();
        }
    }
    sum_all(session.comm(), &mut sums);
    let floating = &dual.stiffness.space.defect;
    let out = scene.bodies.iter().enumerate().map(|(b, body)| {
        let (load, contact, size) = (sums[b], sums[n + b], sums[2 * n + b]);
        let rest = load + contact;
        let floats = floating[b] > 0;
        let scale = load.abs().max(size);
        BodyBalance {
            name: body.spec.name.clone(),
            floating: floats,
            load,
            contact,
            reaction: (!floats).then_some(-rest),
            imbalance: if floats && scale > 0.0 {
                rest.abs() / scale
            } else {
                0.0
            },
        }
    });
    Ok(out.collect())
}

/// One outer step as the report has it.
pub fn outer_step(load_step: usize, number: usize, step: &Step) -> OuterStep {
    let spectrum = |s: crate::feti::Spectrum| json::Spectrum::new(s.lambda_min, s.lambda_max);
    OuterStep {
        load_step,
        step: number,
        method: step.method.name().into(),
        active: step.active,
        entered: step.entered,
        left: step.left,
        iterations: step.iterations,
        estimate: step.estimate.map(spectrum),
        exact: step.exact.map(spectrum),
        wrong: step.wrong,
        residual: step.residual,
        tolerance: step.tolerance,
        seconds: step.seconds,
    }
}

/// The methods that made the steps, in order.
pub fn method(steps: &[OuterStep]) -> String {
    let mut seen: BTreeMap<usize, &str> = BTreeMap::new();
    for (k, step) in steps.iter().enumerate() {
        if !seen.values().any(|m| *m == step.method) {
            seen.insert(k, &step.method);
        }
    }
    seen.into_values().collect::<Vec<_>>().join(", then ")
}
