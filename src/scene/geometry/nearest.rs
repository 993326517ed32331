//! The nearest of many points.

use std::collections::HashMap;

/// Points in cells of equal size.
pub(crate) struct Nearest {
    points: Vec<[f64; 3]>,
    cells: HashMap<[i64; 3], Vec<u32>>,
    low: [f64; 3],
    width: f64,
    /// Cells along the longest direction.
    reach: i64,
}

impl Nearest {
    pub fn new(points: &[[f64; 3]]) -> Nearest {
        let fold = |d: usize, start: f64, f: fn(f64, f64) -> f64| {
            points.iter().map(|p| p[d]).fold(start, f)
        };
        let low = [0, 1, 2].map(|d| fold(d, f64::INFINITY, f64::min));
        let high = [0, 1, 2].map(|d| fold(d, f64::NEG_INFINITY, f64::max));
        let size = (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        // Points of a surface: about one in each of the cells that it meets.
        let across = (points.len() as f64).sqrt().max(1.0);
        let width = if size > 0.0 { size / across } else { 1.0 };
        let mut out = Nearest {
            points: points.to_vec(),
            cells: HashMap::new(),
            low,
            width,
            reach: across.ceil() as i64 + 1,
        };
        for (k, &point) in points.iter().enumerate() {
            out.cells.entry(out.cell(point)).or_default().push(k as u32);
        }
        out
    }

    fn cell(&self, point: [f64; 3]) -> [i64; 3] {
        [0, 1, 2].map(|d| ((point[d] - self.low[d]) / self.width).floor() as i64)
    }

    /// The point nearest to `x`; the first of several.
    pub fn find(&self, x: [f64; 3]) -> Option<usize> {
        let square = |k: u32| -> f64 {
            let p = self.points[k as usize];
            (0..3).map(|d| (p[d] - x[d]).powi(2)).sum()
        };
        // Outside the box of the points the search begins at its border.
        let centre = self.cell(x).map(|c| c.clamp(0, self.reach));
        let outside = (0..3)
            .map(|d| (self.low[d] + (centre[d] as f64 + 0.5) * self.width - x[d]).abs())
            .fold(0.0, f64::max);
        let mut best: Option<(f64, u32)> = None;
        for ring in 0..=self.reach {
            let safe = (ring - 1) as f64 * self.width - outside;
            if best.is_some_and(|(s, _)| safe > 0.0 && s < safe * safe) {
                break;
            }
            for cell in shell(centre, ring) {
                for &k in self.cells.get(&cell).into_iter().flatten() {
                    let candidate = (square(k), k);
                    if best.is_none_or(|b| candidate < b) {
                        best = Some(candidate);
                    }
                }
            }
        }
        best.map(|(_, k)| k as usize)
    }
}

/// The cells at a distance of `ring` cells.
fn shell([x, y, z]: [i64; 3], ring: i64) -> impl Iterator<Item = [i64; 3]> {
    (-ring..=ring).flat_map(move |k| {
        (-ring..=ring).flat_map(move |j| {
            let whole = k.abs() == ring || j.abs() == ring;
            let step = if whole || ring == 0 { 1 } else { 2 * ring };
            (-ring..=ring)
                .step_by(step as usize)
                .map(move |i| [x + i, y + j, z + k])
        })
    })
}
