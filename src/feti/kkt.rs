//! The certificate: how well (u, λ) satisfies the optimality conditions of the whole problem, from K, f and B alone.

use super::dual::Dual;
use super::exchange::{max_all, min_all, sum_all};
use crate::petsc::{Session, Vec as PetscVec};
use crate::substructures::Substructures;
use crate::Result;

/// How well the optimality conditions hold, relative to the sizes of their terms.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Kkt {
    /// ‖K u − f + Bᵀ λ‖ / (‖f‖ + ‖Bᵀ λ‖) in the norm of diag(K)⁻¹, in which stiff and soft parts count alike; residuals of
    /// primal dofs and averages are summed over their copies.
    pub stationarity: f64,
    /// Largest violation of B u = c (≤ c) over the largest |u|; inequality rows count whether or not they hold.
    pub feasibility: f64,
    /// Largest |λ_r (B u − c)_r| over inequality rows, relative to max |λ| · max |u|; zero without inequality rows.
    pub complementarity: f64,
    /// Smallest multiplier of an inequality row, relative to max |λ|; zero without inequality rows.
    pub min_multiplier: f64,
}

/// What is known of a pair (u, λ).
pub struct Certificate {
    /// Optimality.
    pub kkt: Kkt,
    /// ½ uᵀ K u − fᵀ u + λᵀ (B u − c), the value of the Lagrangian: equal to the energy at the solution, and stationary there,
    /// so that its error is of second order.
    pub energy: f64,
    /// B u − c on the owned rows, those that do not hold included.
    pub gaps: Vec<f64>,
}

/// Computes the certificate. Collective.
pub fn certify(
    session: &Session,
    problem: &Substructures,
    dual: &Dual,
    u: &[Vec<f64>],
    lambda: &PetscVec,
) -> Result<Certificate> {
    let comm = session.comm();
    let stiffness = &dual.stiffness;
    let jump = &stiffness.jump;
    let mut ghost = vec![0.0; jump.ghosts.len()];
    stiffness.dual_halo.fetch(lambda, &mut ghost)?;

    // [Σ r²/d, Σ f²/d, Σ (Bᵀλ)²/d, energy] with d = diag(K); residuals and d of primal dofs, to be summed over copies
    let mut sums = [0.0; 4];
    let mut primal = vec![0.0; stiffness.space.ghosts.len()];
    let mut primal_d = primal.clone();
    let mut work = stiffness.work();
    for (j, sub) in problem.local.iter().enumerate() {
        let local = &stiffness.locals[j];
        let mut r = vec![0.0; sub.k.n()];
        sub.k.mul(&u[j], &mut r);
        let products = u[j].iter().zip(&r).zip(&sub.f);
        sums[3] += products.map(|((u, ku), f)| u * (0.5 * ku - f)).sum::<f64>();
        let d: Vec<f64> = (0..sub.k.n()).map(|i| sub.k.get(i, i)).collect();
        sums[1] += sub.f.iter().zip(&d).map(|(f, d)| f * f / d).sum::<f64>();
        r.iter_mut().zip(&sub.f).for_each(|(r, f)| *r -= f);
        jump.columns[j].b_transpose_all(&ghost, &mut work[j].v);
        for (&i, v) in local.interface.iter().zip(&work[j].v) {
            r[i as usize] += v;
            sums[2] += v * v / d[i as usize];
        }
        let places = &stiffness.space.of_subdomain[j];
        let fixing = places[local.n_pi() - local.fixing.len()..].iter();
        // Fixing dofs take nothing over: no residual, any divisor.
        fixing.for_each(|&at| primal_d[at as usize] = 1.0);
        // What a copy takes over from another one: a force at a vertex, one along a functional on an edge or face.
        let mut on_gamma: Vec<f64> = local.interface.iter().map(|&i| r[i as usize]).collect();
        let stiff: Vec<f64> = local.interface.iter().map(|&i| d[i as usize]).collect();
        for (i, &at) in (local.n_delta..local.n_gamma()).zip(places) {
            primal[at as usize] += std::mem::take(&mut on_gamma[i]);
            primal_d[at as usize] += stiff[i];
        }
        if !local.basis.is_empty() {
            local.basis.to_coordinates(&mut on_gamma);
            let vectors = local.basis.vectors(stiff.len());
            let pivots = local.basis.pivots().into_iter().zip(&vectors);
            for ((p, q), &at) in pivots.zip(&places[local.n_vertices()..]) {
                primal[at as usize] += std::mem::take(&mut on_gamma[p]);
                let weights = q.iter().zip(&stiff);
                primal_d[at as usize] += weights.map(|(q, d)| q * q * d).sum::<f64>();
            }
            local.basis.to_nodes(&mut on_gamma);
        }
        for (&i, v) in local.interface.iter().zip(&on_gamma) {
            r[i as usize] = *v;
        }
        sums[0] += r.iter().zip(&d).map(|(r, d)| r * r / d).sum::<f64>();
        for (y, &i) in work[j].y.iter_mut().zip(&local.interface) {
            *y = u[j][i as usize];
        }
    }
    let rows = dual.multipliers()?;
    stiffness.jump_of_all(&work, &rows)?;
    let mut gaps = rows.to_vec()?;
    gaps.iter_mut().zip(&jump.gap).for_each(|(b, c)| *b -= c);
    let lambda = lambda.array()?;
    sums[3] += gaps.iter().zip(&*lambda).map(|(b, l)| b * l).sum::<f64>();
    sum_all(comm, &mut sums);
    let primal = stiffness.primal.weighted_square(&primal, &primal_d)?;
    let stationarity = (sums[0] + primal).sqrt() / positive(sums[1].sqrt() + sums[2].sqrt());

    let mut largest = [0.0f64; 4]; // |u|, |λ|, violation, |λ (Bu − c)|
    let mut smallest = [0.0f64];
    largest[0] = u.iter().flatten().fold(0.0, |a, v| a.max(v.abs()));
    for r in 0..jump.n_owned {
        largest[1] = largest[1].max(lambda[r].abs());
        if jump.inequality[r] {
            largest[2] = largest[2].max(gaps[r]);
            largest[3] = largest[3].max((lambda[r] * gaps[r]).abs());
            smallest[0] = smallest[0].min(lambda[r]);
        } else if jump.active[r] {
            largest[2] = largest[2].max(gaps[r].abs());
        }
    }
    drop(lambda);
    max_all(comm, &mut largest);
    min_all(comm, &mut smallest);
    let [u_max, lambda_max, violation, product] = largest;
    Ok(Certificate {
        kkt: Kkt {
            stationarity,
            feasibility: violation / positive(u_max),
            complementarity: product / positive(lambda_max * u_max),
            min_multiplier: smallest[0] / positive(lambda_max),
        },
        energy: sums[3],
        gaps,
    })
}

/// A divisor: one in place of zero, for problems without load.
fn positive(x: f64) -> f64 {
    if x > 0.0 {
        x
    } else {
        1.0
    }
}
