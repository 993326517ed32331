//! Contact as point data of a VTU file: arrays over all points, from data at the candidates.
//!
//! Every entry of an array is finite. ParaView would accept NaN (VTK 9.7 reads it in base64 and in ascii, and leaves it
//! out of the colour range), but filters that compute, such as contours and calculators, pass it on, and other readers
//! of the format need not support it. So `multiplier`, `gap` and `contact` are 0 away from the interfaces, and
//! `candidate` is 1 where their values are meaningful: a threshold on `candidate` shows the interfaces alone.

use super::friction_fields::{FrictionFields, PointFriction};
use super::vtu::Vtu;
use base::{Error, Result};

/// The four arrays, pressures where nodes have areas, and friction.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactFields {
    /// Sum of the multipliers of the point's candidates; 0 elsewhere.
    pub multiplier: Vec<f64>,
    /// Smallest gap of the point's candidates; 0 elsewhere.
    pub gap: Vec<f64>,
    /// 1 where a candidate of the point is closed, else 0.
    pub contact: Vec<i32>,
    /// 1 where the point has a candidate, else 0.
    pub candidate: Vec<i32>,
    /// Sum of the areas of the point's candidates; empty where forces are not reported as pressures.
    area: Vec<f64>,
    /// `multiplier` over `area`.
    pressure: Vec<f64>,
    /// Forces of smoothed pressures, then these over `area`; `None`: none are smoothed.
    smoothed: Option<Vec<f64>>,
    /// Whether there are pressures, also where no candidate is.
    has_pressure: bool,
    /// Shear stresses, slips and states; `None`: there is no friction.
    friction: Option<FrictionFields>,
}

impl ContactFields {
    /// A mesh of `points` points without candidates.
    pub fn new(points: usize) -> Self {
        ContactFields {
            multiplier: vec![0.0; points],
            gap: vec![0.0; points],
            contact: vec![0; points],
            candidate: vec![0; points],
            area: Vec::new(),
            pressure: Vec::new(),
            smoothed: None,
            has_pressure: false,
            friction: None,
        }
    }

    /// These fields with pressures, also where no candidate is added: the pieces of a grid have the same arrays.
    #[must_use]
    pub fn with_areas(mut self) -> Self {
        self.begin_areas();
        self
    }

    /// These fields with smoothed pressures beside the pressures.
    #[must_use]
    pub fn with_smoothed(mut self) -> Self {
        self.smoothed = Some(vec![0.0; self.multiplier.len()]);
        self
    }

    /// Adds the force of a smoothed pressure to a point.
    pub fn add_smoothed(&mut self, point: usize, force: f64) {
        let to = self.smoothed.as_mut().and_then(|s| s.get_mut(point));
        if let Some(to) = to.filter(|_| force.is_finite()) {
            *to += force;
        }
    }

    /// These fields with friction, also where no candidate has any.
    #[must_use]
    pub fn with_friction(mut self) -> Self {
        self.friction = Some(FrictionFields::new(self.multiplier.len()));
        self
    }

    /// Adds friction to a point.
    pub fn add_friction(&mut self, point: usize, at: &PointFriction) {
        if let Some(friction) = &mut self.friction {
            friction.add(point, at);
        }
    }

    fn begin_areas(&mut self) {
        self.has_pressure = true;
        self.area.resize(self.multiplier.len(), 0.0);
        self.pressure.resize(self.multiplier.len(), 0.0);
    }

    /// Adds one candidate at one point. A point where several interfaces meet has several candidates.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) when the mesh has no such point or a number is not finite.
    pub fn add(&mut self, point: usize, multiplier: f64, gap: f64, closed: bool) -> Result<()> {
        if point >= self.multiplier.len() {
            return Err(Error::input(format!(
                "a contact candidate names point {point}, but the mesh has {} points",
                self.multiplier.len()
            )));
        }
        if !(multiplier.is_finite() && gap.is_finite()) {
            return Err(Error::input(format!(
                "the contact candidate at point {point} has the multiplier {multiplier} \
                 and the gap {gap}, expected finite numbers"
            )));
        }
        let first = self.candidate[point] == 0;
        self.multiplier[point] += multiplier;
        self.gap[point] = if first { gap } else { self.gap[point].min(gap) };
        self.contact[point] |= i32::from(closed);
        self.candidate[point] = 1;
        Ok(())
    }

    /// Adds the area of a candidate to a point; the candidate must have been added before.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) when the mesh has no such point or the area is negative or not
    /// finite.
    pub fn add_area(&mut self, point: usize, area: f64) -> Result<()> {
        let n = self.multiplier.len();
        if point >= n || !(area >= 0.0 && area.is_finite()) {
            return Err(Error::input(format!(
                "a contact candidate at point {point} of {n} has the area {area}, \
                 expected a number that is not negative"
            )));
        }
        self.begin_areas();
        self.area[point] += area;
        Ok(())
    }

    /// Computes pressures and shear stresses, once all candidates have been added; where there is no area they are 0.
    pub fn divide(&mut self) {
        for (p, pressure) in self.pressure.iter_mut().enumerate() {
            if self.area[p] > 0.0 {
                *pressure = self.multiplier[p] / self.area[p];
            }
        }
        let divided = self.smoothed.iter_mut().flatten().zip(&self.area);
        divided
            .filter(|(_, area)| **area > 0.0)
            .for_each(|(force, area)| *force /= area);
        if let Some(friction) = &mut self.friction {
            friction.divide(&self.area);
        }
    }

    /// The grid with the arrays attached as point data.
    #[must_use]
    pub fn on<'a>(&'a self, grid: Vtu<'a>) -> Vtu<'a> {
        let grid = if self.has_pressure {
            grid.point_data("contact_pressure", 1, &self.pressure[..])
        } else {
            grid
        };
        let grid = match &self.smoothed {
            Some(smoothed) => grid.point_data("contact_pressure_smoothed", 1, &smoothed[..]),
            None => grid,
        };
        let grid = match &self.friction {
            Some(friction) => friction.on(grid),
            None => grid,
        };
        grid.point_data("multiplier", 1, &self.multiplier[..])
            .point_data("gap", 1, &self.gap[..])
            .point_data("contact", 1, &self.contact[..])
            .point_data("candidate", 1, &self.candidate[..])
    }
}

#[cfg(test)]
#[path = "../../tests/paraview/contact_fields.rs"]
mod tests;
