//! Friction as point data of a VTU file: the shear stress, the slip and the state of contact at each point.

use super::vtu::Vtu;

/// The state of contact with friction as a number, in the array `contact_state`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i32)]
pub enum ContactState {
    /// The sides are apart, or there is no friction.
    Open = 0,
    /// The sides stick.
    Stick = 1,
    /// The sides slip.
    Slip = 2,
}

/// Friction at a node, as the body of the node feels it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointFriction {
    /// The force of friction on the body.
    pub force: [f64; 3],
    /// The slip of the body beside the other side.
    pub slip: [f64; 3],
    /// Whether the sides stick or slip.
    pub state: ContactState,
}

/// The three arrays; every entry is finite, and 0 where there is no friction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FrictionFields {
    /// Forces of friction, then these over the areas of the points; three components each.
    pub shear: Vec<f64>,
    /// Three components each.
    pub slip: Vec<f64>,
    pub state: Vec<i32>,
}

impl FrictionFields {
    pub fn new(points: usize) -> FrictionFields {
        FrictionFields {
            shear: vec![0.0; 3 * points],
            slip: vec![0.0; 3 * points],
            state: vec![0; points],
        }
    }

    /// Adds a node at a point. Where several interfaces meet, forces add up, and slip and state are the largest ones.
    pub fn add(&mut self, point: usize, at: &PointFriction) {
        let Some(state) = self.state.get_mut(point) else {
            return;
        };
        *state = (*state).max(at.state as i32);
        let own = 3 * point..3 * point + 3;
        let shear = self.shear[own.clone()].iter_mut().zip(at.force);
        shear.for_each(|(to, force)| *to += force);
        let square = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>();
        if square(&at.slip) > square(&self.slip[own.clone()]) {
            self.slip[own].copy_from_slice(&at.slip);
        }
    }

    /// Turns forces into stresses; where there is no area the stress is 0.
    pub fn divide(&mut self, area: &[f64]) {
        for (p, shear) in self.shear.chunks_exact_mut(3).enumerate() {
            match area.get(p) {
                Some(&area) if area > 0.0 => shear.iter_mut().for_each(|s| *s /= area),
                _ => shear.fill(0.0),
            }
        }
    }

    /// The grid with the arrays attached as point data.
    pub fn on<'a>(&'a self, grid: Vtu<'a>) -> Vtu<'a> {
        grid.point_data("shear", 3, &self.shear[..])
            .point_data("slip", 3, &self.slip[..])
            .point_data("contact_state", 1, &self.state[..])
    }
}
