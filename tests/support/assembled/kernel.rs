//! The motions of a body without energy: those of its rigid motions, or of what supports leave of them, that K does not
//! see.

use base::linalg::csr::Csr;
use faer::Mat;
use std::collections::BTreeMap;

/// A sparse vector.
pub type Column = Vec<(usize, f64)>;

/// Combinations of motions with less force than this, relative to that of their parts, have none.
const ZERO: f64 = 1e-11;

/// Columns that span the kernel of K in the span of some columns of one body.
///
/// Most are columns by themselves. A support that leaves a rotation about its own place has a combination in its
/// kernel: the rotation about the body's centre, and a translation.
pub fn kernel(k: &Csr, columns: Vec<Column>) -> Vec<Column> {
    let moves = |z: &Column| z.iter().any(|&(_, v)| v != 0.0);
    let columns = columns.into_iter().filter(moves);
    let (mut out, others): (Vec<Column>, Vec<Column>) = columns.partition(|z| is_kernel(k, z));
    if others.len() < 2 {
        return out;
    }
    let dofs: Vec<usize> = others[0].iter().map(|e| e.0).collect();
    let weight = |i: usize| k.get(i, i).powf(-0.5);
    let forces = |z: &Column| -> Vec<f64> {
        let value: BTreeMap<usize, f64> = z.iter().copied().collect();
        let force = |&i: &usize| {
            let (col, val) = k.row(i);
            let each = col.iter().zip(val);
            each.map(|(&j, v)| v * value.get(&(j as usize)).copied().unwrap_or(0.0))
                .sum::<f64>()
                * weight(i)
        };
        dofs.iter().map(force).collect()
    };
    // Both in the scale of the diagonal.
    let length = |z: &Column| z.iter().map(|&(i, v)| (v / weight(i)).powi(2)).sum::<f64>();
    let norms: Vec<f64> = others.iter().map(|z| length(z).sqrt()).collect();
    let all: Vec<Vec<f64>> = others.iter().map(forces).collect();
    let matrix = Mat::from_fn(dofs.len().max(all.len()), all.len(), |i, j| {
        all[j].get(i).map_or(0.0, |v| v / norms[j])
    });
    let svd = matrix.thin_svd().expect("singular values");
    let values = svd.S().column_vector();
    for c in (0..all.len()).filter(|&c| values[c] <= ZERO) {
        let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
        for (j, z) in others.iter().enumerate() {
            let part = svd.V()[(j, c)] / norms[j];
            z.iter()
                .for_each(|&(i, v)| *sum.entry(i).or_default() += part * v);
        }
        let sum: Column = sum.into_iter().collect();
        // Columns that depend on each other where they are free have sums that do not move.
        if length(&sum) > 1e-12 {
            out.push(sum);
        }
    }
    out
}

/// K z = 0 up to rounding.
fn is_kernel(k: &Csr, column: &Column) -> bool {
    let value: BTreeMap<usize, f64> = column.iter().copied().collect();
    column.iter().all(|&(i, _)| {
        let (col, val) = k.row(i);
        let (mut sum, mut size) = (0.0f64, 0.0f64);
        for (&j, &v) in col.iter().zip(val) {
            let z = value.get(&(j as usize)).copied().unwrap_or(0.0);
            sum += v * z;
            size += (v * z).abs();
        }
        sum.abs() <= 1e-12 * size
    })
}
