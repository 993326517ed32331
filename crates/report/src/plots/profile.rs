//! Multiplier and gap along the interfaces: a figure for the interfaces with the largest forces, and all data as CSV.

use super::plot::{Axis, Band, Figure, LineStyle, Marker, Panel, Series};
use crate::drawing::canvas::Colour;
use crate::drawing::ticks::{self, Scale};
use crate::interfaces::{self, InterfaceNodes};
use crate::pictures::values::extremes;
use base::Result;
use std::path::{Path, PathBuf};

/// Number of interfaces in the figure.
const SHOWN: usize = 12;
/// Up to this number of points, each gets a marker.
const MARKED: usize = 40;
/// A gap below this part of the interface's length is rounding.
const CLOSED: f64 = 1e-11;
/// A gap of displacements in space below this part of the interface's length counts as closed: their scale is not that
/// of the interface, and iterations end at a tolerance.
const CLOSED_IN_SPACE: f64 = 1e-6;
/// Background of the contact zone.
const ZONE: Colour = Colour(0xde, 0xea, 0xd8);
/// Background where the sides slip.
const SLIPS: Colour = Colour(0xf9, 0xe6, 0xcf);

/// An interface in the plane.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct InterfaceProfile {
    /// Its nodes.
    pub nodes: InterfaceNodes,
    /// Name of the coordinate along the interface: `x` or `y`, or `t` for the parameter of a curved one.
    pub label: String,
}

impl InterfaceProfile {
    /// Position of a node along the interface.
    fn t(&self, k: usize) -> f64 {
        match &self.label[..] {
            "x" => self.nodes.points[k][0],
            "y" => self.nodes.points[k][1],
            _ => self.nodes.t[k][0],
        }
    }

    /// The nodes in order of their position.
    fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.nodes.t.len()).collect();
        order.sort_by(|&a, &b| self.t(a).total_cmp(&self.t(b)));
        order
    }

    /// Smallest and largest position, with a margin.
    fn range(&self) -> (f64, f64) {
        let t: Vec<f64> = (0..self.nodes.t.len()).map(|k| self.t(k)).collect();
        let (low, high) = extremes(&t);
        let air = if high > low {
            0.02 * (high - low)
        } else {
            0.5 * low.abs().max(1.0)
        };
        if low <= high {
            (low - air, high + air)
        } else {
            (0.0, 1.0)
        }
    }

    /// The zone of a node: its label and its colour; `None` where the sides are apart.
    fn zone_of(&self, k: usize) -> Option<(&'static str, Colour)> {
        match self.nodes.friction.get(k).map(|f| f.state) {
            Some("slip") => Some(("slips", SLIPS)),
            Some("stick") => Some(("sticks", ZONE)),
            Some("open") => None,
            Some(_) | None => self.nodes.active[k].then_some(("in contact", ZONE)),
        }
    }

    /// The contact zone; with friction where the sides stick and where they slip. Its ends are half-way between nodes
    /// of different zones.
    fn zone(&self) -> Vec<Band> {
        let order = self.order();
        let t = |k: usize| self.t(order[k]);
        let zone = |k: usize| self.zone_of(order[k]);
        let mut out = Vec::new();
        let mut k = 0;
        while k < order.len() {
            let (first, kind) = (k, zone(k));
            let same = |k: usize| zone(k).map(|z| z.0) == kind.map(|z| z.0);
            while k < order.len() && same(k) {
                k += 1;
            }
            let Some((label, colour)) = kind else {
                continue;
            };
            let from = if first > 0 {
                0.5 * (t(first - 1) + t(first))
            } else {
                t(0)
            };
            let to = if k < order.len() {
                0.5 * (t(k - 1) + t(k))
            } else {
                t(k - 1)
            };
            out.push(Band {
                label: label.into(),
                range: (from, to),
                colour,
            });
        }
        out
    }

    /// The shear stress of friction node by node, its absolute value; empty without friction.
    fn shear(&self) -> Vec<f64> {
        let size = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        self.nodes.friction.iter().map(|f| size(f.shear)).collect()
    }

    /// The panels of multiplier and gap, one below the other; `largest_gap` is that of the whole figure.
    fn panels(&self, largest_gap: f64) -> [Panel; 2] {
        let order = self.order();
        let marker = if order.len() <= MARKED {
            Marker::Circle
        } else {
            Marker::None
        };
        let curve = |name: &str, values: &[f64], colour: Colour| {
            let points = order.iter().map(|&k| (self.t(k), values[k])).collect();
            Series::new(name, points, colour).marker(marker, true, 2.6)
        };
        let zero = |x: (f64, f64)| {
            Series::new("", vec![(x.0, 0.0), (x.1, 0.0)], Colour::CYCLE[7])
                .line_only()
                .line(LineStyle::Dotted)
        };
        let x = self.range();
        // Rounding errors are not magnified to the size of the panel, and the range always contains zero, the gap of
        // closed contact.
        let (low, high) = extremes(&self.nodes.gap);
        let length = x.1 - x.0;
        let closed = if self.nodes.has_pressure() {
            CLOSED_IN_SPACE * length
        } else {
            CLOSED * length
        };
        let y = if low > high || low.abs().max(high.abs()) <= closed {
            let top = if largest_gap > closed {
                largest_gap
            } else {
                length
            };
            (-0.05 * top, top)
        } else {
            let (low, high) = ticks::range([0.0, low, high].into_iter(), Scale::Linear);
            (low.min(-0.05 * (high - low)), high)
        };
        let (what, force) = if self.nodes.has_pressure() {
            ("pressure", &self.nodes.shown_pressure())
        } else {
            ("multiplier", &self.nodes.multiplier)
        };
        let shear = self.shear();
        let (least, most) = extremes(force);
        let most = shear
            .iter()
            .copied()
            .filter(|v| v.is_finite())
            .fold(most, f64::max);
        // Bounds far above all stresses, as those that make sides stick, are cut off.
        let bounds = self.nodes.friction.iter().map(|f| f.bound);
        let bounds: Vec<f64> = bounds
            .map(|b| if b > 2.0 * most { f64::NAN } else { b })
            .collect();
        let most = bounds.iter().copied().fold(most, f64::max);
        let (least, most) = (least.min(0.0), most.max(0.0));
        let shown = if most > least {
            let air = 0.06 * (most - least);
            (least - air, most + air)
        } else {
            (-0.05, 1.0)
        };
        let within = |label: &str, range: (f64, f64)| Axis {
            range: Some(range),
            ..Axis::new(label, Scale::Linear)
        };
        let panel = |title: &str, below: &str, y: Axis, mut series: Vec<Series>| {
            series.insert(0, zero(x));
            Panel {
                bands: self.zone(),
                ..Panel::new(title, within(below, x), y, series)
            }
        };
        let mut forces = vec![curve(what, force, Colour::CYCLE[0])];
        if !shear.is_empty() {
            let bound = curve("bound of the shear stress", &bounds, Colour::CYCLE[3]);
            forces.push(
                bound
                    .marker(Marker::None, false, 0.0)
                    .line(LineStyle::Dashed),
            );
            forces.push(curve("shear stress", &shear, Colour::CYCLE[2]));
        }
        let gap = curve("gap", &self.nodes.gap, Colour::CYCLE[1]);
        [
            panel(&self.nodes.name, "", within(what, shown), forces),
            panel("", &self.label, within("gap", y), vec![gap]),
        ]
    }
}

