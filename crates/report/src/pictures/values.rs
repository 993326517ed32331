//! The values that a picture shows: numbers on points or cells, their range and their colours.

use crate::drawing::canvas::Colour;
use crate::drawing::colormap::viridis;
use crate::drawing::ticks::Scale;
use base::{Error, Result};

/// Numbers to show.
#[derive(Debug, Clone, Copy)]
pub enum ShownValues<'a> {
    /// One per point, interpolated in the cells.
    Nodal(&'a [f64]),
    /// One per cell.
    Cell(&'a [f64]),
}

impl<'a> ShownValues<'a> {
    fn numbers(self) -> &'a [f64] {
        match self {
            ShownValues::Nodal(v) | ShownValues::Cell(v) => v,
        }
    }
}

/// A field in a picture: its title, values and scale.
#[derive(Debug, Clone, Copy)]
pub struct ShownField<'a> {
    /// Title above the picture.
    pub title: &'a str,
    /// The values.
    pub values: ShownValues<'a>,
    /// Scale of the colours.
    pub scale: Scale,
}

impl<'a> ShownField<'a> {
    /// Numbers on points.
    pub fn nodal(title: &'a str, values: &'a [f64]) -> Self {
        ShownField {
            title,
            values: ShownValues::Nodal(values),
            scale: Scale::Linear,
        }
    }

    /// Numbers on cells.
    pub fn cell(title: &'a str, values: &'a [f64]) -> Self {
        ShownField {
            title,
            values: ShownValues::Cell(values),
            scale: Scale::Linear,
        }
    }

    /// A coefficient by cell, on a logarithmic scale where it varies by more than 100.
    pub fn coefficient(title: &'a str, values: &'a [f64]) -> Self {
        let (low, high) = extremes(values);
        let scale = if low > 0.0 && high > 100.0 * low {
            Scale::Log
        } else {
            Scale::Linear
        };
        ShownField {
            scale,
            ..ShownField::cell(title, values)
        }
    }

    /// Checks that the numbers fit a mesh with these numbers of points and cells.
    pub(super) fn check(&self, points: usize, cells: usize) -> Result<()> {
        let (expected, what) = match self.values {
            ShownValues::Nodal(_) => (points, "points"),
            ShownValues::Cell(_) => (cells, "cells"),
        };
        let found = self.values.numbers().len();
        if found != expected {
            return Err(Error::input(format!(
                "the field '{}' has {found} numbers, expected one for each of {expected} {what}",
                self.title
            )));
        }
        Ok(())
    }

    /// The numbers at the corners of a cell.
    pub(super) fn at<const N: usize>(&self, cell: usize, corners: [u32; N]) -> [f64; N] {
        match self.values {
            ShownValues::Nodal(v) => corners.map(|p| v[p as usize]),
            ShownValues::Cell(v) => [v[cell]; N],
        }
    }

    /// The numbers at the two ends of the colour bar; a constant field gets the middle colour.
    pub(super) fn range(&self) -> (f64, f64) {
        let numbers = self.values.numbers().iter().copied();
        let shown = numbers.filter(|&v| self.scale.shows(v));
        let (low, high) = shown.fold((f64::INFINITY, f64::NEG_INFINITY), |m, v| {
            (m.0.min(v), m.1.max(v))
        });
        if low > high {
            return (1.0, 2.0);
        }
        if high - low > 1e-10 * high.abs().max(low.abs()) {
            return (low, high);
        }
        match self.scale {
            Scale::Linear if low == 0.0 => (-1.0, 1.0),
            Scale::Linear => (low - 0.5 * low.abs(), low + 0.5 * low.abs()),
            Scale::Log => (low / 2.0, low * 2.0),
        }
    }

    /// The map from numbers to colours, for a colour bar of this range.
    pub(super) fn colour(&self, range: (f64, f64)) -> impl Fn(f64) -> Colour {
        let scale = self.scale;
        let (low, high) = (scale.forward(range.0), scale.forward(range.1));
        move |v| {
            if scale.shows(v) {
                viridis((scale.forward(v) - low) / (high - low))
            } else {
                viridis(f64::NAN)
            }
        }
    }
}

/// Smallest and largest finite number; (∞, −∞) without any.
pub(crate) fn extremes(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().filter(|v| v.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |m, &v| {
        (m.0.min(v), m.1.max(v))
    })
}

#[cfg(test)]
#[path = "../../tests/pictures/values.rs"]
mod tests;
