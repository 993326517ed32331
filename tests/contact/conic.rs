//! Contact with friction as a conic programme, solved by Clarabel: an interior point method that shares nothing with
//! the contact loop.
//!
//! ```text
//!     minimise    ½ uᵀ K u − fᵀ u + Σ ½ p²/C + Σ ½ q²/C_t + Σ g t
//!     subject to  B u = c + p (ties),    B_n u ≤ c_n + p,    |B_t u − c_t − q| ≤ t
//! ```
//!
//! p and q are what soft rows give way, and are not there where a row is rigid. For given g this is Tresca's problem,
//! with intervals in the plane and discs in space. Coulomb's is a fixed point of g = μ λ_n on top of it.

use std::collections::BTreeMap;

use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT::{self, NonnegativeConeT, SecondOrderConeT, ZeroConeT};
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus};
use faer::linalg::solvers::SolveLstsq;
use faer::Mat;
use fetifeti::problem::Law;
use fetifeti::{Problem, Row};

/// Programmes of a fixed point at most.
const ROUNDS: usize = 60;

/// A change of g below this, relative to the largest force, ends the fixed point.
const STILL: f64 = 1e-9;

/// A bound below this, relative to the largest force, is none.
const NOTHING: f64 = 1e-12;

/// Earlier rounds from which the next g is taken.
const MEMORY: usize = 6;

/// The matrices of a problem; loads, gaps and bounds come with each load step.
pub struct Conic<'a> {
    problem: &'a Problem,
    number: BTreeMap<u64, usize>,
    /// The largest entry of the diagonal of K: the unit of stiffness.
    unit: f64,
    /// The unit of each unknown over the unit of length: as much larger as it is soft.
    scale: Vec<f64>,
}

/// The solution of a programme.
pub struct Solved {
    pub u: Vec<f64>,
    /// By row.
    pub lambda: Vec<f64>,
    /// By row: B u − c, less what a soft row gives way.
    pub excess: Vec<f64>,
    /// ½ uᵀ K u − fᵀ u with the energy of soft rows, without the work of friction.
    pub energy: f64,
}

/// A matrix in the making.
#[derive(Default)]
struct Triplets(Vec<usize>, Vec<usize>, Vec<f64>);

impl Triplets {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.0.push(row);
        self.1.push(column);
        self.2.push(value);
    }

    fn matrix(self, rows: usize, columns: usize) -> CscMatrix<f64> {
        CscMatrix::new_from_triplets(rows, columns, self.0, self.1, self.2)
    }
}

impl<'a> Conic<'a> {
    /// The programmes of a problem, of which one rank has all.
    pub fn new(problem: &'a Problem) -> Conic<'a> {
        let mut number = BTreeMap::new();
        let mut diagonal: Vec<f64> = Vec::new();
        for sub in &problem.local {
            for (i, dof) in sub.dofs.iter().enumerate() {
                let next = number.len();
                let at = *number.entry(*dof).or_insert(next);
                diagonal.resize(number.len(), 0.0);
                let (columns, values) = sub.k.row(i);
                let own = columns.iter().zip(values).filter(|(&j, _)| j as usize == i);
                diagonal[at] += own.map(|(_, k)| k).sum::<f64>();
            }
        }
        let unit = diagonal.iter().fold(0.0f64, |a, k| a.max(*k));
        Conic {
            problem,
            number,
            unit,
            scale: diagonal.iter().map(|k| (unit / k).sqrt()).collect(),
        }
    }

    /// Values by subdomain, summed up by unknown; copies of an unknown are written once if they are to agree.
    pub fn gathered(&self, values: &[Vec<f64>], sum: bool) -> Vec<f64> {
        let mut out = vec![0.0; self.number.len()];
        for (sub, values) in self.problem.local.iter().zip(values) {
            for (dof, v) in sub.dofs.iter().zip(values) {
                let at = self.number[dof];
                out[at] = if sum { out[at] + v } else { *v };
            }
        }
        out
    }

    /// B u by row.
    pub fn jumps(&self, u: &[f64]) -> Vec<f64> {
        let of = |row: &Row| row.terms.iter().map(|(d, b)| b * u[self.number[d]]).sum();
        self.problem.rows.iter().map(of).collect()
    }

    /// Bᵀ λ: the forces of all rows at the nodes, which are unique where multipliers are not.
    pub fn reactions(&self, lambda: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.number.len()];
        for (row, l) in self.problem.rows.iter().zip(lambda) {
            row.terms
                .iter()
                .for_each(|(dof, b)| out[self.number[dof]] += b * l);
        }
        out
    }

