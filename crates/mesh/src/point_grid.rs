//! Points by cells of equal width: which are in a box, without a look at all.

use std::collections::HashMap;

/// Numbered points by cells of equal width.
pub struct PointGrid {
    cells: HashMap<[i64; 3], Vec<usize>>,
    width: f64,
}

impl PointGrid {
    /// These numbered points in cells of this width.
    pub fn new(points: impl Iterator<Item = (usize, [f64; 3])>, width: f64) -> PointGrid {
        let mut grid = PointGrid {
            cells: HashMap::new(),
            width,
        };
        for (k, x) in points {
            grid.cells.entry(grid.cell(x)).or_default().push(k);
        }
        grid
    }

    fn cell(&self, x: [f64; 3]) -> [i64; 3] {
        x.map(|v| (v / self.width).floor() as i64)
    }

    /// The points in the cells that meet a box.
    pub fn within(&self, low: [f64; 3], high: [f64; 3]) -> impl Iterator<Item = usize> + '_ {
        let (a, b) = (self.cell(low), self.cell(high));
        // A box that is large beside the cells has more of them than there are with points.
        let many = (0..3).map(|d| b[d] as f64 - a[d] as f64 + 1.0);
        let large = many.product::<f64>() > self.cells.len() as f64;
        let every = || {
            let rows = (a[2]..=b[2]).flat_map(move |k| (a[1]..=b[1]).map(move |j| [j, k]));
            rows.flat_map(move |[j, k]| (a[0]..=b[0]).map(move |i| [i, j, k]))
        };
        let held = || {
            let inside = |c: &&[i64; 3]| (0..3).all(|d| (a[d]..=b[d]).contains(&c[d]));
            let mut held: Vec<[i64; 3]> = self.cells.keys().filter(inside).copied().collect();
            held.sort_by_key(|&[i, j, k]| [k, j, i]);
            held
        };
        let (every, held) = ((!large).then(every), large.then(held));
        let cells = every.into_iter().flatten();
        let cells = cells.chain(held.into_iter().flatten());
        cells.filter_map(|c| self.cells.get(&c)).flatten().copied()
    }

    /// The points in the cells that meet the cube of half width `near` around a point.
    pub fn around(&self, x: [f64; 3], near: f64) -> impl Iterator<Item = usize> + '_ {
        self.within(x.map(|v| v - near), x.map(|v| v + near))
    }
}

#[cfg(test)]
#[path = "../tests/point_grid.rs"]
mod tests;
