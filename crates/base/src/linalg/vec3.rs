//! Vectors of three components; those of the plane end in 0.

/// a · b.
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// |a|.
pub fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// a / |a|; `None` for 0.
pub fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(a);
    (length > 0.0).then(|| a.map(|v| v / length))
}

/// a − b.
pub fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|d| a[d] - b[d])
}

/// a × b.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The unit vectors that are perpendicular to the unit vector `n`: one in the plane, two in space. Along an axis they
/// are axes.
pub fn tangents(n: [f64; 3], dim: usize) -> Vec<[f64; 3]> {
    if dim == 2 {
        return vec![[0.0 - n[1], n[0], 0.0]];
    }
    let least = (0..3).min_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs()));
    let mut first = [0.0; 3];
    first[least.expect("three components")] = 1.0;
    let along = dot(first, n);
    let mut first: [f64; 3] = std::array::from_fn(|c| first[c] - along * n[c]);
    let size = dot(first, first).sqrt();
    first.iter_mut().for_each(|v| *v /= size);
    vec![first, cross(n, first)]
}

/// Centre and radius of the ball around a box from `low` to `high`.
pub fn ball([low, high]: [[f64; 3]; 2]) -> ([f64; 3], f64) {
    let centre = [0, 1, 2].map(|d| 0.5 * (low[d] + high[d]));
    (centre, 0.5 * norm(minus(high, low)))
}

#[cfg(test)]
#[path = "../../tests/linalg/vec3.rs"]
mod tests;
