//! Deflation of the eigenvalues above τ that coefficients cause by jumping inside bodies (docs/theory.md, section 12).
//!
//! ```text
//!     W = P M⁻¹ [ P_iᵀ F_i μ ],    P_2 = I − W (Wᵀ F W)⁺ Wᵀ F
//! ```
//!
//! The columns μ are the eigenvectors at the top of the pencils of the bodies, one body after the other ([`pencil`],
//! [`search`]). They are found once, with the rows that hold at the start. M⁻¹ becomes P_2 M⁻¹ P_2ᵀ, and λ₀ gets the
//! part of the solution in range W. Every Krylov method then works in the F-orthogonal complement of W without knowing
//! of it.
//!
//! W without P is sparse: a column lives on its body and the neighbours of that body. P = I − Q G (Gᵀ Q G)⁻¹ Gᵀ is
//! therefore kept as a factor, in P W and in F P W:
//!
//! ```text
//!     P W = W − Q G X,    F P W = F W − F Q G X,    X = (Gᵀ Q G)⁻¹ Gᵀ W
//! ```

pub mod balanced_operator;
pub mod matrices;
pub mod panels;
pub mod pencil;
pub mod profitability;
pub mod search;
pub mod sparse;
pub mod whole;

use std::time::Instant;

use super::cost::variation::JUMPS;
use super::operators::dual::Dual;
use super::projector::graph::BodyGraph;
use super::projector::sweep::MultiplierColumn;
use super::settings::Adaptive;
use super::spectrum::Spectrum;
use crate::feti::projector::sweep;
use crate::substructures::Problem;
use crate::Result;
use balanced_operator::BalancedOperator;
use matrices::DeflationMatrices;
use parallel::exchange::total;
use pencil::Pencil;
use whole::Whole;

/// The result and the cost of the search; the same on every rank except for the seconds.
#[derive(Debug, Clone, Default)]
pub struct Cost {
    /// τ.
    pub tau: f64,
    /// Number of vectors of each body.
    pub vectors: Vec<usize>,
    /// Number of vectors that bodies share. They are found after those of the bodies.
    pub shared: usize,
    /// Bodies with more vectors above τ than the cap allows, or whose vectors did not settle.
    pub capped: Vec<usize>,
    /// The largest Ritz value that is deflated, over all bodies; 0 if nothing is deflated.
    pub largest: f64,
    /// Number of vectors that depend on others.
    pub dependent: usize,
    /// The spectrum that the iterations saw before the search.
    pub before: Option<Spectrum>,
    /// Whether the iteration broke down with the vectors. They are then not used.
    pub given_up: bool,
    /// Seconds of the search and of the matrices.
    pub seconds: f64,
}

/// Vectors whose renewal takes more than this many products with F are used only if no fewer rows hold. Else many have
/// lost their rows: they depend on each other, and to renew them costs more than the iteration.
const MANY: f64 = 100.0;

/// Where coefficients jump, an iteration is broken off at this eigenvalue. Elsewhere the limit is far higher.
pub const EXPECTED: f64 = 1.5 * Adaptive::USUAL;

/// The eigenvalue at which an iteration is broken off to deflate the eigenvalues above τ. `varies` is the largest ratio
/// of coefficients inside a body.
///
/// Where coefficients do not vary, κ comes from the mesh, and `auto` deflates only if κ is far larger than usual.
pub fn watch(adaptive: Adaptive, varies: f64) -> Option<f64> {
    match adaptive {
        Adaptive::Off => None,
        Adaptive::Auto if varies > JUMPS => Some(EXPECTED),
        Adaptive::Auto => Some(20.0 * Adaptive::USUAL),
        Adaptive::Below(tau) => Some(1.2 * tau),
    }
}

/// P_2 for the rows that hold.
pub struct Deflation {
    /// Result and cost of the search.
    pub cost: Cost,
    graph: BodyGraph,
    balance: BalancedOperator,
    /// M⁻¹ P_iᵀ F_i μ with all rows of the search.
    columns: Vec<MultiplierColumn>,
    matrices: DeflationMatrices,
    /// Whether the rows that hold are too few for so many vectors: P_2 is I then.
    idle: bool,
    /// Whether the user has asked for a bound of the spectrum: the vectors are then used whatever they cost.
    pub bounded: bool,
    /// Whether the last search found nothing above the bound. No iteration is broken off for another search then.
    pub exhausted: bool,
}

