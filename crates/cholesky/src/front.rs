//! The factorisation of a dense front: a panel of pivots with the rows below them, and the update of these rows,
//! −L₂ L₂ᵀ with L₂ the factor in these rows.

use faer::MatRef;

use super::strips::{strips, STRIP};
use base::linalg::dense::{self, Dense, Scratch};

/// Added to the diagonal entry of a dof that is left out. Its root divides what other dofs have in common with it.
const OUT: f64 = 1e300;

/// Number of columns of a panel in one product. With more of them a product reads them from memory that is further
/// away.
const DEEP: usize = 128;

/// Factors the pivot block, scales the rows below it and computes their update, in [`strips`](super::strips); earlier
/// entries do not count. Returns `Err(j)` if pivot j is below `least`, relative to its diagonal entry. `pause` is
/// called now and then in large fronts.
pub(super) fn factor_front(
    panel: &mut Dense,
    update: &mut [f64],
    diagonal: &[f64],
    least: f64,
    scratch: &mut Scratch,
    pause: &mut dyn FnMut(),
) -> Result<(), usize> {
    let width = panel.cols;
    let (mut pivot, mut below) = panel.view_mut().split_at_row_mut(width);
    let failed = dense::cholesky(pivot.as_mut(), scratch).err();
    let done = failed.map_or(width, |e| e.index);
    for (j, &d) in diagonal.iter().enumerate().take(done) {
        let l = pivot[(j, j)];
        if l * l <= least * d || l.is_nan() {
            return Err(j);
        }
    }
    if done < width {
        return Err(done);
    }
    for start in (0..below.nrows()).step_by(STRIP) {
        let n = STRIP.min(below.nrows() - start);
        let strip = below.as_mut().subrows_mut(start, n);
        dense::solve_right_transpose(pivot.as_ref(), strip);
        pause();
    }
    subtract_square(update, false, below.as_ref(), pause);
    Ok(())
}

/// C ← β C − A Aᵀ for the triangle C, β ∈ {0, 1}.
fn subtract_square(c: &mut [f64], add: bool, a: MatRef<'_, f64>, pause: &mut dyn FnMut()) {
    for strip in strips(a.nrows()) {
        let entries = strip.of(c);
        let (mut square, mut rest) = entries.split_at_row_mut(strip.columns);
        for k in (0..a.ncols()).step_by(DEEP) {
            let add = add || k > 0;
            let a = a
                .subcols(k, DEEP.min(a.ncols() - k))
                .split_at_row(strip.start)
                .1;
            let (across, far) = a.split_at_row(strip.columns);
            dense::rank_k_update(square.as_mut(), add, -1.0, across);
            dense::multiply(rest.as_mut(), add, -1.0, far, across.transpose());
        }
        pause();
    }
}

/// [`factor_front`], but pivots below `least` are replaced. Returns their columns, increasing.
pub(super) fn factor_semidefinite(
    panel: &mut Dense,
    update: &mut [f64],
    diagonal: &[f64],
    least: f64,
    scratch: &mut Scratch,
    pause: &mut dyn FnMut(),
) -> Vec<usize> {
    // Most fronts have no such pivot. Large products take half the time of those of a group.
    let width = panel.cols;
    let square = panel.lower();
    if factor_front(panel, update, diagonal, least, scratch, pause).is_ok() {
        return Vec::new();
    }
    let mut rest = &square[..];
    for j in 0..width {
        let (column, after) = rest.split_at(width - j);
        panel.col_mut(j)[j..width].copy_from_slice(column);
        rest = after;
    }
    factor_by_groups(panel, update, diagonal, least, scratch)
}

/// Number of columns that are factored together where pivots vanish.
const TOGETHER: usize = 48;

/// [`factor_semidefinite`] of a front in which pivots vanish.
fn factor_by_groups(
    panel: &mut Dense,
    update: &mut [f64],
    diagonal: &[f64],
    least: f64,
    scratch: &mut Scratch,
) -> Vec<usize> {
    let (width, size) = (panel.cols, panel.rows);
    let mut weak = Vec::new();
    for start in (0..width).step_by(TOGETHER) {
        let end = (start + TOGETHER).min(width);
        // The columns of the group, from its first row down.
        let mut group = Dense::from_fn(size - start, end - start, |i, j| {
            if i < j {
                0.0
            } else {
                panel.get(start + i, start + j)
            }
        });
        let begin = group.clone();
        let mut held: Vec<usize> = Vec::new();
        loop {
            let mut square = Dense::from_fn(end - start, end - start, |i, j| group.get(i, j));
            let own = &diagonal[start..end];
            match factor_front(&mut square, &mut [], own, least, scratch, &mut || ()) {
                Ok(()) => {
                    (0..end - start).for_each(|j| {
                        group.col_mut(j)[..end - start].copy_from_slice(square.col(j));
                    });
                    break;
                }
                Err(j) => {
                    held.push(j);
                    group.clone_from(&begin);
                    held.iter().for_each(|&j| group.set(j, j, OUT));
                }
            }
        }
        held.sort_unstable();
        weak.extend(held.into_iter().map(|j| start + j));
        let (square, mut below) = group.view_mut().split_at_row_mut(end - start);
        dense::solve_right_transpose(square.as_ref(), below.as_mut());
        for j in start..end {
            panel.col_mut(j)[start..].copy_from_slice(group.col(j - start));
        }
        let below = group.view().subrows(end - start, size - end);
        if end < width {
            let across = below.subrows(0, width - end).transpose();
            let rest = panel
                .view_mut()
                .submatrix_mut(end, end, size - end, width - end);
            let (square, rest) = rest.split_at_row_mut(width - end);
            dense::rank_k_update(square, true, -1.0, across.transpose());
            let below = below.subrows(width - end, size - width);
            dense::multiply(rest, true, -1.0, below, across);
        }
        let far = below.subrows(width - end, size - width);
        subtract_square(update, start > 0, far, &mut || ());
    }
    weak
}

#[cfg(test)]
#[path = "../tests/front.rs"]
mod tests;
