//! The certificate measures how well (u, λ) satisfies the optimality conditions of the whole problem. It uses K, f and
//! B alone.

use super::leftover::Leftover;
use crate::feti::jump::columns::JumpColumns;
use crate::feti::operators::dual::Dual;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::substructures::{Problem, Subdomain};
use crate::Result;
use base::linalg::strained::strained;
use parallel::exchange::{max_all, sum_all};
use petsc::Vec as PetscVec;

/// The certificate may be this many times the tolerance of the iteration, because the iteration measures another norm.
const CREDIBLE: f64 = 1e4;

/// Displacements and forces below this part of the problem's scale are measured against that scale: a solution u = 0
/// has none of its own, and bodies may touch without force.
const SMALL: f64 = 1e-8;

/// How well the optimality conditions hold, relative to the sizes of their terms.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct Kkt {
    /// ‖K u − f + Bᵀ λ‖ / (‖f‖ + ‖Bᵀ λ‖) in the norm of diag(K)⁻¹, in which stiff and soft parts have the same weight.
    /// Residuals of primal dofs and averages are summed over their copies.
    pub stationarity: f64,
    /// Largest violation of B u = c (≤ c) over the largest |u|; inequality rows count whether or not they hold.
    pub feasibility: f64,
    /// Largest |λ_r (B u − c)_r| over inequality rows, relative to max |λ| · max |u|; zero without inequality rows.
    pub complementarity: f64,
    /// Smallest multiplier of an inequality row, relative to max |λ|; zero without inequality rows.
    pub min_multiplier: f64,
    /// Estimate of ‖u − u*‖_K / ‖u‖_K, where u* is the solution with the rows that hold; `None` where the iteration did
    /// not converge.
    pub error: Option<f64>,
}

impl Kkt {
    /// Whether displacements and rows are a solution at this relative tolerance. NaN never is.
    pub fn is_credible(&self, rtol: f64) -> bool {
        self.beyond(rtol) <= 1.0
    }

    /// How far displacements and rows are from a solution at this relative tolerance: beyond 1 they are none. NaN if
    /// one of them is.
    pub(crate) fn beyond(&self, rtol: f64) -> f64 {
        let forces = self.stationarity / (CREDIBLE * rtol).clamp(1e-3, 0.5);
        let jumps = self.feasibility / (CREDIBLE * rtol).clamp(1e-6, 0.1);
        if (forces + jumps).is_nan() {
            f64::NAN
        } else {
            forces.max(jumps)
        }
    }
}

/// Optimality, energy and gaps of a pair (u, λ).
pub struct Certificate {
    /// Optimality.
    pub kkt: Kkt,
    /// ½ uᵀ K u − fᵀ u + λᵀ (B u − c) − ½ λᵀ C λ, the value of the Lagrangian. At the solution it equals the energy and
    /// is stationary; its error is therefore of second order.
    pub energy: f64,
    /// B u − C λ − c on the owned rows, including those that do not hold.
    pub gaps: Vec<f64>,
    /// The residuals that the estimate of the error begins with.
    pub left: Leftover,
}

