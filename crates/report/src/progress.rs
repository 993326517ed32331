//! A progress line on stderr for the phases of a run and for the contact loop, redrawn in place and removed at the end.
//! There is none where stderr is not a terminal.
//!
//! ```text
//! load step 4 of 20, about 12 s left, contact step 3, 9 active  [######>        ] 2.3e-4 of 1.0e-8, 17 it
//! ```

use super::pace::left;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Length of the bar in characters.
const BAR: usize = 30;
/// Shortest time between two redraws: more than twenty per second are not visible.
const PAUSE: Duration = Duration::from_millis(50);

/// The line.
pub struct ProgressLine {
    out: Option<Box<dyn Write>>,
    now: Box<dyn Fn() -> Duration>,
    drawn: Option<Duration>,
    width: usize,
    step: usize,
    active: usize,
    /// The load step, if there are several, with what is left.
    load_step: String,
    /// When the first load step began, and its number.
    began: Option<(Duration, usize)>,
}

impl ProgressLine {
    /// A line on stderr, if that is a terminal and `enabled` is set: on rank 0, without `--quiet`.
    pub fn new(enabled: bool) -> Self {
        let start = Instant::now();
        let terminal = enabled && std::io::stderr().is_terminal();
        let out: Option<Box<dyn Write>> = if terminal {
            Some(Box::new(std::io::stderr()))
        } else {
            None
        };
        ProgressLine::to(out, Box::new(move || start.elapsed()))
    }

    /// A line on any writer, or none, with any clock; for tests.
    pub fn to(out: Option<Box<dyn Write>>, now: Box<dyn Fn() -> Duration>) -> Self {
        ProgressLine {
            out,
            now,
            drawn: None,
            width: 0,
            step: 0,
            active: 0,
            load_step: String::new(),
            began: None,
        }
    }

    /// Shows a phase outside the iterations.
    pub fn phase(&mut self, what: &str) {
        self.draw(what);
    }

    /// Starts load step `step` of `n`, counted from 0; what is left follows from the steps since the first call.
    pub fn load_step(&mut self, step: usize, n: usize) {
        let now = (self.now)();
        let (start, first) = *self.began.get_or_insert((now, step));
        let left = left(now.saturating_sub(start), step - first, n - first);
        let left = left.map_or(String::new(), |left| format!(", {left}"));
        self.load_step = format!("load step {} of {n}{left}", step + 1);
        let line = self.load_step.clone();
        self.draw(&line);
    }

    /// Starts an outer step. The line is always redrawn: outer steps are few.
    pub fn step(&mut self, step: usize, active: usize) {
        (self.step, self.active) = (step, active);
        self.draw(&self.line(None));
    }

    /// Shows the residual after some inner iterations of the step, relative to its start. The line is redrawn at most
    /// twenty times a second.
    pub fn residual(&mut self, relative: f64, tolerance: f64, iterations: usize) {
        if self.out.is_none() {
            return;
        }
        let early = |last: Duration| (self.now)() < last + PAUSE;
        if self.drawn.is_some_and(early) {
            return;
        }
        self.draw(&self.line(Some((relative, tolerance, iterations))));
    }

    /// Removes the line. Also done when the value is dropped.
    pub fn finish(&mut self) {
        if self.width > 0 {
            let blank = " ".repeat(self.width);
            self.put(&format!("\r{blank}\r"));
            self.width = 0;
        }
    }

    fn line(&self, residual: Option<(f64, f64, usize)>) -> String {
        let before = match self.load_step.as_str() {
            "" => String::new(),
            step => format!("{step}, "),
        };
        let mut text = format!("{before}contact step {}, {} active", self.step, self.active);
        let (relative, tolerance, iterations) = residual.unwrap_or((1.0, f64::NAN, 0));
        let cells = (fraction(relative, tolerance) * BAR as f64) as usize;
        let mut bar = "#".repeat(cells);
        if cells < BAR {
            bar.push('>');
        }
        text += &format!("  [{bar:<BAR$}]");
        if residual.is_some() {
            text += &format!(" {relative:.1e} of {tolerance:.1e}, {iterations} it");
        }
        text
    }

    fn draw(&mut self, line: &str) {
        if self.out.is_none() {
            return;
        }
        let width = line.chars().count();
        // Blanks overwrite the end of a longer line before.
        let rest = " ".repeat(self.width.saturating_sub(width));
        self.put(&format!("\r{line}{rest}"));
        self.width = width;
        self.drawn = Some((self.now)());
    }

    fn put(&mut self, text: &str) {
        if let Some(out) = &mut self.out {
            // If the terminal has gone away, the computation continues.
            if out
                .write_all(text.as_bytes())
                .and_then(|()| out.flush())
                .is_err()
            {
                self.out = None;
            }
        }
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        self.finish();
    }
}

/// Progress of a residual from 1 to the tolerance, in decades; between 0 and 1.
fn fraction(relative: f64, tolerance: f64) -> f64 {
    if relative.is_nan() || tolerance.is_nan() || tolerance >= 1.0 {
        // No decades to cover, or no number: full when the residual is small enough.
        return if relative <= tolerance { 1.0 } else { 0.0 };
    }
    let decades = relative.max(1e-300).log10() / tolerance.max(1e-300).log10();
    decades.clamp(0.0, 1.0)
}

#[cfg(test)]
#[path = "../tests/progress.rs"]
mod tests;
