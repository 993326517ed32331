//! Decides whether a solution is that of the quadratic programme: energy, u, the rows that hold, the forces between
//! bodies.
//!
//! The bound of the energy is 1e-8 of its scale ([`Tolerances`]): the solver reduces its residual to 1e-11, and a
//! residual changes the energy by its work on the multipliers, which are up to 10³ times as large as the residual's
//! reference where stiffnesses jump by 10⁴. A wrong row changes the energy by the square of what it moves.

use crate::support::assembled::compare::{compare, energy_scale, Candidate, Tolerances};
use crate::support::assembled::{Assembled, Place, Reference};
use crate::support::qp::certificate::{self, largest};
use faer::{Mat, Side};
use fetifeti::problem::RowSource;
use fetifeti::Solution;
use std::collections::{BTreeMap, BTreeSet};

/// Eigenvalues of the products of unit rows below the first bound are zero; with one between the bounds nothing is said
/// about a force.
const DEPENDENT: [f64; 2] = [1e-11, 1e-7];

/// The largest force of a pair that may differ, relative to the largest force.
const FORCE: f64 = 1e-6;

/// How two answers agree, over the load steps: largest deviations and counts.
#[derive(Debug, Clone, Copy, Default)]
pub struct Agreed {
    pub steps: usize,
    pub energy: f64,
    pub u: f64,
    pub force: f64,
    /// Inequality rows, and those of them that carry force.
    pub rows: usize,
    pub closed: usize,
    /// Pairs and obstacles whose force is unique, and others.
    pub forces: usize,
    pub shared: usize,
}

impl Agreed {
    pub fn include(&mut self, other: Agreed) {
        self.steps += other.steps;
        self.energy = self.energy.max(other.energy);
        self.u = self.u.max(other.u);
        self.force = self.force.max(other.force);
        self.rows = self.rows.max(other.rows);
        self.closed = self.closed.max(other.closed);
        self.forces += other.forces;
        self.shared += other.shared;
    }
}

/// How exactly the reference knows its energy, relative to the scale of errors.
pub fn known(problem: &Assembled, reference: &Reference) -> f64 {
    let other = problem.qp.energy(&reference.u);
    (other - reference.energy).abs() / energy_scale(problem, reference)
}

/// Compares a solution, whose displacements by unknown are `u`, with the reference; an error lists what is wrong.
pub fn judge(
    problem: &Assembled,
    reference: &Reference,
    u: &[f64],
    solution: &Solution,
) -> Result<Agreed, String> {
    let rows = solution.rows();
    let lambda: Vec<f64> = rows.iter().map(|r| r.multiplier).collect();
    let answer = Candidate {
        u,
        lambda: &lambda,
        energy: solution.energy,
    };
    let tolerances = Tolerances::default();
    let agreement = compare(problem, reference, &answer, &tolerances)?;
    let (length, force) = certificate::sizes(
        &problem.qp,
        &reference.u,
        &reference.solved.equal,
        &reference.solved.below,
    );

    // Rows that hold are closed, and rows that carry force hold, where no others could carry it.
    let sizes = (tolerances.strict * length, tolerances.strict * force);
    let gap = |k: usize, u: &[f64]| {
        let row = &problem.qp.below[k];
        (row.rhs - row.times(u)) / row.norm()
    };
    let open: Vec<bool> = problem
        .place
        .iter()
        .map(|p| matches!(*p, Place::Below(k) if gap(k, &reference.u) > sizes.0))
        .collect();
    let unique = Unique::new(problem, &open);
    let length = length.max(largest(u.iter().copied()));
    let mut wrong = Vec::new();
    for (r, place) in problem.place.iter().enumerate() {
        let Place::Below(k) = *place else { continue };
        let apart = gap(k, u) > tolerances.strict * length;
        let carries = reference.solved.below[k] * problem.qp.below[k].norm() > sizes.1;
        let missed = carries && !rows[r].holds() && unique.force(&[r]);
        if missed || (apart && rows[r].holds()) {
            wrong.push(r);
        }
    }
    if !wrong.is_empty() {
        return Err(format!("rows {wrong:?} have the wrong state"));
    }

    let mut out = Agreed {
        steps: 1,
        energy: agreement.energy,
        u: agreement.u,
        rows: problem.qp.below.len(),
        closed: agreement.closed,
        ..Agreed::default()
    };
    let below = |&r: &usize| matches!(problem.place[r], Place::Below(_));
    let mut pairs: BTreeMap<RowSource, Vec<usize>> = BTreeMap::new();
    for r in (0..rows.len()).filter(below) {
        pairs.entry(rows[r].label.source).or_default().push(r);
    }
    let sum = |of: &[f64], pair: &[usize]| pair.iter().map(|&r| of[r]).sum::<f64>();
    let scale = largest(pairs.values().map(|p| sum(&reference.lambda, p))).max(force);
    for (source, pair) in &pairs {
        if !unique.force(pair) {
            out.shared += 1;
            continue;
        }
        out.forces += 1;
        let [ours, theirs] = [&lambda, &reference.lambda].map(|of| sum(of, pair));
        let off = (ours - theirs).abs() / scale;
        if off.is_nan() || off > FORCE {
            return Err(format!("the force of {source:?} is {ours}, not {theirs}"));
        }
        out.force = out.force.max(off);
    }
    Ok(out)
}

