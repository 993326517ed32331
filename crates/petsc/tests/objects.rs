//! The PETSc layer on one rank, in one process.

use crate::testing::with_session;
use crate::{
    max_memory, Comm, Is, Ksp, Mat, MatFlag, NormType, Options, Scatter, Session, Stopped,
    Vec as PVec,
};
use base::linalg::csr::Csr;
use base::Error;

pub fn laplacian(session: &Session, n: usize) -> Mat {
    let mut entries = vec![];
    for i in 0..n as u32 {
        entries.push((i, i, 2.0));
        if i > 0 {
            entries.push((i, i - 1, -1.0));
            entries.push((i - 1, i, -1.0));
        }
    }
    let mat = Mat::from_csr(session, &Csr::from_triplets(n, &entries)).unwrap();
    mat.set_flag(MatFlag::Spd).unwrap();
    mat
}

#[test]
fn vectors() {
    with_session(|session| {
        let x = PVec::from_slice(session, &[3.0, -4.0, 0.0]).unwrap();
        let y = x.duplicate().unwrap();
        assert_eq!(
            (x.local_len(), x.global_len(), x.ownership_range()),
            (3, 3, 0..3)
        );
        assert_eq!(x.norm2().unwrap(), 5.0);
        assert_eq!(x.norm_inf().unwrap(), 4.0);
        y.set(1.0).unwrap();
        y.axpy(2.0, &x).unwrap();
        assert_eq!(y.to_vec().unwrap(), [7.0, -7.0, 1.0]);
        y.aypx(-1.0, &x).unwrap();
        assert_eq!(y.to_vec().unwrap(), [-4.0, 3.0, -1.0]);
        assert_eq!(y.dot(&x).unwrap(), -24.0);
        y.scale(0.5).unwrap();
        assert_eq!(y.sum().unwrap(), -1.0);
        let z = x.duplicate().unwrap();
        z.pointwise_mult(&x, &y).unwrap();
        assert_eq!(z.to_vec().unwrap(), [-6.0, -6.0, 0.0]);
        z.pointwise_divide(&z.clone(), &x).unwrap();
        assert_eq!(z.to_vec().unwrap(), [-2.0, 1.5, 0.0]);
        assert_eq!(PVec::with_global_len(session, 7).unwrap().global_len(), 7);
        assert_eq!(PVec::mpi(session, 0).unwrap().array().unwrap().len(), 0);
    });
}

#[test]
fn lent_entries_cannot_be_used_twice() {
    with_session(|session| {
        let x = PVec::from_slice(session, &[1.0, 2.0]).unwrap();
        let alias = x.clone();
        {
            let a = x.array().unwrap();
            assert_eq!(*alias.array().unwrap(), [1.0, 2.0]);
            assert!(alias.array_mut().is_err() && alias.set(0.0).is_err());
            assert!(alias.norm2().is_ok());
            assert_eq!(a[1], 2.0);
        }
        let mut a = x.array_mut().unwrap();
        a[0] = 5.0;
        assert!(alias.array().is_err() && alias.norm2().is_err() && alias.scale(2.0).is_err());
        drop(a);
        assert_eq!(alias.sum().unwrap(), 7.0);
    });
}

#[test]
fn vectors_in_files() {
    with_session(|session| {
        let path = std::env::temp_dir().join(format!("fetifeti-vec-{}", std::process::id()));
        let x = PVec::from_slice(session, &[1.0, 1e-300, -2.5]).unwrap();
        x.save(&path).unwrap();
        let y = x.duplicate().unwrap();
        y.load(&path).unwrap();
        assert_eq!(x.to_vec().unwrap(), y.to_vec().unwrap());
        let short = PVec::seq(session, 2).unwrap();
        assert!(short.load(&path).is_err());
        std::fs::remove_file(&path).unwrap();
        let error = y.load(&path).unwrap_err();
        let trace = error.trace();
        assert!(
            trace[0].contains("fetifeti-vec") || trace.iter().any(|t| t.contains("PetscViewer")),
            "{error}"
        );
    });
}

