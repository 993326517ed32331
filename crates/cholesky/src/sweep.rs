//! The way of a solve through the fronts, for one right-hand side and for several side by side.
//!
//! Every front works on one dense vector [x; w]: x at its pivots, w at the rows below them. Four columns of the panel
//! are applied together to all rows below them. The vector is read and written once for four columns, the panel is read
//! once, from one end to the other.

use super::multifrontal::PartialCholesky;
use super::panel::COLUMNS;
use super::symbolic::Front;
use crate::panel;

/// The values of one unknown: a number, or one for each of several right-hand sides.
pub(super) trait SweepValue: Copy + Default {
    /// Adds another.
    fn add(&mut self, other: &Self);

    /// Solves with the square of `N` pivots and subtracts their columns from the rows below, for `work` = [x; rows
    /// below] and a group of columns (`panel.rs`).
    fn eliminate<const N: usize>(group: &[f64], work: &mut [Self]);

    /// Subtracts the products of `N` columns with the rows below and solves with the transposed square.
    fn substitute<const N: usize>(group: &[f64], work: &mut [Self]);
}

impl PartialCholesky {
    /// y ← [L_II⁻¹ y_I; y_Γ − L_ΓI L_II⁻¹ y_I] in the order of elimination.
    pub(super) fn lower<E: SweepValue>(&self, y: &mut [E]) {
        self.lower_of(self.symbolic.fronts.iter(), y);
    }

    /// The part of [`lower`](Self::lower) that these fronts do, which come in the order of elimination.
    pub(super) fn lower_of<'a, E: SweepValue>(
        &self,
        fronts: impl Iterator<Item = &'a Front>,
        y: &mut [E],
    ) {
        let mut work = Vec::new();
        for front in fronts {
            let (width, size) = (front.width(), front.size());
            let (pivots, below) = y[front.start..].split_at_mut(width);
            work.clear();
            work.extend_from_slice(pivots);
            work.resize(size, E::default());
            eliminate(&self.panels[front.panel..], width, &mut work);
            pivots.copy_from_slice(&work[..width]);
            for (&p, w) in front.below.iter().zip(&work[width..]) {
                below[p as usize - front.end].add(w);
            }
        }
    }

    /// y ← [L_II⁻ᵀ (y_I − L_ΓIᵀ y_Γ); y_Γ] in the order of elimination.
    pub(super) fn upper<E: SweepValue>(&self, y: &mut [E]) {
        self.upper_of(self.symbolic.fronts.iter().rev(), y);
    }

    /// The part of [`upper`](Self::upper) that these fronts do, which come in the reverse order of elimination.
    pub(super) fn upper_of<'a, E: SweepValue>(
        &self,
        fronts: impl Iterator<Item = &'a Front>,
        y: &mut [E],
    ) {
        let mut work = Vec::new();
        for front in fronts {
            let width = front.width();
            let (pivots, below) = y[front.start..].split_at_mut(width);
            work.clear();
            work.extend_from_slice(pivots);
            let rows = front.below.iter().map(|&p| below[p as usize - front.end]);
            work.extend(rows);
            substitute(&self.panels[front.panel..], width, &mut work);
            pivots.copy_from_slice(&work[..width]);
        }
    }
}

/// x ← L⁻¹ x and w ← w − L_below x for `work` = [x; w] and a panel of `width` columns.
pub(super) fn eliminate<E: SweepValue>(panel: &[f64], width: usize, work: &mut [E]) {
    let size = work.len();
    for j in (0..width).step_by(COLUMNS) {
        let (group, work) = (&panel[panel::group(j, size)..], &mut work[j..]);
        match width - j {
            1 => E::eliminate::<1>(group, work),
            2 => E::eliminate::<2>(group, work),
            3 => E::eliminate::<3>(group, work),
            _ => E::eliminate::<COLUMNS>(group, work),
        }
    }
}

/// x ← L⁻ᵀ (x − L_belowᵀ w) for `work` = [x; w].
pub(super) fn substitute<E: SweepValue>(panel: &[f64], width: usize, work: &mut [E]) {
    let size = work.len();
    for j in (0..width).step_by(COLUMNS).rev() {
        let (group, work) = (&panel[panel::group(j, size)..], &mut work[j..]);
        match width - j {
            1 => E::substitute::<1>(group, work),
            2 => E::substitute::<2>(group, work),
            3 => E::substitute::<3>(group, work),
            _ => E::substitute::<COLUMNS>(group, work),
        }
    }
}
