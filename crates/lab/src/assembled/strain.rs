//! The energy norm of displacements that are mostly rigid motions.
//!
//! Where nothing but contact holds a body, and no load drives it, it may stand in many places. Two solutions then
//! differ by a motion r without energy, of any size. K r = 0 holds in numbers only to ε ‖K‖, so that wᵀK w of their
//! difference has rounding of ε ‖K‖ |r|², of either sign, which can be 1e-3 of the solution. The energy is therefore
//! that of w − r, subdomain by subdomain.

use super::layout::UnknownLayout;
use super::system::AssembledSystem;
use base::linalg::strained::{strained, RIGID};
use base::Result;
use fetifeti::Subdomain;
use parallel::contiguous_share;
use parallel::exchange::sum_all;
use petsc::{PetscInt, Scatter, Session, Vec as PetscVec};

/// √(wᵀ K w), whatever rigid motions w has; K is that of `system`. Collective.
///
/// # Errors
/// As [`Scene::subdomain`](scene::Scene::subdomain), and PETSc's.
pub fn energy_norm(
    session: &Session,
    layout: &UnknownLayout,
    system: &AssembledSystem,
    w: &PetscVec,
) -> Result<f64> {
    let plain = system.energy_norm(w)?;
    let d = w.duplicate()?;
    system.a.diagonal(&d)?;
    d.pointwise_mult(&d, w)?;
    if plain * plain > RIGID * d.dot(w)? {
        return Ok(plain);
    }
    let scene = layout.scene();
    let share = contiguous_share(scene.n_subdomains(), session.size(), session.rank());
    let mine: Result<Vec<Subdomain>> = share.map(|s| scene.subdomain(s)).collect();
    let mine = session.agree(mine)?;
    let values = values(session, layout, w, &mine, false)?;
    let each = mine.iter().zip(&values).map(|(s, v)| energy(s, v));
    let mut sum = [each.sum::<f64>()];
    sum_all(session.comm(), &mut sum);
    Ok(sum[0].max(0.0).sqrt())
}

/// u at the dofs of these subdomains, through frames and equations: Σ coefficient · w, with the offsets of equations if
/// w stands for displacements and without them if it is a difference of two. Collective.
///
/// # Errors
/// PETSc's.
pub fn values(
    session: &Session,
    layout: &UnknownLayout,
    w: &PetscVec,
    subdomains: &[Subdomain],
    offsets: bool,
) -> Result<Vec<Vec<f64>>> {
    let dofs = || subdomains.iter().flat_map(|s| &s.dofs);
    let terms: Vec<(Vec<(u64, f64)>, f64)> =
        dofs().map(|&dof| layout.terms(layout.index(dof))).collect();
    let places = terms.iter().flat_map(|(list, _)| list);
    let places: Vec<PetscInt> = places.map(|t| t.0 as PetscInt).collect();
    let near = PetscVec::seq(session, places.len())?;
    Scatter::new(w, &places, &near)?.forward(w, &near)?;
    let near = near.array()?;
    let mut near = near.iter();
    let mut u = terms.iter().map(|(list, offset)| {
        let each = list.iter().zip(&mut near);
        let sum: f64 = each.map(|((_, c), w)| c * w).sum();
        sum + if offsets { *offset } else { 0.0 }
    });
    let of = |s: &Subdomain| u.by_ref().take(s.dofs.len()).collect();
    Ok(subdomains.iter().map(of).collect())
}

/// uᵀ K u of one subdomain.
fn energy(s: &Subdomain, u: &[f64]) -> f64 {
    let of = |u: &[f64]| -> f64 {
        let mut force = vec![0.0; u.len()];
        s.k.mul(u, &mut force);
        u.iter().zip(&force).map(|(u, f)| u * f).sum()
    };
    let plain = of(u);
    let columns = s.near_kernel.as_deref();
    match strained(&s.k, columns, &s.k.diagonal(), u, plain) {
        Some(without) => of(&without),
        None => plain,
    }
}