#[test]
fn scatter_and_index_sets() {
    with_session(|session| {
        let x = PVec::from_slice(session, &[10.0, 11.0, 12.0]).unwrap();
        let to = PVec::seq(session, 4).unwrap();
        let scatter = Scatter::new(&x, &[2, 0, 2], &to).unwrap();
        scatter.forward(&x, &to).unwrap();
        assert_eq!(to.to_vec().unwrap(), [12.0, 10.0, 12.0, 0.0]);
        scatter.reverse_add(&to, &x).unwrap();
        assert_eq!(x.to_vec().unwrap(), [20.0, 11.0, 36.0]);
        let is = Is::general(session, Comm::Own, &[4, 1]).unwrap();
        assert_eq!(is.indices().unwrap(), [4, 1]);
    });
}

#[test]
fn direct_and_iterative_solution() {
    with_session(|session| {
        let n = 20;
        let a = laplacian(session, n);
        assert_eq!(a.row(1).unwrap(), (vec![0, 1, 2], vec![-1.0, 2.0, -1.0]));
        let (b, x) = (a.left_vec().unwrap(), a.right_vec().unwrap());
        b.set(1.0).unwrap();
        let direct = Ksp::new(session, Comm::Own).unwrap();
        direct.set_operators(&a, &a).unwrap();
        direct.set_type("preonly").unwrap();
        direct.pc().unwrap().set_type("cholesky").unwrap();
        direct.pc().unwrap().set_solver_type("mumps").unwrap();
        direct.solve(&b, &x).unwrap();
        // -u'' = 1 by second differences: u_i = (i + 1)(n - i) / 2.
        for (i, u) in x.array().unwrap().iter().enumerate() {
            assert!((u - ((i + 1) * (n - i)) as f64 / 2.0).abs() < 1e-10);
        }
        // A load without symmetry: with one, rounding decides whether the tenth residual of CG is zero.
        for (i, b) in b.array_mut().unwrap().iter_mut().enumerate() {
            *b = (1 + i * i) as f64;
        }
        direct.solve(&b, &x).unwrap();
        let cg = Ksp::new(session, Comm::Own).unwrap();
        cg.set_operators(&a, &a).unwrap();
        cg.set_type("cg").unwrap();
        cg.pc().unwrap().set_type("none").unwrap();
        cg.set_norm_type(NormType::Unpreconditioned).unwrap();
        cg.set_tolerances(Some(1e-10), None, None, Some(100))
            .unwrap();
        cg.set_compute_eigenvalues(true).unwrap();
        cg.record_residuals(100).unwrap();
        let y = x.duplicate().unwrap();
        cg.solve(&b, &y).unwrap();
        let reason = cg.converged_reason().unwrap();
        assert!(
            reason.converged() && reason.name == "CONVERGED_RTOL",
            "{reason:?}"
        );
        let history = cg.residual_history().unwrap();
        assert_eq!(history.len(), cg.iterations().unwrap() + 1);
        let size = b.norm2().unwrap();
        assert!((history[0] - size).abs() < 1e-12 * size);
        assert_eq!(*history.last().unwrap(), cg.residual_norm().unwrap());
        assert_eq!(cg.eigenvalues().unwrap().len(), cg.iterations().unwrap());
        assert_eq!(cg.type_name().unwrap(), "cg");
        assert_eq!(cg.tolerances().unwrap().3, 100);
        y.axpy(-1.0, &x).unwrap();
        assert!(y.norm_inf().unwrap() < 1e-8 * x.norm_inf().unwrap());
        // Too few iterations are a reason, not an error.
        cg.set_tolerances(None, None, None, Some(2)).unwrap();
        cg.solve(&b, &y).unwrap();
        assert_eq!(cg.converged_reason().unwrap().name, "DIVERGED_ITS");
    });
}

