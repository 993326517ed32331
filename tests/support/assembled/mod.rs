//! A contact problem assembled body by body and solved by the reference of `tests/support/qp`: what runs of the method
//! are measured against.
//!
//! Unknowns are the free body dofs, so that a node where bodies meet has one for each of them; ties, contacts and
//! obstacles are the rows. This is the problem as the rows of a scene state it, without the method's tearing inside
//! bodies.

pub mod compare;
mod kernel;

use std::collections::BTreeMap;

use super::qp::{self, Outcome, Qp, Solved};
use base::linalg::csr::Csr;
use fetifeti::problem::Law;
use fetifeti::{Problem, Row};
use kernel::Column;
use scene::Scene;

/// The place of a row of the scene in the problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// An equation that does not hold: no constraint.
    Nowhere,
    Equal(usize),
    Below(usize),
}

/// The problem, its numbering, and its rows in the order of the scene.
pub struct Assembled {
    pub qp: Qp,
    /// Body dof of each unknown, increasing.
    pub dofs: Vec<u64>,
    pub body: Vec<usize>,
    pub rows: Vec<Row>,
    pub place: Vec<Place>,
}

/// The solution by body dof and by row.
pub struct Reference {
    pub solved: Solved,
    /// By unknown, as [`Assembled::dofs`].
    pub u: Vec<f64>,
    /// By row; 0 where a row is no constraint.
    pub lambda: Vec<f64>,
    pub energy: f64,
    /// Inequality rows that are closed.
    pub closed: Vec<usize>,
    /// Sum of the multipliers of all inequalities.
    pub contact_force: f64,
}

impl Assembled {
    pub fn of_scene(scene: &Scene) -> Assembled {
        Assembled::new(&scene.substructures(&|_| true).unwrap())
    }

    /// Assembles the whole problem; `problem` must contain all subdomains and rows.
    pub fn new(problem: &Problem) -> Assembled {
        assert_eq!(problem.local.len(), problem.n_subdomains);
        let mut body_of = BTreeMap::new();
        for s in &problem.local {
            s.dofs.iter().for_each(|&d| {
                body_of.insert(d, s.body);
            });
        }
        let dofs: Vec<u64> = body_of.keys().copied().collect();
        let n = dofs.len();
        let mut triplets = Vec::new();
        let mut f = vec![0.0; n];
        // Candidates for kernel columns, by body and number.
        let mut columns: BTreeMap<(usize, usize), BTreeMap<usize, f64>> = BTreeMap::new();
        for s in &problem.local {
            let place: Vec<usize> = s.dofs.iter().map(|&d| find(&dofs, d)).collect();
            for (i, &at) in place.iter().enumerate() {
                f[at] += s.f[i];
                let (col, val) = s.k.row(i);
                for (&j, &v) in col.iter().zip(val) {
                    triplets.push((at as u32, place[j as usize] as u32, v));
                }
            }
            let near = s.near_kernel.as_ref().expect("columns of the kernels");
            for (c, column) in near.iter().enumerate() {
                let whole = columns.entry((s.body, c)).or_default();
                whole.extend(place.iter().copied().zip(column.iter().copied()));
            }
        }
        let k = Csr::from_triplets(n, &triplets);
        let mut by_body: BTreeMap<usize, Vec<Column>> = BTreeMap::new();
        for ((body, _), column) in columns {
            let of_body = by_body.entry(body).or_default();
            of_body.push(column.into_iter().collect());
        }
        let of_body = by_body
            .into_values()
            .flat_map(|all| kernel::kernel(&k, all));
        let kernel: Vec<Column> = of_body.collect();
        let (mut equal, mut below, mut place) = (Vec::new(), Vec::new(), Vec::new());
        for row in &problem.rows {
            let terms: Vec<(usize, f64)> = row
                .terms
                .iter()
                .map(|&(d, b)| (find(&dofs, d), b))
                .collect();
            let row_here = qp::Row::new(terms, row.gap);
            place.push(if row.law == Law::Unilateral {
                below.push(row_here);
                Place::Below(below.len() - 1)
            } else if row.holds {
                equal.push(row_here);
                Place::Equal(equal.len() - 1)
            } else {
                Place::Nowhere
            });
        }
        Assembled {
            qp: Qp {
                k,
                f,
                equal,
                below,
                kernel,
            },
            body: dofs.iter().map(|d| body_of[d]).collect(),
            dofs,
            rows: problem.rows.clone(),
            place,
        }
    }

    /// The outcome: a solution, or the proof that there is none.
    pub fn outcome(&self) -> Outcome {
        self.qp.solve()
    }

    /// The solution.
    ///
    /// # Panics
    /// Panics where there is no solution, or none can be certified.
    pub fn solve(&self) -> Reference {
        self.reference(self.outcome().solved())
    }

    pub fn reference(&self, solved: Solved) -> Reference {
        let lambda = self
            .place
            .iter()
            .map(|place| match *place {
                Place::Nowhere => 0.0,
                Place::Equal(k) => solved.equal[k],
                Place::Below(k) => solved.below[k],
            })
            .collect();
        let closed = (0..self.rows.len())
            .filter(|&r| {
                matches!(self.place[r], Place::Below(k) if solved.closed.binary_search(&k).is_ok())
            })
            .collect();
        Reference {
            u: solved.u.clone(),
            energy: solved.energy,
            contact_force: solved.below.iter().sum(),
            lambda,
            closed,
            solved,
        }
    }

    /// Number of the unknown at a body dof.
    pub fn unknown(&self, dof: u64) -> usize {
        find(&self.dofs, dof)
    }

    /// Values by unknown, from (body dof, value) pairs of all copies. The values of one body dof must agree up to
    /// `tolerance`, relative to the largest value.
    pub fn gather(
        &self,
        copies: impl IntoIterator<Item = (u64, f64)>,
        tolerance: f64,
    ) -> Result<Vec<f64>, String> {
        let mut range = vec![[f64::NAN; 2]; self.dofs.len()];
        for (dof, v) in copies {
            let [low, high] = range[self.unknown(dof)];
            range[self.unknown(dof)] = [low.min(v), high.max(v)];
        }
        let largest = range.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
        for (i, [low, high]) in range.iter().enumerate() {
            if (high - low).is_nan() || high - low > tolerance * largest {
                return Err(format!(
                    "copies of body dof {} in body {} run from {low} to {high}",
                    self.dofs[i], self.body[i]
                ));
            }
        }
        Ok(range
            .into_iter()
            .map(|[low, high]| 0.5 * (low + high))
            .collect())
    }
}

fn find(dofs: &[u64], dof: u64) -> usize {
    dofs.binary_search(&dof)
        .expect("rows and subdomains speak of free body dofs")
}
