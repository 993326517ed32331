//! The threads that share one rank's subdomains.

use std::sync::Mutex;

use rayon::prelude::*;

use base::{Error, Result};

/// A pool of threads, or none: subdomains are then processed one after the other.
pub struct Team {
    pool: Option<rayon::ThreadPool>,
    /// Whether one iteration has enough work to be worth waking threads.
    iterates: bool,
}

/// If the dense operators have fewer entries than this, one thread applies them faster than two can be woken. Waking
/// takes some ten microseconds; a core reads about this many numbers in that time.
const WORTH_WAKING: usize = 100_000;

impl Team {
    /// A team of `threads` threads (0 or 1: no pool).
    pub fn new(threads: usize) -> Result<Team> {
        if threads < 2 {
            return Ok(Team {
                pool: None,
                iterates: false,
            });
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| {
                Error::environment(format!("cannot start {threads} threads")).because(e)
            })?;
        Ok(Team {
            pool: Some(pool),
            iterates: true,
        })
    }

    /// Number of threads that work.
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or(1, |p| p.current_num_threads())
    }

    /// Sets the number of entries of the dense operators that one iteration applies.
    pub fn set_load(&mut self, entries: usize) {
        self.iterates = entries > WORTH_WAKING;
    }

    /// Runs `work` on every item; items are independent of each other.
    pub fn for_each<T: Send>(&self, items: &mut [T], work: impl Fn(usize, &mut T) + Sync + Send) {
        match self.pool.as_ref().filter(|_| self.iterates) {
            Some(pool) => each(pool, items, &work),
            None => items
                .iter_mut()
                .enumerate()
                .for_each(|(i, item)| work(i, item)),
        }
    }

    /// Calls `work` for every index below `n`; results are in order.
    pub fn map<T: Send>(&self, n: usize, work: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
        match &self.pool {
            Some(pool) => {
                let results: Vec<Mutex<Option<T>>> = (0..n).map(|_| Mutex::new(None)).collect();
                each(pool, &mut vec![(); n], &|i, ()| {
                    let result = work(i);
                    *results[i].lock().expect("nobody else has it") = Some(result);
                });
                let results = results.into_iter();
                let result = |r: Mutex<Option<T>>| r.into_inner().ok().flatten();
                results
                    .map(|r| result(r).expect("every index is called"))
                    .collect()
            }
            None => (0..n).map(work).collect(),
        }
    }
}

/// Calls `work` for every item. Rayon's code is made once for each type of items and not for each `work`: it was a
/// twentieth of what is compiled.
fn each<T: Send>(pool: &rayon::ThreadPool, items: &mut [T], work: &(dyn Fn(usize, &mut T) + Sync)) {
    let all = items.par_iter_mut().enumerate();
    pool.install(|| all.for_each(|(i, item)| work(i, item)));
}
