//! Triangles whose size follows a function: fine where something happens, coarse away from it.

use super::planform::Planform;

/// Points on the segment from `a` to `b`, both included, whose distances are about `size`.
pub(crate) fn graded_line(
    a: [f64; 2],
    b: [f64; 2],
    size: &dyn Fn([f64; 2]) -> f64,
) -> Vec<[f64; 2]> {
    let at = |t: f64| [0, 1].map(|d| a[d] + (b[d] - a[d]) * t);
    along(&at, (b[0] - a[0]).hypot(b[1] - a[1]), size, [a, b])
}

/// Points on an arc between two angles, as [`graded_line`].
pub(crate) fn graded_arc(
    centre: [f64; 2],
    radius: f64,
    [from, to]: [f64; 2],
    size: &dyn Fn([f64; 2]) -> f64,
) -> Vec<[f64; 2]> {
    let at = |t: f64| {
        let (s, c) = (from + (to - from) * t).sin_cos();
        let on = [centre[0] + radius * c, centre[1] + radius * s];
        // Other curves end on the axes of the circle: to the last bit.
        [0, 1].map(|d| {
            if (on[d] - centre[d]).abs() < 1e-14 * radius {
                centre[d]
            } else {
                on[d]
            }
        })
    };
    along(&at, radius * (to - from).abs(), size, [at(0.0), at(1.0)])
}

/// Points on the curve `at`, 0 ≤ t ≤ 1, of about constant speed `length`, with equal ∫ ds / size between them.
pub(crate) fn along(
    at: &dyn Fn(f64) -> [f64; 2],
    length: f64,
    size: &dyn Fn([f64; 2]) -> f64,
    ends: [[f64; 2]; 2],
) -> Vec<[f64; 2]> {
    const SAMPLES: usize = 4000;
    let step = 1.0 / SAMPLES as f64;
    let mut sums = vec![0.0];
    for k in 0..SAMPLES {
        let middle = at((k as f64 + 0.5) * step);
        sums.push(sums[k] + length * step / size(middle));
    }
    let whole = sums[SAMPLES];
    let n = (whole.ceil() as usize).max(1);
    let inner = (1..n).map(|k| {
        let wanted = whole * k as f64 / n as f64;
        let after = sums.partition_point(|s| *s < wanted).clamp(1, SAMPLES);
        let part = (wanted - sums[after - 1]) / (sums[after] - sums[after - 1]);
        at((after as f64 - 1.0 + part) * step)
    });
    let [first, last] = ends;
    std::iter::once(first).chain(inner).chain([last]).collect()
}

/// Fills a convex region with triangles whose edges are about `size` long. `outline` goes once around it, and its
/// last point is its first.
pub(crate) fn graded(outline: &[[f64; 2]], size: &dyn Fn([f64; 2]) -> f64) -> Planform {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for p in outline {
        for d in 0..2 {
            low[d] = low[d].min(p[d]);
            high[d] = high[d].max(p[d]);
        }
    }
    let side = (high[0] - low[0]).max(high[1] - low[1]);
    let mut seeds = Vec::new();
    let mut squares = vec![(low, side)];
    while let Some((corner, side)) = squares.pop() {
        let middle = corner.map(|x| x + 0.5 * side);
        let wanted = size(middle);
        if side > wanted {
            let half = 0.5 * side;
            for k in [0, 1, 2, 3] {
                let at = [
                    corner[0] + half * (k & 1) as f64,
                    corner[1] + half * (k >> 1) as f64,
                ];
                squares.push((at, half));
            }
            continue;
        }
        // A point near the middle of a square of about the size: no two triangles are equal.
        let shake = |k: usize| 0.4 * side * (noise(middle, k) - 0.5);
        let seed = [middle[0] + shake(0), middle[1] + shake(1)];
        if inside(outline, seed) > 0.5 * side {
            seeds.push(seed);
        }
    }
    // In the order of places, not of the search.
    seeds.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    Planform::over(&[outline.to_vec()], &seeds, None, |p| {
        inside(outline, p) > 0.0
    })
}

/// A number between 0 and 1 without a pattern.
fn noise([x, y]: [f64; 2], k: usize) -> f64 {
    let t = (12.9898 * x + 78.233 * y + 37.719 * k as f64).sin() * 43758.5453;
    t - t.floor()
}

/// The distance of a point from a convex outline, positive inside; it runs counterclockwise.
fn inside(outline: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let distance = |pair: &[[f64; 2]]| {
        let [a, b] = [pair[0], pair[1]];
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        (u[0] * v[1] - u[1] * v[0]) / u[0].hypot(u[1])
    };
    outline
        .windows(2)
        .map(distance)
        .fold(f64::INFINITY, f64::min)
}

/// Triangles of 6 nodes: corners, then middles of edges. `place` puts the middle of an edge between two nodes of the
/// boundary onto a curve.
pub(crate) fn quadratic(
    plan: &Planform,
    place: &dyn Fn([[f64; 2]; 2]) -> Option<[f64; 2]>,
) -> (Vec<[f64; 2]>, Vec<Vec<u32>>) {
    let mut points = plan.points.clone();
    let mut middles = std::collections::HashMap::new();
    let mut cells = Vec::with_capacity(plan.triangles.len());
    for corners in &plan.triangles {
        let mut cell: Vec<u32> = corners.iter().map(|&n| n as u32).collect();
        for k in 0..3 {
            let [a, b] = [corners[k], corners[(k + 1) % 3]];
            let node = *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                let ends = [a, b].map(|n| plan.points[n]);
                let straight = [0, 1].map(|d| 0.5 * (ends[0][d] + ends[1][d]));
                points.push(place(ends).unwrap_or(straight));
                points.len() as u32 - 1
            });
            cell.push(node);
        }
        cells.push(cell);
    }
    (points, cells)
}
