//! Points that are far from each other: what fixes a body at them holds every rigid motion, and holds it well.

use super::vec3::{dot, minus, norm};

/// Points are well apart if their distance is at least this much of the largest possible one.
const APART: f64 = 0.5;

/// Points lie on a line if none is farther from it than this fraction of its length.
const FLAT: f64 = 1e-6;

/// Adds places to `chosen` until it has two that are well apart and, if `third` is wanted, one that is well apart from
/// the line through them.
pub fn complete(n: usize, at: impl Fn(usize) -> [f64; 3], third: bool, chosen: &mut Vec<usize>) {
    let farthest = |from: &dyn Fn(usize) -> f64| {
        (0..n).max_by(|&a, &b| from(a).total_cmp(&from(b)).then(b.cmp(&a)))
    };
    let mut middle = [0.0; 3];
    for k in 0..n {
        (0..3).for_each(|d| middle[d] += at(k)[d] / n as f64);
    }
    let Some(a) = farthest(&|k| distance(at(k), middle)) else {
        return;
    };
    let Some(b) = farthest(&|k| distance(at(k), at(a))) else {
        return;
    };
    if chosen.is_empty() {
        chosen.push(a);
    }
    let length = distance(at(a), at(b));
    let (p, mut q) = widest(&at, chosen);
    if distance(at(p), at(q)) < APART * length {
        // One of a and b is at least half of the length away from p.
        let Some(far) = farthest(&|k| distance(at(k), at(p))) else {
            return;
        };
        chosen.push(far);
        q = far;
    }
    if !third {
        return;
    }
    let height = |k: usize| from_line(at(k), at(p), at(q));
    let Some(top) = farthest(&height) else { return };
    let most = height(top);
    let have = chosen.iter().map(|&c| height(c)).fold(0.0, f64::max);
    if most > FLAT * length && have < APART * most {
        chosen.push(top);
    }
}

/// The two of the chosen that are farthest apart.
fn widest(at: &impl Fn(usize) -> [f64; 3], chosen: &[usize]) -> (usize, usize) {
    let mut best = (-1.0, (chosen[0], chosen[0]));
    for (k, &a) in chosen.iter().enumerate() {
        for &b in &chosen[k + 1..] {
            let d = distance(at(a), at(b));
            if d > best.0 {
                best = (d, (a, b));
            }
        }
    }
    best.1
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(minus(a, b))
}

/// The distance of `x` from the line through `a` and `b`.
fn from_line(x: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    let length = distance(a, b);
    if length == 0.0 {
        return distance(x, a);
    }
    let (u, v) = (minus(b, a), minus(x, a));
    let along = dot(u, v) / (length * length);
    let foot = [0, 1, 2].map(|d| a[d] + along * u[d]);
    distance(x, foot)
}