    /// The size of forces under these loads and gaps.
    pub fn force(&self, loads: &[f64], gaps: &[f64]) -> f64 {
        let largest = |v: &[f64]| v.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        largest(loads).max(self.unit * largest(gaps))
    }

    /// The bound of each node with friction where the rows have these multipliers.
    pub fn bounds(&self, lambda: &[f64]) -> Vec<f64> {
        let nodes = self.problem.friction.iter();
        nodes.map(|n| n.bound.at(lambda[n.normal])).collect()
    }

    /// The solution for given bounds g of the nodes with friction.
    ///
    /// # Errors
    /// The word of Clarabel where it has no solution to the tolerance.
    pub fn tresca(&self, loads: &[f64], gaps: &[f64], g: &[f64]) -> Result<Solved, SolverStatus> {
        let (rows, scale) = (&self.problem.rows, &self.scale);
        let force = self.force(loads, gaps);
        let length = force / self.unit;
        let mut p = Triplets::default();
        for sub in &self.problem.local {
            let at: Vec<usize> = sub.dofs.iter().map(|d| self.number[d]).collect();
            for (i, &row) in at.iter().enumerate() {
                let (columns, values) = sub.k.row(i);
                for (&j, k) in columns.iter().zip(values) {
                    let column = at[j as usize];
                    if row <= column {
                        p.add(row, column, k / self.unit * scale[row] * scale[column]);
                    }
                }
            }
        }
        let mut q: Vec<f64> = loads
            .iter()
            .zip(scale)
            .map(|(f, s)| -f / force * s)
            .collect();
        // What a row gives way is a further unknown.
        let mut way = vec![None; rows.len()];
        for (r, row) in rows.iter().enumerate().filter(|(_, r)| r.compliance > 0.0) {
            way[r] = Some(q.len());
            p.add(q.len(), q.len(), 1.0 / (row.compliance * self.unit));
            q.push(0.0);
        }
        // Clarabel asks for s = b − A x in a cone; the place of each row among those of A.
        let (mut a, mut b, mut cones) = (Triplets::default(), Vec::new(), Vec::new());
        let mut place = vec![None; rows.len()];
        let mut put = |r: usize, sign: f64, b: &mut Vec<f64>| {
            let terms = rows[r].terms.iter();
            terms.for_each(|(dof, v)| {
                let column = self.number[dof];
                a.add(b.len(), column, sign * v * scale[column]);
            });
            if let Some(way) = way[r] {
                a.add(b.len(), way, -sign);
            }
            place[r] = Some((b.len(), sign));
            b.push(sign * gaps[r] / length);
        };
        let of_law = |law: Law| {
            let rows = rows.iter().enumerate();
            rows.filter(move |(_, row)| row.law == law && (law != Law::Tie || row.holds))
        };
        type Cone = fn(usize) -> SupportedConeT<f64>;
        let flat: [(Law, Cone); 2] = [(Law::Tie, ZeroConeT), (Law::Unilateral, NonnegativeConeT)];
        for (law, cone) in flat {
            let first = b.len();
            of_law(law).for_each(|(r, _)| put(r, 1.0, &mut b));
            cones.push(cone(b.len() - first));
        }
        let mut tops = Vec::new();
        for (node, g) in self.problem.friction.iter().zip(g) {
            if *g <= NOTHING * force {
                continue;
            }
            tops.push((b.len(), q.len()));
            // In units of its bound, so that small bounds do no harm.
            q.push(1.0);
            b.push(0.0);
            let bound = -g / force;
            node.tangential.iter().for_each(|&t| put(t, bound, &mut b));
            cones.push(SecondOrderConeT(1 + node.tangential.len()));
        }
        tops.iter().for_each(|&(row, t)| a.add(row, t, -1.0));
        let (m, all) = (b.len(), q.len());
        let (p, a) = (p.matrix(all, all), a.matrix(m, all));
        let settings = { DefaultSettingsBuilder::default() }
            .verbose(false)
            .tol_gap_abs(1e-13)
            .tol_gap_rel(1e-13)
            .tol_feas(1e-12)
            // Longer steps lose digits where rows depend on each other.
            .max_step_fraction(0.9)
            .reduced_tol_gap_abs(1e-9)
            .reduced_tol_gap_rel(1e-9)
            .reduced_tol_feas(1e-8)
            .build()
            .expect("good settings");
        let solver = DefaultSolver::new(&p, &q, &a, &b, &cones, settings);
        let mut solver = solver.expect("a programme");
        solver.solve();
        let found = &solver.solution;
        match found.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {}
            other => return Err(other),
        }
        let u: Vec<f64> = found
            .x
            .iter()
            .zip(scale)
            .map(|(x, s)| x * s * length)
            .collect();
        let with = |(k, sign): (usize, f64)| force * sign * found.z[k];
        let lambda: Vec<f64> = place.iter().map(|at| at.map_or(0.0, with)).collect();
        let jumps = self.jumps(&u);
        let left = |r: usize| jumps[r] - rows[r].compliance * lambda[r] - gaps[r];
        let excess: Vec<f64> = (0..rows.len()).map(left).collect();
        let tangential = self.problem.friction.iter().flat_map(|n| &n.tangential);
        let dissipated: f64 = tangential.map(|&t| lambda[t] * excess[t]).sum();
        Ok(Solved {
            excess,
            energy: found.obj_val * force * length - dissipated,
            u,
            lambda,
        })
    }

    /// The solution with the bounds that follow from the pressure, beginning with all that touches stuck; `None` where
    /// it does not come to rest.
    pub fn coulomb(&self, loads: &[f64], gaps: &[f64]) -> Option<Solved> {
        let force = self.force(loads, gaps);
        let mut g = vec![force; self.problem.friction.len()];
        let mut before: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        for round in 0..ROUNDS {
            let found = match self.tresca(loads, gaps, &g) {
                Ok(found) => found,
                // Bounds that hold nothing: half of the way back.
                Err(_) => {
                    let (last, _) = before.pop()?;
                    g = g.iter().zip(last).map(|(a, b)| 0.5 * (a + b)).collect();
                    before.clear();
                    continue;
                }
            };
            let image = self.bounds(&found.lambda);
            let rest: Vec<f64> = image.iter().zip(&g).map(|(a, b)| a - b).collect();
            let off = rest.iter().fold(0.0f64, |a, r| a.max(r.abs()));
            if off <= STILL * force {
                return Some(found);
            }
            before.push((g, rest));
            if round == 0 || before.len() > MEMORY {
                before.remove(0);
            }
            g = mixed(&before, image);
        }
        None
    }
}

