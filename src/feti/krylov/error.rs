//! The error of displacements in the energy norm, estimated from K, f and B (docs/theory.md, section 8).
//!
//! ```text
//!     r = f − K u − Bᵀ λ,   δ = c − B u
//!     z = E (S̃⁺ Eᵀ r + R α),   E = I − B_Dᵀ B                     a correction with B z = 0
//!     ‖u − u*‖²_K  ≈  max(rᵀz, (rᵀz)² / zᵀK_ΓΓ z)  +  |B_Dᵀ δ|²_KΓΓ
//! ```
//!
//! With the right operators the first term is an upper bound of the error that B does not see. The second term is a
//! lower bound with any operators, because it depends on K alone: it is what remains if S̃⁺ is wrong.

use super::loads::Loads;
use super::recovery::LinearSolution;
use super::refinement::remainder;
use super::residual::Iterate;
use crate::feti::method::LinearMethod;
use crate::feti::operators::dual::Dual;
use crate::Result;
use base::linalg::csr::Csr;
use parallel::exchange::sum_all;

/// Residuals inside subdomains are left out if this many times their norm is no error that counts. It bounds the
/// inverse of the smallest singular value of an interior problem that is scaled to unit diagonal.
const INSIDE: f64 = 1e6;

/// An estimate of ‖u − u*‖_K.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Estimate {
    /// A lower bound that depends on K alone.
    pub least: f64,
    /// An upper bound, if the operators are those of K.
    pub most: f64,
}

impl LinearMethod {
    /// Estimates ‖u − u*‖_K, where u* is the solution with the rows that hold. Errors well below `bound` need not be
    /// exact. The cost is about half an iteration. Collective.
    pub(crate) fn energy_error(&self, solution: &LinearSolution, bound: f64) -> Result<Estimate> {
        let (problem, dual) = (&self.problem, &*self.dual());
        let _timed = dual.timed_certificate()?;
        let (stiffness, left) = (&dual.stiffness, &solution.left);
        let mut inside = 0.0;
        let loads = if INSIDE * left.inside <= bound {
            let g = left.on_gamma.clone();
            let f: Vec<&[f64]> = g.iter().map(Vec::as_slice).collect();
            let kernel = dual.natural.kernel_load(dual.comm(), &f, &g);
            Loads {
                interiors: Vec::new(),
                kernel,
                g,
                jumps: None,
            }
        } else {
            let lambda = dual.multipliers()?;
            lambda.array_mut()?.copy_from_slice(&solution.lambda);
            let forces = remainder(problem, dual, &solution.u, &lambda)?.0;
            let f: Vec<&[f64]> = forces.iter().map(Vec::as_slice).collect();
            let loads = Loads::of(dual, &f, None);
            inside = work_inside(dual, &loads, &f);
            loads
        };
        let z = correction(dual, loads)?;

        // B_Dᵀ δ
        let mut ghost = stiffness.scaled_ghosts();
        let rows = dual.multipliers()?;
        {
            let jump = &stiffness.jump;
            let mut rows = rows.array_mut()?;
            for (r, row) in rows.iter_mut().enumerate() {
                if jump.active[r] {
                    *row = jump.held[r] - jump.gap[r] - solution.gaps[r];
                }
            }
        }
        stiffness.fetch_scaled(&rows, &mut ghost)?;
        let (locals, columns) = (&stiffness.locals, &stiffness.jump.columns);
        let parts = stiffness.team.map(problem.local.len(), |j| {
            let (k, interface) = (&problem.local[j].k, &locals[j].gamma().interface);
            let mut open = vec![0.0; interface.len()];
            columns.of(j).bd_transpose(&ghost, &mut open);
            [
                z[j].0.iter().zip(&z[j].1).map(|(g, z)| g * z).sum(),
                energy(k, interface, &z[j].1),
                energy(k, interface, &open),
            ]
        });
        let mut sums = [0.0, 0.0, 0.0, inside];
        for part in parts {
            sums.iter_mut().zip(part).for_each(|(s, p)| *s += p);
        }
        sum_all(dual.comm(), &mut sums);
        let [work, of_z, open, inside] = sums;
        let least = if of_z > 0.0 { work * work / of_z } else { 0.0 };
        Ok(Estimate {
            least: (least + inside).sqrt(),
            most: (work.max(least) + inside + open).sqrt(),
        })
    }
}

/// Eᵀ r in the sense of [`Loads::g`], and z, on Γ of each local subdomain. Collective.
fn correction(dual: &Dual, loads: Loads) -> Result<Vec<(Vec<f64>, Vec<f64>)>> {
    let stiffness = &dual.stiffness;
    let columns = &stiffness.jump.columns;
    let closed = vec![0.0; stiffness.jump.n_owned];
    let mut at = Iterate::new(
        dual,
        Loads {
            jumps: Some(closed),
            ..loads
        },
    )?;
    let mut ghost = stiffness.scaled_ghosts();
    for (columns, g) in columns.iter().zip(&at.loads.g) {
        columns.add_bd(g, &mut ghost); /*                       λ ← B_D g                 */
    }
    stiffness.sum_scaled(&ghost, &at.lambda)?;
    at.balance(dual)?; /*                                       λ ← λ + Q G (GᵀQG)⁻¹ (…)  */
    at.place(dual)?; /*                                         y ← S̃⁺(g − Bᵀλ) + R α     */
    stiffness.jump_of(&at.residual.work, &at.residual.r)?;
    stiffness.fetch_scaled(&at.residual.r, &mut ghost)?;
    stiffness.team.for_each(&mut at.residual.work, |j, w| {
        columns.of(j).bd_transpose(&ghost, &mut w.v);
        w.y.iter_mut().zip(&w.v).for_each(|(y, v)| *y -= v); /* z ← y − B_Dᵀ B y          */
    });
    let z = at.residual.work.into_iter().map(|w| w.y);
    Ok(at.loads.g.into_iter().zip(z).collect())
}

/// f_Iᵀ K_II⁻¹ f_I over the subdomains of this rank.
pub(super) fn work_inside(dual: &Dual, loads: &Loads, f: &[&[f64]]) -> f64 {
    let locals = &dual.stiffness.locals;
    let works = dual.stiffness.team.map(locals.len(), |j| {
        let x = loads.inside(locals, j);
        let terms = x.iter().zip(f[j]);
        terms.map(|(x, f)| x * f).sum::<f64>()
    });
    works.iter().sum()
}

/// vᵀ K_ΓΓ v.
fn energy(k: &Csr, interface: &[u32], v: &[f64]) -> f64 {
    let mut x = vec![0.0; k.n()];
    let at = || interface.iter().zip(v).filter(|(_, v)| **v != 0.0);
    at().for_each(|(&i, v)| x[i as usize] = *v);
    let force = |i: u32| {
        let (col, val) = k.row(i as usize);
        let terms = col.iter().zip(val).map(|(&j, k)| k * x[j as usize]);
        terms.sum::<f64>()
    };
    at().map(|(&i, v)| v * force(i)).sum()
}
