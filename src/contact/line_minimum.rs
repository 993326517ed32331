//! The minimiser of a convex, piecewise quadratic function along a line, from its slope.
//!
//! The slope φ' is continuous, increasing and piecewise linear. Newton's method on φ' ends after a handful of
//! evaluations, because it is exact on the piece with the minimum. Bisection takes over where it leaves the bracket.

/// Largest number of evaluations of φ'.
const EVALUATIONS: usize = 60;

/// Two lengths that differ by less than this part are one.
const SAME: f64 = 1e-12;

/// The t in (0, 1], or in (0, ∞) if it may go `beyond`, that minimises φ; `None` if φ does not fall at 0. `slope`
/// returns φ'(t) and φ''(t).
pub fn line_minimum(slope: impl Fn(f64) -> [f64; 2], beyond: bool) -> Option<f64> {
    // NaN is no descent either.
    let falls = slope(0.0)[0] < 0.0;
    if !falls {
        return None;
    }
    let (mut low, mut high, mut t) = (0.0, 1.0, 1.0);
    for _ in 0..EVALUATIONS {
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
        if (next - t).abs() <= SAME * next {
            break;
        }
        t = next;
    }
    Some(if t > 0.0 { t } else { high })
}

#[cfg(test)]
#[path = "../../tests/inside/contact/line_minimum.rs"]
mod tests;