/// Anderson's mixing: the combination of earlier rounds whose residuals cancel best; the `image` of the last g where
/// there is one round alone.
fn mixed(rounds: &[(Vec<f64>, Vec<f64>)], image: Vec<f64>) -> Vec<f64> {
    let Some(((last, rest), earlier)) = rounds.split_last().filter(|(_, e)| !e.is_empty()) else {
        return image;
    };
    let (n, m) = (rest.len(), earlier.len());
    // Damped, so that residuals that hardly differ do no harm.
    let size = rest.iter().fold(0.0f64, |a, r| a.max(r.abs()));
    let change = Mat::from_fn(n + m, m, |i, j| match i.checked_sub(n) {
        None => rest[i] - earlier[j].1[i],
        Some(k) => 1e-6 * size * f64::from(u8::from(k == j)),
    });
    let wanted = Mat::from_fn(n + m, 1, |i, _| rest.get(i).copied().unwrap_or(0.0));
    let weight = change.qr().solve_lstsq(wanted);
    let next = |i: usize| {
        let step =
            |j: usize| weight[(j, 0)] * (last[i] + rest[i] - earlier[j].0[i] - earlier[j].1[i]);
        (image[i] - (0..m).map(step).sum::<f64>()).max(0.0)
    };
    (0..n).map(next).collect()
}
