//! The minimiser of a convex, piecewise quadratic function φ, by Newton's method with steps to the least value along
//! each direction.
//!
//! Along a line the slope φ' is continuous, increasing and piecewise linear. Newton's method on φ' ends after a handful
//! of evaluations, because it is exact on the piece with the minimum. Bisection takes over where it leaves the bracket.

use super::tuning::Tuning;

/// A convex, piecewise quadratic function φ, a point, and a direction from it.
pub trait PiecewiseQuadratic {
    /// Computes Newton's direction at the point. Returns whether there is one: at the minimum there is none.
    fn direct(&mut self) -> bool;

    /// φ' and φ'' at t along the direction.
    fn slope(&self, t: f64) -> [f64; 2];

    /// Goes t along the direction. Returns whether that was more than rounding.
    fn go(&mut self, t: f64) -> bool;
}

/// Takes the point of `function` to its minimum, in at most `steps` steps of Newton's method.
pub fn minimise(function: &mut impl PiecewiseQuadratic, steps: usize, tuning: &Tuning) {
    for _ in 0..steps {
        if !function.direct() {
            return;
        }
        let length = line_minimum(|t| function.slope(t), true, tuning);
        if !length.is_some_and(|t| function.go(t)) {
            return;
        }
    }
}

/// The t in (0, 1], or in (0, ∞) if it may go `beyond`, that minimises φ; `None` if φ does not fall at 0. `slope`
/// returns φ'(t) and φ''(t).
pub fn line_minimum(slope: impl Fn(f64) -> [f64; 2], beyond: bool, tuning: &Tuning) -> Option<f64> {
    // NaN is no descent either.
    let falls = slope(0.0)[0] < 0.0;
    if !falls {
        return None;
    }
    let (mut low, mut high, mut t) = (0.0, 1.0, 1.0);
    for _ in 0..tuning.line_evaluations {
        let [first, second] = slope(t);
        if first <= 0.0 {
            if t == 1.0 && !beyond {
                return Some(1.0);
            }
            low = t;
            if t == high {
                high *= 2.0;
                t = high;
                continue;
            }
        } else {
            high = t;
        }
        let newton = t - first / second;
        let next = if low < newton && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - t).abs() <= tuning.line_same * next {
            break;
        }
        t = next;
    }
    Some(if t > 0.0 { t } else { high })
}

#[cfg(test)]
#[path = "../../tests/inside/contact/piecewise_quadratic.rs"]
mod tests;
