//! The point of a polyhedral cone next to a given one, by the method of Lawson and Hanson for least squares with
//! multipliers that are not negative.

use faer::linalg::solvers::SolveLstsq;
use faer::Mat;

/// A gain relative to the vector's length that counts as none.
const ZERO: f64 = 1e-13;

/// The x nearest to `e` with a·x ≤ 0 for all unit vectors `a` of `below`, and a·x = 0 for those of `equal`.
///
/// x = e − Σ y_a a, where y ≥ 0 minimises the length of x: what is left of `e` when the cone of the rows has taken what
/// it can.
pub fn nearest(e: &[f64], equal: &[Vec<f64>], below: &[Vec<f64>]) -> Vec<f64> {
    let negative = equal
        .iter()
        .map(|a| a.iter().map(|v| -v).collect::<Vec<f64>>());
    let columns: Vec<Vec<f64>> = equal
        .iter()
        .cloned()
        .chain(negative)
        .chain(below.iter().cloned())
        .collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let size = dot(e, e).sqrt();
    let (mut passive, mut y): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut x = e.to_vec();
    let mut refused = vec![false; columns.len()];
    for _ in 0..20 * (columns.len() + 1) {
        let gain = |j: &usize| dot(&columns[*j], &x);
        let candidates = (0..columns.len()).filter(|j| !refused[*j] && !passive.contains(j));
        let best = candidates.max_by(|a, b| gain(a).total_cmp(&gain(b)));
        let Some(next) = best.filter(|j| gain(j) > ZERO * size) else {
            break;
        };
        passive.push(next);
        y.push(0.0);
        while !passive.is_empty() {
            let a = Mat::from_fn(e.len(), passive.len(), |i, j| columns[passive[j]][i]);
            let b = Mat::from_fn(e.len(), 1, |i, _| e[i]);
            let z = a.qr().solve_lstsq(&b);
            let z: Vec<f64> = (0..passive.len()).map(|j| z[(j, 0)]).collect();
            if z.iter().all(|&z| z > 0.0) {
                y = z;
                break;
            }
            let ratio = |j: usize| {
                if z[j] <= 0.0 {
                    y[j] / (y[j] - z[j])
                } else {
                    1.0
                }
            };
            let step = (0..z.len()).map(ratio).fold(1.0, f64::min);
            let stays: Vec<bool> = (0..z.len())
                .map(|j| z[j] > 0.0 || ratio(j) > step)
                .collect();
            let moved: Vec<f64> = y.iter().zip(&z).map(|(y, z)| y + step * (z - y)).collect();
            // A column that leaves as soon as it has come gains nothing but rounding.
            refused[next] |= !stays[passive.len() - 1] && passive.last() == Some(&next);
            y = moved
                .iter()
                .zip(&stays)
                .filter(|(_, stays)| **stays)
                .map(|(y, _)| *y)
                .collect();
            let kept = passive.iter().zip(&stays).filter(|(_, stays)| **stays);
            passive = kept.map(|(j, _)| *j).collect();
        }
        x.copy_from_slice(e);
        for (j, y) in passive.iter().zip(&y) {
            x.iter_mut()
                .zip(&columns[*j])
                .for_each(|(x, a)| *x -= y * a);
        }
    }
    x
}
