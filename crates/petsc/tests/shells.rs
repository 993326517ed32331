//! Callbacks from PETSc on one rank: shell matrices and preconditioners, their errors and panics.

use super::objects::laplacian;
use crate::testing::with_session;
use crate::{Comm, Ksp, Mat, ShellMat, ShellPc, Vec as PVec};
use base::{Error, ErrorKind, Result};
use std::cell::Cell;
use std::rc::Rc;

/// y = factor · x; counts its live instances.
struct Scaled {
    factor: f64,
    drops: Rc<Cell<usize>>,
    error: Cell<u8>,
}

impl Scaled {
    fn boxed(drops: &Rc<Cell<usize>>, error: u8) -> Box<Scaled> {
        Box::new(Scaled {
            factor: 2.0,
            drops: drops.clone(),
            error: Cell::new(error),
        })
    }

    fn act(&self, x: &PVec, y: &PVec) -> Result<()> {
        match self.error.get() {
            1 => return Err(Error::input("The load of body 3 is not a number.")),
            2 => panic!("the callback panics"),
            _ => {}
        }
        y.copy_from(x)?;
        y.scale(self.factor)
    }
}

impl ShellMat for Scaled {
    fn mult(&self, x: &PVec, y: &PVec) -> Result<()> {
        self.act(x, y)
    }
    fn diagonal(&self, d: &PVec) -> Result<()> {
        d.set(self.factor)
    }
}

impl ShellPc for Scaled {
    fn apply(&self, x: &PVec, y: &PVec) -> Result<()> {
        self.act(x, y)
    }
}

impl Drop for Scaled {
    fn drop(&mut self) {
        self.drops.set(self.drops.get() + 1);
    }
}

#[test]
fn shells_work_and_are_dropped_by_petsc() {
    with_session(|session| {
        let drops = Rc::new(Cell::new(0));
        let mat = Mat::shell(session, 3, 3, Scaled::boxed(&drops, 0)).unwrap();
        let (x, y) = (mat.right_vec().unwrap(), mat.left_vec().unwrap());
        x.set(3.0).unwrap();
        mat.mult(&x, &y).unwrap();
        assert_eq!(y.to_vec().unwrap(), [6.0; 3]);
        mat.diagonal(&y).unwrap();
        assert_eq!(y.to_vec().unwrap(), [2.0; 3]);
        let refused = mat.mult_transpose(&x, &y).unwrap_err();
        assert!(refused.to_string().contains("transposed"), "{refused}");

        let ksp = Ksp::new(session, Comm::World).unwrap();
        ksp.set_operators(&mat, &mat).unwrap();
        ksp.set_type("cg").unwrap();
        let pc = ksp.pc().unwrap();
        pc.set_shell("first", Scaled::boxed(&drops, 0)).unwrap();
        pc.set_shell("second", Scaled::boxed(&drops, 0)).unwrap();
        assert_eq!(drops.get(), 1, "a second shell replaces the first");
        let u = x.duplicate().unwrap();
        ksp.solve(&x, &u).unwrap();
        assert!((u.sum().unwrap() - 4.5).abs() < 1e-12);
        drop(mat);
        assert_eq!(drops.get(), 1, "the solver still holds the matrix");
        drop(pc);
        drop(ksp);
        assert_eq!(drops.get(), 3);
    });
}

#[test]
fn errors_and_panics_of_callbacks_come_back() {
    with_session(|session| {
        for (error, in_pc) in [(1, false), (2, false), (1, true), (2, true)] {
            let drops = Rc::new(Cell::new(0));
            let of = |here: bool| Scaled::boxed(&drops, if here { error } else { 0 });
            let mat = Mat::shell(session, 3, 3, of(!in_pc)).unwrap();
            let ksp = Ksp::new(session, Comm::World).unwrap();
            ksp.set_operators(&mat, &mat).unwrap();
            ksp.pc().unwrap().set_shell("shell", of(in_pc)).unwrap();
            let (x, b) = (mat.right_vec().unwrap(), mat.left_vec().unwrap());
            b.set(1.0).unwrap();
            let found = ksp.solve(&b, &x).unwrap_err();
            let message = found.message();
            match (error, found.kind()) {
                (1, ErrorKind::Input) => assert_eq!(message, "The load of body 3 is not a number."),
                (2, ErrorKind::Environment) => {
                    assert!(message.contains("the callback panics"), "{message}");
                }
                _ => panic!("{found:?}"),
            }
            drop((mat, ksp));
            assert_eq!(drops.get(), 2);
        }
        // The stored error has been taken: PETSc's next error is its own.
        let a = laplacian(session, 3);
        let wrong = PVec::seq(session, 4).unwrap();
        let error = a.mult(&wrong, &a.left_vec().unwrap()).unwrap_err();
        assert!(error
            .message()
            .starts_with("MatMult failed with PETSc error"));
        assert!(
            error.trace().len() >= 2 && error.trace()[1].starts_with("MatMult()"),
            "{error}"
        );
    });
}

/// A failure two callbacks deep keeps its identity.
#[test]
fn nested_failures_come_back() {
    struct Outer(Ksp);
    impl ShellMat for Outer {
        fn mult(&self, x: &PVec, y: &PVec) -> Result<()> {
            self.0.solve(x, y)
        }
    }
    with_session(|session| {
        let drops = Rc::new(Cell::new(0));
        let inner = Mat::shell(session, 2, 2, Scaled::boxed(&drops, 1)).unwrap();
        let ksp = Ksp::new(session, Comm::World).unwrap();
        ksp.set_operators(&inner, &inner).unwrap();
        ksp.pc().unwrap().set_type("none").unwrap();
        let outer = Mat::shell(session, 2, 2, Box::new(Outer(ksp))).unwrap();
        let (x, y) = (outer.right_vec().unwrap(), outer.left_vec().unwrap());
        x.set(1.0).unwrap();
        let error = outer.mult(&x, &y).unwrap_err();
        assert_eq!(error.to_string(), "The load of body 3 is not a number.");
    });
}
