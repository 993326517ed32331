//! Rigid motions of bodies as combinations of kernel vectors, most of which do not take part.

use bytemuck::{Pod, Zeroable};

/// A coefficient of a motion, or of a row of G, on its way to other ranks: the name of its column, and the value.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Coefficient {
    /// Name of the column.
    pub column: usize,
    /// The coefficient.
    pub value: f64,
}

impl Coefficient {
    /// In the column of this name.
    pub fn new(column: u32, value: f64) -> Coefficient {
        Coefficient {
            column: column as usize,
            value,
        }
    }

    /// The name of the column, and the value.
    pub fn pair(&self) -> (u32, f64) {
        (self.column as u32, self.value)
    }
}

/// Entries of a motion below this, relative to its largest one, are rounding of sums of two motions.
pub(super) const NOTHING: f64 = 1e-13;

/// Entries of a motion below this, relative to its largest one, are rounding of solves with many columns.
pub(super) const NOTHING_SOLVED: f64 = 1e-10;

/// A combination of kernel vectors: (column of R, coefficient), by increasing column.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct KernelMotion(pub Vec<(u32, f64)>);

impl KernelMotion {
    /// The motion with these coefficients, without those below `least` relative to the largest.
    pub(super) fn above(
        least: f64,
        entries: impl Iterator<Item = (u32, f64)> + Clone,
    ) -> KernelMotion {
        let largest = entries.clone().fold(0.0f64, |a, e| a.max(e.1.abs()));
        KernelMotion(entries.filter(|e| e.1.abs() > least * largest).collect())
    }

    /// Σ of coefficients times entries of x.
    pub fn dot(&self, x: &[f64]) -> f64 {
        self.0.iter().map(|&(c, v)| v * x[c as usize]).sum()
    }

    /// The largest coefficient.
    pub fn largest(&self) -> f64 {
        self.0.iter().fold(0.0, |a, e| a.max(e.1.abs()))
    }

    /// The first column with the largest coefficient.
    pub(super) fn first_largest(&self) -> Option<u32> {
        let order = |a: &&(u32, f64), b: &&(u32, f64)| {
            let sizes = a.1.abs().total_cmp(&b.1.abs());
            sizes.then(b.0.cmp(&a.0))
        };
        self.0.iter().max_by(order).map(|e| e.0)
    }

    /// Σ of the squares of the coefficients.
    pub fn square(&self) -> f64 {
        self.0.iter().map(|e| e.1 * e.1).sum()
    }

    /// Σ of the products of the coefficients with those of another motion.
    pub fn dot_with(&self, other: &KernelMotion) -> f64 {
        let of = |e: &(u32, f64)| match other.0.binary_search_by_key(&e.0, |o| o.0) {
            Ok(k) => e.1 * other.0[k].1,
            Err(_) => 0.0,
        };
        self.0.iter().map(of).sum()
    }

    /// α times the motion.
    pub fn times(&self, alpha: f64) -> KernelMotion {
        KernelMotion(self.0.iter().map(|&(c, v)| (c, alpha * v)).collect())
    }

    /// The motion plus α times another one.
    pub fn plus(&self, alpha: f64, other: &KernelMotion) -> KernelMotion {
        let mut all: Vec<(u32, f64)> = self.0.clone();
        all.extend(other.0.iter().map(|&(c, v)| (c, alpha * v)));
        all.sort_by_key(|e| e.0);
        let of_column = |s: &[(u32, f64)]| (s[0].0, s.iter().map(|e| e.1).sum());
        let sums: Vec<(u32, f64)> = all.chunk_by(|a, b| a.0 == b.0).map(of_column).collect();
        KernelMotion::above(NOTHING, sums.iter().copied())
    }

    /// The work of a row of G on it.
    pub fn work(&self, columns: &[u32], values: &[f64]) -> f64 {
        let of = |&c: &u32| match self.0.binary_search_by_key(&c, |e| e.0) {
            Ok(k) => self.0[k].1,
            Err(_) => 0.0,
        };
        columns.iter().zip(values).map(|(c, g)| g * of(c)).sum()
    }
}