#[test]
fn options_are_read_set_and_checked() {
    with_session(|session| {
        let options = Options::new(session, "opt_");
        for (name, value) in [
            ("real", Some("1e-3")),
            ("count", Some("12")),
            ("on", None),
            ("off", Some("no")),
            ("kind", Some("Diagonal")),
            ("bad", Some("abc")),
            ("typo", Some("7")),
        ] {
            options.set_value(name, value).unwrap();
        }
        assert_eq!(options.get_f64("real").unwrap(), Some(1e-3));
        assert_eq!(options.get_usize("count").unwrap(), Some(12));
        assert_eq!(options.get_i64("absent").unwrap(), None);
        assert_eq!(options.get_bool("on").unwrap(), Some(true));
        assert_eq!(options.get_bool("off").unwrap(), Some(false));
        let names = ["identity", "diagonal"];
        assert_eq!(options.get_enum("kind", &names).unwrap(), Some(1));
        assert_eq!(options.f64("absent", 0.5, "").unwrap(), 0.5);
        for error in [
            options.get_f64("bad").unwrap_err(),
            options.get_usize("bad").unwrap_err(),
            options.get_bool("bad").unwrap_err(),
        ] {
            let message = error.message();
            assert!(error.is_input() && message.contains("-opt_bad") && message.contains("abc"));
        }
        let error = options.get_enum("bad", &names).unwrap_err().to_string();
        assert_eq!(
            error,
            "Option -opt_bad is \"abc\"; expected one of identity, diagonal."
        );
        // The typo is the one option that nothing reads.
        assert_eq!(
            options.left().unwrap(),
            [("-opt_typo".to_string(), "7".to_string())]
        );
        options.set_default("count", "99").unwrap();
        options.set_default("fresh", "5").unwrap();
        assert_eq!(options.get_usize("count").unwrap(), Some(12));
        assert_eq!(options.get_usize("fresh").unwrap(), Some(5));
        options.clear_value("count").unwrap();
        assert_eq!(options.get_usize("count").unwrap(), None);
        for name in ["real", "on", "off", "kind", "bad", "typo", "fresh"] {
            options.clear_value(name).unwrap();
        }
    });
}

#[test]
fn a_solver_takes_its_prefixed_options() {
    with_session(|session| {
        let options = Options::new(session, "pre_fix_");
        options.set_value("ksp_type", Some("gmres")).unwrap();
        let ksp = Ksp::new(session, Comm::Own).unwrap();
        ksp.set_options_prefix("pre_").unwrap();
        ksp.append_options_prefix("fix_").unwrap();
        ksp.set_from_options().unwrap();
        assert_eq!(ksp.type_name().unwrap(), "gmres");
        assert!(options.left().unwrap().is_empty());
        options.clear_value("ksp_type").unwrap();
    });
}

#[test]
fn memory_is_plausible() {
    with_session(|_| assert!((1e6..1e12).contains(&max_memory())));
}

#[test]
fn looks_at_an_iteration() {
    with_session(|session| {
        let (n, b) = (40, PVec::with_global_len(session, 40).unwrap());
        b.set(1.0).unwrap();
        let (a, x) = (laplacian(session, n), b.duplicate().unwrap());
        let ksp = Ksp::new(session, Comm::World).unwrap();
        ksp.set_operators(&a, &a).unwrap();
        ksp.set_type("cg").unwrap();
        ksp.pc().unwrap().set_type("none").unwrap();
        // The look sees the iterate that belongs to its residual: a multiple of b after one iteration.
        let (mut looks, now) = (0, b.duplicate().unwrap());
        let at_most = |most: usize, looks: &mut usize| {
            let mut look = |residual: f64| {
                *looks += 1;
                ksp.current_solution(&now)?;
                let image = b.duplicate()?;
                a.mult(&now, &image)?;
                image.aypx(-1.0, &b)?;
                assert!((image.norm2()? - residual).abs() < 1e-12);
                Ok(*looks > most)
            };
            ksp.solve_watched(&b, &x, None, Some(&mut look))
        };
        assert_eq!(at_most(3, &mut looks).unwrap(), Stopped::Look);
        assert_eq!((looks, ksp.iterations().unwrap()), (4, 3));
        assert!(ksp.converged_reason().unwrap().converged());
        looks = 0;
        assert_eq!(at_most(1000, &mut looks).unwrap(), Stopped::No);
        assert!(looks > 4 && ksp.iterations().unwrap() == looks);
        let mut fail = |_| Err(Error::input("seen enough"));
        let error = ksp.solve_watched(&b, &x, None, Some(&mut fail));
        assert!(error.unwrap_err().to_string().contains("seen enough"));
    });
}
