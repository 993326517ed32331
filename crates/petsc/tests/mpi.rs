//! The PETSc layer on several ranks: values do not depend on the number of ranks, and failures end the run.

use super::under_mpirun as mpi;
use crate::{
    extreme_eigenvalues, Comm, Ksp, Mat, NormType, PetscInt, Scatter, Session, ShellMat, ShellPc,
    Vec as PVec,
};
use base::{Error, Result};

/// An error on rank 1, while rank 0 waits in a reduction.
fn error_outside(session: &Session) -> Result<()> {
    match session.rank() {
        1 => Err(Error::input("The file is unreadable.")),
        _ => {
            let x = PVec::mpi(session, 2)?;
            x.norm2().map(|_| ())
        }
    }
}

/// Errors on all ranks but the first, and the common error that they agree on.
fn agreed(session: &Session) -> Result<()> {
    let mine = match session.rank() {
        0 => Ok(()),
        rank => Err(Error::input(format!("Bad number seen by rank {rank}."))),
    };
    let result = session.agree(mine);
    // Collective work is possible after the agreement.
    let x = PVec::mpi(session, 1)?;
    x.set(1.0)?;
    assert_eq!(x.sum()?, session.size() as f64);
    result
}

/// Each rank holds two rows of the 1D Laplacian.
fn laplacian(session: &Session, local: usize) -> Result<Mat> {
    let n = (local * session.size()) as PetscInt;
    let first = (local * session.rank()) as PetscInt;
    let mut entries = vec![];
    for i in first..first + local as PetscInt {
        // Half of the diagonal comes from the neighbour, so that off-rank contributions are summed.
        entries.push((i, i, 1.0));
        entries.push(((i + 1) % n, (i + 1) % n, 1.0));
        for j in [i - 1, i + 1] {
            if (0..n).contains(&j) {
                entries.push((i, j, -1.0));
            }
        }
    }
    Mat::from_triplets(session, Comm::World, local, local, &entries)
}

fn values(session: &Session) -> Result<()> {
    let (n, size) = (12, session.size());
    let local = n / size;
    let a = laplacian(session, local)?;
    let (x, b) = (a.right_vec()?, a.left_vec()?);
    for (k, value) in x.array_mut()?.iter_mut().enumerate() {
        *value = ((session.rank() * local + k + 1) as f64).powi(2);
    }
    a.mult(&x, &b)?;
    // Second differences of squares are 2; the ends are 1·2 - 4 and 2·144 - 121.
    let expected: f64 = -2.0 * (n as f64 - 2.0) + (2.0 - 4.0) + (2.0 * 144.0 - 121.0);
    assert!((b.sum()? - expected).abs() < 1e-12, "{}", b.sum()?);

    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_operators(&a, &a)?;
    ksp.set_type("cg")?;
    ksp.pc()?.set_type("none")?;
    ksp.set_norm_type(NormType::Unpreconditioned)?;
    ksp.set_tolerances(Some(1e-12), None, None, None)?;
    ksp.set_compute_singular_values(true)?;
    let y = x.duplicate()?;
    ksp.solve(&b, &y)?;
    assert!(ksp.converged_reason()?.converged());
    y.axpy(-1.0, &x)?;
    assert!(y.norm_inf()? < 1e-9);
    // Eigenvalues 2 - 2 cos(kπ/13); CG sees them all.
    let angle = std::f64::consts::PI / (n as f64 + 1.0);
    let (small, large) = (2.0 - 2.0 * angle.cos(), 2.0 + 2.0 * angle.cos());
    let (hi, lo) = ksp.extreme_singular_values()?;
    assert!((hi / large - 1.0).abs() < 1e-8 && (lo / small - 1.0).abs() < 1e-8);

    // The same eigenvalues by SLEPc, with C = I.
    let identity: Vec<_> = (0..local)
        .map(|k| (session.rank() * local + k) as PetscInt)
        .map(|i| (i, i, 1.0))
        .collect();
    let c = Mat::from_triplets(session, Comm::World, local, local, &identity)?;
    let ends = extreme_eigenvalues(session, &a, &c, None, &x, (1e-10, None), "")?;
    let [lo, hi] = ends.map(|end| end.value);
    assert!((hi / large - 1.0).abs() < 1e-8 && (lo / small - 1.0).abs() < 1e-8);

    // Every rank fetches the whole vector backwards and adds it back.
    let whole = PVec::seq(session, n)?;
    let backwards: Vec<PetscInt> = (0..n as PetscInt).rev().collect();
    let scatter = Scatter::new(&x, &backwards, &whole)?;
    scatter.forward(&x, &whole)?;
    for (k, value) in whole.array()?.iter().enumerate() {
        assert_eq!(*value, ((n - k) as f64).powi(2));
    }
    let sum = x.duplicate()?;
    scatter.reverse_add(&whole, &sum)?;
    sum.axpy(-(size as f64), &x)?;
    assert_eq!(sum.norm_inf()?, 0.0);

    // MATIS: every rank contributes the 2 × 2 matrix of an edge; assembled they are the Laplacian with free ends.
    let edge = base::linalg::csr::Csr::from_triplets(
        2,
        &[(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)],
    );
    let edge = Mat::from_csr(session, &edge)?;
    let owned = if session.rank() == 0 { 2 } else { 1 };
    let rank = session.rank() as PetscInt;
    let torn = Mat::unassembled(session, owned, &[rank, rank + 1], &edge, false)?;
    let whole = torn.convert("aij")?;
    let (u, v, w) = (torn.right_vec()?, torn.left_vec()?, torn.left_vec()?);
    u.set_random()?;
    torn.mult(&u, &v)?;
    whole.mult(&u, &w)?;
    w.axpy(-1.0, &v)?;
    assert!(w.norm_inf()? < 1e-14 && v.norm_inf()? > 0.0);
    if session.rank() == 0 {
        assert_eq!(whole.row(0)?, (vec![0, 1], vec![1.0, -1.0]));
        println!("all values agree");
    }
    Ok(())
}

