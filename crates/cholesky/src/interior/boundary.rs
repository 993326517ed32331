//! The factor of the interior and S, from a Cholesky factor of K + diag(0, D) in which the interface comes last.
//!
//! ```text
//!     K + diag(0, D) = [ L_II        ] [ L_IIᵀ  L_ΓIᵀ ]        S = L_ΓΓ L_ΓΓᵀ − D
//!                      [ L_ΓI   L_ΓΓ ] [        L_ΓΓᵀ ]
//! ```

use std::sync::Arc;

use faer::linalg::matmul::triangular::{matmul, BlockStructure};
use faer::{Accum, Par};

use super::triangle::Triangle;
use crate::multifrontal::{PartialCholesky, SingularInterior, SINGULAR};
use crate::panel;
use crate::symbolic::{Keep, Symbolic};
use base::linalg::dense::Dense;

/// A supernode of L.
pub struct Panel<'a> {
    /// Its first column.
    pub start: usize,
    /// Number of columns.
    pub width: usize,
    /// Rows below the columns' own, increasing.
    pub below: &'a [u32],
    /// Entries by columns, `width + below.len()` each.
    pub values: &'a [f64],
}

/// Splits the supernodes of L into the factor of the interior and S. `diagonal` is the diagonal of K in the interior.
pub fn split(
    triangle: &Triangle,
    keep: Keep,
    diagonal: impl Iterator<Item = f64>,
    shift: &[f64],
    panels: &[Panel],
) -> Result<(PartialCholesky, Dense), SingularInterior> {
    let interior = triangle.n_interior();
    let n = triangle.n() - interior;
    // A supernode may reach from the interior into the interface.
    let inside = |p: &Panel| (p.start + p.width).min(interior).saturating_sub(p.start);
    let size = |p: &Panel| p.width + p.below.len();

    // The rows below the interior columns of a supernode, as far as they are kept.
    let below = |p: &Panel| -> Vec<u32> {
        let rest = (p.start + inside(p)..p.start + p.width).map(|r| r as u32);
        let all = rest.chain(p.below.iter().copied());
        match keep {
            Keep::Boundary => all.collect(),
            Keep::Interior => all.take_while(|&r| (r as usize) < interior).collect(),
        }
    };
    let fronts = panels.iter().filter(|p| inside(p) > 0);
    let fronts: Vec<_> = fronts.map(|p| (p.start, inside(p), below(p))).collect();
    let length =
        |(_, width, below): &(usize, usize, Vec<u32>)| panel::length(*width, width + below.len());
    let mut values = Vec::with_capacity(fronts.iter().map(length).sum());
    let mut kept = fronts.iter();
    let mut l = Dense::zeros(n, n);
    let mut pivots = Vec::with_capacity(interior);
    for panel in panels {
        let (width, size) = (inside(panel), size(panel));
        if width > 0 {
            let front = kept.next().expect("a front for each of these");
            let rows = width + front.2.len();
            panel::append(panel.values, size, width, rows, &mut values);
        }
        pivots.extend((0..width).map(|j| panel.values[j * size + j]));
        for j in width..panel.width {
            let column = &panel.values[j * size..(j + 1) * size];
            let target = l.col_mut(panel.start + j - interior);
            for (r, &v) in column.iter().enumerate().skip(j) {
                target[row_of(panel, r) - interior] = v;
            }
        }
    }
    held(diagonal, &pivots, &triangle.dofs)?;

    let (dofs, interface) = triangle.dofs.split_at(interior);
    let symbolic = Symbolic::of_factor(dofs.to_vec(), interface, fronts.into_iter());
    let factor = PartialCholesky {
        symbolic: Arc::new(symbolic),
        panels: values,
    };
    Ok((factor, product(&l, shift)))
}

/// The row of the r-th entry of a column.
fn row_of(panel: &Panel, r: usize) -> usize {
    match r.checked_sub(panel.width) {
        None => panel.start + r,
        Some(r) => panel.below[r] as usize,
    }
}

/// Returns an error for the first pivot of L that vanishes relative to the diagonal entry it came from.
pub fn held(
    diagonal: impl Iterator<Item = f64>,
    pivots: &[f64],
    dofs: &[u32],
) -> Result<(), SingularInterior> {
    let mut all = diagonal.zip(pivots).zip(dofs);
    let vanishes = |&((d, l), _): &((f64, &f64), &u32)| l * l <= SINGULAR * d || !l.is_finite();
    match all.find(vanishes) {
        Some((_, &dof)) => Err(SingularInterior { dof }),
        None => Ok(()),
    }
}

/// L Lᵀ − D, both triangles.
fn product(l: &Dense, shift: &[f64]) -> Dense {
    let mut s = Dense::zeros(l.rows, l.rows);
    matmul(
        s.view_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        l.view(),
        BlockStructure::TriangularLower,
        l.view().transpose(),
        BlockStructure::TriangularUpper,
        1.0,
        Par::Seq,
    );
    for (i, d) in shift.iter().enumerate() {
        let value = s.get(i, i) - d;
        s.set(i, i, value);
    }
    s.mirror_lower();
    s
}
