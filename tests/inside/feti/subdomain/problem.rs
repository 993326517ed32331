//! The operators of one subdomain compared with its matrix.

use super::*;
use crate::feti::interface::entities::AverageKind;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::feti::subdomain::which::Operator;
use crate::matrices::{distance, grid_laplacian, random};

#[test]
fn s_plus_inverts_a_definite_subdomain() {
    // With one subdomain, S̃⁺ = T + Ψ Σ⁻¹ Ψᵀ is S⁻¹; interiors come back through condense and recover.
    let (k, x) = grid_laplacian(9, 9, 0.1);
    let delta: Vec<u32> = (1..8).collect();
    for form in [OperatorForm::Explicit, OperatorForm::Implicit] {
        s_plus_inverts(&k, &x, &delta, form);
    }
}

fn s_plus_inverts(k: &Csr, x: &[[f64; 3]], delta: &[u32], form: OperatorForm) {
    let local = LocalProblem::new(
        k,
        delta,
        &[0, 8],
        &[],
        Some(x),
        Condenser::alone(Keep::Interior),
        form,
    )
    .expect("definite");
    assert_eq!(local.is_implicit(), form == OperatorForm::Implicit);
    assert!(local.gamma.fixing.is_empty());
    let u = random(k.n(), 5);
    let mut f = vec![0.0; k.n()];
    k.mul(&u, &mut f);
    let (work, g) = local.condense_many(&[&f]).remove(0);
    let local = ScaledSubdomain::new(Arc::new(local), 1.0);
    let mut p = vec![0.0; 2];
    let half = local.begin(&g, &mut p);
    let (local, whole) = (local.kind(), &local);
    let s = |i, j| local.sigma.get(i, j);
    let det = s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0);
    let c = [
        (s(1, 1) * p[0] - s(0, 1) * p[1]) / det,
        (s(0, 0) * p[1] - s(1, 0) * p[0]) / det,
    ];
    let mut u_gamma = vec![0.0; local.gamma.n_gamma()];
    assert_eq!(whole.in_halves(), form == OperatorForm::Implicit);
    if whole.in_halves() {
        whole.finish(half, &c, &mut u_gamma);
    } else {
        local.apply_one(Operator::T, &g, &mut u_gamma);
        whole.add_psi(&c, &mut u_gamma);
    }
    let back = &local.recover_many(&[(&work, &u_gamma)], &[1.0])[0];
    let error = distance(back, &u);
    assert!(error < 1e-12, "error {error:.1e}");
}

#[test]
fn an_indefinite_or_broken_matrix_is_refused() {
    for value in [-3.0, f64::NAN] {
        let (mut k, x) = grid_laplacian(12, 12, 0.1);
        for i in 0..k.n() {
            let at = k.row_ptr[i]
                + k.row(i)
                    .0
                    .iter()
                    .position(|&j| j as usize == i)
                    .expect("diagonal");
            k.val[at] += value;
        }
        let delta: Vec<u32> = (0..12).collect();
        for form in [OperatorForm::Explicit, OperatorForm::Implicit] {
            let condenser = Condenser::alone(Keep::Interior);
            let made = LocalProblem::new(&k, &delta, &[], &[], Some(&x), condenser, form);
            assert!(made.is_err(), "{value}");
        }
    }
}

#[test]
fn a_floating_subdomain_holds_one_dof_and_its_primal_matrix_vanishes() {
    let (k, x) = grid_laplacian(8, 6, 0.0);
    let delta: Vec<u32> = (0..8).collect();
    let form = OperatorForm::Implicit; // becomes dense: no vertex holds anything
    let local = LocalProblem::new(
        &k,
        &delta,
        &[],
        &[],
        Some(&x),
        Condenser::alone(Keep::Interior),
        form,
    )
    .expect("one is held");
    assert!(!local.is_implicit());
    assert_eq!((local.gamma.fixing.len(), local.gamma.n_pi()), (1, 1));
    assert!(local.sigma.get(0, 0).abs() < 1e-13);
    assert!(local.gamma.psi.data.iter().all(|v| (v - 1.0).abs() < 1e-12));
}

