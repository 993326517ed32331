//! Where bodies come to rest that nothing holds.

use std::collections::BTreeMap;

use crate::contact::piecewise_quadratic::{minimise, PiecewiseQuadratic};
use crate::contact::tuning::Tuning;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::by_column::ByColumn;
use base::linalg::dense::Dense;
use base::linalg::nnls::nnls;
use base::linalg::semidefinite::Semidefinite;
use base::linalg::union_find::UnionFind;
use parallel::parcels::Parcels;

/// A row a z ≤ b: a as (motion, coefficient as bits), scaled to a largest coefficient of 1.
type MotionConstraint = Vec<[u64; 2]>;

/// The smallest rigid motion that removes all violations of inequality rows, as coefficients of the kernel vectors that
/// are known here. It is a combination of those motions that nothing holds or drives. Where some violations stay
/// whatever the motion is, it is the motion that leaves the least sum of their squares. `None` if bodies are to stay
/// where they are. Collective.
pub fn least_distance(dual: &Dual, gaps: &[f64], tuning: &Tuning) -> Option<Vec<f64>> {
    let motions = dual.natural.unheld();
    if motions.is_empty() {
        return None;
    }
    let (comm, jump, g) = (dual.comm(), &dual.stiffness.jump, &dual.natural.all);
    let by_column = ByColumn::new(dual.natural.known(), motions.iter());
    // Of several rows with the same a only the smallest b matters.
    let mut tightest: BTreeMap<MotionConstraint, f64> = BTreeMap::new();
    let meet = |all: &mut BTreeMap<MotionConstraint, f64>, a: MotionConstraint, b: f64| {
        let least = all.entry(a).or_insert(f64::INFINITY);
        *least = least.min(b);
    };
    // Rows that hold see nothing of these motions but rounding.
    let open = |i: &usize| jump.law[*i].is_inequality() && !jump.active[*i];
    for i in jump.rows_between_bodies().filter(open) {
        let (columns, values) = g.entries(i);
        let a = by_column.works(columns, values);
        let largest = a.iter().fold(0.0f64, |m, x| m.max(x.1.abs()));
        let size: f64 = values.iter().map(|x| x.abs()).sum();
        if largest > tuning.against * size {
            let rounded = a.iter().map(|&(m, x)| {
                let x = (x / largest * 1e12).round() / 1e12 + 0.0;
                [m as u64, x.to_bits()]
            });
            let row = rounded.filter(|e| e[1] != 0).collect();
            meet(&mut tightest, row, -gaps[i] / largest);
        }
    }
    let mut mine = Parcels::default();
    for (a, &b) in &tightest {
        mine.push(b, a.iter().copied());
    }
    let mut all: BTreeMap<MotionConstraint, f64> = BTreeMap::new();
    for (b, a) in mine.gather_all(comm).iter().flat_map(Parcels::iter) {
        meet(&mut all, a.to_vec(), b);
    }
    // Motions that share a row are looked at together.
    let mut sets = UnionFind::new(motions.len());
    for a in all.keys() {
        a.iter()
            .for_each(|e| sets.join(a[0][0] as usize, e[0] as usize));
    }
    let mut rows: BTreeMap<usize, Vec<(&MotionConstraint, f64)>> = BTreeMap::new();
    for (a, &b) in &all {
        let set = sets.find(a[0][0] as usize);
        rows.entry(set).or_default().push((a, b));
    }
    let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for m in 0..motions.len() {
        members.entry(sets.find(m)).or_default().push(m);
    }
    let mut alpha: Option<Vec<f64>> = None;
    for (set, rows) in rows {
        let members = &members[&set];
        let Some(z) = least(members, &rows, tuning) else {
            continue;
        };
        let known = dual.natural.known();
        let alpha = alpha.get_or_insert_with(|| vec![0.0; known.n()]);
        let parts = members.iter().zip(z);
        parts.for_each(|(&m, z)| known.add(z, &motions[m], alpha));
    }
    alpha
}

