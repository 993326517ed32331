//! One PETSc for all tests of a process.

use petsc::Session;
use std::panic::{catch_unwind, resume_unwind, AssertUnwindSafe};
use std::sync::mpsc::{channel, Sender};
use std::sync::{Mutex, OnceLock};
use std::thread;

type Job = Box<dyn FnOnce(&Session) + Send>;

/// Runs a test on the thread that owns PETSc; returns its result, or panics as it did.
///
/// PETSc can be initialised once per process and is not thread safe, while the test harness runs tests on many threads.
/// So one thread owns the session for the life of the process, and tests take turns on it.
pub fn with_session<T: Send + 'static>(test: impl FnOnce(&Session) -> T + Send + 'static) -> T {
    static JOBS: OnceLock<Mutex<Sender<Job>>> = OnceLock::new();
    let jobs = JOBS.get_or_init(|| {
        let (send, receive) = channel::<Job>();
        thread::Builder::new()
            .name("petsc".into())
            .spawn(move || {
                let session = Session::new(&[], "").expect("PETSc starts");
                for job in receive {
                    job(&session);
                }
            })
            .expect("a thread can be started");
        Mutex::new(send)
    });
    let (send, receive) = channel();
    let job: Job = Box::new(move |session| {
        let result = catch_unwind(AssertUnwindSafe(|| test(session)));
        // The receiver waits below until this arrives.
        let _ = send.send(result);
    });
    jobs.lock()
        .expect("no test panics while it holds the lock")
        .send(job)
        .expect("the PETSc thread lives as long as the process");
    match receive.recv().expect("the PETSc thread answers") {
        Ok(value) => value,
        Err(payload) => resume_unwind(payload),
    }
}
