//! The C library's heap, in programs of our own.

/// What a thread's heap grows by: a whole segment of glibc's at once.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const SEGMENT: std::ffi::c_int = 64 << 20;

/// Lets the heaps of threads grow by whole segments. For programs, at their start: hosts of the library decide for themselves.
///
/// glibc lets the heap of every thread but the first grow page by page, a system call each, in which all threads of the process wait for each
/// other: two threads set up no faster than one. Address space is taken, not memory. Elsewhere nothing is done.
pub fn let_threads_allocate() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        extern "C" {
            fn mallopt(parameter: std::ffi::c_int, value: std::ffi::c_int) -> std::ffi::c_int;
        }
        // From malloc.h.
        const M_TOP_PAD: std::ffi::c_int = -2;
        const M_MMAP_THRESHOLD: std::ffi::c_int = -3;
        // Setting one ends the adaptation of the other, whose final value is this one.
        const LARGEST: std::ffi::c_int = 32 << 20;
        // SAFETY: mallopt takes two integers and may be called at any time; a value that it refuses changes nothing.
        unsafe {
            mallopt(M_TOP_PAD, SEGMENT);
            mallopt(M_MMAP_THRESHOLD, LARGEST);
        }
    }
}
