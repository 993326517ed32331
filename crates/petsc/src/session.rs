//! An initialised PETSc: starting it, ending it, and failing on several ranks without a hang.

use super::eigen_search::{EigenSearch, Listener};
use super::error::{c_string, collect_traces, panicked, settled};
use super::together;
use base::{Error, Result};
use mpi::raw::FromRaw;
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use petsc_sys as sys;
use petsc_sys::Flag;
use std::cell::{Cell, RefCell};
use std::collections::{BTreeSet, HashSet};
use std::ffi::{c_char, c_int};
use std::mem::{ManuallyDrop, MaybeUninit};
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::ptr::{null, null_mut};
use std::rc::Rc;
use std::sync::OnceLock;
use std::time::Duration;

/// The ranks that share a new object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comm {
    /// All ranks of the session.
    World,
    /// This rank alone.
    Own,
}

/// An initialised PETSc. Cheap to clone; the last clone (every PETSc object holds one) finalises PETSc if this
/// session initialised it.
#[derive(Clone)]
pub struct Session(pub(super) Rc<Inner>);

pub(super) struct Inner {
    /// The communicator of [`Comm::World`] as PETSc gets it.
    world: sys::MPI_Comm,
    /// PETSc's inner communicator of `world`, held so that destroying the last object frees no communicator.
    held: sys::MPI_Comm,
    /// Our communicator for messages of the method, apart from PETSc's.
    comm: ManuallyDrop<SimpleCommunicator>,
    /// The communicator of [`Session::agree`].
    agreement: ManuallyDrop<SimpleCommunicator>,
    /// The communicator of the end of [`Session::run`] only: its one operation must not meet any other.
    ending: ManuallyDrop<SimpleCommunicator>,
    rank: usize,
    size: usize,
    /// Whether we initialised PETSc, and therefore finalise it.
    owned: bool,
    /// Whether we initialised SLEPc, and therefore finalise it.
    began_slepc: Cell<bool>,
    /// Options that `-help` has listed.
    pub(super) listed: RefCell<HashSet<String>>,
    /// Options that our own code has asked for, with their dash.
    pub(super) asked: RefCell<BTreeSet<String>>,
    /// Who is told of long searches.
    listener: RefCell<Option<Listener>>,
}

impl Session {
    /// Initialises PETSc (and MPI, unless the program did) with these command-line arguments, without the program's
    /// name.
    ///
    /// PETSc reads its options from `args`, PETSC_OPTIONS, `-options_file` and .petscrc; `help` is printed first under
    /// `-help`. PETSc's printed stacks are replaced by [`ErrorKind::Petsc`](base::ErrorKind::Petsc), its signal handler
    /// is left out.
    ///
    /// # Errors
    /// [`ErrorKind::Environment`](base::ErrorKind::Environment) when PETSc is already initialised or finalised, is
    /// another version than the one compiled against, or refuses to start.
    pub fn new(args: &[String], help: &str) -> Result<Session> {
        check_version()?;
        let (mut begun, mut ended) = (Flag::of(false), Flag::of(false));
        petsc!(PetscInitialized(&mut begun))?;
        petsc!(PetscFinalized(&mut ended))?;
        if begun.get() {
            return Err(Error::environment(
                "PETSc is already initialised: use Session::borrowed.",
            ));
        }
        if ended.get() {
            return Err(Error::environment(
                "PETSc was finalised in this process and cannot start again.",
            ));
        }
        // This precedes PetscInitialize: errors in the options are then returned as errors, too.
        collect_traces()?;
        // Rust reports panics and stack overflows itself. Options set before PetscInitialize are kept by it.
        petsc!(PetscOptionsSetValue(
            null_mut(),
            c"-no_signal_handler".as_ptr(),
            c"true".as_ptr()
        ))?;
        // PETSc and MPI keep pointers to the arguments until the end: they are leaked, once per process.
        let mut argv: Vec<*mut c_char> = std::iter::once("fetifeti")
            .chain(args.iter().map(String::as_str))
            .map(|arg| c_string(arg).into_raw())
            .collect();
        let argc: &'static mut c_int = Box::leak(Box::new(argv.len() as c_int));
        argv.push(null_mut());
        let argv: &'static mut *mut *mut c_char =
            Box::leak(Box::new(Box::leak(argv.into_boxed_slice()).as_mut_ptr()));
        let help = c_string(help).into_raw();
        // What a static variable names is no leak for those who look for leaks.
        static KEPT: OnceLock<[usize; 3]> = OnceLock::new();
        let _ = KEPT.set([
            std::ptr::from_mut(argc) as usize,
            std::ptr::from_mut(argv) as usize,
            help as usize,
        ]);
        if let Err(error) = petsc!(PetscInitialize(argc, argv, null(), help)) {
            let why = error.trace().first().cloned();
            let why = why.unwrap_or_else(|| error.to_string());
            settled();
            let error = Error::environment(format!("PETSc does not start: {why}."));
            end_mpi(&error);
            return Err(error);
        }
        // SAFETY: PETSc is initialised, so PETSC_COMM_WORLD is valid until it is finalised.
        let world = unsafe { sys::ff_comm_world() };
        Session::on(world, true)
    }

