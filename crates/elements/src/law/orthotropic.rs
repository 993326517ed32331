//! Orthotropic laws: three planes of symmetry.

use super::{number, Constants, Tangent};

/// The constants along three axes that are orthogonal to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orthotropic {
    /// E_1, E_2, E_3.
    pub young: [f64; 3],
    /// ν_12, ν_13, ν_23: a pull along the first axis shortens the second by ν_12 of its strain; ν_21 = ν_12 E_2/E_1.
    pub poisson: [f64; 3],
    /// G_12, G_13, G_23.
    pub shear: [f64; 3],
}

impl Constants for Orthotropic {
    fn tangent(&self) -> Result<Tangent, String> {
        let [e1, e2, e3] = self.young;
        for (name, values) in [("young", self.young), ("shear", self.shear)] {
            for value in values {
                number(name, value, value > 0.0, "a positive number")?;
            }
        }
        for value in self.poisson {
            number("poisson", value, true, "a finite number")?;
        }
        let [n12, n13, n23] = self.poisson.map(|v| -v);
        let compliance = [
            [1.0 / e1, n12 / e1, n13 / e1],
            [n12 / e1, 1.0 / e2, n23 / e2],
            [n13 / e1, n23 / e2, 1.0 / e3],
        ];
        let [g12, g13, g23] = self.shear;
        Ok(Tangent::of_compliance(compliance, [g12, g23, g13]))
    }
}
