//! Blocks of many rows, such as the mortar rows of an interface: B_D without a dense matrix.
//!
//! The owner of the block applies B_D with a sparse factor, of G = B D⁻¹ Bᵀ ([`by_rows`]) or, where that would cost
//! digits, of a matrix on the dofs that rows share ([`by_dofs`]). B_Dᵀ λ is sent to the subdomains dof by dof, and y is
//! summed dof by dof over the copies for B_D y.

mod by_dofs;
mod by_rows;
mod dependencies;
mod elimination;
mod pattern;
mod rank;
pub mod slots;

use crate::feti::jump::turn::Turn;
use base::linalg::dense::Dense;
use base::linalg::sorted::distinct;
use by_dofs::ByDofs;
use by_rows::ByRows;
use dependencies::Dependencies;
use pattern::JumpMatrices;

/// A block with more rows than this is coupled. At most 28 rows meet at a point where eight bodies do, and a dense
/// block of 48 rows takes about a millisecond.
pub const MANY: usize = 48;

/// Where the dofs that rows share are softer than their own dofs by more than this, G costs digits: as many as this
/// ratio has.
const STEEP: f64 = 1e4;

/// Sets of dependent rows with more members than this are not looked into as a whole: what is asked about them costs
/// the fourth power of their number. B B⁺ c is known for all of them, from N.
const DEPENDENT: usize = 200;

/// The rows of a coupled block.
#[derive(Debug)]
pub struct Coupled {
    b: JumpMatrices,
    /// D.
    weights: Vec<f64>,
    /// Whether G would cost digits.
    steep: bool,
    active: Vec<bool>,
    dependencies: Option<Dependencies>,
    /// B_D by a factor of a matrix on dofs, which takes precedence over `by_rows`.
    by_dofs: Option<ByDofs>,
    /// B_D by a factor of G.
    by_rows: Option<ByRows>,
}

impl Coupled {
    /// The block with these rows, lists of (dof, coefficient), and the weights D of the dofs. No row holds yet.
    pub fn new(rows: &[Vec<(u32, f64)>], weights: &[f64]) -> Coupled {
        let rows = pattern::compressed(rows);
        let columns = pattern::transposed(&rows, weights.len());
        let b = JumpMatrices { rows, columns };
        Coupled {
            steep: (0..b.rows.n()).any(|r| is_steep(&b, weights, r)),
            weights: weights.to_vec(),
            active: vec![false; b.rows.n()],
            dependencies: None,
            by_dofs: None,
            by_rows: None,
            b,
        }
    }

    /// The dofs of row `r` and its coefficients.
    pub fn row(&self, r: usize) -> (&[u32], &[f64]) {
        self.b.rows.row(r)
    }

    /// Prepares B_D for the rows that hold.
    pub fn hold(&mut self, active: &[bool]) {
        self.active.copy_from_slice(active);
        let mut kept = active.to_vec();
        self.dependencies = Dependencies::new(&self.b, active).map(|(dependencies, left)| {
            left.iter().for_each(|&r| kept[r as usize] = false);
            dependencies
        });
        self.by_dofs = if self.steep {
            ByDofs::new(&self.b, &IN_A.weights(&self.weights), &kept)
        } else {
            None
        };
        if self.by_dofs.is_none() {
            let new = || {
                if self.steep {
                    ByRows::new(&self.b, &IN_G.weights(&self.weights))
                } else {
                    ByRows::new(&self.b, &self.weights)
                }
            };
            let by_rows = self.by_rows.get_or_insert_with(new);
            by_rows.hold(&self.b, &kept);
        }
    }

    /// Turns two rows, which have the dofs of both; B_D is that of before.
    pub fn turn(&mut self, turn: &Turn) {
        self.b.turn(turn);
    }

    /// v ← B_Dᵀ λ.
    pub fn lift(&self, lambda: &[f64], v: &mut [f64]) {
        let mut own;
        let lambda = match &self.dependencies {
            None => lambda,
            Some(dependencies) => {
                own = lambda.to_vec();
                dependencies.project(&mut own);
                &own
            }
        };
        match (&self.by_dofs, &self.by_rows) {
            (Some(by_dofs), _) => by_dofs.lift(lambda, v),
            (None, Some(by_rows)) => by_rows.lift(&self.b, lambda, v),
            _ => v.fill(0.0),
        }
    }

    /// λ ← B_D y; `y` is summed over the copies of each dof.
    pub fn collect(&self, y: &[f64], lambda: &mut [f64]) {
        match (&self.by_dofs, &self.by_rows) {
            (Some(by_dofs), _) => by_dofs.collect(y, lambda),
            (None, Some(by_rows)) => by_rows.collect(&self.b, y, lambda),
            _ => lambda.fill(0.0),
        }
        if let Some(dependencies) = &self.dependencies {
            dependencies.project(lambda);
        }
    }