impl Certificate {
    /// Computes the certificate from the displacements of each local subdomain and the multipliers. `known` is a
    /// displacement of the problem's scale; right-hand sides of the rows are others. Collective.
    pub fn new(
        problem: &Problem,
        dual: &Dual,
        u: &[Vec<f64>],
        lambda: &PetscVec,
        known: f64,
    ) -> Result<Certificate> {
        let _timed = dual.timed_certificate()?;
        let comm = dual.comm();
        let stiffness = &dual.stiffness;
        let jump = &stiffness.jump;
        let mut ghost = vec![0.0; jump.ghosts.len()];
        stiffness.dual_halo.fetch(lambda, &mut ghost)?;

        let (locals, places) = (&stiffness.locals, &stiffness.space.of_subdomain);
        let examined = stiffness.team.map(locals.len(), |j| {
            let (sub, columns) = (&problem.local[j], jump.columns.of(j));
            examine((sub, &u[j]), &locals[j], (columns, &ghost), &places[j])
        });
        let mut sums = [0.0; 8];
        let mut on_gamma = Vec::new();
        let mut primal = vec![0.0; stiffness.space.ghosts.len()];
        let mut primal_d = primal.clone();
        let mut scale = known;
        let mut work = stiffness.work();
        for (part, work) in examined.into_iter().zip(&mut work) {
            sums.iter_mut().zip(part.sums).for_each(|(s, p)| *s += p);
            for (at, r, d) in part.primal {
                primal[at as usize] += r;
                primal_d[at as usize] += d;
            }
            // Fixing dofs take no force over from other copies: their residual is zero, and any divisor will do.
            part.fixing
                .iter()
                .for_each(|&at| primal_d[at as usize] = 1.0);
            work.y = part.on_interface;
            scale = scale.max(part.loaded);
            on_gamma.push(part.residual);
        }
        let rows = dual.multipliers()?;
        stiffness.jump_of_all(&work, &rows)?;
        let mut gaps = rows.to_vec()?;
        gaps.iter_mut().zip(&jump.gap).for_each(|(b, c)| *b -= c);
        let lambda = lambda.array()?;
        jump.less_compression(&lambda, &mut gaps);
        // The work of friction on a slip is no energy.
        let slips = |r: &usize| jump.law[*r].is_friction() && !jump.active[*r];
        let rows = (0..jump.n_owned).filter(|r| !slips(r));
        sums[3] += rows.map(|r| gaps[r] * lambda[r]).sum::<f64>();
        let compressed = jump.compliance.iter().zip(&*lambda);
        sums[3] += compressed.map(|(c, l)| 0.5 * c * l * l).sum::<f64>();
        sum_all(comm, &mut sums);
        let primal = stiffness.primal.weighted_square(&primal, &primal_d)?;
        let forces = sums[1].sqrt() + sums[2].sqrt();
        let residual = (sums[0] + primal).sqrt();

        // |u|, |λ|, violation, |λ (Bu − c)|, scale, loads of a subdomain, pull
        let mut largest = [0.0, 0.0, 0.0, 0.0, scale, problem.largest_load(), 0.0];
        largest[0] = u.iter().flatten().fold(0.0, |a, v| a.max(v.abs()));
        for r in 0..jump.n_owned {
            largest[1] = largest[1].max(lambda[r].abs());
            if jump.is_candidate(r) {
                largest[4] = largest[4].max(jump.gap[r].abs());
            }
            let law = jump.law[r];
            largest[2] = largest[2].max(law.violation(gaps[r], jump.active[r]));
            largest[3] = largest[3].max(law.complementarity(lambda[r], gaps[r]));
            largest[6] = largest[6].max(law.pull(lambda[r]));
        }
        drop(lambda);
        max_all(comm, &mut largest);
        let [u_max, lambda_max, violation, product, length, load, pull] = largest;
        let lambda_max = lambda_max.max(SMALL * load);
        let (u_least, least) = (SMALL * length, SMALL * length * sums[7].sqrt());
        Ok(Certificate {
            kkt: Kkt {
                stationarity: residual / positive(forces.max(least)),
                feasibility: violation / positive(u_max.max(u_least)),
                complementarity: product / positive(lambda_max * u_max.max(u_least)),
                min_multiplier: 0.0 - pull / positive(lambda_max),
                error: None,
            },
            left: Leftover {
                on_gamma,
                inside: sums[4].sqrt(),
                size: sums[5].max(0.0).sqrt().max(least),
                terms: sums[6].sqrt() + forces,
            },
            energy: sums[3],
            gaps,
        })
    }
}

/// The contribution of one subdomain to the certificate.
struct Examined {
    /// Σ r²/d, Σ f²/d, Σ (Bᵀλ)²/d and the energy, with d = diag(K); then Σ r²/d inside, uᵀK u, Σ d u² and Σ d.
    sums: [f64; 8],
    /// Residuals and d of primal dofs, which are summed over copies: (ghost, r, d).
    primal: Vec<(u32, f64, f64)>,
    /// Ghosts of fixing dofs.
    fixing: Vec<u32>,
    /// The largest |f/d|: a displacement of the problem's scale, also where all is held and u = 0.
    loaded: f64,
    /// u on Γ.
    on_interface: Vec<f64>,
    /// f − K u − Bᵀ λ on Γ.
    residual: Vec<f64>,
}