/// Least distance programming by NNLS (Lawson and Hanson, chapter 23): min ‖z‖ with −A z ≥ −b, for the motions
/// `members`. `None` if z = 0 does.
fn least(
    members: &[usize],
    rows: &[(&MotionConstraint, f64)],
    tuning: &Tuning,
) -> Option<Vec<f64>> {
    if rows.iter().all(|row| row.1 >= 0.0) {
        return None;
    }
    let n = members.len();
    let scale = rows.iter().fold(0.0f64, |m, row| m.max(row.1.abs()));
    let mut e = Dense::zeros(n + 1, rows.len());
    for (k, (a, b)) in rows.iter().enumerate() {
        for &[m, x] in a.iter() {
            let j = members.binary_search(&(m as usize));
            e.set(j.expect("rows of this set"), k, -f64::from_bits(x));
        }
        e.set(n, k, -b / scale);
    }
    let mut wanted = vec![0.0; n + 1];
    wanted[n] = 1.0;
    let (_, rest) = nnls(&e, &wanted, &vec![false; rows.len()]);
    if rest[n].abs() < 1e-9 {
        return (n <= tuning.placed_together).then(|| least_violation(members, rows, tuning));
    }
    // `rest` is b − A x here, the negative of the residual in the book. The quotient is the same.
    Some((0..n).map(|j| -rest[j] / rest[n] * scale).collect())
}

/// min ½ ‖(A z − b)₊‖² + ½ δ ‖z‖² for the motions `members`, with a δ that is small beside A.
fn least_violation(
    members: &[usize],
    rows: &[(&MotionConstraint, f64)],
    tuning: &Tuning,
) -> Vec<f64> {
    let n = members.len();
    let of = |a: &MotionConstraint| -> Vec<(usize, f64)> {
        let place = |m: u64| members.binary_search(&(m as usize));
        let entries = a.iter().map(|&[m, x]| (place(m), f64::from_bits(x)));
        entries
            .map(|(j, x)| (j.expect("rows of this set"), x))
            .collect()
    };
    let mut violation = Violation {
        rows: rows.iter().map(|(a, b)| (of(a), *b)).collect(),
        weak: 1e-9 * rows.len() as f64 / n as f64,
        z: vec![0.0; n],
        d: Vec::new(),
        now: 0.0,
    };
    violation.now = violation.value(&violation.z);
    minimise(&mut violation, tuning.placed_steps, tuning);
    violation.z
}

/// Violations at z, and a direction from there.
struct Violation {
    /// A and b.
    rows: Vec<(Vec<(usize, f64)>, f64)>,
    /// δ.
    weak: f64,
    z: Vec<f64>,
    d: Vec<f64>,
    /// Twice the function at z.
    now: f64,
}

impl Violation {
    fn value(&self, z: &[f64]) -> f64 {
        let squares: f64 = self.rows.iter().map(|row| beyond(z, row).powi(2)).sum();
        squares + self.weak * z.iter().map(|z| z * z).sum::<f64>()
    }
}

fn along(a: &[(usize, f64)], z: &[f64]) -> f64 {
    a.iter().map(|&(j, x)| x * z[j]).sum()
}

fn beyond(z: &[f64], (a, b): &(Vec<(usize, f64)>, f64)) -> f64 {
    (along(a, z) - b).max(0.0)
}

impl PiecewiseQuadratic for Violation {
    fn direct(&mut self) -> bool {
        let n = self.z.len();
        let mut h = Dense::zeros(n, n);
        self.d = self.z.iter().map(|z| -self.weak * z).collect();
        (0..n).for_each(|j| h.set(j, j, self.weak));
        for row in &self.rows {
            let far = beyond(&self.z, row);
            if far > 0.0 {
                for &(i, x) in &row.0 {
                    self.d[i] -= x * far;
                    for &(j, y) in &row.0 {
                        h.set(i, j, h.get(i, j) + x * y);
                    }
                }
            }
        }
        Semidefinite::new(&h).solve(&mut self.d);
        true
    }

    fn slope(&self, t: f64) -> [f64; 2] {
        let mut sums = [0.0, 0.0];
        for (z, d) in self.z.iter().zip(&self.d) {
            sums[0] += self.weak * d * (z + t * d);
            sums[1] += self.weak * d * d;
        }
        for (a, b) in &self.rows {
            let (far, opens) = (along(a, &self.z) - b, along(a, &self.d));
            if far + t * opens > 0.0 {
                sums[0] += opens * (far + t * opens);
                sums[1] += opens * opens;
            }
        }
        sums
    }

    fn go(&mut self, t: f64) -> bool {
        let z = self.z.iter().zip(&self.d);
        let next: Vec<f64> = z.map(|(z, d)| z + t * d).collect();
        let then = self.value(&next);
        let falls = then < (1.0 - 1e-12) * self.now;
        if falls {
            (self.z, self.now) = (next, then);
        }
        falls
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/contact/repairs/placed.rs"]
mod tests;
