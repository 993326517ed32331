//! T, Ψ and Σ from S: a change of basis for averages and other functionals, a choice of dofs to hold where S_ΔΔ is
//! singular, and the change back to the nodal dofs.

use super::problem::Gamma;
use base::linalg::dense::{self, Dense, Scratch};
use cholesky::multifrontal::SingularInterior;

/// S_ΔΔ counts as singular if a pivot is below this fraction of the dof's diagonal entry of K. The dof then becomes a
/// primal dof of its own. A dof that did not need this does no harm, because the primal problem frees it exactly; the
/// bound is generous for that reason.
const WEAKLY_HELD: f64 = 1e-6;

/// T and Σ from S (`schur`) and the diagonal of K on Γ (`stiff`), in the basis in which averages are coordinates and in
/// the order [Δ, vertices, functionals, fixing dofs]; then changed back to the nodal dofs. Ψ and the fixing dofs are
/// left in `gamma`.
pub(super) fn condense_dual(
    gamma: &mut Gamma,
    schur: &Dense,
    stiff: &[f64],
) -> Result<(Dense, Dense), SingularInterior> {
    let (n_delta, n_gamma) = (gamma.n_delta, gamma.n_gamma());
    let pivots = gamma.basis.pivots();
    let mut order = moved_to_the_end(n_gamma, n_delta, &pivots);
    let mut n = n_delta - pivots.len();
    let changed = (!pivots.is_empty()).then(|| {
        let mut s = schur.clone();
        gamma.basis.congruence_to_coordinates(&mut s);
        permuted(&s, &order)
    });
    let mut s = changed.as_ref().unwrap_or(schur);
    let stiff: Vec<f64> = order.iter().map(|&i| stiff[i]).collect();
    let mut scratch = Scratch::default();
    let held;
    let mut l = match try_cholesky(s, &stiff, n, &mut scratch) {
        Some(l) => l,
        None => {
            // Hold the dofs that keep S_ΔΔ from being definite.
            let fixing = weakest(s, &stiff, n);
            let moved = moved_to_the_end(n_gamma, n, &fixing);
            gamma.fixing = fixing.iter().map(|&i| order[i]).collect();
            order = moved.iter().map(|&i| order[i]).collect();
            let stiff: Vec<f64> = moved.iter().map(|&i| stiff[i]).collect();
            held = permuted(s, &moved);
            s = &held;
            n -= fixing.len();
            let singular = SingularInterior {
                dof: gamma.interface[order[n]],
            };
            try_cholesky(s, &stiff, n, &mut scratch).ok_or(singular)?
        }
    };
    let n_pi = n_gamma - n;
    let t = dense::inverse_from_cholesky(l.view(), &mut scratch);
    l.data = Vec::new();

    let s_delta_pi = s.view().submatrix(0, n, n, n_pi);
    let mut psi = Dense::zeros(n, n_pi);
    dense::multiply(psi.view_mut(), false, -1.0, t.view(), s_delta_pi);
    let mut sigma = Dense::zeros(n_pi, n_pi);
    for j in 0..n_pi {
        let column = s.col(n + j)[n..].to_vec();
        sigma.col_mut(j).copy_from_slice(&column);
    }
    dense::multiply(
        sigma.view_mut(),
        true,
        1.0,
        s_delta_pi.transpose(),
        psi.view(),
    );
    sigma.symmetrise();
    if n < n_delta {
        return Ok(back_to_nodes(gamma, &t, &psi, sigma, &order));
    }
    gamma.psi = psi;
    Ok((t, sigma))
}

