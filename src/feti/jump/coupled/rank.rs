//! The rank of sparse rows, by Gaussian elimination with threshold complete pivoting.
//!
//! Pivots in a fixed order would not do: some hat functions of a fine side, seen from a coarse one, are nearly
//! dependent when the others are left out, although all rows together are as well conditioned as can be. Rounding then
//! grows until a row that depends on others seems not to.

use rustc_hash::FxHashMap;

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
    /// The largest entry that is left, relative to the size of the row.
    largest: f64,
    /// Pivot rows that were subtracted: (step, factor).
    less: Vec<(usize, f64)>,
}

impl Open {
    fn new(row: u32, left: Vec<(u32, f64)>) -> Open {
        Open {
            row,
            size: largest(&left),
            left,
            largest: 1.0,
            less: Vec::new(),
        }
    }

    /// Subtracts the pivot row of this step, whose pivot is entry `at`. Afterwards the dof of the pivot is gone. `met`
    /// gets the dofs that are new in the row.
    fn subtract(
        &mut self,
        step: usize,
        (pivot, at): (&[(u32, f64)], usize),
        met: &mut impl FnMut(u32),
    ) {
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
            let here = mine.next_if(|e| e.0 == j).map(|e| e.1);
            if j == dof {
                continue;
            }
            if here.is_none() {
                met(j);
            }
            out.push((j, here.unwrap_or(0.0) - factor * v));
        }
        out.extend(mine);
        self.left = out;
        self.largest = largest(&self.left) / self.size;
        self.less.push((step, factor));
    }
}

/// The largest absolute value.
fn largest(entries: &[(u32, f64)]) -> f64 {
    entries.iter().fold(0.0f64, |a, e| a.max(e.1.abs()))
}

/// The rows in `on` that follow from the others in `on`; without them these are independent.
pub fn dependent(b: &JumpMatrices, on: &[bool]) -> Vec<DependentRow> {
    let rows = (0..on.len()).filter(|&r| on[r]).map(|r| {
        let (col, val) = b.rows.row(r);
        let entries = col.iter().copied().zip(val.iter().copied());
        Open::new(r as u32, entries.collect())
    });
    let (mut rows, empty): (Vec<Open>, Vec<Open>) = rows.partition(|row| row.size > 0.0);
    // The rows that have, or have had, a dof.
    let mut users: FxHashMap<u32, Vec<usize>> = FxHashMap::default();
    for (i, row) in rows.iter().enumerate() {
        row.left
            .iter()
            .for_each(|e| users.entry(e.0).or_default().push(i));
    }
    let mut open: Vec<usize> = (0..rows.len()).collect();
    let mut pivots: Vec<usize> = Vec::new();
    loop {
        let most = open.iter().map(|&i| rows[i].largest).fold(0.0, f64::max);
        if most <= FOLLOWS {
            break;
        }
        let good = (0..open.len()).filter(|&k| rows[open[k]].largest >= THRESHOLD * most);
        let sparsest = good.min_by_key(|&k| (rows[open[k]].left.len(), rows[open[k]].row));
        let chosen = open.swap_remove(sparsest.expect("the largest one is good"));
        let pivot = rows[chosen].left.clone();
        let by_size = |&i: &usize, &j: &usize| {
            let size = |i: usize| pivot[i].1.abs();
            size(i).total_cmp(&size(j)).then(j.cmp(&i))
        };
        let at = (0..pivot.len()).max_by(by_size);
        let at = at.expect("something is left of the row");
        let step = pivots.len();
        pivots.push(chosen);
        rows[chosen].largest = -1.0;
        for i in users.remove(&pivot[at].0).unwrap_or_default() {
            // A row that is a pivot itself stays as it is.
            if rows[i].largest < 0.0 {
                continue;
            }
            let mut met = |dof| users.entry(dof).or_default().push(i);
            rows[i].subtract(step, (&pivot, at), &mut met);
        }
    }
    let dependent = open.iter().map(|&i| &rows[i]).chain(&empty);
    let mut out: Vec<DependentRow> = dependent.map(|d| combined(d, (&rows, &pivots))).collect();
    out.sort_by_key(|d| d.row);
    out
}

/// A row of which nothing is left, as a combination of rows of B: pivot row = row of B − Σ factor · earlier pivot row.
fn combined(dependent: &Open, (rows, pivots): (&[Open], &[usize])) -> DependentRow {
    let mut factors = vec![0.0; pivots.len()];
    for &(step, factor) in &dependent.less {
        factors[step] += factor;
    }
    let mut combination = Vec::new();
    for (step, &pivot) in pivots.iter().enumerate().rev() {
        let pivot = &rows[pivot];
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
