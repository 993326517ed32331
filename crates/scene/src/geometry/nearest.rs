//! The nearest of many points: a k-d tree.

/// Points in a balanced tree, stored as an array: the root of a range is its middle.
pub(crate) struct Nearest {
    /// The points in the order of the tree, with their numbers.
    points: Vec<([f64; 3], u32)>,
}

/// The coordinate along which the tree is split at a depth.
fn axis(depth: usize) -> usize {
    depth % 3
}

impl Nearest {
    pub fn new(points: &[[f64; 3]]) -> Nearest {
        let mut points: Vec<([f64; 3], u32)> = points
            .iter()
            .enumerate()
            .map(|(k, &point)| (point, k as u32))
            .collect();
        split(&mut points, 0);
        Nearest { points }
    }

    /// The point nearest to `x`; of several the one of lowest number.
    pub fn find(&self, x: [f64; 3]) -> Option<usize> {
        let mut best = (f64::INFINITY, u32::MAX);
        search(&self.points, 0, x, &mut best);
        (best.1 != u32::MAX).then_some(best.1 as usize)
    }
}

fn split(points: &mut [([f64; 3], u32)], depth: usize) {
    if points.len() < 2 {
        return;
    }
    let (middle, d) = (points.len() / 2, axis(depth));
    points.select_nth_unstable_by(middle, |a, b| a.0[d].total_cmp(&b.0[d]).then(a.1.cmp(&b.1)));
    let (low, high) = points.split_at_mut(middle);
    split(low, depth + 1);
    split(&mut high[1..], depth + 1);
}

fn search(points: &[([f64; 3], u32)], depth: usize, x: [f64; 3], best: &mut (f64, u32)) {
    let Some(&(point, number)) = points.get(points.len() / 2) else {
        return;
    };
    let square = (0..3).map(|d| (point[d] - x[d]).powi(2)).sum();
    if (square, number) < *best {
        *best = (square, number);
    }
    let (low, rest) = points.split_at(points.len() / 2);
    let (high, d) = (&rest[1..], axis(depth));
    let away = x[d] - point[d];
    let (near, far) = if away < 0.0 { (low, high) } else { (high, low) };
    search(near, depth + 1, x, best);
    // The other half is behind a plane; an equal distance may have a lower number.
    if away * away <= best.0 {
        search(far, depth + 1, x, best);
    }
}

#[cfg(test)]
#[path = "../../tests/geometry/nearest.rs"]
mod tests;