    /// A session inside a program that initialised PETSc itself, on one of its communicators. PETSc is not finalised at
    /// the end and its error handler stays the host's.
    ///
    /// # Errors
    /// [`ErrorKind::Environment`](base::ErrorKind::Environment) when PETSc is not initialised or is another version
    /// than the one compiled against.
    ///
    /// # Safety
    /// `comm` is a valid communicator, and neither it nor PETSc ends before the session and all objects made with it.
    pub unsafe fn borrowed(comm: sys::MPI_Comm) -> Result<Session> {
        check_version()?;
        let mut begun = Flag::of(false);
        petsc!(PetscInitialized(&mut begun))?;
        if !begun.get() {
            return Err(Error::environment("PETSc is not initialised."));
        }
        Session::on(comm, false)
    }

    fn on(world: sys::MPI_Comm, owned: bool) -> Result<Session> {
        let (mut held, mut tag) = (MaybeUninit::uninit(), 0);
        petsc!(PetscCommDuplicate(world, held.as_mut_ptr(), &mut tag))?;
        let comm = duplicate(world)?;
        let (rank, size) = (comm.rank() as usize, comm.size() as usize);
        Ok(Session(Rc::new(Inner {
            world,
            // SAFETY: PetscCommDuplicate returned without error, so it wrote the communicator.
            held: unsafe { held.assume_init() },
            comm: ManuallyDrop::new(comm),
            agreement: ManuallyDrop::new(duplicate(world)?),
            ending: ManuallyDrop::new(duplicate(world)?),
            rank,
            size,
            owned,
            began_slepc: Cell::new(false),
            listed: RefCell::default(),
            asked: RefCell::default(),
            listener: RefCell::default(),
        })))
    }

    /// The communicator for our own messages: the same ranks as PETSc's, its messages kept apart.
    pub fn comm(&self) -> &SimpleCommunicator {
        &self.0.comm
    }

    /// This rank, in 0..size.
    pub fn rank(&self) -> usize {
        self.0.rank
    }

    /// Number of ranks.
    pub fn size(&self) -> usize {
        self.0.size
    }

    /// The MPI communicator to create PETSc objects on.
    pub(crate) fn raw_comm(&self, comm: Comm) -> sys::MPI_Comm {
        match comm {
            Comm::World => self.0.world,
            // SAFETY: MPI is initialised.
            Comm::Own => unsafe { sys::ff_comm_self() },
        }
    }

    /// True the first time that `-help` meets this key.
    pub(crate) fn list_once(&self, key: &str) -> bool {
        self.0.listed.borrow_mut().insert(key.to_string())
    }

    /// From now on `listener` is told of searches for eigenvalues, on this rank.
    pub fn listen(&self, listener: Listener) {
        *self.0.listener.borrow_mut() = Some(listener);
    }

    pub(super) fn tell(&self, search: Option<&EigenSearch>) {
        if let Some(listener) = &*self.0.listener.borrow() {
            listener(search);
        }
    }

    /// Initialises SLEPc if nobody has.
    pub(crate) fn need_slepc(&self) -> Result<()> {
        let mut begun = Flag::of(false);
        petsc!(SlepcInitialized(&mut begun))?;
        if !begun.get() {
            petsc!(SlepcInitialize(null_mut(), null_mut(), null(), null()))?;
            self.0.began_slepc.set(true);
        }
        Ok(())
    }

    /// Collective: `Ok` on all ranks, or the same error on all: that of the lowest failing rank.
    ///
    /// Every rank must reach the call, also after a failure. A failure of one rank (a file, a factorisation, a bad
    /// number) then becomes a common error instead of a hang.
    ///
    /// # Errors
    /// The error of the lowest rank that passed one.
    pub fn agree<T>(&self, result: Result<T>) -> Result<T> {
        together::agree(&self.0.agreement, result)
    }

    /// Ends a piece of work of all ranks: returns the result, or the error and whether all ranks return it. If only
    /// some ranks fail while the others are still at work, the failed ranks wait for them for about a second at most.
    pub fn conclude<T>(&self, result: Result<T>) -> std::result::Result<T, (Error, bool)> {
        if self.size() == 1 {
            return result.map_err(|error| (error, true));
        }
        match (
            together::first_failure(&self.0.ending, result.is_err()),
            result,
        ) {
            (Some(first), result) if first < self.size() => match self.agree(result) {
                Err(error) => Err((error, true)),
                Ok(_) => unreachable!("a rank failed"),
            },
            (_, Ok(value)) => Ok(value),
            (_, Err(error)) => Err((error, false)),
        }
    }

