//! Distance of a load from the cone of forces that the rows can exert, for many rigid motions. It is computed by MPRGP,
//! where the exact method of [`crate::linalg::nnls`] would take too long.

use mpi::topology::SimpleCommunicator;

use super::mprgp::{Bounded, Setting};
use crate::linalg::dense::Dense;
use crate::Result;

/// Largest number of products with GᵀG.
const PRODUCTS: usize = 20_000;

/// min ½ ‖G x − e‖² with x_j ≥ 0 if column j belongs to an inequality.
struct Cone {
    columns: Vec<Vec<(usize, f64)>>,
    r: usize,
    free: Vec<bool>,
}

impl Cone {
    /// G x.
    fn force(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.r];
        for (column, &x) in self.columns.iter().zip(x).filter(|(_, x)| **x != 0.0) {
            column.iter().for_each(|&(i, g)| out[i] += g * x);
        }
        out
    }

    /// Gᵀ v.
    fn work(&self, v: &[f64]) -> Vec<f64> {
        let of = |column: &Vec<(usize, f64)>| column.iter().map(|&(i, g)| g * v[i]).sum();
        self.columns.iter().map(of).collect()
    }

    /// An upper bound of ‖GᵀG‖: ‖G‖₁ ‖G‖_∞.
    fn norm(&self) -> f64 {
        let mut rows = vec![0.0; self.r];
        let mut largest = 0.0f64;
        for column in &self.columns {
            column.iter().for_each(|&(i, g)| rows[i] += f64::abs(g));
            largest = largest.max(column.iter().map(|e| e.1.abs()).sum());
        }
        largest * rows.into_iter().fold(0.0, f64::max)
    }
}

impl Bounded for Cone {
    fn apply(&mut self, x: &[f64], y: &mut [f64]) -> Result<()> {
        y.copy_from_slice(&self.work(&self.force(x)));
        Ok(())
    }

    fn enter(&mut self, free: &[bool]) -> Result<()> {
        self.free.copy_from_slice(free);
        Ok(())
    }

    fn precondition(&mut self, v: &[f64], z: &mut [f64]) -> Result<()> {
        for ((z, v), free) in z.iter_mut().zip(v).zip(&self.free) {
            *z = if *free { *v } else { 0.0 };
        }
        Ok(())
    }
}

/// The part of `e` outside the cone of the columns of `g`, and whether it is known well: it is smaller than `enough`,
/// or it belongs to a minimiser. The cone has nonnegative coefficients, except where `equation` is true. Every rank
/// computes the same by itself.
pub fn outside(g: &Dense, e: &[f64], equation: &[bool], enough: f64) -> Result<(Vec<f64>, bool)> {
    let n = g.cols;
    let entries = |j: usize| {
        let column = g.col(j).iter().copied().enumerate();
        column.filter(|e| e.1 != 0.0).collect()
    };
    let mut cone = Cone {
        columns: (0..n).map(entries).collect(),
        r: g.rows,
        free: vec![false; n],
    };
    let rest = |cone: &Cone, x: &[f64]| -> Vec<f64> {
        let force = cone.force(x);
        e.iter().zip(force).map(|(e, f)| e - f).collect()
    };
    let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let bound = cone.norm();
    if n == 0 || bound == 0.0 {
        return Ok((e.to_vec(), true));
    }
    let lower: Vec<f64> = equation
        .iter()
        .map(|&eq| if eq { f64::NEG_INFINITY } else { 0.0 })
        .collect();
    let comm = SimpleCommunicator::self_comm();
    let setting = Setting {
        comm: &comm,
        lower: &lower,
        fixed: &vec![false; n],
        length: 1.9 / bound,
    };
    let b = cone.work(e);
    // If the cone contains the load, the forces are found to `enough`. Otherwise the rest belongs to a minimiser if the
    // gradient is far smaller.
    let checker = Cone {
        columns: cone.columns.clone(),
        r: cone.r,
        free: Vec::new(),
    };
    let scale = bound.sqrt();
    let mut known = false;
    let mut stop = |x: &[f64], gradient: f64| {
        let left = norm(&rest(&checker, x));
        known = left <= enough || gradient <= 1e-4 * scale * left;
        known
    };
    let run = setting.minimise(&mut cone, &b, vec![0.0; n], &mut stop, PRODUCTS)?;
    Ok((rest(&cone, &run.x), known))
}

#[cfg(test)]
#[path = "../../tests/inside/contact/cone.rs"]
mod tests;
