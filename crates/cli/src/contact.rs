//! Contact in the report: rows with their places, forces per interface, the balance of every body.

use std::collections::BTreeMap;

use super::friction::{self, FrictionRows};
use super::smoothed::smoothed;
use fetifeti::problem::{BodyNode, RowSource};
use fetifeti::solution::{SolvedRow, Step};
use fetifeti::Solution;
use petsc::Session;
use report::interfaces::InterfaceNodes;
use report::json::contact::{InterfaceForce, InterfaceKind, OuterStep, Slid};
use report::plots::profile::InterfaceProfile;
use scene::sliding::Sliding;
use scene::{InterfaceShape, Scene};

/// All rows on rank 0, ordered by interface and t; empty on the other ranks. Collective.
pub fn rows(session: &Session, solution: &Solution) -> Vec<SolvedRow> {
    let mut rows = SolvedRow::on_first_rank(session.comm(), solution.rows());
    rows.sort_by(SolvedRow::by_place);
    rows
}

pub(super) fn by_source(rows: &[SolvedRow]) -> impl Iterator<Item = &[SolvedRow]> {
    // All equations are one group.
    let equation = |row: &SolvedRow| matches!(row.label.source, RowSource::Equation(_));
    rows.chunk_by(move |a, b| a.label.source == b.label.source || equation(a) && equation(b))
}

/// For rows from one source: the body of the nodes with multipliers, and its side on which they lie. `None` where
/// bodies meet in less than a side.
pub(super) fn side(scene: &Scene, rows: &[SolvedRow]) -> Option<(usize, usize)> {
    let source = rows.first()?.label.source;
    scene.sides_of(source).get(scene.carrier(source)).copied()
}

/// The node with the multiplier of a row.
pub(super) fn carrier(scene: &Scene, row: &SolvedRow) -> Option<BodyNode> {
    row.label.members[scene.carrier(row.label.source)]
}

pub(super) fn name(scene: &Scene, source: RowSource) -> String {
    let k = match source {
        RowSource::Obstacle(k) => return scene.obstacles[k].name.clone(),
        RowSource::Interface(k) => k,
        RowSource::Equation(_) => return "equations".into(),
    };
    let interface = &scene.interfaces[k];
    let [a, b] = interface.order.map(|o| interface.bodies[o]);
    let body = |b: usize| &scene.bodies[b].spec.name;
    if interface.area.is_some() {
        return format!("{}|{} gaps", body(a), body(b));
    }
    if a == b {
        // A body that touches itself does so with two sides.
        let [first, second] = interface.order.map(|o| {
            let mesh = scene.bodies[a].mesh();
            format!("{}.{}", body(a), mesh.side_name(interface.sides[o]))
        });
        return format!("{first}|{second}");
    }
    format!("{}|{}", body(a), body(b))
}

/// Sliding by interface and obstacle; those that do not touch do not slide.
pub type Slides = BTreeMap<RowSource, Sliding>;

/// Forces per interface and obstacle, with friction, and the sliding where it is known.
pub fn forces(
    scene: &Scene,
    (rows, tangential): (&[SolvedRow], &[SolvedRow]),
    slides: Option<&Slides>,
) -> Vec<InterfaceForce> {
    by_source(rows)
        .map(|rows| {
            let some = rows.iter().any(|r| r.is_inequality());
            let all = rows.iter().all(|r| r.is_inequality());
            let least = |f: fn(&SolvedRow) -> f64| rows.iter().map(f).fold(f64::INFINITY, f64::min);
            let most =
                |f: fn(&SolvedRow) -> f64| rows.iter().map(f).fold(f64::NEG_INFINITY, f64::max);
            let own = friction::of_source(tangential, rows[0].label.source);
            let slid = slides.filter(|_| some);
            let slid = slid.map(|all| all.get(&rows[0].label.source).copied().unwrap_or_default());
            InterfaceForce {
                name: name(scene, rows[0].label.source),
                kind: match (rows[0].label.source, some, all) {
                    (RowSource::Obstacle(_), ..) => InterfaceKind::Obstacle,
                    (_, false, _) => InterfaceKind::Tied,
                    (_, _, true) => InterfaceKind::Contact,
                    _ => InterfaceKind::Mixed,
                },
                candidates: rows.len(),
                active: rows.iter().filter(|r| r.holds()).count(),
                force: rows.iter().map(|r| r.multiplier).sum(),
                largest_gap: most(|r| r.gap),
                smallest_gap: least(|r| r.gap),
                min_multiplier: least(|r| r.multiplier),
                max_multiplier: most(|r| r.multiplier),
                resultant: scene.form.is_elastic().then(|| resultant(scene, rows)),
                max_pressure: pressures(scene, rows).map(|p| p.fold(0.0, f64::max)),
                area: pressures(scene, rows).map(|_| {
                    let touching = rows.iter().filter(|r| r.is_inequality() && r.holds());
                    touching.map(|r| r.label.area).sum()
                }),
                slid: recorded(slid),
                friction: friction::force(scene, own),
                extremes: friction::extremes(own),
            }
        })
        .collect()
}