/// The figure: the interfaces with the largest forces, each with its multiplier above its gap.
///
/// # Errors
/// [`base::ErrorKind::Input`] when the arrays of an interface differ in length.
pub fn figure(profiles: &[InterfaceProfile], title: &str) -> Result<Figure> {
    profiles.iter().try_for_each(|p| p.nodes.check(&[]))?;
    let known = profiles.iter().filter(|p| !p.nodes.t.is_empty());
    let (order, title) = interfaces::largest(known, |p| &p.nodes, SHOWN, title);
    let columns = match order.len() {
        0 | 1 => 1,
        2 | 4 => 2,
        10.. => 4,
        _ => 3,
    };
    let gaps = order.iter().map(|p| extremes(&p.nodes.gap).1);
    let largest_gap = gaps.fold(0.0, f64::max);
    let mut panels = Vec::new();
    for row in order.chunks(columns) {
        let pairs: Vec<[Panel; 2]> = row.iter().map(|p| p.panels(largest_gap)).collect();
        for half in 0..2 {
            panels.extend(pairs.iter().map(|pair| pair[half].clone()));
            panels.extend((row.len()..columns).map(|_| Panel::blank()));
        }
    }
    Ok(Figure {
        title,
        panels,
        columns,
        panel_size: match columns {
            1 => (620.0, 220.0),
            2 => (430.0, 190.0),
            _ => (330.0, 176.0),
        },
    })
}

/// Writes `interfaces.png`, `interfaces.svg` and `interfaces.csv` into a directory; returns their paths. The CSV has
/// all interfaces.
///
/// # Errors
/// [`base::ErrorKind::Input`] when the lists of an interface differ in length; [`base::ErrorKind::Environment`] with
/// the path.
pub fn write(profiles: &[InterfaceProfile], title: &str, dir: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = figure(profiles, title)?.save(&dir.join("interfaces"))?;
    let csv = dir.join("interfaces.csv");
    interfaces::csv(profiles.iter().map(|p| &p.nodes), false).write_csv(&csv)?;
    paths.push(csv);
    Ok(paths)
}

#[cfg(test)]
#[path = "../../tests/plots/profile.rs"]
mod tests;
