//! Extreme eigenvalues of C A for singular pairs, compared with dense algebra.

use crate::testing::with_session;
use crate::{
    extreme_eigenvalues, Comm, Eps, Mat, PetscInt, ProblemType, Session, ShellOp, Vec as PVec,
    Which,
};
use faer::{Mat as Dense, Side};
use std::cell::Cell;
use std::rc::Rc;

/// A reproducible stream of numbers in (-1, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((self.0 >> 11) as f64 / (1u64 << 53) as f64) * 2.0 - 1.0
    }

    fn dense(&mut self, m: usize, n: usize) -> Dense<f64> {
        Dense::from_fn(m, n, |_, _| self.next())
    }
}

fn orthonormal(random: &mut Random, n: usize) -> Dense<f64> {
    random.dense(n, n).qr().compute_Q()
}

fn petsc(session: &Session, a: &Dense<f64>) -> Mat {
    let mut entries = vec![];
    for i in 0..a.nrows() {
        for j in 0..a.ncols() {
            entries.push((i as PetscInt, j as PetscInt, a[(i, j)]));
        }
    }
    Mat::from_triplets(session, Comm::World, a.nrows(), a.ncols(), &entries).unwrap()
}

/// The non-zero eigenvalues of C A are those of Lᵀ C L with A = L Lᵀ on the range.
fn reference(a: &Dense<f64>, c: &Dense<f64>, rank: usize) -> (f64, f64) {
    let n = a.nrows();
    let eig = a.self_adjoint_eigen(Side::Lower).unwrap();
    let (u, s) = (eig.U(), eig.S());
    let l = Dense::from_fn(n, rank, |i, k| {
        u[(i, n - rank + k)] * s.column_vector()[n - rank + k].sqrt()
    });
    let small = l.transpose() * c * &l;
    let values = small.self_adjoint_eigenvalues(Side::Lower).unwrap();
    (values[0], values[rank - 1])
}

fn check(
    session: &Session,
    name: &str,
    a: &Dense<f64>,
    c: &Dense<f64>,
    rank: usize,
    random: &mut Random,
) {
    let (small, large) = reference(a, c, rank);
    let (pa, pc) = (petsc(session, a), petsc(session, c));
    // The orthogonal projection onto the range of A.
    let eig = a.self_adjoint_eigen(Side::Lower).unwrap();
    let v = eig.U().subcols(a.nrows() - rank, rank);
    let e = petsc(session, &(v * v.transpose()));
    let raw = PVec::mpi(session, a.nrows()).unwrap();
    for x in raw.array_mut().unwrap().iter_mut() {
        *x = random.next();
    }
    let start = raw.duplicate().unwrap();
    pc.mult(&raw, &start).unwrap();
    let accuracy = (1e-10, None);
    let [lo, hi] = extreme_eigenvalues(session, &pa, &pc, Some(&e), &start, accuracy, "spectrum_")
        .unwrap_or_else(|error| panic!("{name}: {error}"))
        .map(|end| end.value);
    assert!(
        (lo / small - 1.0).abs() < 1e-8,
        "{name}: smallest {lo}, expected {small}"
    );
    assert!(
        (hi / large - 1.0).abs() < 1e-8,
        "{name}: largest {hi}, expected {large}"
    );
}

/// A = V Λ Vᵀ and C = V M Vᵀ with the same kernel.
fn same_kernel(
    random: &mut Random,
    n: usize,
    rank: usize,
    spread: f64,
) -> (Dense<f64>, Dense<f64>) {
    let q = orthonormal(random, n);
    let v = q.subcols(0, rank);
    let values: Vec<f64> = (0..rank).map(|_| spread.powf(random.next())).collect();
    let a =
        v * Dense::from_fn(rank, rank, |i, j| if i == j { values[i] } else { 0.0 }) * v.transpose();
    let g = random.dense(rank, rank);
    let m = &g * g.transpose() + Dense::<f64>::identity(rank, rank);
    (a, v * m * v.transpose())
}

#[test]
fn pairs_with_one_kernel() {
    with_session(|session| {
        let mut random = Random(1);
        for (n, rank, spread) in [
            (60, 40, 10.0),
            (60, 40, 1.0),
            (6, 3, 10.0),
            (6, 1, 3.0),
            (5, 5, 3.0),
            (1, 1, 2.0),
            (300, 250, 30.0),
            (300, 250, 1.0),
        ] {
            let (a, c) = same_kernel(&mut random, n, rank, spread);
            check(
                session,
                &format!("n={n} rank={rank} spread={spread}"),
                &a,
                &c,
                rank,
                &mut random,
            );
        }
    });
}

/// With preconditioning: C is nearly the pseudo-inverse of A, with many eigenvalues at 1.
#[test]
fn clustered_at_one() {
    with_session(|session| {
        let mut random = Random(7);
        for (n, rank, top) in [
            (200, 150, 3usize),
            (200, 150, 20),
            (8, 5, 2),
            (400, 300, 100),
        ] {
            let q = orthonormal(&mut random, n);
            let v = q.subcols(0, rank);
            let values: Vec<f64> = (0..rank).map(|_| 10f64.powf(random.next())).collect();
            let root = |p: f64| {
                Dense::from_fn(
                    rank,
                    rank,
                    |i, j| if i == j { values[i].powf(p) } else { 0.0 },
                )
            };
            let w = orthonormal(&mut random, rank);
            // Σ w (θ) wᵀ with `top` eigenvalues between 1 and 5, the others 1.
            let theta: Vec<f64> = (0..rank)
                .map(|k| {
                    if k < top {
                        3.0 + 2.0 * random.next()
                    } else {
                        1.0
                    }
                })
                .collect();
            let t = &w
                * Dense::from_fn(rank, rank, |i, j| if i == j { theta[i] } else { 0.0 })
                * w.transpose();
            let a = v * root(1.0) * v.transpose();
            let c = v * root(-0.5) * &t * root(-0.5) * v.transpose();
            check(
                session,
                &format!("cluster n={n} rank={rank} top={top}"),
                &a,
                &c,
                rank,
                &mut random,
            );
        }
    });
}