impl Deflation {
    /// Searches all bodies for vectors above `tau`, at most `most` in each. Collective.
    pub fn new(problem: &Problem, dual: &Dual, tau: f64, most: usize) -> Result<Deflation> {
        let clock = Instant::now();
        let graph = BodyGraph::new(problem, &dual.stiffness);
        let mut cost = Cost {
            tau,
            vectors: vec![0; graph.n],
            ..Cost::default()
        };
        let mut jumps: Vec<(u32, MultiplierColumn)> = Vec::new();
        let owners: Vec<usize> = problem.local.iter().map(|s| s.body).collect();
        let mut balance = BalancedOperator::new(dual, &owners, graph.n);
        let pencil = Pencil::new(problem, dual, &graph)?;
        balance.take(dual, &pencil)?;
        let found = search::top(&pencil, tau, most, |slot, _, image| {
            let entries = pencil.parts[slot]
                .clone()
                .map(|i| (pencil.rows[i], image[i]));
            let body = pencil.bodies[slot];
            let column = MultiplierColumn {
                entries: entries.filter(|e| e.1 != 0.0).collect(),
                reach: graph.near[body as usize].clone(),
            };
            jumps.push((body, column));
        })?;
        for (body, found) in pencil.bodies.iter().zip(&found) {
            let body = *body as usize;
            cost.vectors[body] = found.theta.len();
            cost.largest = found.theta.iter().fold(cost.largest, |a, t| a.max(*t));
            if found.capped {
                cost.capped.push(body);
            }
        }
        drop(pencil);
        cost.capped.sort_unstable();
        // Sort by body, so that the order does not depend on the colours.
        jumps.sort_by_key(|j| j.0);
        let jumps: Vec<MultiplierColumn> = jumps.into_iter().map(|j| j.1).collect();
        let columns = sweep::images(&dual.multipliers()?, &graph, &jumps, |x, y| {
            dual.m_many(x, y)
        })?;
        let matrices = DeflationMatrices::new(dual, &graph, &balance, &columns, None)?;
        cost.dependent = columns.len() - matrices.rank();
        cost.seconds = clock.elapsed().as_secs_f64();
        Ok(Deflation {
            cost,
            graph,
            balance,
            columns,
            matrices,
            idle: false,
            bounded: false,
            exhausted: false,
        })
    }

    /// Deflates the eigenvalues of the whole problem that are still above `bound`, at most `most` vectors. Returns the
    /// number of vectors found. Collective.
    pub fn polish(&mut self, dual: &Dual, bound: f64, most: usize) -> Result<usize> {
        let clock = Instant::now();
        let everywhere: Vec<u32> = (0..self.graph.n as u32).collect();
        let mut found = Vec::new();
        let whole = Whole::new(dual, self)?;
        search::top(&whole, bound, most, |_, vector, _| {
            let entries = vector.iter().enumerate().filter(|e| *e.1 != 0.0);
            found.push(MultiplierColumn {
                entries: entries.map(|(row, &v)| (row as u32, v)).collect(),
                reach: everywhere.clone(),
            });
        })?;
        let n = found.len();
        if n > 0 {
            self.columns.extend(found);
            self.matrices =
                DeflationMatrices::new(dual, &self.graph, &self.balance, &self.columns, None)?;
            self.cost.shared += n;
        }
        self.cost.seconds += clock.elapsed().as_secs_f64();
        Ok(n)
    }

    /// Masks W by the rows that hold now and rebuilds the matrices that depend on it. Collective.
    pub fn renew(&mut self, dual: &Dual) -> Result<()> {
        if self.columns.is_empty() {
            return Ok(());
        }
        let jump = &dual.stiffness.jump;
        let active = &jump.active;
        let rows = jump.rows_between_bodies().filter(|&r| active[r]).count();
        let rows = total(dual.comm(), rows as f64);
        let vectors = self.cost.vectors.iter().sum::<usize>() + self.cost.shared;
        // A vector lives on its body and those near it.
        let near = self.cost.vectors.iter().zip(&self.graph.near);
        let near: usize = near.map(|(n, near)| n * near.len()).sum();
        let products = near as f64 / self.graph.n as f64;
        self.idle = !self.bounded && products > MANY && vectors as f64 > rows;
        if self.idle {
            return Ok(());
        }
        let mask = |column: &MultiplierColumn| MultiplierColumn {
            entries: column
                .entries
                .iter()
                .copied()
                .filter(|e| active[e.0 as usize])
                .collect(),
            reach: column.reach.clone(),
        };
        let columns: Vec<MultiplierColumn> = self.columns.iter().map(mask).collect();
        let before = Some(&self.matrices);
        self.matrices = DeflationMatrices::new(dual, &self.graph, &self.balance, &columns, before)?;
        Ok(())
    }

    /// Sets P_2 = I from now on.
    pub fn give_up(&mut self) {
        self.cost.given_up = true;
        self.columns.clear();
    }

    /// P_2 as matrices; `None` without vectors.
    pub fn matrices(&self) -> Option<&DeflationMatrices> {
        (!self.columns.is_empty() && !self.idle).then_some(&self.matrices)
    }
}
