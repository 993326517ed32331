//! The data along interfaces, which plots of plane problems and maps of solids show, and all of it as CSV.

use crate::tables::table::Table;
use base::{Error, Result};

/// The nodes of one interface. All lists have one entry per node.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct InterfaceNodes {
    /// `left|right` for two bodies, `left.top above` for an obstacle.
    pub name: String,
    /// Parameters along the interface; in the plane the second one is zero.
    pub t: Vec<[f64; 2]>,
    /// Position.
    pub points: Vec<[f64; 3]>,
    /// Remaining distance between the sides.
    pub gap: Vec<f64>,
    /// Force at the node; positive where the sides press against each other.
    pub multiplier: Vec<f64>,
    /// Whether the sides touch.
    pub active: Vec<bool>,
    /// The part of the side that belongs to the node: in the plane a length. Empty if forces are not reported as
    /// pressures.
    pub area: Vec<f64>,
    /// Pressures without oscillations; empty where they are none but those of the forces.
    pub smoothed: Vec<f64>,
    /// Friction node by node; empty without friction.
    pub friction: Vec<NodeFriction>,
}

/// Friction at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeFriction {
    /// `open`, `stick`, `slip` or `tied`.
    pub state: &'static str,
    /// The shear stress of friction on the first body, or on the body of an obstacle; NaN where a node has no area.
    pub shear: [f64; 3],
    /// The bound of the shear stress: μ p in Coulomb's law without a limit; NaN where a node has no area.
    pub bound: f64,
    /// The slip of the first body beside the other side in the load step.
    pub slip: [f64; 3],
}

impl InterfaceNodes {
    /// Checks that the lists, and those in `more`, have one entry per node.
    pub(super) fn check(&self, more: &[(usize, &str)]) -> Result<()> {
        let n = self.t.len();
        let areas = if self.has_pressure() {
            self.area.len()
        } else {
            n
        };
        let lists = [
            (self.points.len(), "points"),
            (self.gap.len(), "gaps"),
            (self.multiplier.len(), "multipliers"),
            (self.active.len(), "states"),
            (areas, "areas"),
            (self.smoothed.len().max(n), "smoothed pressures"),
            (self.friction.len().max(n), "nodes with friction"),
        ];
        match lists.iter().chain(more).find(|list| list.0 != n) {
            None => Ok(()),
            Some((found, list)) => Err(Error::input(format!(
                "the interface '{}' lists {found} {list}, expected one for each of {n} nodes",
                self.name
            ))),
        }
    }

    /// Whether pressures are shown: whether there are areas.
    pub(super) fn has_pressure(&self) -> bool {
        !self.area.is_empty()
    }

    /// Force per area, node by node; NaN where a node has no area.
    pub fn pressure(&self) -> Vec<f64> {
        let each = self.multiplier.iter().zip(&self.area);
        each.map(|(&force, &area)| if area > 0.0 { force / area } else { f64::NAN })
            .collect()
    }

    /// The pressures that pictures show: the smoothed ones where there are some.
    pub(super) fn shown_pressure(&self) -> Vec<f64> {
        if self.smoothed.is_empty() {
            self.pressure()
        } else {
            self.smoothed.clone()
        }
    }

    /// Sum of the multipliers.
    pub fn force(&self) -> f64 {
        self.multiplier.iter().sum()
    }
}

/// All nodes as CSV: name, t, s (the second parameter), x, y, z, gap, multiplier, active (0 or 1), pressure and area;
/// in the plane without s and z. Pressure and area are empty where forces are not reported as pressures. Where an
/// interface has smoothed pressures, all of them have a column pressure_smoothed. Where one has friction, all of them
/// have the columns state, shear_x, …, shear_bound and slip_x, …, which are empty on the others.
pub(super) fn csv<'a>(interfaces: impl Iterator<Item = &'a InterfaceNodes>, solid: bool) -> Table {
    let interfaces: Vec<_> = interfaces.map(|i| (i, i.pressure())).collect();
    let smoothed = interfaces.iter().any(|(i, _)| !i.smoothed.is_empty());
    let friction = interfaces.iter().any(|(i, _)| !i.friction.is_empty());
    let nodes = interfaces.iter();
    let nodes = nodes.flat_map(|(i, pressure)| (0..i.t.len()).map(move |k| (*i, pressure, k)));
    Table::of(nodes)
        .exact("name", |(i, _, _)| i.name.as_str())
        .exact("t", |(i, _, k)| i.t[*k][0])
        .when(solid, |t| t.exact("s", |(i, _, k)| i.t[*k][1]))
        .exact("x", |(i, _, k)| i.points[*k][0])
        .exact("y", |(i, _, k)| i.points[*k][1])
        .when(solid, |t| t.exact("z", |(i, _, k)| i.points[*k][2]))
        .exact("gap", |(i, _, k)| i.gap[*k])
        .exact("multiplier", |(i, _, k)| i.multiplier[*k])
        .exact("active", |(i, _, k)| u8::from(i.active[*k]))
        .exact("pressure", |(_, pressure, k)| pressure.get(*k).copied())
        .exact("area", |(i, _, k)| i.area.get(*k).copied())
        .when(smoothed, |t| {
            t.exact("pressure_smoothed", |(i, pressure, k)| {
                i.smoothed.get(*k).or(pressure.get(*k)).copied()
            })
        })
        .when(friction, |t| {
            let at = |i: &InterfaceNodes, k: usize| i.friction.get(k).copied();
            let mut t = t.exact("state", move |(i, _, k)| at(i, *k).map(|f| f.state));
            let axes = || ["x", "y", "z"].into_iter().take(if solid { 3 } else { 2 });
            for (c, axis) in axes().enumerate() {
                t = t.exact(format!("shear_{axis}"), move |(i, _, k)| {
                    at(i, *k).map(|f| f.shear[c])
                });
            }
            t = t.exact("shear_bound", move |(i, _, k)| at(i, *k).map(|f| f.bound));
            for (c, axis) in axes().enumerate() {
                t = t.exact(format!("slip_{axis}"), move |(i, _, k)| {
                    at(i, *k).map(|f| f.slip[c])
                });
            }
            t
        })
        .table()
}

/// The interfaces with the largest forces, at most `shown`, and the title, which gives the total number where there are
/// more. Forces that are not finite come first: the reader must see them.
pub(super) fn largest<'a, T>(
    interfaces: impl Iterator<Item = &'a T>,
    nodes: fn(&T) -> &InterfaceNodes,
    shown: usize,
    title: &str,
) -> (Vec<&'a T>, String) {
    let size = |t: &T| match nodes(t).force().abs() {
        force if force.is_nan() => f64::INFINITY,
        force => force,
    };
    let mut order: Vec<&T> = interfaces.collect();
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let note = format!(
        "the {shown} of {} interfaces with the largest forces",
        order.len()
    );
    let title = match (title, order.len() > shown) {
        (_, false) => title.to_string(),
        ("", true) => note,
        _ => format!("{title}: {note}"),
    };
    order.truncate(shown);
    (order, title)
}