#[test]
fn sparse_solves_and_dense_matrices_are_the_same_operators() {
    let (k, x) = grid_laplacian(11, 7, 0.0);
    let node = |x: u32, y: u32| x + 11 * y;
    let delta: Vec<u32> = (1..10).chain((1..6).map(|y| node(10, y))).collect();
    let vertices = [node(0, 0), node(10, 0), node(10, 6)];
    let average = |kind, dofs: &[u32], weights| Average {
        kind,
        key: 0,
        dofs: dofs.to_vec(),
        weights,
    };
    // The means over both edges, and what changes along the first.
    let slope = (0..9).map(|i| f64::from(i) - 4.0).collect();
    let averages = [
        average(AverageKind::Mean, &delta[..9], None),
        average(AverageKind::Mean, &delta[9..], None),
        average(AverageKind::Motion, &delta[..9], Some(slope)),
    ];
    let averages: Vec<&Average> = averages.iter().collect();
    let make = |form| {
        LocalProblem::new(
            &k,
            &delta,
            &vertices,
            &averages,
            Some(&x),
            Condenser::alone(Keep::Interior),
            form,
        )
    };
    let dense = make(OperatorForm::Explicit).expect("held by vertices");
    let sparse = make(OperatorForm::Implicit).expect("held by vertices");
    assert!(sparse.is_implicit() && !dense.is_implicit());
    let close = |a: &[f64], b: &[f64]| {
        let far = distance(a, b);
        assert!(far < 1e-12, "{far:.1e}");
    };
    let columns = Dense {
        rows: dense.gamma.n_gamma(),
        cols: 11,
        data: random(11 * dense.gamma.n_gamma(), 4),
    };
    let mut stored = make(OperatorForm::Implicit).expect("held by vertices");
    stored.store_psi();
    let [dense, sparse, stored] =
        [dense, sparse, stored].map(|local| ScaledSubdomain::new(Arc::new(local), 1.0));
    assert!(sparse.in_halves() && !stored.in_halves());
    close(&dense.psi().data, &sparse.psi().data);
    close(&dense.psi().data, &stored.psi().data);
    // Ψᵀ V, and T V + Ψ C, of several vectors and of one.
    let n_pi = dense.gamma().n_pi();
    let c = Dense {
        rows: n_pi,
        cols: 11,
        data: random(11 * n_pi, 6),
    };
    let both = |local: &ScaledSubdomain| {
        let (mut p, mut y) = (Dense::zeros(n_pi, 11), columns.clone());
        let half = local.begin_many(&columns, &mut p);
        local.finish_many(half, &columns, &c, &mut y);
        [p.data, y.data].concat()
    };
    close(&both(&dense), &both(&sparse));
    close(&both(&dense), &both(&stored));
    let (mut p, mut y) = (c.clone(), columns.clone());
    for k in 0..11 {
        let half = sparse.begin(columns.col(k), p.col_mut(k));
        sparse.finish(half, c.col(k), y.col_mut(k));
    }
    close(&both(&dense), &[p.data, y.data].concat());
    let (mut ours, mut theirs) = (columns.clone(), columns);
    sparse.add_psi(c.col(0), ours.col_mut(0));
    dense.add_psi(c.col(0), theirs.col_mut(0));
    close(&ours.data, &theirs.data);
    let (dense, sparse) = (dense.kind(), sparse.kind());
    close(&dense.sigma.data, &sparse.sigma.data);
    close(&dense.s().data, &sparse.s().data);
    let t = |local: &LocalProblem| {
        let n = local.gamma.n_delta;
        let all = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
        let entries = all.map(|(i, j)| local.entry(Operator::T, i, j));
        entries.collect::<Vec<_>>()
    };
    close(&t(dense), &t(sparse));
    // More columns than are processed side by side, and a load.
    let v = Dense {
        rows: dense.gamma.n_gamma(),
        cols: 11,
        data: random(11 * dense.gamma.n_gamma(), 3),
    };
    for which in [Operator::S, Operator::T] {
        let n = dense.order(which);
        let head = |c: usize| v.col(c)[..n].to_vec();
        let v = Dense {
            rows: n,
            cols: 11,
            data: (0..11).flat_map(head).collect(),
        };
        let (mut a, mut b) = (Dense::zeros(n, 11), Dense::zeros(n, 11));
        dense.apply(which, &v, &mut a, 11);
        sparse.apply(which, &v, &mut b, 11);
        close(&a.data, &b.data);
    }
    let loads = [random(k.n(), 7), random(k.n(), 8)];
    let loads: Vec<&[f64]> = loads.iter().map(|f| &f[..]).collect();
    let (a, b) = (dense.condense_many(&loads), sparse.condense_many(&loads));
    let u = random(dense.gamma.n_gamma(), 9);
    for (a, b) in a.iter().zip(&b) {
        close(&a.1, &b.1);
        let a = dense.recover_many(&[(&a.0, &u)], &[3.0]);
        let b = sparse.recover_many(&[(&b.0, &u)], &[3.0]);
        close(&a[0], &b[0]);
    }
}
