//! Transversely isotropic laws: an axis about which the material is the same in all directions, as fibres have it.

use super::{Constants, Orthotropic, Tangent};

/// The constants along the first axis, that of the fibres, and across it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transverse {
    /// Young's moduli along and across the axis.
    pub young: [f64; 2],
    /// Poisson's ratios: what a pull along the axis shortens across, and what a pull across shortens across.
    pub poisson: [f64; 2],
    /// The shear modulus of planes that have the axis.
    pub shear: f64,
}

impl Constants for Transverse {
    fn tangent(&self) -> Result<Tangent, String> {
        let ([along, across], [first, second]) = (self.young, self.poisson);
        Orthotropic {
            young: [along, across, across],
            poisson: [first, first, second],
            shear: [self.shear, self.shear, across / (2.0 * (1.0 + second))],
        }
        .tangent()
    }
}
