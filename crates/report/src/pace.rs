//! How much of a long run is left, by what its parts have taken so far.

use std::time::{Duration, Instant};

/// The pace of a run of several parts.
pub struct Pace {
    start: Instant,
    parts: usize,
    done: usize,
}

impl Pace {
    /// The pace of a run of so many parts that begins now.
    pub fn new(parts: usize) -> Pace {
        Pace {
            start: Instant::now(),
            parts,
            done: 0,
        }
    }

    /// A part is done.
    pub fn done(&mut self) {
        self.done += 1;
    }

    /// A part is left out.
    pub fn skip(&mut self) {
        self.parts = self.parts.saturating_sub(1);
    }

    /// Such as "; 3 of 10 done, about 2 min left"; empty before the first part is done, and at the end.
    pub fn text(&self) -> String {
        match left(self.start.elapsed(), self.done, self.parts) {
            None => String::new(),
            Some(left) => format!("; {} of {} done, {left}", self.done, self.parts),
        }
    }
}

/// The time that is left if the rest takes as long for each part; `None` where nothing is done, or nothing is left.
pub fn left(elapsed: Duration, done: usize, parts: usize) -> Option<String> {
    if done == 0 || done >= parts {
        return None;
    }
    let seconds = elapsed.as_secs_f64() / done as f64 * (parts - done) as f64;
    Some(match seconds {
        s if s < 1.0 => "less than 1 s left".into(),
        s if s < 100.0 => format!("about {s:.0} s left"),
        s if s < 6000.0 => format!("about {:.0} min left", s / 60.0),
        s => format!("about {:.1} h left", s / 3600.0),
    })
}

#[cfg(test)]
#[path = "../tests/pace.rs"]
mod tests;
