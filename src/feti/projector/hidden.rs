//! Motions that nothing holds and that no pivot of a sparse factor shows.
//!
//! Many columns are factored without a choice of pivots. The last pivot of a singular matrix is then rounding over the
//! square of the last entry of its null vector, and no small number if that entry is small: a stack of bodies that
//! slides under a last one which it lifts a little. Inverse iteration finds the vector; mostly a single solve tells
//! that there is none.

use super::gram::{Gram, GramFactor, REGULAR};
use super::kernel_motion::{KernelMotion, NOTHING_SOLVED};
use super::refined::probe;
use parallel::exchange::sum_all;

/// Steps of inverse iteration.
const STEPS: usize = 3;

/// The smallest eigenvalue of the matrix, scaled to a unit diagonal, that may be rounding. Slender stacks of bodies
/// have small ones of their own, so that the motion has to be tried on the rows.
const ROUNDING: f64 = 1e-13;

impl Gram {
    /// The motion on which a sparse factor of all columns that it keeps is weakest, and the name of its column that is
    /// best left out; `None` if the factor is regular. Collective.
    pub fn weakest(&self) -> Option<(u32, KernelMotion)> {
        let GramFactor::Sparse { factor, scale } = &self.factor else {
            return None;
        };
        let team = factor.team();
        let comm = team.comm();
        let n_own = team.sizes().0;
        let kept = |c: u32| f64::from(u8::from(scale[c as usize] > 0.0));
        let known = &self.known;
        let start = |c: u32| kept(c) * probe(known.name(c) as usize);
        let mut shares: Vec<f64> = team.dofs().map(start).collect();
        let norm = |own: &[f64]| {
            let mut sum = [own.iter().map(|v| v * v).sum::<f64>()];
            sum_all(comm, &mut sum);
            sum[0].sqrt()
        };
        let (mut before, mut least) = (norm(&shares[..n_own]), f64::INFINITY);
        for _ in 0..STEPS {
            // Ghosts are shares of what their owners have.
            shares[n_own..].fill(0.0);
            factor.solve_shares(&mut shares); /*                         x ← A⁺ x / ‖x‖ */
            let after = norm(&shares[..n_own]);
            least = least.min(before / after);
            // What is not a number is not regular, and no motion.
            if least > REGULAR || !after.is_finite() {
                self.smallest
                    .set(if after.is_finite() { least } else { 0.0 });
                return None;
            }
            shares.iter_mut().for_each(|x| *x /= after);
            before = 1.0;
        }
        if least > ROUNDING {
            return None;
        }
        let mut x = vec![0.0; known.n()];
        team.own_dofs()
            .zip(&shares)
            .for_each(|(c, v)| x[c as usize] = *v);
        known.sum(comm, &mut x);
        // The largest entry, and of equal ones the first.
        let column = known.motion(comm, &x, 0.0).first_largest()?;
        x.iter_mut().zip(scale).for_each(|(x, s)| *x *= s);
        Some((column, known.motion(comm, &x, NOTHING_SOLVED)))
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/projector/hidden.rs"]
mod tests;
