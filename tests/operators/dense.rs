//! The operators of docs/theory.md as dense matrices, built directly from the torn substructures.
#![allow(dead_code)] // every test file uses its own part

use std::collections::{BTreeMap, BTreeSet};

use faer::{Mat, Side};
use fetifeti::{FetiFeti, Problem};
use petsc::Vec as PetscVec;

/// A symmetric function of a symmetric positive semidefinite matrix, zero on its kernel.
pub fn on_range(a: &Mat<f64>, f: impl Fn(f64) -> f64) -> Mat<f64> {
    let n = a.nrows();
    if n == 0 {
        return Mat::zeros(0, 0);
    }
    let eig = a.self_adjoint_eigen(Side::Lower).expect("eigenvalues");
    let (u, s) = (eig.U(), eig.S().column_vector());
    let largest = (0..n).fold(0.0f64, |m, i| m.max(s[i].abs()));
    let kept: Vec<f64> = (0..n)
        .map(|i| if s[i] > 1e-11 * largest { f(s[i]) } else { 0.0 })
        .collect();
    let scaled = Mat::from_fn(n, n, |i, j| u[(i, j)] * kept[j]);
    &scaled * u.transpose()
}

pub fn pseudo_inverse(a: &Mat<f64>) -> Mat<f64> {
    on_range(a, |x| 1.0 / x)
}

/// Largest entry of a − b relative to the largest entry of b.
pub fn defect(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    assert_eq!((a.nrows(), a.ncols()), (b.nrows(), b.ncols()));
    let (mut off, mut size) = (0.0f64, 0.0f64);
    for j in 0..b.ncols() {
        for i in 0..b.nrows() {
            off = off.max((a[(i, j)] - b[(i, j)]).abs());
            size = size.max(b[(i, j)].abs());
        }
    }
    if size > 0.0 {
        off / size
    } else {
        off
    }
}

/// The columns of an operator on multipliers, by unit vectors (one rank).
pub fn columns(solver: &FetiFeti, apply: impl Fn(&PetscVec, &PetscVec)) -> Mat<f64> {
    let (x, y) = (
        solver.dual().multipliers().unwrap(),
        solver.dual().multipliers().unwrap(),
    );
    let m = x.to_vec().unwrap().len();
    let mut out = Mat::zeros(m, m);
    for j in 0..m {
        x.set(0.0).unwrap();
        x.array_mut().unwrap()[j] = 1.0;
        apply(&x, &y);
        for (i, v) in y.to_vec().unwrap().into_iter().enumerate() {
            out[(i, j)] = v;
        }
    }
    out
}

/// All operators as dense matrices on copies: the local dofs of all subdomains, one after the other.
pub struct Reference {
    /// B and B_D = (B D⁻¹ Bᵀ)⁺ B D⁻¹, m × copies.
    pub b: Mat<f64>,
    pub bd: Mat<f64>,
    /// B S̃⁺ Bᵀ with an arbitrary generalised inverse.
    pub f: Mat<f64>,
    /// G = B R, where R are the kernels of the floating bodies.
    pub g: Mat<f64>,
    pub m_lumped: Mat<f64>,
    pub m_dirichlet: Mat<f64>,
    pub m_corrected: Mat<f64>,
}