    /// q ← diag(Ĝ B D⁻¹ X D⁻¹ Bᵀ Ĝ), where X is diagonal and Ĝ = diag(G)⁻¹; zero on rows that do not hold.
    pub fn diagonal(&self, x: &[f64], q: &mut [f64]) {
        for (r, q) in q.iter_mut().enumerate() {
            let (col, val) = self.b.rows.row(r);
            let (mut g, mut sum) = (0.0, 0.0);
            for (&j, v) in col.iter().zip(val) {
                let scaled = v / self.weights[j as usize];
                g += v * scaled;
                sum += scaled * scaled * x[j as usize];
            }
            *q = if self.active[r] { sum / (g * g) } else { 0.0 };
        }
    }

    /// The rows in `on` that take part in dependencies among these rows: outside them multipliers without forces,
    /// Bᵀ N = 0, are zero. Empty if there are too many.
    pub fn dependent(&self, on: &[bool]) -> Vec<usize> {
        let support = match Dependencies::new(&self.b, on) {
            Some((dependencies, _)) => dependencies.support(),
            None => Vec::new(),
        };
        match support.len() {
            ..=DEPENDENT => support,
            _ => Vec::new(),
        }
    }

    /// [`dependent`](Self::dependent) as one set, or if there are too many the rows of every dependency that has not.
    pub fn dependent_sets(&self, on: &[bool]) -> Vec<Vec<usize>> {
        let Some((dependencies, _)) = Dependencies::new(&self.b, on) else {
            return Vec::new();
        };
        let support = dependencies.support();
        match support.len() {
            ..=DEPENDENT => vec![support],
            _ => dependencies
                .parts()
                .filter(|rows| rows.len() <= DEPENDENT)
                .collect(),
        }
    }

    /// B B⁺ c over the rows in `active`, in place. Returns whether that is another c.
    pub fn reconcile(&self, active: &[bool], c: &mut [f64]) -> bool {
        let own;
        let dependencies = if active == self.active {
            self.dependencies.as_ref()
        } else {
            own = Dependencies::new(&self.b, active);
            own.as_ref().map(|(dependencies, _)| dependencies)
        };
        dependencies.inspect(|d| d.project(c)).is_some()
    }

    /// B on these rows and the dofs that they have.
    pub fn part(&self, rows: &[usize]) -> Dense {
        let dofs = self.dofs(rows);
        let mut out = Dense::zeros(rows.len(), dofs.len());
        for (i, &r) in rows.iter().enumerate() {
            let (col, val) = self.b.rows.row(r);
            for (j, v) in col.iter().zip(val) {
                let at = dofs.binary_search(j).expect("every dof was collected");
                out.set(i, at, *v);
            }
        }
        out
    }

    /// The dofs of these rows, increasing.
    pub fn dofs(&self, rows: &[usize]) -> Vec<u32> {
        distinct(rows.iter().flat_map(|&r| self.b.rows.row(r).0).copied())
    }
}

/// Whether the dofs that row `r` shares with others are much softer than its own ones, or, if it has none, than each
/// other.
fn is_steep(b: &JumpMatrices, weights: &[f64], r: usize) -> bool {
    let (col, val) = b.rows.row(r);
    // Σ coefficient² / D over dofs that the row has for itself, and over the others.
    let mut softness = [0.0; 2];
    let mut ends = [f64::INFINITY, 0.0f64];
    for (&j, v) in col.iter().zip(val).filter(|e| *e.1 != 0.0) {
        let (is_shared, weight) = (b.users(j as usize).nth(1).is_some(), weights[j as usize]);
        softness[usize::from(is_shared)] += v * v / weight;
        ends = [ends[0].min(weight), ends[1].max(weight)];
    }
    softness[1] > STEEP * softness[0] && ends[1] > STEEP * ends[0]
}

/// How far weights may differ: up to `plain` as they do, beyond by `margin` times the root of their ratio, at most by
/// `most`.
struct WeightRange {
    plain: f64,
    margin: f64,
    most: f64,
}

/// With G: digits that it loses are lost in λ_min.
const IN_G: WeightRange = WeightRange {
    plain: 1e6,
    margin: 1.0,
    most: 1e12,
};

/// Without G: what is lost is symmetry of B_D and B_Dᵀ. κ grows by 1/margin².
const IN_A: WeightRange = WeightRange {
    plain: 1e8,
    margin: 30.0,
    most: f64::INFINITY,
};

impl WeightRange {
    /// D with ratios within reach. B_Dᵀ is a right inverse of B with any positive D, and powers of D with an exponent
    /// of at least one half keep κ bounded, whatever D is.
    fn weights(&self, weights: &[f64]) -> Vec<f64> {
        let ends = weights
            .iter()
            .fold([f64::INFINITY, 0.0f64], |[low, high], w| {
                [low.min(*w), high.max(*w)]
            });
        let ratio = ends[1] / ends[0];
        if ratio.is_nan() || ratio <= self.plain {
            return weights.to_vec();
        }
        let wanted = (self.margin * ratio.sqrt()).max(self.plain);
        let exponent = wanted.min(self.most).ln() / ratio.ln();
        let weight = |w| f64::powf(w / ends[0], exponent);
        weights.iter().map(|w| weight(*w)).collect()
    }
}

#[cfg(test)]
#[path = "../../../../tests/inside/feti/jump/coupled.rs"]
mod tests;
