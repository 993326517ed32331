//! Factors and Schur complements of matrices of every kind, against dense solutions.

use faer::linalg::solvers::Solve;

use super::{Condenser, InteriorFactor};
use crate::matrices::{grid_laplacian, random};
use crate::multifrontal::PartialCholesky;
use crate::symbolic::{Keep, Symbolic};
use base::linalg::csr::Csr;
use scene::Scene;

/// A subdomain that touches no side of its body: K is singular, and Γ is its whole surface.
struct Case {
    name: &'static str,
    k: Csr,
    x: Vec<[f64; 3]>,
    interface: Vec<u32>,
}

/// The middle one of three subdomains in every direction.
fn cases() -> Vec<Case> {
    let of = |name, dim: usize, elastic: bool, elements: usize| {
        let load = match (elastic, dim) {
            (false, _) => "load = 1.0",
            (true, 2) => "load = [1.0, 0.0]\npoisson = 0.3",
            (true, _) => "load = [1.0, 0.0, 0.0]\npoisson = 0.3",
        };
        let physics = if elastic { "elasticity" } else { "scalar" };
        let text = format!(
            "dimension = {dim}\nphysics = \"{physics}\"\n[grid]\nbodies = 1\nsubdomains = 3\n\
             elements_per_subdomain = {elements}\ndirichlet = \"all\"\n{load}\n"
        );
        let scene = Scene::parse("case", &text).expect("a scene");
        let sub = scene.subdomain(scene.n_subdomains() / 2).expect("there");
        let x = sub.coordinates.clone().expect("a scene has coordinates");
        let range = |a: usize| {
            let of = |f: fn(f64, f64) -> f64, from| x.iter().map(|p| p[a]).fold(from, f);
            (of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY))
        };
        let at_side = |&i: &u32| {
            (0..dim).any(|a| {
                let (low, high) = range(a);
                let v = x[i as usize][a];
                (v - low).min(high - v) < 1e-9
            })
        };
        let interface = (0..sub.k.n() as u32).filter(at_side).collect();
        let k = std::sync::Arc::unwrap_or_clone(sub.k);
        Case {
            name,
            interface,
            x,
            k,
        }
    };
    vec![
        of("scalar 2D", 2, false, 12),
        of("elastic 2D", 2, true, 8),
        of("scalar 3D", 3, false, 6),
        of("elastic 3D", 3, true, 4),
    ]
}

fn pick(k: &Csr, rows: &[u32], cols: &[u32]) -> faer::Mat<f64> {
    faer::Mat::from_fn(rows.len(), cols.len(), |i, j| {
        k.get(rows[i] as usize, cols[j] as usize)
    })
}

fn inside(case: &Case) -> Vec<u32> {
    let kept = |i: &u32| case.interface.contains(i);
    (0..case.k.n() as u32).filter(|i| !kept(i)).collect()
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0f64, |s, v| s.max(v.abs()));
    let far = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    far.fold(0.0, f64::max) / size
}

#[test]
fn solutions_are_those_of_the_dense_matrix() {
    for case in cases() {
        let dofs = inside(&case);
        let a = pick(&case.k, &dofs, &dofs);
        let triplets: Vec<(u32, u32, f64)> = (0..dofs.len() as u32)
            .flat_map(|i| (0..dofs.len() as u32).map(move |j| (i, j)))
            .map(|(i, j)| (i, j, a[(i as usize, j as usize)]))
            .filter(|t| t.2 != 0.0)
            .collect();
        let k = Csr::from_triplets(dofs.len(), &triplets);
        let x: Vec<[f64; 3]> = dofs.iter().map(|&i| case.x[i as usize]).collect();
        let symbolic = Symbolic::new(&k, &[], Some(&x));
        let (factor, _) = PartialCholesky::new(&k, symbolic.into()).expect("definite");
        assert!(factor.bytes() > 8 * k.n());
        let loads: Vec<Vec<f64>> = (0..3).map(|c| random(k.n(), c + 7)).collect();
        let right = faer::Mat::from_fn(k.n(), 3, |i, c| loads[c][i]);
        let dense = a.partial_piv_lu().solve(&right);
        let mut many = loads.clone();
        factor.solve_many(&mut many);
        let mut one = loads[1].clone();
        factor.solve(&mut one);
        for (c, found) in [(0, &many[0]), (1, &many[1]), (2, &many[2]), (1, &one)] {
            let expected: Vec<f64> = (0..k.n()).map(|i| dense[(i, c)]).collect();
            let error = far(found, &expected);
            assert!(error < 1e-10, "{}: {error:.1e}", case.name);
        }
    }
}

