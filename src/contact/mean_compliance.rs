//! How much softer bodies are at the rows than the nodes there alone.
//!
//! ```text
//!     κ̄ = trace(S Pᵀ F P S) / n,      S² = 1 / diag(B diag(K)⁻¹ Bᵀ),      by  xᵀ(…)x with random signs x
//! ```
//!
//! In compact bodies a row gives way by a few times what its nodes do. A thin ring bends: there it is thousands of
//! times that. Rows that are springs are to be measured by what bodies do.

use super::force_balance::ForceBalance;
use crate::feti::LinearMethod;
use crate::Result;
use parallel::exchange::total;

/// κ̄ of the inequalities, from this number of vectors of signs; 1 if there are none. `nodes` is the compliance of the
/// nodes on the owned rows. Collective.
pub fn mean_compliance(method: &LinearMethod, nodes: &[f64], samples: u64) -> Result<f64> {
    let comm = method.session.comm();
    let dual = method.dual();
    let (natural, jump) = (&dual.natural, &dual.stiffness.jump);
    let counts = |i: usize| jump.law[i].is_inequality() && nodes[i] > 0.0;
    let scale: Vec<f64> = (0..nodes.len())
        .map(|i| {
            if counts(i) {
                nodes[i].sqrt().recip()
            } else {
                0.0
            }
        })
        .collect();
    let rows = total(comm, (0..nodes.len()).filter(|&i| counts(i)).count() as f64);
    if rows == 0.0 {
        return Ok(1.0);
    }
    // Forces that move no body as a whole.
    let mut g = natural.all.clone();
    g.scale_rows(&scale);
    let balance = (natural.r > 0).then(|| ForceBalance::new(comm, g, natural));
    let (lambda, image) = (dual.multipliers()?, dual.multipliers()?);
    let mut sum = 0.0;
    for sample in 0..samples {
        let sign = |i: usize| match mixed(samples * (jump.first + i) as u64 + sample) & 1 {
            0 => -1.0,
            _ => 1.0,
        };
        let mut x: Vec<f64> = (0..nodes.len())
            .map(|i| if counts(i) { sign(i) } else { 0.0 })
            .collect();
        if let Some(balance) = &balance {
            balance.project(comm, &mut x);
        }
        let forces = x.iter().zip(&scale).map(|(x, s)| x * s);
        for (l, force) in lambda.array_mut()?.iter_mut().zip(forces) {
            *l = force;
        }
        dual.stiffness.f_mult_all(&lambda, &image)?;
        let work = lambda
            .array()?
            .iter()
            .zip(&*image.array()?)
            .map(|(l, y)| l * y)
            .sum();
        sum += total(comm, work);
    }
    Ok(sum / (samples as f64 * rows))
}

/// A number that looks random, of one that does not (SplitMix64). Signs that repeat would be blind for wide bends.
fn mixed(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
