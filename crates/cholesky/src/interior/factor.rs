//! Condensed loads and interior solutions.

use crate::multifrontal::PartialCholesky;
use crate::symbolic::Keep;
use base::linalg::csr::Csr;

/// The factored interior of a subdomain.
///
/// [`forward`](InteriorFactor::forward) turns a load f into [work; g] with the condensed load g = f_Γ − K_ΓI K_II⁻¹
/// f_I; [`backward`](InteriorFactor::backward) turns [work; u_Γ] into the solution with u_I = K_II⁻¹ (f_I − K_IΓ u_Γ).
/// The meaning of `work` depends on the kind of factor.
#[derive(Debug)]
pub enum InteriorFactor {
    /// [L_II; L_ΓI] by fronts: each direction costs half a solve.
    Fronts(PartialCholesky),
    /// Solves with K_II: each direction costs a whole solve.
    Solves(Condensation),
}

impl InteriorFactor {
    /// The fronts of `k`; `keep` says whether they have the rows of the interface.
    pub(crate) fn new(
        k: &Csr,
        interface: &[u32],
        fronts: PartialCholesky,
        keep: Keep,
    ) -> InteriorFactor {
        match keep {
            Keep::Boundary => InteriorFactor::Fronts(fronts),
            Keep::Interior => InteriorFactor::Solves(Condensation::new(k, interface, fronts)),
        }
    }

    /// Condenses the load `b` (length n, by dof).
    pub fn forward(&self, b: &mut [f64]) {
        match self {
            InteriorFactor::Fronts(f) => f.forward(b),
            InteriorFactor::Solves(c) => c.one(b, Condensation::forward),
        }
    }

    /// Solves in the interior for given values on the interface; `b` holds both.
    pub fn backward(&self, b: &mut [f64]) {
        match self {
            InteriorFactor::Fronts(f) => f.backward(b),
            InteriorFactor::Solves(c) => c.one(b, Condensation::backward),
        }
    }

    /// Applies [`forward`](InteriorFactor::forward) to at most [`LANES`](crate::lanes::LANES) vectors.
    pub fn forward_many(&self, columns: &mut [Vec<f64>]) {
        match self {
            InteriorFactor::Fronts(f) => f.forward_many(columns),
            InteriorFactor::Solves(c) => c.forward(columns),
        }
    }

    /// Applies [`backward`](InteriorFactor::backward) to at most [`LANES`](crate::lanes::LANES) vectors.
    pub fn backward_many(&self, columns: &mut [Vec<f64>]) {
        match self {
            InteriorFactor::Fronts(f) => f.backward_many(columns),
            InteriorFactor::Solves(c) => c.backward(columns),
        }
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        match self {
            InteriorFactor::Fronts(f) => f.bytes(),
            InteriorFactor::Solves(c) => c.bytes(),
        }
    }
}

/// A solver for K_II, and the block K_ΓI.
#[derive(Debug)]
pub struct Condensation {
    /// x ← [K_II⁻¹ x_I; 0].
    interior: PartialCholesky,
    interface: Vec<u32>,
    /// K_ΓI: a row for each interface dof, columns by dof.
    coupling: Csr,
}

impl Condensation {
    /// `interior` solves with K_II on vectors by dof and leaves zero on the interface.
    pub fn new(k: &Csr, interface: &[u32], interior: PartialCholesky) -> Condensation {
        let inside = k.others(interface);
        let mut coupling = k.block(interface, &inside);
        let by_dof = |j: &mut u32| *j = inside[*j as usize];
        coupling.col.iter_mut().for_each(by_dof);
        coupling.col.shrink_to_fit();
        coupling.val.shrink_to_fit();
        Condensation {
            interior,
            interface: interface.to_vec(),
            coupling,
        }
    }

    /// The interface dofs, each with its row of K_ΓI.
    fn rows(&self) -> impl Iterator<Item = (usize, &[u32], &[f64])> {
        self.interface.iter().enumerate().map(|(r, &i)| {
            let (col, val) = self.coupling.row(r);
            (i as usize, col, val)
        })
    }

    /// g ← f_Γ − K_ΓI K_II⁻¹ f_I; f_I is left as it is.
    fn forward(&self, columns: &mut [Vec<f64>]) {
        if self.interface.is_empty() {
            return;
        }
        let mut x = columns.to_vec();
        self.interior.solve_many(&mut x);
        for (b, x) in columns.iter_mut().zip(&x) {
            for (i, col, val) in self.rows() {
                let pulled: f64 = col.iter().zip(val).map(|(&j, v)| v * x[j as usize]).sum();
                b[i] -= pulled;
            }
        }
    }

    /// u_I ← K_II⁻¹ (f_I − K_IΓ u_Γ); u_Γ is left as it is.
    fn backward(&self, columns: &mut [Vec<f64>]) {
        let on_interface =
            |b: &Vec<f64>| -> Vec<f64> { self.interface.iter().map(|&i| b[i as usize]).collect() };
        let u: Vec<Vec<f64>> = columns.iter().map(on_interface).collect();
        for (b, u) in columns.iter_mut().zip(&u) {
            for ((_, col, val), u) in self.rows().zip(u) {
                for (&j, v) in col.iter().zip(val) {
                    b[j as usize] -= v * u;
                }
            }
        }
        self.interior.solve_many(columns);
        for (b, u) in columns.iter_mut().zip(&u) {
            for (&i, &u) in self.interface.iter().zip(u) {
                b[i as usize] = u;
            }
        }
    }

    /// Applies `work` to a single vector.
    fn one(&self, b: &mut [f64], work: impl Fn(&Condensation, &mut [Vec<f64>])) {
        let mut columns = [b.to_vec()];
        work(self, &mut columns);
        b.copy_from_slice(&columns[0]);
    }

    fn bytes(&self) -> usize {
        self.interior.bytes() + 12 * self.coupling.nnz()
    }
}