#[test]
fn s_is_the_dense_schur_complement_and_the_factor_condenses_and_recovers() {
    let both =
        [Keep::Boundary, Keep::Interior].map(|keep| cases().into_iter().map(move |c| (keep, c)));
    for (keep, case) in both.into_iter().flatten() {
        let (factor, s) = Condenser::alone(keep)
            .condense(&case.k, &case.interface, Some(&case.x))
            .expect("the interior is held");
        let (dofs, gamma) = (inside(&case), &case.interface);
        let inner = pick(&case.k, &dofs, &dofs).partial_piv_lu();
        let dense = pick(&case.k, gamma, gamma)
            - pick(&case.k, gamma, &dofs) * inner.solve(pick(&case.k, &dofs, gamma));
        let error = (s.view() - &dense).norm_max() / dense.norm_max();
        assert!(error < 1e-10, "{}: S {error:.1e}", case.name);

        let (u, v) = (random(case.k.n(), 3), random(case.k.n(), 4));
        let loads = [u, v].map(|u| {
            let mut f = vec![0.0; u.len()];
            case.k.mul(&u, &mut f);
            (u, f)
        });
        let mut many: Vec<Vec<f64>> = loads.iter().map(|l| l.1.clone()).collect();
        factor.forward_many(&mut many);
        let mut one = loads[0].1.clone();
        factor.forward(&mut one);
        check(&factor, &case, &s, &loads[0].0, one, false);
        for (work, (u, _)) in many.into_iter().zip(&loads) {
            check(&factor, &case, &s, u, work, true);
        }
        assert!(factor.bytes() > 8 * dofs.len());
    }
}

/// Checks that the condensed load of K u is S u_Γ, and that back substitution from u_Γ gives u.
fn check(
    factor: &InteriorFactor,
    case: &Case,
    s: &base::linalg::dense::Dense,
    u: &[f64],
    mut work: Vec<f64>,
    many: bool,
) {
    let on_gamma = |v: &[f64]| -> Vec<f64> {
        let gamma = case.interface.iter();
        gamma.map(|&i| v[i as usize]).collect()
    };
    let u_gamma = on_gamma(u);
    let mut g = vec![0.0; u_gamma.len()];
    s.add_mul(&u_gamma, &mut g);
    assert!(far(&on_gamma(&work), &g) < 1e-10, "{}", case.name);
    for (&i, u) in case.interface.iter().zip(&u_gamma) {
        work[i as usize] = *u;
    }
    if many {
        let mut columns = [work];
        factor.backward_many(&mut columns);
        [work] = columns;
    } else {
        factor.backward(&mut work);
    }
    assert!(far(&work, u) < 1e-10, "{}", case.name);
}

#[test]
fn matrices_that_are_not_definite_are_refused() {
    // Nothing holds the last two dofs: their second pivot is zero.
    let (held, mut x) = grid_laplacian(8, 8, 0.5);
    let n = held.n() as u32;
    let mut triplets: Vec<(u32, u32, f64)> = Vec::new();
    for i in 0..n {
        let (col, val) = held.row(i as usize);
        triplets.extend(col.iter().zip(val).map(|(&j, &v)| (i, j, v)));
    }
    triplets.extend([
        (n, n, 1.0),
        (n, n + 1, -1.0),
        (n + 1, n, -1.0),
        (n + 1, n + 1, 1.0),
    ]);
    let k = Csr::from_triplets(n as usize + 2, &triplets);
    x.extend([[9.0, 9.0, 0.0], [10.0, 9.0, 0.0]]);
    let symbolic = Symbolic::new(&k, &[], Some(&x));
    let singular = PartialCholesky::new(&k, symbolic.into());
    let e = singular.expect_err("singular");
    assert!(e.dof >= n, "{e:?}");
    for case in cases() {
        let dofs = inside(&case);
        for (name, value) in [("negative", -1.5), ("zero", -1.0), ("NaN", f64::NAN)] {
            // One pivot in the middle of the interior.
            let mut k = case.k.clone();
            let dof = dofs[dofs.len() / 2] as usize;
            let at = k.row_ptr[dof]
                + k.row(dof)
                    .0
                    .iter()
                    .position(|&j| j as usize == dof)
                    .expect("a diagonal entry");
            k.val[at] += value * k.val[at];
            let found =
                Condenser::alone(Keep::Interior).condense(&k, &case.interface, Some(&case.x));
            assert!(found.is_err(), "{}: {name}", case.name);
        }
        // An eigenvalue below zero although every diagonal entry is positive.
        let mut k = case.k.clone();
        for i in 0..k.n() {
            for e in k.row_ptr[i]..k.row_ptr[i + 1] {
                if k.col[e] as usize == i {
                    k.val[e] *= 0.5;
                }
            }
        }
        let found = Condenser::alone(Keep::Interior).condense(&k, &case.interface, Some(&case.x));
        assert!(found.is_err(), "{}: indefinite", case.name);
    }
}

#[test]
fn an_interface_without_interior_and_an_interior_without_interface() {
    let k = Csr::from_triplets(2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)]);
    let (factor, s) = Condenser::alone(Keep::Interior)
        .condense(&k, &[1, 0], None)
        .expect("nothing to do");
    assert!(far(&s.data, &[2.0, -1.0, -1.0, 2.0]) < 1e-14);
    let mut b = vec![3.0, 4.0];
    factor.forward(&mut b);
    factor.backward(&mut b);
    assert_eq!(b, [3.0, 4.0]);
    let (factor, s) = Condenser::alone(Keep::Interior)
        .condense(&k, &[], None)
        .expect("definite");
    assert!(s.data.is_empty());
    let mut b = vec![3.0, 0.0];
    factor.forward(&mut b);
    factor.backward(&mut b);
    assert!(far(&b, &[2.0, 1.0]) < 1e-14, "{b:?}");
}
