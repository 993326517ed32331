//! The elastic laws of a body that are not isotropic, and the axes along which their constants count.

use super::motion::Isometry;
use base::linalg::orthogonal::IDENTITY;
use base::linalg::vec3::{cross, dot, norm, tangents, unit};
use elements::law::Tangent;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

/// The laws of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct LawSpec {
    /// The laws.
    pub laws: Vec<OrientedLaw>,
    /// The number of the law of every cell of a mesh, [`LawSpec::ISOTROPIC`] for those with E and ν of the body; empty:
    /// the first everywhere.
    pub of_cell: Vec<u32>,
}

impl LawSpec {
    /// The number of no law: E and ν of the body.
    pub const ISOTROPIC: u32 = u32::MAX;

    /// One law for the whole body.
    pub fn everywhere(law: OrientedLaw) -> LawSpec {
        LawSpec {
            laws: vec![law],
            of_cell: Vec::new(),
        }
    }

    /// The law of a cell; `None` if it is isotropic.
    pub fn of(&self, cell: usize) -> Option<&OrientedLaw> {
        self.laws.get(self.number(cell) as usize)
    }

    /// A number that is equal for equal laws and axes.
    pub(crate) fn key(&self) -> u64 {
        let mut state = DefaultHasher::new();
        self.of_cell.hash(&mut state);
        for law in &self.laws {
            let numbers = |numbers: &[f64], state: &mut DefaultHasher| {
                numbers.iter().for_each(|v| v.to_bits().hash(state));
            };
            numbers(law.tangent.0.as_flattened(), &mut state);
            numbers(law.axes.at([0.0; 3]).as_flattened(), &mut state);
        }
        state.finish()
    }

    /// The number of the law of a cell.
    pub fn number(&self, cell: usize) -> u32 {
        match self.of_cell.is_empty() {
            true => 0,
            false => self.of_cell[cell],
        }
    }
}

/// A law and its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrientedLaw {
    /// The law along the axes of the material.
    pub tangent: Tangent,
    /// The axes.
    pub axes: MaterialAxes,
}

/// The axes of a material, in the coordinates of its body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaterialAxes {
    /// Three orthonormal vectors everywhere.
    Fixed([[f64; 3]; 3]),
    /// Radial, around and along an axis.
    Cylinder {
        /// A point of the axis.
        centre: [f64; 3],
        /// Its direction, of length one.
        axis: [f64; 3],
        /// How the three axes are turned at each point: rows of the new ones along the old ones.
        turn: [[f64; 3]; 3],
    },
}

impl MaterialAxes {
    /// The axes at a point.
    pub fn at(&self, point: [f64; 3]) -> [[f64; 3]; 3] {
        match self {
            MaterialAxes::Fixed(axes) => *axes,
            MaterialAxes::Cylinder { centre, axis, turn } => {
                let away: [f64; 3] = std::array::from_fn(|d| point[d] - centre[d]);
                let along = dot(away, *axis);
                let out: [f64; 3] = std::array::from_fn(|d| away[d] - along * axis[d]);
                // On the axis all directions are alike.
                let radial = unit(out).unwrap_or_else(|| tangents(*axis, 3)[0]);
                let own = [radial, cross(*axis, radial), *axis];
                let row = |r: &[f64; 3]| -> [f64; 3] {
                    std::array::from_fn(|d| (0..3).map(|k| r[k] * own[k][d]).sum())
                };
                [row(&turn[0]), row(&turn[1]), row(&turn[2])]
            }
        }
    }

    /// Whether the axes do not depend on the point.
    pub fn is_fixed(&self) -> bool {
        matches!(self, MaterialAxes::Fixed(_))
    }
}

impl OrientedLaw {
    /// The law at a point of the body's own coordinates, in the axes of space; `frame` says how the body lies in it.
    pub fn at(&self, point: [f64; 3], frame: Option<&Isometry>) -> Tangent {
        let own = self.axes.at(point);
        if own == IDENTITY && frame.is_none_or(Isometry::is_shift) {
            return self.tangent;
        }
        let placed = match frame {
            Some(frame) => frame.turned(&own),
            None => own,
        };
        self.tangent.along(&placed)
    }
}

/// The sine of the angle below which two directions count as one.
const PARALLEL: f64 = 1e-6;

/// The axes whose first is along `first` and whose second lies in the plane of both vectors; `None` if they are
/// parallel.
pub fn axes_of(first: [f64; 3], second: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    let (x, second) = (unit(first)?, unit(second)?);
    let normal = cross(x, second);
    let z = unit(normal).filter(|_| norm(normal) > PARALLEL)?;
    Some([x, cross(z, x), z])
}

#[cfg(test)]
#[path = "../../tests/model/law.rs"]
mod tests;
