//! Rigid motions: where the copies of a body stand.

use base::linalg::orthogonal::{Matrix, IDENTITY};
use base::linalg::vec3::{dot, unit};

/// A rotation about the origin, then a translation: x becomes R x + t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Isometry {
    /// R, by rows.
    pub turn: [[f64; 3]; 3],
    /// t.
    pub shift: [f64; 3],
}

impl Isometry {
    /// A translation.
    pub fn shift(shift: [f64; 3]) -> Isometry {
        let turn = IDENTITY;
        Isometry { turn, shift }
    }

    /// A rotation by an angle in degrees about an axis through the origin, then a translation. In the plane the axis is
    /// z. `None` if the axis is 0 or something is not finite.
    ///
    /// ```
    /// use fetifeti_scene::Isometry;
    ///
    /// let motion = Isometry::about([0.0, 0.0, 2.0], 90.0, [5.0, 0.0, 0.0]).expect("an axis");
    /// assert_eq!(motion.apply([1.0, 2.0, 3.0]), [3.0, 1.0, 3.0]);
    /// assert_eq!(motion.invert([3.0, 1.0, 3.0]), [1.0, 2.0, 3.0]);
    /// assert!(Isometry::about([0.0; 3], 90.0, [0.0; 3]).is_none());
    /// ```
    pub fn about(axis: [f64; 3], degrees: f64, shift: [f64; 3]) -> Option<Isometry> {
        let finite = degrees.is_finite() && axis.iter().chain(&shift).all(|v| v.is_finite());
        let axis = unit(axis).filter(|_| finite)?;
        let [sin, cos] = sine_and_cosine(degrees);
        let [x, y, z] = axis;
        // R = cos I + sin [axis]× + (1 − cos) axis axisᵀ
        let across = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        let mut turn = [[0.0; 3]; 3];
        for (i, row) in turn.iter_mut().enumerate() {
            for (j, r) in row.iter_mut().enumerate() {
                *r = cos * IDENTITY[i][j] + sin * across[i][j] + (1.0 - cos) * axis[i] * axis[j];
            }
        }
        Some(Isometry { turn, shift })
    }

    /// Whether nothing turns.
    pub fn is_shift(&self) -> bool {
        self.turn == IDENTITY
    }

    /// Axes, as rows, that are turned along.
    pub(crate) fn turned(&self, axes: &Matrix) -> Matrix {
        if self.is_shift() {
            return *axes;
        }
        axes.map(|axis| self.turn.map(|row| dot(row, axis)))
    }

    /// R x + t.
    pub fn apply(&self, x: [f64; 3]) -> [f64; 3] {
        let turned = if self.is_shift() {
            x
        } else {
            self.turn.map(|row| dot(row, x))
        };
        [0, 1, 2].map(|d| turned[d] + self.shift[d])
    }

    /// Rᵀ (y − t).
    pub fn invert(&self, y: [f64; 3]) -> [f64; 3] {
        let back = [0, 1, 2].map(|d| y[d] - self.shift[d]);
        if self.is_shift() {
            back
        } else {
            [0, 1, 2].map(|d| (0..3).map(|k| self.turn[k][d] * back[k]).sum())
        }
    }

    /// This motion after another one.
    #[must_use]
    pub fn after(&self, first: &Isometry) -> Isometry {
        let product = |a: &Matrix, b: &Matrix| {
            a.map(|row| [0, 1, 2].map(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
        };
        Isometry {
            turn: product(&self.turn, &first.turn),
            shift: self.apply(first.shift),
        }
    }
}

/// Sine and cosine of an angle in degrees, exact for right angles: bodies turned by them meet as those that are not.
fn sine_and_cosine(degrees: f64) -> [f64; 2] {
    let within = degrees.rem_euclid(360.0);
    let quarter = (within / 90.0).round();
    let (sin, cos) = (within - 90.0 * quarter).to_radians().sin_cos();
    match quarter as u32 % 4 {
        0 => [sin, cos],
        1 => [cos, -sin],
        2 => [-sin, -cos],
        _ => [-cos, sin],
    }
}
