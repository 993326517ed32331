//! Application of an operator to many columns of multipliers that live near one body each. Columns whose images do not
//! overlap share a product.

use super::graph::BodyGraph;
use super::rows::KernelRows;
use crate::Result;
use petsc::Vec as PetscVec;

/// This rank's entries of a column of multipliers.
#[derive(Debug, Clone, Default)]
pub struct MultiplierColumn {
    /// (owned row, value), by increasing row.
    pub entries: Vec<(u32, f64)>,
    /// Bodies that the column's rows touch: the operator reaches the rows of these bodies. The same on every rank.
    pub reach: Vec<u32>,
}

/// Sets of columns that can share a product.
fn groups(graph: &BodyGraph, columns: &[MultiplierColumn]) -> Vec<Vec<usize>> {
    // For each group, the bodies that its columns reach, and their neighbours.
    let mut taken: Vec<Vec<bool>> = Vec::new();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (c, column) in columns.iter().enumerate() {
        let fits = |taken: &Vec<bool>| column.reach.iter().all(|&b| !taken[b as usize]);
        let g = taken.iter().position(fits).unwrap_or_else(|| {
            taken.push(vec![false; graph.n]);
            groups.push(Vec::new());
            groups.len() - 1
        });
        for b in graph.around(&column.reach) {
            taken[g][b as usize] = true;
        }
        groups[g].push(c);
    }
    groups
}

/// Number of products at a time.
const TOGETHER: usize = 8;

/// The images of all columns under `apply`, an operator on several vectors laid out like `like`. It must lead from a
/// row to rows of the bodies that the row touches and no further. Collective.
pub fn images(
    like: &PetscVec,
    graph: &BodyGraph,
    columns: &[MultiplierColumn],
    mut apply: impl FnMut(&[PetscVec], &[PetscVec]) -> Result<()>,
) -> Result<Vec<MultiplierColumn>> {
    let groups = groups(graph, columns);
    let vectors = || {
        let n = groups.len().min(TOGETHER);
        (0..n).map(|_| like.duplicate()).collect::<Result<Vec<_>>>()
    };
    let (xs, ys) = (vectors()?, vectors()?);
    let mut out: Vec<MultiplierColumn> = vec![MultiplierColumn::default(); columns.len()];
    const NONE: u32 = u32::MAX;
    let mut owner = vec![NONE; graph.n];
    for batch in groups.chunks(TOGETHER) {
        let (xs, ys) = (&xs[..batch.len()], &ys[..batch.len()]);
        for (group, x) in batch.iter().zip(xs) {
            x.set(0.0)?;
            let mut x = x.array_mut()?;
            for &(row, value) in group.iter().flat_map(|&c| &columns[c].entries) {
                x[row as usize] = value;
            }
        }
        apply(xs, ys)?;
        for (group, y) in batch.iter().zip(ys) {
            owner.fill(NONE);
            for &c in group {
                for &b in &columns[c].reach {
                    owner[b as usize] = c as u32;
                }
                out[c].reach = graph.around(&columns[c].reach);
            }
            for (row, &value) in y.array()?.iter().enumerate().filter(|v| *v.1 != 0.0) {
                let bodies = graph.touched.at(row).iter();
                let column = bodies.map(|&b| owner[b as usize]).find(|&c| c != NONE);
                if let Some(c) = column {
                    out[c as usize].entries.push((row as u32, value));
                }
            }
        }
    }
    Ok(out)
}

/// The columns of G or Q G, which are given by rows. `reach` has, for each body, the bodies that it touches.
pub fn kernel_columns(
    rows: &KernelRows,
    start: &[usize],
    reach: impl Fn(usize) -> Vec<u32>,
) -> Vec<MultiplierColumn> {
    let mut columns = vec![MultiplierColumn::default(); *start.last().unwrap_or(&0)];
    for body in 0..start.len().saturating_sub(1) {
        for column in &mut columns[start[body]..start[body + 1]] {
            column.reach = reach(body);
        }
    }
    for i in 0..rows.n() {
        for (c, value) in rows.row(i) {
            columns[c].entries.push((i as u32, value));
        }
    }
    columns
}
