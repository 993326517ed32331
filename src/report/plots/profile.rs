//! Multiplier and gap along the interfaces: a figure for the interfaces with the largest forces, and all data as CSV.

use super::plot::{Axis, Band, Figure, Line, Marker, Panel, Series};
use crate::report::drawing::canvas::Colour;
use crate::report::drawing::ticks::{self, Scale};
use crate::report::interfaces;
use crate::report::output;
use crate::report::pictures::values::extremes;
use crate::report::tables::summary::exactly;
use crate::report::tables::table::quoted;
use crate::Result;
use std::path::{Path, PathBuf};

/// Number of interfaces in the figure.
const SHOWN: usize = 12;
/// Up to this number of points, each gets a marker.
const MARKED: usize = 40;
/// A gap below this part of the interface's length is rounding.
const CLOSED: f64 = 1e-11;
/// The same bound for displacements in space: their scale is not that of the interface, and iterations end at a
/// tolerance.
const CLOSED_IN_SPACE: f64 = 1e-6;
/// Background of the contact zone.
const ZONE: Colour = Colour(0xde, 0xea, 0xd8);

/// The data along one interface, node by node.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Profile {
    /// `left|right` for two bodies, `left.top above` for an obstacle.
    pub name: String,
    /// Name of the coordinate `t`, such as `y`.
    pub label: String,
    /// Position along the interface.
    pub t: Vec<f64>,
    /// Position in the plane.
    pub points: Vec<[f64; 2]>,
    /// Remaining distance between the sides.
    pub gap: Vec<f64>,
    /// Force at the node; positive where the sides press against each other.
    pub multiplier: Vec<f64>,
    /// Whether the sides touch.
    pub active: Vec<bool>,
    /// The nodal area (in the plane a length); empty if forces are not reported as pressures.
    pub area: Vec<f64>,
}

impl Profile {
    fn check(&self) -> Result<()> {
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
        ];
        interfaces::check_lengths(&self.name, n, "positions", &lists)
    }

    /// Whether pressures are shown: whether there are areas.
    fn has_pressure(&self) -> bool {
        !self.area.is_empty()
    }

    /// Force per area, node by node; NaN where a node has no area.
    pub fn pressure(&self) -> Vec<f64> {
        interfaces::pressure(&self.multiplier, &self.area)
    }

    /// Sum of the multipliers.
    pub fn force(&self) -> f64 {
        self.multiplier.iter().sum()
    }

    /// The nodes in order of their position.
    fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.t.len()).collect();
        order.sort_by(|&a, &b| self.t[a].total_cmp(&self.t[b]));
        order
    }

    /// Smallest and largest position, with a margin.
    fn range(&self) -> (f64, f64) {
        let (low, high) = extremes(&self.t);
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

    /// The contact zone. Its ends are half-way between the last node in contact and the next open one.
    fn zone(&self) -> Vec<Band> {
        let order = self.order();
        let t = |k: usize| self.t[order[k]];
        let mut out = Vec::new();
        let mut k = 0;
        while k < order.len() {
            let first = k;
            while k < order.len() && self.active[order[k]] {
                k += 1;
            }
            if k > first {
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
                    label: "in contact".into(),
                    range: (from, to),
                    colour: ZONE,
                });
            }
            k += 1;
        }
        out
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
            let points = order.iter().map(|&k| (self.t[k], values[k])).collect();
            Series::new(name, points, colour).marker(marker, true, 2.6)
        };
        let zero = |x: (f64, f64)| {
            Series::new("", vec![(x.0, 0.0), (x.1, 0.0)], Colour::CYCLE[7])
                .marker(Marker::None, true, 0.0)
                .line(Line::Dotted)
        };
        let x = self.range();
        let axis = |label: &str| Axis {
            range: Some(x),
            ..Axis::new(label, Scale::Linear)
        };
        // Rounding errors are not magnified to the size of the panel, and the range always contains zero, the gap of
        // closed contact.
        let (low, high) = extremes(&self.gap);
        let length = x.1 - x.0;
        let closed = match self.has_pressure() {
            true => CLOSED_IN_SPACE * length,
            false => CLOSED * length,
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
        let (what, force) = if self.has_pressure() {
            ("pressure", &self.pressure())
        } else {
            ("multiplier", &self.multiplier)
        };
        let (least, most) = extremes(force);
        let (least, most) = (least.min(0.0), most.max(0.0));
        let shown = if most > least {
            let air = 0.06 * (most - least);
            (least - air, most + air)
        } else {
            (-0.05, 1.0)
        };
        [
            Panel {
                title: self.name.clone(),
                x: axis(""),
                y: Axis {
                    range: Some(shown),
                    ..Axis::new(what, Scale::Linear)
                },
                series: vec![zero(x), curve(what, force, Colour::CYCLE[0])],
                bands: self.zone(),
            },
            Panel {
                title: String::new(),
                x: axis(&self.label),
                y: Axis {
                    range: Some(y),
                    ..Axis::new("gap", Scale::Linear)
                },
                series: vec![zero(x), curve("gap", &self.gap, Colour::CYCLE[1])],
                bands: self.zone(),
            },
        ]
    }
}

/// The figure: the interfaces with the largest forces, each with its multiplier above its gap.
///
/// # Errors
/// [`crate::Error::Input`] when the arrays of an interface differ in length.
pub fn figure(profiles: &[Profile], title: &str) -> Result<Figure> {
    profiles.iter().try_for_each(Profile::check)?;
    let known = profiles.iter().filter(|p| !p.t.is_empty());
    let (order, title) = interfaces::largest(known, Profile::force, SHOWN, title);
    let columns = match order.len() {
        0 | 1 => 1,
        2 | 4 => 2,
        10.. => 4,
        _ => 3,
    };
    let largest_gap = order.iter().map(|p| extremes(&p.gap).1).fold(0.0, f64::max);
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
/// all interfaces: name, t, x, y, gap, multiplier, active (0 or 1), and with areas pressure and area.
///
/// # Errors
/// [`crate::Error::Input`] when the arrays of an interface differ in length; [`crate::Error::Environment`] with the
/// path.
pub fn write(profiles: &[Profile], title: &str, dir: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = figure(profiles, title)?.save(&dir.join("interfaces"))?;
    let csv = dir.join("interfaces.csv");
    output::write_file(&csv, |out| {
        let pressures = profiles.iter().any(Profile::has_pressure);
        let more = if pressures { ",pressure,area" } else { "" };
        writeln!(out, "name,t,x,y,gap,multiplier,active{more}")?;
        for p in profiles {
            let pressure = p.pressure();
            let name = quoted(&p.name);
            for k in 0..p.t.len() {
                let [x, y] = p.points[k];
                let numbers = [p.t[k], x, y, p.gap[k], p.multiplier[k]].map(|v| exactly(Some(v)));
                let active = u8::from(p.active[k]);
                write!(out, "{name},{},{active}", numbers.join(","))?;
                if pressures {
                    let number = |list: &[f64]| exactly(list.get(k).copied());
                    write!(out, ",{},{}", number(&pressure), number(&p.area))?;
                }
                writeln!(out)?;
            }
        }
        Ok(())
    })?;
    paths.push(csv);
    Ok(paths)
}

#[cfg(test)]
#[path = "../../../tests/inside/report/plots/profile.rs"]
mod tests;
