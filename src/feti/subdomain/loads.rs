//! Condensation of loads to the interface, and back substitution from interface values.

use super::problem::LocalProblem;

impl LocalProblem {
    /// Condenses loads, at most [`LANES`](cholesky::lanes::LANES). Returns (work, g) for each with g = f_Γ −
    /// K_ΓI K_II⁻¹ f_I in the order of Γ. `work` is for
    /// [`ScaledSubdomain::recover_many`](super::scaled::ScaledSubdomain::recover_many).
    pub fn condense_many(&self, loads: &[&[f64]]) -> Vec<(Vec<f64>, Vec<f64>)> {
        self.operators.condense(&self.gamma.interface, loads)
    }

    /// Solutions on all dofs for at most [`LANES`](cholesky::lanes::LANES) parts, each with `work` of
    /// [`condense_many`](Self::condense_many) and the interface values `u_gamma`. The matrix of each part is the
    /// factored one times its entry of `scales`.
    pub(crate) fn recover_many(&self, parts: &[(&[f64], &[f64])], scales: &[f64]) -> Vec<Vec<f64>> {
        let placed = |((work, u_gamma), scale): (&(&[f64], &[f64]), &f64)| {
            let mut x: Vec<f64> = match *scale {
                1.0 => work.to_vec(),
                scale => work.iter().map(|w| w / scale).collect(),
            };
            for (&i, &u) in self.gamma.interface.iter().zip(*u_gamma) {
                x[i as usize] = u;
            }
            x
        };
        let mut x: Vec<Vec<f64>> = parts.iter().zip(scales).map(placed).collect();
        self.operators.recover(&mut x);
        x
    }
}