impl Reference {
    /// `rows`: the copies that each multiplier ties, with coefficients.
    pub fn new(problem: &Problem, b: Mat<f64>) -> Reference {
        let start: Vec<usize> = problem
            .local
            .iter()
            .scan(0, |at, s| {
                *at += s.k.n();
                Some(*at - s.k.n())
            })
            .collect();
        let n: usize = problem.local.iter().map(|s| s.k.n()).sum();
        let mut k = Mat::<f64>::zeros(n, n);
        let mut d = vec![0.0; n];
        let mut dof = vec![0; n];
        let mut body = vec![0; n];
        let mut copies: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        let mut vertex = vec![false; n];
        let mut subdomains = vec![0; problem.n_bodies];
        for (s, &at) in problem.local.iter().zip(&start) {
            subdomains[s.body] += 1;
            for i in 0..s.k.n() {
                let (col, val) = s.k.row(i);
                col.iter()
                    .zip(val)
                    .for_each(|(&j, &v)| k[(at + i, at + j as usize)] = v);
                d[at + i] = s.rho[i];
                dof[at + i] = s.dofs[i];
                body[at + i] = s.body;
                copies.entry(s.dofs[i]).or_default().push(at + i);
            }
            s.primal
                .iter()
                .for_each(|&i| vertex[at + i as usize] = true);
        }
        let contact: BTreeSet<u64> = problem
            .rows
            .iter()
            .flat_map(|r| &r.terms)
            .map(|t| t.0)
            .collect();
        let shared = |c: usize| copies[&dof[c]].len() > 1;
        let on_gamma = |c: usize| shared(c) || contact.contains(&dof[c]);
        let primal = |c: usize| vertex[c] && shared(c);

        // W̃: the copies of a shared vertex are one unknown.
        let mut unknown = vec![0; n];
        let mut n_unknowns = 0;
        for c in 0..n {
            let first = copies[&dof[c]][0];
            if primal(c) && first < c {
                unknown[c] = unknown[first];
            } else {
                unknown[c] = n_unknowns;
                n_unknowns += 1;
            }
        }
        let e = Mat::from_fn(n, n_unknowns, |c, u| f64::from(u8::from(unknown[c] == u)));
        let k_tilde = e.transpose() * &k * &e;
        let b_tilde = &b * &e;
        let f = &b_tilde * pseudo_inverse(&k_tilde) * b_tilde.transpose();

        // The kernel of a body is spanned by the constants, if K maps them to zero.
        let mut kernels = Vec::new();
        for candidate in 0..problem.n_bodies {
            let constant = Mat::from_fn(n, 1, |c, _| f64::from(u8::from(body[c] == candidate)));
            let image = &k * &constant;
            let largest = (0..n).fold(0.0f64, |m, c| m.max(image[(c, 0)].abs() / k[(c, c)]));
            if constant.norm_l2() > 0.0 && largest < 1e-12 {
                kernels.push(constant);
            }
        }
        let r = Mat::from_fn(n, kernels.len(), |c, j| kernels[j][(c, 0)]);
        let g = &b * &r;

        let b_over_d = Mat::from_fn(b.nrows(), n, |i, c| b[(i, c)] / d[c]);
        let bd = pseudo_inverse(&(&b_over_d * b.transpose())) * &b_over_d;

        // S on the torn interface: interior dofs are eliminated.
        let gamma: Vec<usize> = (0..n).filter(|&c| on_gamma(c)).collect();
        let inner: Vec<usize> = (0..n).filter(|&c| !on_gamma(c)).collect();
        let pick =
            |r: &[usize], c: &[usize]| Mat::from_fn(r.len(), c.len(), |i, j| k[(r[i], c[j])]);
        let s = pick(&gamma, &gamma)
            - pick(&gamma, &inner) * pseudo_inverse(&pick(&inner, &inner)) * pick(&inner, &gamma);
        let bd_gamma = Mat::from_fn(b.nrows(), gamma.len(), |i, j| bd[(i, gamma[j])]);
        let m_lumped = &bd_gamma * pick(&gamma, &gamma) * bd_gamma.transpose();
        let m_dirichlet = &bd_gamma * &s * bd_gamma.transpose();

        // Ψ: energy-minimal functions with value one at one vertex and zero at the other primal vertices of the
        // subdomain. Corners of a body count only where the body has several subdomains.
        let pins = |c: usize| vertex[c] && on_gamma(c) && (shared(c) || subdomains[body[c]] > 1);
        let (pinned, loose): (Vec<usize>, Vec<usize>) =
            (0..gamma.len()).partition(|&i| pins(gamma[i]));
        let part =
            |r: &[usize], c: &[usize]| Mat::from_fn(r.len(), c.len(), |i, j| s[(r[i], c[j])]);
        let extension = pseudo_inverse(&part(&loose, &loose)) * part(&loose, &pinned);
        let columns = pinned.iter().filter(|&&i| shared(gamma[i]));
        let vertices: BTreeSet<u64> = columns.map(|&i| dof[gamma[i]]).collect();
        let vertices: Vec<u64> = vertices.into_iter().collect();
        let mut z = Mat::<f64>::zeros(gamma.len(), vertices.len());
        for (v, vertex) in vertices.iter().enumerate() {
            for (p, &i) in pinned.iter().enumerate() {
                if dof[gamma[i]] == *vertex {
                    z[(i, v)] = 1.0;
                    loose
                        .iter()
                        .enumerate()
                        .for_each(|(l, &j)| z[(j, v)] -= extension[(l, p)]);
                }
            }
        }
        let place: BTreeMap<usize, usize> =
            gamma.iter().enumerate().map(|(i, &c)| (c, i)).collect();
        let mut lifted = Mat::<f64>::zeros(gamma.len(), vertices.len());
        for (i, &c) in gamma.iter().enumerate() {
            if contact.contains(&dof[c]) {
                continue;
            }
            let all = &copies[&dof[c]];
            let total: f64 = all.iter().map(|&o| d[o]).sum();
            for v in 0..vertices.len() {
                lifted[(i, v)] = all.iter().map(|o| d[*o] / total * z[(place[o], v)]).sum();
            }
        }
        let sz = &s * &lifted;
        let zsz = lifted.transpose() * &sz;
        let corrected = &s - &sz * pseudo_inverse(&zsz) * sz.transpose();
        let m_corrected = &bd_gamma * corrected * bd_gamma.transpose();
        Reference {
            b,
            bd,
            f,
            g,
            m_lumped,
            m_dirichlet,
            m_corrected,
        }
    }
}