/// The form of a sliding in reports.
pub(super) fn recorded(slid: Option<Sliding>) -> Slid {
    Slid {
        largest_sliding: slid.map(|s| s.largest),
        sliding_over_face: slid.map(|s| s.over_face),
        largest_turn: slid.map(|s| s.turned),
    }
}

/// Σ λ n: the force of the first body, or the only one, on the opposite body or obstacle.
fn resultant(scene: &Scene, rows: &[SolvedRow]) -> Vec<f64> {
    let component = |c: usize| rows.iter().map(|r| r.multiplier * r.normal()[c]).sum();
    (0..scene.dim()).map(component).collect()
}

/// The pressures of the inequalities, where the scene reports multipliers as pressures and some sides may touch.
fn pressures<'a>(
    scene: &Scene,
    rows: &'a [SolvedRow],
) -> Option<impl Iterator<Item = f64> + use<'a>> {
    let contact = || rows.iter().filter(|r| r.is_inequality());
    let some = scene.has_pressure() && contact().next().is_some();
    some.then(|| contact().filter_map(SolvedRow::pressure))
}

/// The rows of each interface or obstacle that has inequalities, with their smoothed pressures, if there are some.
pub(super) fn with_inequalities<'a>(
    scene: &'a Scene,
    rows: &'a [SolvedRow],
) -> impl Iterator<Item = (&'a [SolvedRow], Vec<f64>)> {
    let (pressures, found) = smoothed(scene, rows);
    let mut done = 0;
    let groups = by_source(rows).map(move |rows| {
        let first = done;
        done += rows.len();
        let some = found
            .iter()
            .any(|o| rows[0].label.source == RowSource::Interface(o.interface));
        let own = if some { first..done } else { 0..0 };
        (rows, pressures[own].to_vec())
    });
    groups.filter(|(rows, _)| rows.iter().any(|r| r.is_inequality()))
}

/// The nodes of one interface or obstacle, with their areas if `areas` is set; `friction` has all rows of friction.
pub(super) fn nodes(
    scene: &Scene,
    (rows, smoothed): (&[SolvedRow], Vec<f64>),
    friction: &FrictionRows,
    areas: bool,
) -> InterfaceNodes {
    let column = |f: fn(&SolvedRow) -> f64| rows.iter().map(f).collect::<Vec<f64>>();
    InterfaceNodes {
        name: name(scene, rows[0].label.source),
        t: rows.iter().map(|r| r.label.t).collect(),
        points: rows.iter().map(|r| r.label.point).collect(),
        gap: column(|r| r.gap),
        multiplier: column(|r| r.multiplier),
        active: rows.iter().map(|r| r.holds()).collect(),
        area: if areas {
            column(|r| r.label.area)
        } else {
            Vec::new()
        },
        smoothed,
        friction: friction::along(rows, friction),
    }
}

/// The profiles of multiplier and gap along every interface that has inequalities.
pub fn profiles(
    scene: &Scene,
    rows: &[SolvedRow],
    friction: &FrictionRows,
) -> Vec<InterfaceProfile> {
    let profile = |(rows, smoothed): (&[SolvedRow], Vec<f64>)| {
        let along = match rows[0].label.source {
            RowSource::Obstacle(k) => usize::from(scene.obstacles[k].side < 2),
            RowSource::Equation(_) => 0,
            RowSource::Interface(k) => match scene.interfaces[k].shape {
                InterfaceShape::Face => usize::from(scene.interfaces[k].sides[0] < 2),
                InterfaceShape::Corner => 0,
            },
        };
        // Along a curved side no coordinate increases monotonically.
        let body = rows[0].body();
        let curved = body.is_some_and(|b| !scene.bodies[b].spec.is_straight());
        InterfaceProfile {
            nodes: nodes(scene, (rows, smoothed), friction, scene.has_pressure()),
            label: if curved { "t" } else { ["x", "y"][along] }.into(),
        }
    };
    with_inequalities(scene, rows).map(profile).collect()
}

/// The record of one outer step in the report.
pub fn outer_step(load_step: usize, number: usize, step: &Step) -> OuterStep {
    OuterStep {
        load_step,
        step: number,
        method: step.method.name().into(),
        active: step.active,
        entered: step.entered,
        left: step.left,
        iterations: step.iterations,
        estimate: step.estimate.map(Into::into),
        exact: step.exact.map(Into::into),
        wrong: step.wrong,
        residual: step.residual,
        tolerance: step.tolerance,
        seconds: step.seconds,
    }
}

/// The names of the methods that made the steps, in order.
pub fn method(steps: &[OuterStep]) -> String {
    let mut seen: BTreeMap<usize, &str> = BTreeMap::new();
    for (k, step) in steps.iter().enumerate() {
        if !seen.values().any(|m| *m == step.method) {
            seen.insert(k, &step.method);
        }
    }
    seen.into_values().collect::<Vec<_>>().join(", then ")
}