/// Which sums of multipliers the equilibrium determines: those that vanish on every dependence of the rows.
struct Unique {
    /// Multipliers by row that cancel each other, for the rows of a block that are not open.
    dependences: Vec<Vec<(usize, f64)>>,
    /// Rows about whose dependence rounding decides.
    unclear: BTreeSet<usize>,
}

impl Unique {
    /// `open`: rows that carry no force, whatever the solution.
    fn new(problem: &Assembled, open: &[bool]) -> Unique {
        let mut blocks: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for (r, row) in problem.rows.iter().enumerate() {
            if !open[r] && problem.place[r] != Place::Nowhere {
                blocks.entry(row.block).or_default().push(r);
            }
        }
        let mut out = Unique {
            dependences: Vec::new(),
            unclear: BTreeSet::new(),
        };
        blocks.values().for_each(|rows| out.block(problem, rows));
        out
    }

    fn block(&mut self, problem: &Assembled, rows: &[usize]) {
        let unit = |&r: &usize| -> BTreeMap<usize, f64> {
            let row = match problem.place[r] {
                Place::Equal(k) => &problem.qp.equal[k],
                Place::Below(k) => &problem.qp.below[k],
                Place::Nowhere => unreachable!("rows that do not hold are left out"),
            };
            let mut terms = BTreeMap::new();
            for &(i, b) in &row.terms {
                *terms.entry(i).or_insert(0.0) += b / row.norm();
            }
            terms
        };
        let units: Vec<BTreeMap<usize, f64>> = rows.iter().map(unit).collect();
        let product = |i: usize, j: usize| -> f64 {
            let other = |at: &usize| units[j].get(at).copied().unwrap_or(0.0);
            units[i].iter().map(|(at, b)| b * other(at)).sum()
        };
        let gram = Mat::from_fn(rows.len(), rows.len(), product);
        let eigen = gram.self_adjoint_eigen(Side::Lower).expect("eigenvalues");
        for (k, &value) in eigen.S().column_vector().iter().enumerate() {
            if value > DEPENDENT[1] {
                continue;
            }
            if value > DEPENDENT[0] {
                self.unclear.extend(rows);
                continue;
            }
            let column = rows.iter().enumerate();
            let column = column.map(|(i, &r)| {
                let norm = match problem.place[r] {
                    Place::Equal(k) => problem.qp.equal[k].norm(),
                    Place::Below(k) => problem.qp.below[k].norm(),
                    Place::Nowhere => 1.0,
                };
                (r, eigen.U()[(i, k)] / norm)
            });
            self.dependences.push(column.collect());
        }
    }

    /// Whether the sum of the multipliers of these rows is the same in all solutions.
    fn force(&self, pair: &[usize]) -> bool {
        let pair: BTreeSet<usize> = pair.iter().copied().collect();
        if !pair.is_disjoint(&self.unclear) {
            return false;
        }
        self.dependences.iter().all(|d| {
            let within = d.iter().filter(|(r, _)| pair.contains(r));
            let sum: f64 = within.map(|(_, y)| y).sum();
            let size = largest(d.iter().map(|(_, y)| *y));
            sum.abs() <= 1e-7 * size
        })
    }
}