/// B of a solver on copies, with the entries of B, and with those of B_D.
pub fn jump_of(solver: &FetiFeti) -> (Mat<f64>, Mat<f64>) {
    let (problem, stiffness) = (solver.problem(), &solver.dual().stiffness);
    let n: usize = problem.local.iter().map(|s| s.k.n()).sum();
    let m = stiffness.jump.n_owned;
    let (mut b, mut bd) = (Mat::zeros(m, n), Mat::zeros(m, n));
    let mut start = 0;
    for (j, sub) in problem.local.iter().enumerate() {
        let columns = stiffness.jump.columns.of(j);
        for e in 0..columns.row.len() {
            let row = stiffness.jump.ghosts[columns.row[e] as usize] as usize;
            let copy =
                start + stiffness.locals[j].gamma().interface[columns.at[e] as usize] as usize;
            b[(row, copy)] += columns.b[e];
            bd[(row, copy)] += columns.bd[e];
        }
        start += sub.k.n();
    }
    (b, bd)
}

/// Eigenvalues of P M⁻¹ Pᵀ F on V ∩ range B, increasing.
pub fn spectrum(a: &Mat<f64>, c: &Mat<f64>) -> Vec<f64> {
    // With A = R R (R the root), the non-zero eigenvalues of C A are those of R C R.
    let root = on_range(a, f64::sqrt);
    let small = &root * c * &root;
    let values = small
        .self_adjoint_eigenvalues(Side::Lower)
        .expect("eigenvalues");
    let rank = {
        let all = a
            .self_adjoint_eigenvalues(Side::Lower)
            .expect("eigenvalues");
        let largest = all.last().copied().unwrap_or(0.0);
        all.iter().filter(|v| **v > 1e-11 * largest).count()
    };
    values[values.len() - rank..].to_vec()
}