/// T and Σ with T and Ψ changed to the nodal dofs of Δ, and primal values in units of the functionals.
fn back_to_nodes(
    gamma: &mut Gamma,
    t: &Dense,
    psi: &Dense,
    mut sigma: Dense,
    order: &[usize],
) -> (Dense, Dense) {
    let (n_delta, n) = (gamma.n_delta, t.rows);
    let mut nodal = Dense::zeros(n_delta, n_delta);
    for (j, &oj) in order[..n].iter().enumerate() {
        for (i, &oi) in order[..n].iter().enumerate() {
            nodal.set(oi, oj, t.get(i, j));
        }
    }
    gamma.basis.congruence_to_nodes(&mut nodal);
    let t = nodal;
    let mut nodal = Dense::zeros(n_delta, psi.cols);
    for p in 0..psi.cols {
        for (i, &oi) in order[..n].iter().enumerate() {
            nodal.set(oi, p, psi.get(i, p));
        }
        if order[n + p] < n_delta {
            nodal.set(order[n + p], p, 1.0);
        }
    }
    let first = gamma.n_vertices();
    for k in 0..gamma.basis.len() {
        let (p, factor) = (first + k, gamma.basis.factor(k));
        nodal.col_mut(p).iter_mut().for_each(|v| *v *= factor);
        sigma.col_mut(p).iter_mut().for_each(|v| *v *= factor);
        for q in 0..sigma.cols {
            let value = factor * sigma.get(p, q);
            sigma.set(p, q, value);
        }
    }
    gamma.basis.columns_to_nodes(&mut nodal);
    gamma.psi = nodal;
    (t, sigma)
}

/// L of S_ΔΔ = L Lᵀ; `None` if a pivot is small against the dof's diagonal entry of K (`stiff`).
fn try_cholesky(s: &Dense, stiff: &[f64], n_delta: usize, scratch: &mut Scratch) -> Option<Dense> {
    let mut l = Dense::zeros(n_delta, n_delta);
    for j in 0..n_delta {
        l.col_mut(j)[j..].copy_from_slice(&s.col(j)[j..n_delta]);
    }
    dense::cholesky(l.view_mut(), scratch).ok()?;
    let strong = |j: usize| l.get(j, j).powi(2) > WEAKLY_HELD * stiff[j];
    (0..n_delta).all(strong).then_some(l)
}

/// The dual dofs to hold, increasing, so that S_ΔΔ on the others is definite. They are those that a Cholesky
/// factorisation with diagonal pivoting leaves with a small pivot; pivots are relative to the dofs' diagonal entries of
/// K (`stiff`).
fn weakest(s: &Dense, stiff: &[f64], n: usize) -> Vec<usize> {
    let scale: Vec<f64> = stiff[..n].iter().map(|k| k.sqrt()).collect();
    let mut a = Dense::zeros(n, n);
    for j in 0..n {
        for i in 0..n {
            a.set(i, j, s.get(i, j) / (scale[i] * scale[j]));
        }
    }
    let mut left: Vec<usize> = (0..n).collect();
    loop {
        let best = left.iter().enumerate().max_by(|x, y| {
            a.get(*x.1, *x.1)
                .total_cmp(&a.get(*y.1, *y.1))
                .then(y.1.cmp(x.1))
        });
        let Some((at, &p)) = best else { break };
        let pivot = a.get(p, p);
        if pivot <= WEAKLY_HELD || pivot.is_nan() {
            break;
        }
        left.swap_remove(at);
        let column: Vec<f64> = a.col(p).to_vec();
        for &j in &left {
            let factor = column[j] / pivot;
            for &i in &left {
                let v = a.get(i, j) - column[i] * factor;
                a.set(i, j, v);
            }
        }
    }
    left.sort_unstable();
    left
}

/// The order [Δ without `moved`, the rest, moved].
fn moved_to_the_end(n: usize, n_delta: usize, moved: &[usize]) -> Vec<usize> {
    let stays = (0..n_delta).filter(|i| !moved.contains(i));
    stays
        .chain(n_delta..n)
        .chain(moved.iter().copied())
        .collect()
}

fn permuted(s: &Dense, order: &[usize]) -> Dense {
    let mut out = Dense::zeros(order.len(), order.len());
    for (j, &oj) in order.iter().enumerate() {
        for (i, &oi) in order.iter().enumerate() {
            out.set(i, j, s.get(oi, oj));
        }
    }
    out
}