fn examine(
    (sub, u): (&Subdomain, &[f64]),
    local: &ScaledSubdomain,
    (columns, ghost): (JumpColumns<'_>, &[f64]),
    places: &[u32],
) -> Examined {
    let mut sums = [0.0; 8];
    let mut primal = Vec::new();
    let mut r = vec![0.0; sub.k.n()];
    sub.k.mul(u, &mut r);
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let d = sub.k.diagonal();
    sums[5] = dot(u, &r);
    // A rigid motion has no forces; in numbers it has, where the subdomain is stiff.
    if let Some(v) = strained(&sub.k, sub.near_kernel.as_deref(), &d, u, sums[5]) {
        sub.k.mul(&v, &mut r);
        sums[5] = dot(&v, &r);
    }
    sums[3] = 0.5 * sums[5] - dot(u, &sub.f);
    sums[6] = u.iter().zip(&d).map(|(u, d)| d * u * u).sum();
    sums[7] = d.iter().sum();
    sums[1] = sub.f.iter().zip(&d).map(|(f, d)| f * f / d).sum();
    r.iter_mut().zip(&sub.f).for_each(|(r, f)| *r -= f);
    let mut pull = vec![0.0; local.gamma().n_gamma()];
    columns.b_transpose_all(ghost, &mut pull);
    for (&i, v) in local.gamma().interface.iter().zip(&pull) {
        r[i as usize] += v;
        sums[2] += v * v / d[i as usize];
    }
    let on = |x: &[f64]| -> Vec<f64> {
        local
            .gamma()
            .interface
            .iter()
            .map(|&i| x[i as usize])
            .collect()
    };
    // A copy takes forces over from other copies: at a vertex a force, on an edge or face a force along a functional.
    let (mut on_gamma, stiff) = (on(&r), on(&d));
    let residual = on_gamma.iter().map(|r| -r).collect();
    for (i, &at) in (local.gamma().n_delta..local.gamma().n_gamma()).zip(places) {
        primal.push((at, std::mem::take(&mut on_gamma[i]), stiff[i]));
    }
    if !local.gamma().basis.is_empty() {
        local.gamma().basis.to_coordinates(&mut on_gamma);
        let vectors = local.gamma().basis.vectors(stiff.len());
        let pivots = local.gamma().basis.pivots().into_iter().zip(&vectors);
        for ((p, q), &at) in pivots.zip(&places[local.gamma().n_vertices()..]) {
            let weights = q.iter().zip(&stiff);
            let d = weights.map(|(q, d)| q * q * d).sum::<f64>();
            primal.push((at, std::mem::take(&mut on_gamma[p]), d));
        }
        local.gamma().basis.to_nodes(&mut on_gamma);
    }
    let weigh = |r: &[f64], d: &[f64]| -> f64 { r.iter().zip(d).map(|(r, d)| r * r / d).sum() };
    for &i in &local.gamma().interface {
        r[i as usize] = 0.0;
    }
    sums[4] = weigh(&r, &d);
    sums[0] = sums[4] + weigh(&on_gamma, &stiff);
    let loaded = sub.f.iter().zip(&d).filter(|(_, d)| **d > 0.0);
    let loaded = loaded.map(|(f, d)| (f / d).abs());
    Examined {
        sums,
        loaded: loaded.fold(0.0, f64::max),
        primal,
        fixing: places[local.gamma().n_pi() - local.gamma().fixing.len()..].to_vec(),
        on_interface: on(u),
        residual,
    }
}

/// The divisor x, or one if x is zero (problems without load).
fn positive(x: f64) -> f64 {
    if x > 0.0 {
        x
    } else {
        1.0
    }
}
