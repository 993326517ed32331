//! The rank of sparse rows, by Gaussian elimination with threshold complete pivoting.
//!
//! Pivots in a fixed order would not do: some hat functions of a fine side, seen from a coarse one, are nearly
//! dependent when the others are left out, although all rows together are as well conditioned as can be. Rounding then
//! grows until a row that depends on others seems not to.

use super::pattern::JumpMatrices;

/// A row follows from others if less than this part of its largest entry is left of it. Rounding leaves 1e-15, but B_D
/// has a factor of B D⁻¹ Bᵀ, in which what is left is squared: below √ε nothing would be left there.
const FOLLOWS: f64 = 1e-7;

/// A pivot row has at least this part of what is left, relative to its size, of any row. With 0.1 the rows that are
/// kept of a fine side may be as good as dependent: along a chain of neighbours what is lost at each step multiplies.
const THRESHOLD: f64 = 0.9;

/// A row that follows from others, and the combination that it is: (row, coefficient).
pub struct DependentRow {
    /// The row.
    pub row: u32,
    /// Coefficients of rows that are independent.
    pub combination: Vec<(u32, f64)>,
}

/// A row on its way through the elimination.
struct Open {
    row: u32,
    /// The largest entry of the row in B.
    size: f64,
    /// The rest of it: (dof, value), by increasing dof.
    left: Vec<(u32, f64)>,
    /// Pivot rows that were subtracted: (step, factor).
    less: Vec<(usize, f64)>,
}

impl Open {
    /// The largest entry that is left, relative to the size of the row.
    fn largest(&self) -> f64 {
        let left = self.left.iter();
        left.fold(0.0f64, |a, e| a.max(e.1.abs())) / self.size
    }

    /// Subtracts the pivot row of this step, whose pivot is entry `at`. Afterwards the dof of the pivot is gone.
    fn subtract(&mut self, step: usize, pivot: &[(u32, f64)], at: usize) {
        let (dof, value) = pivot[at];
        let Ok(own) = self.left.binary_search_by_key(&dof, |e| e.0) else {
            return;
        };
        let factor = self.left[own].1 / value;
        let mut out = Vec::with_capacity(self.left.len() + pivot.len());
        let mut mine = self.left.iter().copied().peekable();
        for &(j, v) in pivot {
            while let Some(before) = mine.next_if(|e| e.0 < j) {
                out.push(before);
            }
            let here = mine.next_if(|e| e.0 == j).map_or(0.0, |e| e.1);
            if j != dof {
                out.push((j, here - factor * v));
            }
        }
        out.extend(mine);
        self.left = out;
        self.less.push((step, factor));
    }
}

/// The rows in `on` that follow from the others in `on`; without them these are independent.
pub fn dependent(b: &JumpMatrices, on: &[bool]) -> Vec<DependentRow> {
    let open = (0..on.len()).filter(|&r| on[r]).map(|r| {
        let (col, val) = b.rows.row(r);
        Open {
            row: r as u32,
            size: val.iter().fold(0.0, |a, v| a.max(v.abs())),
            left: col.iter().copied().zip(val.iter().copied()).collect(),
            less: Vec::new(),
        }
    });
    let (mut open, empty): (Vec<Open>, Vec<Open>) = open.partition(|row| row.size > 0.0);
    let mut pivots: Vec<Open> = Vec::new();
    loop {
        let largest: Vec<f64> = open.iter().map(Open::largest).collect();
        let most = largest.iter().copied().fold(0.0, f64::max);
        if most <= FOLLOWS {
            break;
        }
        let good = (0..open.len()).filter(|&i| largest[i] >= THRESHOLD * most);
        let sparsest = good.min_by_key(|&i| (open[i].left.len(), open[i].row));
        let pivot = open.swap_remove(sparsest.expect("the largest one is good"));
        let by_size = |&i: &usize, &j: &usize| {
            let size = |i: usize| pivot.left[i].1.abs();
            size(i).total_cmp(&size(j)).then(j.cmp(&i))
        };
        let at = (0..pivot.left.len()).max_by(by_size);
        let at = at.expect("something is left of the row");
        let step = pivots.len();
        for row in &mut open {
            row.subtract(step, &pivot.left, at);
        }
        pivots.push(pivot);
    }
    let mut out: Vec<DependentRow> = open
        .iter()
        .chain(&empty)
        .map(|d| combined(d, &pivots))
        .collect();
    out.sort_by_key(|d| d.row);
    out
}

/// A row of which nothing is left, as a combination of rows of B: pivot row = row of B − Σ factor · earlier pivot row.
fn combined(dependent: &Open, pivots: &[Open]) -> DependentRow {
    let mut factors = vec![0.0; pivots.len()];
    for &(step, factor) in &dependent.less {
        factors[step] += factor;
    }
    let mut combination = Vec::new();
    for (step, pivot) in pivots.iter().enumerate().rev() {
        let factor = factors[step];
        if factor == 0.0 {
            continue;
        }
        combination.push((pivot.row, factor));
        for &(earlier, less) in &pivot.less {
            factors[earlier] -= factor * less;
        }
    }
    DependentRow {
        row: dependent.row,
        combination,
    }
}
