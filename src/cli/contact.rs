//! What the report says of contact: rows with their places, forces per interface, the balance of every body.

use std::collections::BTreeMap;

use super::areas;
use crate::contact::Step;
use crate::feti::{FetiFeti, Solution};
use crate::parallel::exchange::exchange_words;
use crate::petsc::Session;
use crate::report::json;
use crate::report::json::contact::{InterfaceForce, InterfaceKind, OuterStep};
use crate::report::plots::profile::Profile;
use crate::scene::{distribution, Member, RowSource, Scene, Shape};
use crate::Result;

/// A row of B_gl with all that is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactRow {
    /// 0: an interface, 1: an obstacle; and its number in the scene.
    pub(super) source: (u64, usize),
    /// Parameters along the face or side; the second is 0 in the plane.
    pub(super) t: [f64; 2],
    pub(super) point: [f64; 3],
    /// n: along it the row takes differences; the first member presses the second one that way.
    pub direction: [f64; 3],
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
    /// The area of the side that belongs to the node; 0 where it has none, and in plane scalar problems, which do not speak of pressure.
    pub area: f64,
}

const WORDS: usize = 17;

impl ContactRow {
    fn pack(&self, out: &mut Vec<u64>) {
        let flags = u64::from(self.active) | u64::from(self.inequality) << 1;
        out.extend([self.source.0, self.source.1 as u64, flags]);
        out.extend(self.t.map(f64::to_bits));
        out.extend(self.point.map(f64::to_bits));
        out.extend(self.direction.map(f64::to_bits));
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
            direction: [8, 9, 10].map(number),
            multiplier: number(11),
            distance: number(12),
            members: [member(13), member(15)],
            area: 0.0,
        }
    }

    /// Force per area; `None` where there is no area.
    pub fn pressure(&self) -> Option<f64> {
        (self.area > 0.0).then(|| self.multiplier / self.area)
    }
}

/// Whether multipliers are reported as pressures, too: everywhere but in plane scalar problems.
pub fn has_pressure(scene: &Scene) -> bool {
    scene.dim() == 3 || scene.form.is_elastic()
}

/// All rows on rank 0, by interface and t; empty on the others. Collective.
pub fn rows(
    session: &Session,
    scene: &Scene,
    solver: &FetiFeti,
    solution: &Solution,
) -> Result<Vec<ContactRow>> {
    let owns = distribution::owner(session, scene)?;
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
            direction: label.direction,
            inequality: jump.inequality[i],
            members: label.members.map(member),
            area: 0.0,
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
    if has_pressure(scene) {
        areas::assign(scene, &mut rows);
    }
    Ok(rows)
}

pub(super) fn by_source(rows: &[ContactRow]) -> impl Iterator<Item = &[ContactRow]> {
    rows.chunk_by(|a, b| a.source == b.source)
}

pub(super) fn name(scene: &Scene, (kind, k): (u64, usize)) -> String {
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
                resultant: scene.form.is_elastic().then(|| resultant(scene, rows)),
                max_pressure: pressures(scene, rows).map(|p| p.fold(0.0, f64::max)),
                area: pressures(scene, rows).map(|_| {
                    let touching = rows.iter().filter(|r| r.inequality && r.active);
                    touching.map(|r| r.area).sum()
                }),
            }
        })
        .collect()
}

/// Σ λ n: what the first body, or the only one, presses with on what is opposite.
fn resultant(scene: &Scene, rows: &[ContactRow]) -> Vec<f64> {
    let component = |c: usize| rows.iter().map(|r| r.multiplier * r.direction[c]).sum();
    (0..scene.dim()).map(component).collect()
}

/// The pressures of the inequalities, where multipliers are reported as such and some sides may touch.
fn pressures<'a>(
    scene: &Scene,
    rows: &'a [ContactRow],
) -> Option<impl Iterator<Item = f64> + use<'a>> {
    let contact = || rows.iter().filter(|r| r.inequality);
    let some = has_pressure(scene) && contact().next().is_some();
    some.then(|| contact().filter_map(ContactRow::pressure))
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
            // Along a curved side no coordinate grows steadily.
            let curved =
                rows[0].members[0].is_some_and(|(b, _)| scene.bodies[b].spec.map.is_some());
            let label = if curved { "t" } else { ["x", "y"][along] };
            let column = |f: fn(&ContactRow) -> f64| rows.iter().map(f).collect::<Vec<f64>>();
            Profile {
                name: name(scene, rows[0].source),
                label: label.into(),
                t: column(|r| r.t[0]),
                points: rows.iter().map(|r| [r.point[0], r.point[1]]).collect(),
                gap: column(|r| r.distance),
                multiplier: column(|r| r.multiplier),
                active: rows.iter().map(|r| r.active).collect(),
                area: if has_pressure(scene) {
                    column(|r| r.area)
                } else {
                    Vec::new()
                },
            }
        })
        .collect()
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
