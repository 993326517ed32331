//! The C library's heap in our own programs.

/// Amount by which a thread's heap grows: one segment of glibc.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const SEGMENT: std::ffi::c_int = 64 << 20;

/// Lets the heaps of threads grow by whole segments, and keep what was freed. Programs call it at their start; a host
/// of the library makes this choice itself.
///
/// By default glibc lets the heap of every thread but the first grow page by page. Each page takes a system call, in
/// which all threads of the process wait for each other: set-up with two threads is then no faster than with one.
/// Larger segments take address space, not memory.
///
/// Memory that is free at the end of a heap goes back to the system by default, and comes back as pages of zeros when
/// the next front of a factorisation asks for it: a tenth of the time of many small factorisations. Programs keep it.
///
/// The function does nothing without glibc.
pub fn let_threads_allocate() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        extern "C" {
            fn mallopt(parameter: std::ffi::c_int, value: std::ffi::c_int) -> std::ffi::c_int;
        }
        // From malloc.h.
        const M_TRIM_THRESHOLD: std::ffi::c_int = -1;
        const M_TOP_PAD: std::ffi::c_int = -2;
        const M_MMAP_THRESHOLD: std::ffi::c_int = -3;
        // Setting one parameter ends the adaptation of the other; this is the final value of the adaptation.
        const LARGEST: std::ffi::c_int = 32 << 20;
        const KEPT: std::ffi::c_int = 1 << 30;
        // SAFETY: mallopt takes two integers and may be called at any time; a value that it refuses changes nothing.
        unsafe {
            mallopt(M_TOP_PAD, SEGMENT);
            mallopt(M_MMAP_THRESHOLD, LARGEST);
            mallopt(M_TRIM_THRESHOLD, KEPT);
        }
    }
}