    /// Runs the program's work and returns its exit code: 0, or the error's.
    ///
    /// An error that every rank returns is printed once. An error of some ranks only, while the others are still at
    /// work, is printed with its rank and ends all ranks through MPI_Abort: they may be waiting for the failed one.
    /// Panics count as errors.
    pub fn run(&self, work: impl FnOnce(&Session) -> Result<()>) -> i32 {
        let result = catch_unwind(AssertUnwindSafe(|| work(self)))
            .unwrap_or_else(|payload| Err(panicked("the program", payload.as_ref())));
        if self.size() == 1 {
            return match result {
                Ok(()) => 0,
                Err(error) => {
                    error.tell("Error");
                    error.exit_code()
                }
            };
        }
        let first = together::first_failure(&self.0.ending, result.is_err());
        match (first, result) {
            (Some(first), result) if first < self.size() => {
                // All ranks have arrived; the lowest failing one reports.
                let own = result.is_err();
                let result = self.agree(result);
                let error = result.expect_err("a rank failed");
                if own && first == self.rank() {
                    error.tell("Error");
                }
                error.exit_code()
            }
            (Some(_), _) => 0,
            (None, Err(error)) => {
                error.tell(&format!("Error on rank {}", self.rank()));
                self.abort(error.exit_code())
            }
            (None, Ok(())) => unreachable!("a rank without error waits until the others come"),
        }
    }

    /// Ends all ranks.
    pub fn abort(&self, code: i32) -> ! {
        self.0.comm.abort(code)
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        // SAFETY: dropped once, here, and before MPI may be finalised. Codes are ignored: the program is ending.
        unsafe {
            ManuallyDrop::drop(&mut self.comm);
            ManuallyDrop::drop(&mut self.agreement);
            ManuallyDrop::drop(&mut self.ending);
            sys::PetscCommDestroy(&mut self.held);
            if self.owned {
                if self.began_slepc.get() {
                    sys::SlepcFinalize();
                }
                // The error handler stays: it was allocated before PetscInitialize, when -malloc_debug was not known
                // yet, and PETSc would take its place in memory for a corrupted one.
                sys::PetscFinalize();
            }
        }
    }
}

/// From now on what PETSc prints on standard output goes to standard error: monitors, views, `-options_left`.
pub fn print_on_stderr(_session: &Session) {
    // SAFETY: PETSc is initialised, and writes to the stream only from this thread.
    unsafe { sys::ff_print_on_stderr() }
}

/// Largest memory that this process has held so far, in bytes.
pub fn max_memory() -> f64 {
    // SAFETY: a call without arguments.
    unsafe { sys::ff_max_memory() }
}

/// Ends MPI after a PetscInitialize that failed half-way. With several ranks this function does not return: the others
/// may be waiting for data that the failed rank was to read.
fn end_mpi(error: &Error) {
    use mpi::ffi;
    let (mut begun, mut ended) = (0, 0);
    // SAFETY: both questions are allowed at any time, the rest between MPI_Init and MPI_Finalize.
    unsafe {
        ffi::MPI_Initialized(&mut begun);
        ffi::MPI_Finalized(&mut ended);
        if begun == 0 || ended != 0 {
            return;
        }
        let (mut rank, mut size) = (0, 1);
        ffi::MPI_Comm_rank(ffi::RSMPI_COMM_WORLD, &mut rank);
        ffi::MPI_Comm_size(ffi::RSMPI_COMM_WORLD, &mut size);
        if size == 1 {
            ffi::MPI_Finalize();
            return;
        }
        // The lowest failing rank reports first and ends the others.
        std::thread::sleep(Duration::from_millis(200 * rank.min(20) as u64));
        error.tell(&format!("Error on rank {rank}"));
        ffi::MPI_Abort(ffi::RSMPI_COMM_WORLD, error.exit_code());
    }
}

fn duplicate(comm: sys::MPI_Comm) -> Result<SimpleCommunicator> {
    let mut copy = MaybeUninit::uninit();
    // SAFETY: `comm` is valid; on success the copy is ours, and SimpleCommunicator frees it.
    unsafe {
        if mpi::ffi::MPI_Comm_dup(comm, copy.as_mut_ptr()) != 0 {
            return Err(Error::environment(
                "MPI could not duplicate a communicator.",
            ));
        }
        Ok(SimpleCommunicator::from_raw(copy.assume_init()))
    }
}

/// PETSc's version, as in `3.18.5`.
pub fn version() -> Result<String> {
    let (mut major, mut minor, mut rest) = (0, 0, 0);
    petsc!(PetscGetVersionNumber(
        &mut major,
        &mut minor,
        &mut rest,
        null_mut()
    ))?;
    Ok(format!("{major}.{minor}.{rest}"))
}

/// Structures differ between minor versions, so the headers and the library must agree in both numbers.
fn check_version() -> Result<()> {
    let (mut major, mut minor) = (0, 0);
    petsc!(PetscGetVersionNumber(
        &mut major,
        &mut minor,
        null_mut(),
        null_mut()
    ))?;
    let built = (
        sys::PETSC_VERSION_MAJOR as sys::PetscInt,
        sys::PETSC_VERSION_MINOR as sys::PetscInt,
    );
    if (major, minor) == built {
        return Ok(());
    }
    Err(Error::environment(format!(
        "fetifeti was compiled against PETSc {}.{} but runs with PETSc {major}.{minor}: rebuild it.",
        built.0, built.1
    )))
}
