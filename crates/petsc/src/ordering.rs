//! Fill-reducing orderings of graphs by METIS and Scotch.
//!
//! Both libraries keep the state of their random numbers in global variables. Calls are serialised and start from the
//! same state: an ordering depends on its graph alone.

use std::os::raw::c_int;
use std::sync::{Mutex, PoisonError};

use petsc_sys as sys;

/// Serialises the calls.
static ALONE: Mutex<()> = Mutex::new(());

/// A symmetric graph without loops in compressed rows, both directions of every edge.
#[derive(Debug, Clone, Default)]
pub struct Graph {
    /// Start of each vertex's neighbours; length n + 1.
    pub row: Vec<i32>,
    /// Neighbours, increasing for each vertex.
    pub col: Vec<i32>,
}

/// Whether this build has METIS.
pub fn have_metis() -> bool {
    // SAFETY: takes nothing, returns a constant.
    unsafe { sys::ff_have_metis() != 0 }
}

/// Whether this build has Scotch.
pub fn have_scotch() -> bool {
    // SAFETY: takes nothing, returns a constant.
    unsafe { sys::ff_have_scotch() != 0 }
}

/// METIS's nested dissection: the vertices in the order of elimination.
///
/// # Errors The reason of a failure, one sentence without a full stop.
pub fn metis(graph: &Graph) -> Result<Vec<u32>, String> {
    order(graph, "METIS", sys::ff_metis_order)
}

/// Scotch's nested dissection: the vertices in the order of elimination.
///
/// # Errors The reason of a failure, one sentence without a full stop.
pub fn scotch(graph: &Graph) -> Result<Vec<u32>, String> {
    order(graph, "Scotch", sys::ff_scotch_order)
}

type Order = unsafe extern "C" fn(c_int, *const c_int, *const c_int, *mut c_int) -> c_int;

fn order(graph: &Graph, library: &str, call: Order) -> Result<Vec<u32>, String> {
    let n = graph.row.len().saturating_sub(1);
    assert_eq!(graph.row.last().map_or(0, |&e| e as usize), graph.col.len());
    if n == 0 {
        return Ok(Vec::new());
    }
    let mut found: Vec<c_int> = vec![0; n];
    // A poisoned lock does not matter: it guards no data of ours.
    let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // SAFETY: the arrays have n + 1, row[n] and n entries, live until the call returns, and nobody else is in the
    // library.
    let code = unsafe {
        call(
            n as c_int,
            graph.row.as_ptr(),
            graph.col.as_ptr(),
            found.as_mut_ptr(),
        )
    };
    drop(alone);
    if code != 0 {
        return Err(complaint(library, code));
    }
    Ok(found.into_iter().map(|i| i as u32).collect())
}

/// The meaning of a wrapper's error code, one sentence without a full stop.
fn complaint(library: &str, code: c_int) -> String {
    match code {
        sys::FF_ABSENT => format!("this build has no {library}"),
        c if c == sys::FF_NO_MEMORY as c_int => {
            format!("{library} has not enough memory for the ordering")
        }
        _ => format!("{library} failed at the ordering"),
    }
}
