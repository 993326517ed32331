//! The C library's heap in our own programs.

use petsc_sys as sys;
use std::alloc::{GlobalAlloc, Layout, System};

/// The system's allocator, which ends the program with a sentence and exit code 3 where there is no memory. Rust's own
/// answer is abort(), at which MPI prints a stack. A program names it as its `#[global_allocator]`.
pub struct Heap;

/// `memory`, if it is some.
fn got(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() && bytes > 0 {
        // SAFETY: the function does not return, and allocates nothing.
        unsafe { sys::ff_no_memory(bytes) }
    }
    memory
}

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Heap {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: by the caller, as for the calls below.
        got(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: by the caller.
        got(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: by the caller.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: by the caller.
        got(unsafe { System.realloc(memory, layout, size) }, size)
    }
}

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

/// Gives memory that is free back to the system, also that between what is in use. Programs call it when they are done
/// with many lists that nothing needs any more: what comes next is large and does not fit into the gaps that they
/// leave.
///
/// The function does nothing without glibc.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        extern "C" {
            fn malloc_trim(kept: usize) -> std::ffi::c_int;
        }
        // SAFETY: malloc_trim takes a number and may be called at any time.
        unsafe {
            malloc_trim(0);
        }
    }
}