/// A = Pᵀ F P and C = P M Pᵀ with an oblique projection P: different kernels, as with Q ≠ I.
#[test]
fn oblique_projection() {
    with_session(|session| {
        let mut random = Random(3);
        for (n, defect, kernel, spread) in [
            (80usize, 6usize, 10usize, 10.0f64),
            (80, 6, 0, 1.0),
            (12, 2, 3, 3.0),
        ] {
            let g = random.dense(n, defect);
            let h = random.dense(n, n);
            let q = &h * h.transpose() + Dense::<f64>::identity(n, n);
            let qg = &q * &g;
            let gqg = g.transpose() * &qg;
            let inv = faer::linalg::solvers::DenseSolveCore::inverse(&gqg.partial_piv_lu());
            let p = Dense::<f64>::identity(n, n) - &qg * inv * g.transpose();
            // F = B S Bᵀ and M = B_D T B_Dᵀ with rank n - kernel.
            let b = random.dense(n, n - kernel);
            let s = Dense::from_fn(n - kernel, n - kernel, |i, j| {
                if i == j {
                    spread.powf(random.next())
                } else {
                    0.0
                }
            });
            let f = &b * s * b.transpose();
            let bd = &b
                * faer::linalg::solvers::DenseSolveCore::inverse(
                    &(b.transpose() * &b).partial_piv_lu(),
                );
            let t = random.dense(n - kernel, n - kernel);
            let m = &bd
                * (&t * t.transpose() + Dense::<f64>::identity(n - kernel, n - kernel))
                * bd.transpose();
            let a = p.transpose() * f * &p;
            let c = &p * m * p.transpose();
            check(
                session,
                &format!("oblique n={n} defect={defect} kernel={kernel}"),
                &a,
                &c,
                n - defect - kernel,
                &mut random,
            );
        }
    });
}

/// A perfect preconditioner: every Krylov space has one dimension.
#[test]
fn only_one_eigenvalue() {
    with_session(|session| {
        let mut random = Random(5);
        let q = orthonormal(&mut random, 20);
        let v = q.subcols(0, 12);
        let a = v * v.transpose();
        check(session, "projector", &a, &a, 12, &mut random);
    });
}

/// Without a kernel no projection is needed.
#[test]
fn positive_definite_pair() {
    with_session(|session| {
        let mut random = Random(9);
        let (a, c) = same_kernel(&mut random, 30, 30, 5.0);
        let (small, large) = reference(&a, &c, 30);
        let start = PVec::mpi(session, 30).unwrap();
        start.set_random().unwrap();
        let (pa, pc) = (petsc(session, &a), petsc(session, &c));
        let accuracy = (1e-10, None);
        let ends = extreme_eigenvalues(session, &pa, &pc, None, &start, accuracy, "").unwrap();
        let [lo, hi] = ends.map(|end| end.value);
        assert!((lo / small - 1.0).abs() < 1e-8 && (hi / large - 1.0).abs() < 1e-8);
    });
}

#[test]
fn a_start_in_the_kernel_is_refused() {
    with_session(|session| {
        let zero = Dense::<f64>::zeros(4, 4);
        let a = petsc(session, &zero);
        let start = PVec::mpi(session, 4).unwrap();
        start.set(1.0).unwrap();
        let accuracy = (1e-10, None);
        let error = extreme_eigenvalues(session, &a, &a, None, &start, accuracy, "").unwrap_err();
        assert!(error.is_input(), "{error}");
    });
}

/// STSHELL with a standard problem: the operator drives the iteration, and the eigenvalues are Rayleigh quotients of A.
#[test]
fn spectral_transformation_in_rust() {
    struct Double(Mat, Rc<Cell<usize>>);
    impl ShellOp for Double {
        fn apply(&self, x: &PVec, y: &PVec) -> base::Result<()> {
            self.1.set(self.1.get() + 1);
            self.0.mult(x, y)?;
            y.scale(2.0)
        }
    }
    with_session(|session| {
        let mut random = Random(11);
        let (a, _) = same_kernel(&mut random, 12, 12, 4.0);
        let values = a.self_adjoint_eigenvalues(Side::Lower).unwrap();
        let a = petsc(session, &a);
        let eps = Eps::new(session, Comm::World).unwrap();
        eps.set_operators(&a, None).unwrap();
        eps.set_problem_type(ProblemType::Hep).unwrap();
        eps.set_which(Which::LargestReal).unwrap();
        eps.set_dimensions(2, None).unwrap();
        eps.set_tolerances(1e-10, None).unwrap();
        let applied = Rc::new(Cell::new(0));
        eps.set_st_shell(Box::new(Double(a.clone(), applied.clone())))
            .unwrap();
        eps.solve().unwrap();
        assert!(eps.converged().unwrap() >= 2);
        assert!(eps.error_estimate(0).unwrap() < 1e-9);
        for i in 0..2 {
            assert!((eps.eigenvalue(i).unwrap() - values[11 - i]).abs() < 1e-8);
        }
        assert!(applied.get() > 0, "the operator was not used");
        // The eigenvector is one of A.
        let (x, y) = (a.right_vec().unwrap(), a.left_vec().unwrap());
        eps.eigenvector(0, &x).unwrap();
        a.mult(&x, &y).unwrap();
        y.axpy(-values[11], &x).unwrap();
        assert!(y.norm2().unwrap() < 1e-7);
    });
}
