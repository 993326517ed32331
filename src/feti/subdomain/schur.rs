//! S and T of one subdomain, and the factors that eliminate its interior, in one of three forms: dense matrices, their
//! lower triangles, or sparse solves. No other file distinguishes them.

use std::sync::Arc;

use super::implicit::Implicit;
use super::which::Operator;
use base::linalg::dense::{multiply, Dense};
use base::linalg::symmetric::Symmetric;
use cholesky::interior::InteriorFactor;
use SchurOperators::{Packed, Sparse, Whole};

/// S, n_Γ × n_Γ, and T, n_Δ × n_Δ.
#[derive(Debug)]
pub(crate) enum SchurOperators {
    /// Dense matrices, both triangles.
    Whole(Stored<Dense>),
    /// Lower triangles. S is shared with subdomains that have other primal dofs.
    Packed(Stored<Symmetric>),
    /// Sparse solves.
    Sparse(Box<Implicit>),
}

/// S and T as matrices.
#[derive(Debug)]
pub(crate) struct Stored<M> {
    /// The factor that S came from.
    factor: Arc<InteriorFactor>,
    s: Arc<M>,
    t: M,
}

impl<M> Stored<M> {
    fn of(&self, which: Operator) -> &M {
        match which {
            Operator::S => &self.s,
            Operator::T => &self.t,
        }
    }
}

impl SchurOperators {
    /// Dense matrices, both triangles filled, and the factor that S came from.
    pub fn whole(factor: Arc<InteriorFactor>, s: Arc<Dense>, t: Dense) -> SchurOperators {
        Whole(Stored { factor, s, t })
    }

    /// Sparse solves.
    pub fn sparse(solves: Implicit) -> SchurOperators {
        Sparse(Box::new(solves))
    }

    /// Whether they are sparse solves.
    pub fn is_sparse(&self) -> bool {
        matches!(self, Sparse(_))
    }

    /// The sparse solves.
    pub fn solves(&self) -> Option<&Implicit> {
        match self {
            Sparse(solves) => Some(solves),
            Whole(_) | Packed(_) => None,
        }
    }

    /// Whether only lower triangles are kept.
    pub fn is_packed(&self) -> bool {
        matches!(self, Packed(_))
    }

    /// The factor that S came from; `None` for sparse solves.
    pub fn factor(&self) -> Option<&Arc<InteriorFactor>> {
        match self {
            Whole(Stored { factor, .. }) | Packed(Stored { factor, .. }) => Some(factor),
            Sparse(_) => None,
        }
    }

    /// S as a dense matrix. Sparse solves make it once, lower triangles at every call.
    pub fn s(&self) -> Arc<Dense> {
        match self {
            Whole(stored) => stored.s.clone(),
            Packed(stored) => Arc::new(stored.s.to_dense()),
            Sparse(solves) => solves.whole(Operator::S).clone(),
        }
    }

    /// Keeps only the lower triangles of dense matrices.
    pub fn pack(&mut self) {
        if let Whole(stored) = self {
            let s = Arc::new(Symmetric::new(&stored.s));
            self.pack_beside(s);
        }
    }

    /// [`pack`](Self::pack) where `like`, which has the same S, is packed: its S is shared.
    pub fn pack_like(&mut self, like: &SchurOperators) {
        if let Packed(like) = like {
            self.pack_beside(like.s.clone());
        }
    }

    fn pack_beside(&mut self, s: Arc<Symmetric>) {
        if let Whole(Stored { factor, t, .. }) = self {
            let (factor, t) = (factor.clone(), Symmetric::new(t));
            *self = Packed(Stored { factor, s, t });
        }
    }

    /// An entry of one of the operators.
    pub fn entry(&self, which: Operator, i: usize, j: usize) -> f64 {
        match self {
            Whole(stored) => stored.of(which).get(i, j),
            Packed(stored) => stored.of(which).get(i, j),
            Sparse(solves) => solves.whole(which).get(i, j),
        }
    }

    /// The entries of one of the operators in these rows and columns.
    pub fn block(&self, which: Operator, at: &[usize]) -> Dense {
        match self {
            Sparse(solves) => solves.block(which, at),
            _ => Dense::from_fn(at.len(), at.len(), |p, q| self.entry(which, at[p], at[q])),
        }
    }

    /// A diagonal entry of S; `None` where sparse solves have not made it.
    pub fn s_diagonal(&self, i: usize) -> Option<f64> {
        match self {
            Whole(stored) => Some(stored.s.get(i, i)),
            Packed(stored) => Some(stored.s.get(i, i)),
            Sparse(solves) => solves.known_s().map(|s| s.get(i, i)),
        }
    }

    /// The first `n` columns of y ← A v, A one of the operators.
    pub fn apply(&self, which: Operator, v: &Dense, y: &mut Dense, n: usize) {
        match self {
            Whole(stored) => {
                let y = y.view_mut().subcols_mut(0, n);
                let v = v.view().subcols(0, n);
                multiply(y, false, 1.0, stored.of(which).view(), v);
            }
            Packed(stored) => stored.of(which).mul_columns(v, y, n),
            Sparse(solves) => solves.apply_columns(which, v, y, n),
        }
    }

    /// y ← y + A v for y = 0, A one of the operators.
    pub fn apply_one(&self, which: Operator, v: &[f64], y: &mut [f64]) {
        match self {
            Whole(stored) => stored.of(which).add_mul(v, y),
            Packed(stored) => stored.of(which).add_mul(v, y),
            Sparse(solves) => {
                if v.iter().any(|v| *v != 0.0) {
                    y.copy_from_slice(&solves.apply(which, &[v])[0]);
                }
            }
        }
    }

    /// Loads after elimination of the interior: (work, g) for each with g = f_Γ − K_ΓI K_II⁻¹ f_I on `interface`.
    pub fn condense(&self, interface: &[u32], loads: &[&[f64]]) -> Vec<(Vec<f64>, Vec<f64>)> {
        let factor = match self {
            Whole(Stored { factor, .. }) | Packed(Stored { factor, .. }) => factor,
            Sparse(solves) => return solves.condense(loads),
        };
        let mut work: Vec<Vec<f64>> = loads.iter().map(|f| f.to_vec()).collect();
        match &mut work[..] {
            [one] => factor.forward(one),
            several => factor.forward_many(several),
        }
        let with_gamma = |w: Vec<f64>| {
            let g = interface.iter().map(|&i| w[i as usize]).collect();
            (w, g)
        };
        work.into_iter().map(with_gamma).collect()
    }

    /// Solutions from `work` of [`condense`](Self::condense) with interface values in place.
    pub fn recover(&self, x: &mut [Vec<f64>]) {
        match (self, x) {
            (Sparse(solves), several) => solves.recover(several),
            (Whole(Stored { factor, .. }) | Packed(Stored { factor, .. }), [one]) => {
                factor.backward(one);
            }
            (Whole(Stored { factor, .. }) | Packed(Stored { factor, .. }), several) => {
                factor.backward_many(several);
            }
        }
    }

    /// Bytes of the factors and of dense matrices: (sparse, dense).
    pub fn bytes(&self) -> (usize, usize) {
        match self {
            Whole(Stored { factor, s, t }) => (factor.bytes(), 8 * (s.data.len() + t.data.len())),
            Packed(Stored { factor, s, t }) => (factor.bytes(), s.bytes() + t.bytes()),
            Sparse(solves) => solves.bytes(),
        }
    }
}
