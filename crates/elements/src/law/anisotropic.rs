//! Laws of 21 constants.

use super::{number, Constants, Tangent};

/// The entries D_1111, D_1122, D_2222, D_1133, D_2233, D_3333, D_1112, D_2212, D_3312, D_1212, D_1113, D_2213, D_3313,
/// D_1213, D_1313, D_1123, D_2223, D_3323, D_1223, D_1323, D_2323: the order of *ELASTIC, TYPE=ANISO.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anisotropic(pub [f64; 21]);

/// Our components of 11, 22, 33, 12, 13, 23.
const ORDER: [usize; 6] = [0, 1, 2, 3, 5, 4];

impl Constants for Anisotropic {
    fn tangent(&self) -> Result<Tangent, String> {
        let mut c = [[0.0; 6]; 6];
        let mut entries = self.0.iter();
        for col in 0..6 {
            for (row, &value) in (0..=col).zip(entries.by_ref()) {
                number("anisotropic", value, true, "a finite number")?;
                let (i, j) = (ORDER[row], ORDER[col]);
                (c[i][j], c[j][i]) = (value, value);
            }
        }
        Ok(Tangent(c))
    }
}
