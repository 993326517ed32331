//! Errors that ranks have in common: a failure of one rank becomes an error of all, not a hang.

use super::error::settled;
use base::{Error, ErrorKind, Result};
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use std::ffi::{c_int, c_void};
use std::mem::MaybeUninit;
use std::time::{Duration, Instant};

/// [`Session::agree`](super::Session::agree) on this communicator.
pub(super) fn agree<T>(comm: &SimpleCommunicator, result: Result<T>) -> Result<T> {
    use mpi::collective::{CommunicatorCollectives, Root, SystemOperation};
    let (rank, size) = (comm.rank(), comm.size());
    let mine = if result.is_err() { rank } else { size };
    let mut first = 0;
    comm.all_reduce_into(&mine, &mut first, SystemOperation::min());
    settled();
    if first == size {
        return result;
    }
    let mut packed = match &result {
        Err(error) if first == mine => {
            postcard::to_allocvec(error).expect("an error is plain data")
        }
        _ => Vec::new(),
    };
    let root = comm.process_at_rank(first);
    let mut length = packed.len() as u64;
    root.broadcast_into(&mut length);
    packed.resize(length as usize, 0);
    root.broadcast_into(&mut packed[..]);
    match result {
        Err(error) if first == mine => Err(error),
        _ => Err(relayed(&packed)),
    }
}

/// The lowest failing rank (the number of ranks if none), or `None` if this rank failed and the others did not
/// arrive within the grace time.
pub(super) fn first_failure(comm: &SimpleCommunicator, failed: bool) -> Option<usize> {
    use mpi::ffi;
    use mpi::raw::AsRaw;
    let (rank, size) = (comm.rank(), comm.size());
    // Of several failing ranks the lowest gives up first: it reports, and ends the others.
    let grace = Duration::from_millis(1000 + 200 * rank.min(20) as u64);
    let mine: c_int = if failed { rank } else { size };
    // The buffers must outlive an operation that may never finish: then they are leaked.
    let buffers = Box::into_raw(Box::new([mine, 0 as c_int]));
    let mut request = MaybeUninit::uninit();
    // SAFETY: the buffers live until the operation is complete; the communicator lives as long as the session.
    let code = unsafe {
        ffi::MPI_Iallreduce(
            buffers.cast::<c_int>() as *const c_void,
            buffers.cast::<c_int>().add(1) as *mut c_void,
            1,
            ffi::RSMPI_INT32_T,
            ffi::RSMPI_MIN,
            comm.as_raw(),
            request.as_mut_ptr(),
        )
    };
    if code != 0 {
        return None;
    }
    let start = Instant::now();
    loop {
        let mut done = 0;
        // SAFETY: the request was started above and is tested until it completes, no longer.
        unsafe { ffi::MPI_Test(request.as_mut_ptr(), &mut done, ffi::RSMPI_STATUS_IGNORE) };
        if done != 0 {
            // SAFETY: from Box::into_raw above, and MPI is done with it.
            let [_, first] = *unsafe { Box::from_raw(buffers) };
            return Some(first as usize);
        }
        if failed && start.elapsed() > grace {
            return None;
        }
        // The others have usually arrived, or are about to.
        if start.elapsed() > Duration::from_millis(1) {
            std::thread::sleep(Duration::from_millis(2));
        } else {
            std::thread::yield_now();
        }
    }
}

/// The error that the bytes of another rank hold. PETSc has reported its errors on that rank alone.
fn relayed(bytes: &[u8]) -> Error {
    match postcard::from_bytes::<Error>(bytes) {
        Ok(error) if matches!(error.kind(), ErrorKind::Petsc(_)) => {
            Error::environment(error.to_string())
        }
        Ok(error) => error,
        Err(e) => Error::environment("another rank has failed with an unreadable error").because(e),
    }
}