/// CG with a shell matrix and a shell preconditioner that fails on rank 1 while the others wait for it in a reduction.
fn solve_with(session: &Session, fail: fn() -> Result<()>) -> Result<()> {
    struct Diagonal;
    impl ShellMat for Diagonal {
        fn mult(&self, x: &PVec, y: &PVec) -> Result<()> {
            let x = x.array()?;
            for (k, value) in y.array_mut()?.iter_mut().enumerate() {
                *value = (k + 1) as f64 * x[k];
            }
            Ok(())
        }
    }
    struct FailsOnOne(usize, fn() -> Result<()>);
    impl ShellPc for FailsOnOne {
        fn apply(&self, x: &PVec, y: &PVec) -> Result<()> {
            if self.0 == 1 {
                (self.1)()?;
            }
            y.copy_from(x)
        }
    }
    let a = Mat::shell(session, 5, 5, Box::new(Diagonal))?;
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_operators(&a, &a)?;
    ksp.set_type("cg")?;
    ksp.pc()?
        .set_shell("fails", Box::new(FailsOnOne(session.rank(), fail)))?;
    let (x, b) = (a.right_vec()?, a.left_vec()?);
    b.set(1.0)?;
    ksp.solve(&b, &x)
}

#[test]
fn values_on_1_2_and_4_ranks() {
    let started = mpi::as_rank(|session, _| values(session));
    for ranks in [1, 2, 4] {
        let out = started.run(ranks, "values");
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
        assert!(out.stdout.contains("all values agree"), "{}", out.all());
    }
}

#[test]
fn an_error_in_a_callback_of_one_rank_ends_the_run() {
    let started = mpi::as_rank(|session, _| {
        solve_with(session, || {
            Err(Error::input("Body \"left\" has no matrix."))
        })
    });
    let out = started.run(2, "error_on_one");
    assert_eq!(out.code, 2, "{}", out.all());
    let message = "Error on rank 1: Body \"left\" has no matrix.";
    assert_eq!(out.stderr.matches(message).count(), 1, "{}", out.all());
    assert!(!out.stderr.contains("PETSC ERROR"), "{}", out.all());
}

#[test]
fn a_panic_in_a_callback_of_one_rank_ends_the_run() {
    let started = mpi::as_rank(|session, _| solve_with(session, || panic!("index out of range")));
    let out = started.run(2, "panic_on_one");
    assert_eq!(out.code, 3, "{}", out.all());
    assert!(
        out.stderr.contains("Error on rank 1") && out.stderr.contains("index out of range"),
        "{}",
        out.all()
    );
}

#[test]
fn an_error_of_one_rank_while_the_others_communicate_ends_the_run() {
    let started = mpi::as_rank(|session, _| error_outside(session));
    let out = started.run(2, "error_outside");
    assert_eq!(out.code, 2, "{}", out.all());
    assert!(
        out.stderr.contains("The file is unreadable."),
        "{}",
        out.all()
    );
}

#[test]
fn an_error_of_all_ranks_is_printed_once() {
    let started = mpi::as_rank(|_, _| Err(Error::input("Unknown key \"bodys\".")));
    for ranks in [1, 4] {
        let out = started.run(ranks, "error_on_all");
        assert_eq!(out.code, 2, "{}", out.all());
        assert_eq!(
            out.stderr.matches("Unknown key").count(),
            1,
            "{}",
            out.all()
        );
        assert!(!out.stderr.contains("MPI_ABORT"), "{}", out.all());
    }
}

#[test]
fn an_agreed_error_is_that_of_the_lowest_rank() {
    let started = mpi::as_rank(|session, _| agreed(session));
    let out = started.run(4, "agreed");
    assert_eq!(out.code, 2, "{}", out.all());
    assert_eq!(
        out.stderr
            .matches("Error: Bad number seen by rank 1.")
            .count(),
        1,
        "{}",
        out.all()
    );
    assert!(!out.stderr.contains("rank 2"), "{}", out.all());
}
